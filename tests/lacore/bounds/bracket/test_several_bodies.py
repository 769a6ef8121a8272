"""Brackets of several bodies: each mesh adapts, and both sides of an interface alike."""

import numpy as np
import pytest

import lacore as la
from lacore.bounds.bracket.singular_points import singular_vertices
from lacore.bounds.bracket.whole import mesh_of, on_mesh
from lacore.model.problem.matching import matching
from tests.lacore.assembly.test_bonds import cut_flat, cut_upright, whole
from tests.lacore.bounds.test_several_bodies import layers


@pytest.mark.parametrize("cut", [cut_flat, cut_upright])
def test_a_cut_body_has_the_bracket_of_the_uncut_one(cut):
    """The same elements in another order: by its load factors the same bracket."""
    one, other = (la.bracket(own, 0.1) for own in (whole(), cut()))
    assert other.status is one.status is la.Ending.REACHED
    assert other.strict
    # Shares that are equal but for round-off may be refined in another order.
    assert other.lower <= one.upper
    assert one.lower <= other.upper
    assert other.lower_bound.model.n_elements < 2 * one.lower_bound.model.n_elements


@pytest.mark.parametrize(
    "law", [la.SMOOTH, la.Tresca(0.3), la.Coulomb(0.3, associated=True), la.STICK, la.BOND], ids=str
)
def test_interfaces_of_any_law(law):
    found = la.bracket(layers(law, (7, 2)), 0.2)
    assert found.status is la.Ending.REACHED
    assert found.strict
    gaps = found.gaps()
    assert gaps.total == pytest.approx(found.upper_bound.load_factor - gaps.lower, rel=1e-6)
    sides = found.upper_bound.discretisation.problem
    assert matching(sides) is sides


@pytest.mark.parametrize(
    ("strengths", "depth", "exact"),
    [((1.0, 2.0), 1.25, (5.2657, 5.2831)), ((1.0, 0.5), 2.5, (3.6882, 3.7012))],
    ids=["soft on stiff", "stiff on soft"],
)
@pytest.mark.parametrize("meshes", ["shared", "separate"])
def test_layered_clay(strengths, depth, exact, meshes):
    """Strict brackets of REFERENCES_LAYERED; a box of 3.5 widths holds both mechanisms."""
    top = la.Body(
        la.meshes.rectangle((0, 3.5), (-0.5, 0), 21, 3), la.VonMises(shear_strength=strengths[0])
    )
    low = la.Body(
        la.meshes.rectangle((0, 3.5), (-depth, -0.5), 19, round(6 * depth) - 3),
        la.VonMises(shear_strength=strengths[1]),
    )
    bodies = {"top": top, "low": low}
    problem = la.Problem(
        bodies,
        [la.RigidFooting("top", lambda x: (x[0] <= 0.5) & (x[1] > -1e-9), (0, -1))],
        [
            *(la.Fix(name, "left", "x") for name in bodies),
            *(la.Fix(name, "right") for name in bodies),
            la.Fix("low", "bottom"),
        ],
        [la.Interface(("top", "bottom"), ("low", "top"), la.BOND)],
    )
    found = la.bracket(problem, 0.02, meshes=meshes)
    assert found.status is la.Ending.REACHED
    assert found.lower <= exact[1]
    assert exact[0] <= found.upper


def test_singular_points_of_what_is_bonded_are_those_of_one_body():
    """Where a footing ends at a bond, no angle is straight in either part."""
    places = []
    for problem in (whole(), cut_flat(), cut_upright()):
        mesh = mesh_of(problem)
        places.append(mesh.p[:, singular_vertices(problem)].T.tolist())
    assert places[0] == places[1] == places[2] == [[0.5, 0.0]]


def test_meshes_are_told_apart_as_they_were_joined():
    problem = cut_upright()
    again = on_mesh(problem, mesh_of(problem))
    for name, body in problem.bodies.items():
        other = again.bodies[name].mesh
        order, its = (np.lexsort(mesh.p) for mesh in (body.mesh, other))
        assert np.array_equal(body.mesh.p[:, order], other.p[:, its])
        assert set(other.boundaries) == set(body.mesh.boundaries)
        for side, facets in body.mesh.boundaries.items():
            assert len(other.boundaries[side]) == len(facets)
    uncut = la.solve(problem).load_factor
    assert la.solve(again).load_factor == pytest.approx(uncut, rel=1e-8)


def test_a_bracket_says_which_side_stopped_and_why():
    found = la.bracket(cut_flat(), 1e-3, max_elements=130)
    assert found.status is la.Ending.MAX_ELEMENTS
    assert "lower and upper bounds stopped at" in found.message
    assert "max elements" in found.message
    late = la.bracket(cut_flat(), 1e-4, time_limit=1e-3, meshes="separate")
    assert late.status is la.Ending.TIME_LIMIT
    assert "would end after the time limit" in late.message
    assert "lower bound stopped at" in late.message
    assert "upper bound stopped at" in late.message


def test_options_are_those_of_the_backend():
    with pytest.raises(la.InputError, match="tolerance"):
        la.bracket(cut_flat(), 0.1, options={"tolerence": 1.0})
    found = la.bracket(cut_flat(), 0.1, options={"tolerance": 1e-7})
    assert found.lower_bound.options["tolerance"] == 1e-7


def test_one_mesh_for_several_bodies_is_refused():
    mesh = la.meshes.rectangle((0, 2), (-1, 0), 4, 2)
    with pytest.raises(la.InputError, match="has the bodies"):
        la.bracket(cut_flat(), 0.1, lower_mesh=mesh)


def stack(low, up, way=-1.0, place=(0.0, 1.0)):
    """A square on another one, bonded, their meshes unlike, under a uniform traction."""
    bodies = {
        "low": la.Body(la.meshes.rectangle((0, 1), (0, 1), 4, 4), la.VonMises(shear_strength=low)),
        "up": la.Body(la.meshes.rectangle(place, (1, 2), 3, 3), la.VonMises(shear_strength=up)),
    }
    return la.Problem(
        bodies,
        [la.Traction("up", "top", (0, way))],
        [la.Fix("low", "bottom", "y"), la.Fix("low", "left", "x")],
        [la.Interface(("up", "bottom"), ("low", "top"), la.BOND)],
    )


@pytest.mark.parametrize("way", [-1.0, 1.0], ids=["pressed", "pulled"])
@pytest.mark.parametrize("strengths", [(1.0, 3.0), (3.0, 1.0)], ids=["below", "above"])
def test_a_bonded_stack_is_as_strong_as_its_weaker_part(strengths, way):
    """A plane of shear at 45 degrees fits into either: 2 k of the weaker one."""
    found = la.bracket(stack(*strengths, way), 0.05)
    assert found.strict
    assert found.lower <= 2.0 * (1 + 1e-9)
    assert found.upper >= 2.0


def test_a_bonded_block_on_soil_is_a_rough_footing():
    """Prandtl's N_c at 15 degrees, ``cot(phi) (tan^2(45 + phi/2) e^(pi tan(phi)) - 1) = 10.98``."""
    foot = la.RigidBlock([(0, 0), (0.5, 0), (0.5, 0.2), (0, 0.2)])
    soil = la.Body(la.meshes.rectangle((0, 2.5), (-1.2, 0), 10, 5), la.MohrCoulomb(1.0, 15.0))

    def under(x):
        return (x[1] > -1e-9) & (x[0] <= 0.5 + 1e-9)

    problem = la.Problem(
        {"soil": soil, "foot": foot},
        [la.Pressure("foot", lambda x: x[1] > 0.2 - 1e-9, 1.0)],
        [
            *(la.Fix("soil", side) for side in ("right", "bottom")),
            la.Fix("soil", "left", "x"),
            la.Fix("foot", lambda x: x[0] < 1e-9, "x"),
        ],
        [la.Interface(("soil", under), ("foot", lambda x: x[1] < 1e-9), la.BOND)],
    )
    found = la.bracket(problem, 0.05)
    tangent = np.tan(np.radians(15.0))
    grown = np.tan(np.radians(52.5)) ** 2 * np.exp(np.pi * tangent)
    assert found.strict
    assert found.lower <= (grown - 1) / tangent <= found.upper


@pytest.mark.parametrize(
    ("place", "told"),
    [
        ((0.0, 1.1, 2.1), "does not touch"),
        ((0.0, 1.0001, 2.0001), "0.0001 m apart; move one body"),
        ((0.0, 0.9, 1.9), "does not touch"),
        ((2.0, 1.0, 2.0), "does not touch"),
    ],
    ids=["apart", "nearly", "overlapping", "beside"],
)
def test_bodies_that_are_not_where_they_should_be(place, told):
    given = stack(1.0, 1.0)
    left, low, high = place
    moved = la.Body(la.meshes.rectangle((left, left + 1), (low, high), 3, 3), la.VonMises(1.0))
    with pytest.raises(la.InputError, match=told):
        la.Problem(
            {"low": given.bodies["low"], "up": moved},
            given.reference_loads,
            given.supports,
            given.interfaces,
        )
