"""What bounds promise in any unit, and where a yield surface or a boundary is replaced."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from skfem import MeshTri

import lacore as la
from lacore.assembly.discretise import discretise
from lacore.bounds import lower as lower_module
from lacore.bounds import upper as upper_module
from lacore.bounds.bracket.singular_points import friction_of
from lacore.bounds.equilibrium import EquilibriumDofs
from lacore.bounds.static_contact import _matched
from lacore.bounds.static_corners import CornerError
from lacore.bounds.static_model import static_model
from lacore.bounds.velocity_projection import admissible_velocity
from lacore.limit.conversion import point_in_program
from lacore.model.bodies.any_body import numbered
from lacore.program.kinematic import dimensionless
from lacore.reporting.kinds import Kind
from tests.lacore.models import CRITERION, cantilever, deformable_block


@pytest.mark.parametrize("friction", [la.Coulomb(0.3, associated=True), la.Tresca(0.4)])
@pytest.mark.parametrize("factor", [1e-6, 1e6])
def test_an_admissible_velocity_does_not_depend_on_the_unit_of_speed(friction, factor):
    """It is normalised by the power of the load; what slides keeps sliding, and dilates by it."""
    d = discretise(deformable_block(friction))
    program = dimensionless(d.program, d.natural)
    velocity = point_in_program(d, la.solve(d).point).velocity
    one, other = (admissible_velocity(program, own * velocity) for own in (1.0, factor))
    assert np.abs(one - velocity).max() <= 1e-6 * np.abs(velocity).max()
    assert np.abs(other - one).max() <= 1e-12 * np.abs(one).max()


@pytest.mark.parametrize(
    ("start", "end", "matches"),
    [
        ((0, 0), (1, 0), True),
        ((1, 0), (0, 0), True),
        ((0, 0), (2, 0), False),
        ((0.5, 0), (1, 0), False),
        ((1, 0), (2, 0), False),
    ],
)
def test_edges_of_two_sides_match_at_both_ends_or_not_at_all(start, end, matches):
    """Tractions that are linear on both edges would have to be linear on the whole."""
    body = la.Body(la.meshes.rectangle((0, 1), (-1, 0), 1, 1), CRITERION)
    (dofs,) = numbered({"low": body}, EquilibriumDofs.at).values()
    facets, interface = body.mesh.boundaries["top"], SimpleNamespace(name="contact")
    ends = tuple(np.array(own, dtype=float)[:, None] for own in (start, end))
    if matches:
        first, last = _matched(dofs, interface, facets, ends, "field")
        nodes = dofs.facet_nodes(facets)[:, 0]
        place = body.mesh.p[0, body.mesh.facets[:, facets[0]]]
        expected = nodes if place[0] == start[0] else nodes[::-1]
        assert [first, last] == expected.tolist()
        return
    with pytest.raises(la.InputError, match="the meshes of its two sides do not match"):
        _matched(dofs, interface, facets, ends, "field")


@pytest.mark.parametrize("unit", [1e-3, 1.0, 1e6])
def test_the_natural_speed_has_unit_power_on_the_reference_load(unit):
    """Solvers see forces whose sum at this speed is one."""
    stated = deformable_block(la.Tresca(0.4))
    load = la.Traction("block", "left", (unit, 0))
    model = static_model(replace(stated, reference_loads=[load]))
    forces = np.abs(model.full.reference_load).sum()
    assert forces * model.natural.velocity == pytest.approx(1.0)
    scaled = dimensionless(model.program, model.natural).reference_load
    assert np.abs(scaled).sum() <= 1.0 + 1e-12


@pytest.mark.parametrize("geometry", ["exact", "approximated"])
def test_a_bound_on_edges_that_replace_a_curve_is_labelled(geometry):
    """It is strict for the polygon alone, and says so."""
    stated = deformable_block(la.Tresca(0.4))
    body = replace(stated.bodies["block"], geometry=geometry)
    problem = replace(stated, bodies={"block": body})
    lower, upper = la.lower_bound(problem), la.upper_bound(problem)
    strict = geometry == "exact"
    assert lower.rigor is (la.Rigor.LOWER if strict else la.Rigor.DISCRETE)
    assert upper.rigor is (la.Rigor.UPPER if strict else la.Rigor.DISCRETE)
    warned = [own.kind for own in lower.findings if own.kind is Kind.POLYGON]
    assert len(warned) == (0 if strict else 1)


@pytest.mark.parametrize(
    ("polygon", "rigor"), [("inner", la.Rigor.DISCRETE), ("outer", la.Rigor.UPPER)]
)
def test_a_polygon_inside_of_a_yield_curve_proves_no_upper_bound(polygon, rigor):
    """A clamped column of a rectangular section, M = M_p (1 - (N/N_p)^2)."""
    section = la.sections.rectangle(1.0, 0.5, yield_stress=16.0, layers=2, polygon=polygon)
    frame = la.Frame({"a": (0, 0), "b": (0, 3.0)}, [("a", "b")], sections=section)
    problem = la.Problem(
        {"column": frame},
        [la.PointForce("column", "b", (1, 0))],
        [la.Fix("column", "a", "clamped")],
        dead_loads=[la.PointForce("column", "b", (0, -2.4))],  # 0.3 N_p
    )
    found = la.upper_bound(problem)
    assert found.rigor is rigor
    exact = (1 - 0.3**2) / 3.0
    assert (found.load_factor < exact) == (polygon == "inner")


def test_a_collapse_under_dead_load_is_proven_as_sharply_as_a_state(monkeypatch):
    """A velocity that proves it leaves no more than a limit state may leave by default."""
    asked, prove = [], lower_module.prove_claim

    def proving(*given):
        asked.append(given[-1])
        return prove(*given)

    monkeypatch.setattr(lower_module, "prove_claim", proving)
    heavy = replace(cantilever(), dead_loads=[la.BodyForce("block", (0, -10.0))])
    assert la.lower_bound(heavy).status is la.Status.UNSAFE
    assert asked == [la.solve(cantilever()).tolerance]


@pytest.mark.parametrize("angle", [0.0, 10.0, 30.0, 45.0])
def test_fans_follow_the_tangent_of_the_friction_angle(angle):
    soil = la.MohrCoulomb(1.0, angle) if angle else CRITERION
    body = la.Body(la.meshes.rectangle((0, 1), (0, 1), 1, 1), soil)
    assert friction_of(body) == pytest.approx(np.tan(np.radians(angle)))


@pytest.mark.parametrize(("components", "points"), [(None, 8), ("x", 8), ("y", 8), ("xy", 0)])
def test_contact_that_a_support_takes_altogether_has_no_reactions(components, points):
    """Four edges of two ends each; a support of one direction leaves the other one to contact."""
    stated = deformable_block(la.Tresca(0.4))
    held = [] if components is None else [la.Fix("block", "bottom", components)]
    if components == "xy":
        held.append(la.Fix("block", "left", "y"))
    problem = replace(stated, supports=held)
    model = static_model(replace(problem, reference_loads=[la.Traction("block", "top", (1, 1))]))
    assert model.program.contact.count == points


def test_a_velocity_that_leaks_is_reported_with_its_leak(monkeypatch):
    stated = discretise(deformable_block(la.STICK))
    true = upper_module.admissible_velocity

    def leaking(program, velocity):
        moved = true(program, velocity)
        noise = np.random.default_rng(0).uniform(-1e-3, 1e-3, moved.size)
        return moved + noise

    monkeypatch.setattr(upper_module, "admissible_velocity", leaking)
    found = la.upper_bound(stated)
    assert found.status is la.Status.NOT_CERTIFIED
    assert [own.kind for own in found.findings] == [Kind.VELOCITY_NOT_ADMISSIBLE, Kind.SOLVE]
    assert found.findings[0].values["leak"] == found.divergence > 1e-6


@pytest.mark.parametrize("name", ["reference_loads", "dead_loads"])
def test_quadratic_stresses_take_strength_in_proportion_to_their_load(name):
    """Of reference loads as far as the load factor, of dead loads always."""
    mesh = la.meshes.rectangle((0, 1), (0, 1), 2, 2)
    weight = la.BodyForce("soil", (0.0, la.Linear(-1.0, (0.5, 0.0), at=(0.0, 0.0))))
    push = la.Traction("soil", "top", (1, 0))
    loads = {"reference_loads": [push], "dead_loads": []}
    loads[name] = [*loads[name], weight]
    problem = la.Problem(
        {"soil": la.Body(mesh, la.VonMises(10.0))}, supports=[la.Fix("soil", "bottom")], **loads
    )
    model = static_model(problem)

    def taken(load_factor):
        (own,), (whole,) = model.weakened(load_factor).program.groups, model.program.groups
        return whole.bound - own.bound

    live = name == "reference_loads"
    assert taken(1.0).max() > 0
    assert taken(0.5) == pytest.approx((0.5 if live else 1.0) * taken(1.0))
    assert taken(-0.5) == pytest.approx(taken(0.5))
    assert taken(0.0) == pytest.approx(0.0 if live else taken(1.0))


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_natural_lengths_are_those_of_a_square_or_a_cube_as_large(size):
    """Of unit thickness in the plane."""
    flat = la.meshes.rectangle((0, 4 * size), (0, size), 4, 1)
    solid = la.meshes.box((0, 4 * size), (0, size), (0, 2 * size), 1, 1, 1)
    for mesh, kinematics, load, thickness in (
        (flat, "plane_strain", (1, 0), 1.0),
        (solid, "3d", (1, 0, 0), 2 * size),
    ):
        body = la.Body(mesh, CRITERION, kinematics=kinematics)
        loads, supports = [la.BodyForce("b", load)], [la.Fix("b", "bottom")]
        natural = static_model(la.Problem({"b": body}, loads, supports)).natural
        assert (natural.length, natural.thickness) == pytest.approx((2 * size, thickness))


@pytest.mark.parametrize("size", [1e-5, 1.0, 1e5])
@pytest.mark.parametrize(("rise", "fixed"), [(0.0, True), (0.1, False), (-0.1, False)])
def test_a_shear_that_ends_in_line_between_two_elements_needs_two_stresses(size, rise, fixed):
    """Two triangles whose outer edges are in line, or not: whatever their size."""
    corners = np.array([[-1, 0], [0, rise], [1, 0], [0, -1]], dtype=float).T
    mesh = MeshTri(size * corners, np.array([[0, 1, 3], [1, 2, 3]]).T).with_boundaries(
        {
            "sheared": lambda x: (x[0] < 0) & (x[1] > -0.25 * size),
            "held": lambda x: x[1] < -0.25 * size,
        }
    )
    loads, supports = [la.Traction("b", "sheared", (1, 0))], [la.Fix("b", "held")]
    problem = la.Problem({"b": la.Body(mesh, CRITERION)}, loads, supports)
    if not fixed:
        static_model(problem)
        return
    with pytest.raises(CornerError) as found:
        static_model(problem)
    assert found.value.elements == [0, 1]
