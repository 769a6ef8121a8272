"""Strict bounds of several bodies: edges that match or not, smooth, rough, rubbing, bonded."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csr_matrix

import lacore as la
from lacore.bounds.static_bonds import StaticBonds
from lacore.model.problem.matching import glued
from lacore.reporting.kinds import Kind
from tests.lacore.models import CRITERION

LAWS = [la.SMOOTH, la.Tresca(0.3), la.Coulomb(0.3, associated=True), la.STICK, la.BOND]
EXACT = 1e-9  # of a load factor: sums over some thousand terms that are exact to 1e-15 each


def under(x):
    return (x[0] <= 0.5) & (x[1] > -1e-9)


def layers(law=la.BOND, below=(6, 2), strengths=(1.0, 1.0), depth=1.0):
    """Half of a rough strip footing of width 1 on two layers, the upper one 0.5 deep."""
    nx, ny = below
    top, low = (la.VonMises(shear_strength=k) for k in strengths)
    bodies = {
        "top": la.Body(la.meshes.rectangle((0, 2), (-0.5, 0), 8, 2), top),
        "low": la.Body(la.meshes.rectangle((0, 2), (-depth, -0.5), nx, ny), low),
    }
    held = [
        la.Fix(name, side, "xy" if side == "right" else "x")
        for name in bodies
        for side in ("left", "right")
    ]
    return la.Problem(
        bodies,
        [la.RigidFooting("top", under, (0, -1))],
        [*held, la.Fix("low", "bottom")],
        [la.Interface(("low", "top"), ("top", "bottom"), law)],
    )


@pytest.mark.parametrize("below", [(8, 2), (4, 2), (11, 3)], ids=["same", "nested", "other"])
@pytest.mark.parametrize("law", LAWS, ids=str)
def test_bounds_enclose_and_gaps_add_up(law, below):
    """Whether or not edges match; the gap is split on meshes that do."""
    problem = layers(law, below)
    lower, upper = la.lower_bound(problem), la.upper_bound(problem)
    assert (lower.rigor, upper.rigor) == (la.Rigor.LOWER, la.Rigor.UPPER)
    assert lower.load_factor <= upper.load_factor
    above = la.upper_bound(la.matching(problem))
    identity = la.gap_identity(above, lower)
    assert identity.total == pytest.approx(
        identity.upper - identity.lower, abs=EXACT * identity.upper
    )
    assert identity.least >= -EXACT * identity.upper


def test_laws_stand_in_their_order():
    """What carries more of one interface carries more of the structure; on one mesh exactly."""
    smooth, rubbed, stuck, bonded = (
        la.lower_bound(layers(law)).load_factor for law in (LAWS[0], LAWS[1], LAWS[3], LAWS[4])
    )
    round_off = 1e-6  # of solves to 1e-8
    assert smooth <= rubbed + round_off
    assert rubbed <= stuck + round_off
    assert stuck <= bonded + round_off


def test_gaps_of_other_meshes_are_refused_with_the_mend():
    problem = layers(below=(11, 3))
    with pytest.raises(la.InputError, match=r"lacore\.matching") as wrong:
        la.gap_identity(la.upper_bound(problem), la.lower_bound(problem))
    assert wrong.value.fix


def test_matching_divides_what_does_not_match_and_nothing_else():
    problem = layers(below=(11, 3))
    matched = la.matching(problem)
    assert la.matching(matched) is matched
    assert la.matching(layers(below=(8, 2))).bodies["top"].mesh.nelements == 8 * 2 * 4
    for name, body in matched.bodies.items():
        before, mesh = problem.bodies[name].mesh, body.mesh
        assert set(mesh.boundaries) == set(before.boundaries)
        for side in before.boundaries:
            assert _length(mesh, side) == pytest.approx(_length(before, side), rel=1e-12)
    segments = matched.segments[0]
    (glue,) = glued(matched, bonded=True)
    one, other = (
        matched.bodies[name].mesh.p[:, own]
        for name, own in zip((glue.first, glue.second), glue.vertices, strict=True)
    )
    assert one.shape[1] == 2 * segments.slave.size
    assert one == pytest.approx(other, abs=1e-12)


def _length(mesh, side):
    ends = mesh.p[:, mesh.facets[:, mesh.boundaries[side]]]
    return float(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=0).sum())


def test_a_shorter_body_gets_a_vertex_where_it_ends():
    """A punch that ends inside an edge of the ground: tractions end there, too."""
    ground = la.Body(la.meshes.rectangle((0, 3), (-1, 0), 5, 2), CRITERION)
    punch = la.Body(la.meshes.rectangle((1, 2), (0, 1), 2, 2), la.VonMises(shear_strength=9.0))
    bond = la.Interface(("punch", "bottom"), ("ground", lambda x: x[1] > -1e-9), la.BOND)
    problem = la.Problem(
        {"ground": ground, "punch": punch},
        [la.Traction("punch", "top", (0, -1))],
        [la.Fix("ground", "bottom"), la.Fix("ground", "left"), la.Fix("ground", "right")],
        [bond],
    )
    lower, upper = la.lower_bound(problem), la.upper_bound(la.matching(problem))
    assert lower.status is upper.status is la.Status.SOLVED
    assert 2.0 < lower.load_factor <= upper.load_factor


def test_a_support_of_bonded_edges_has_no_lower_bound():
    problem = layers(below=(8, 2))
    seam = la.Fix("top", lambda x: x[1] < -0.5 + 1e-9, "x")
    with pytest.raises(la.InputError, match="holds edges that are bonded"):
        la.lower_bound(replace(problem, supports=(*problem.supports, seam)))


def clay_on_sand(friction_angle, below):
    """As `layers`, the lower layer of soil in a closed box, which the clay flows over."""
    problem = layers(below=below)
    low = replace(problem.bodies["low"], criterion=la.MohrCoulomb(1.0, friction_angle))
    return replace(problem, bodies={**problem.bodies, "low": low})


@pytest.mark.parametrize("below", [(8, 2), (11, 3)], ids=["same", "other"])
def test_soil_that_rests_is_rigid_in_velocities_that_prove(below):
    """What a solver leaves of its strains, 1e-8, is no flow that soil has; none at all is one."""
    problem = clay_on_sand(45.0, below)
    upper, lower = la.upper_bound(problem), la.lower_bound(la.matching(problem))
    assert upper.rigor is la.Rigor.UPPER
    assert lower.load_factor <= upper.load_factor
    moved = np.abs(upper.velocity[upper.discretisation.continua["low"].dofs])
    assert moved.max() <= EXACT * np.abs(upper.velocity).max()


def test_soil_that_moves_may_be_rigid_in_velocities_that_prove():
    """A strong block of soil on clay, pushed aside: shear k of the clay under 0.9, on 0.3."""
    cap = la.Body(la.meshes.rectangle((-0.2, 0.7), (0, 0.3), 5, 2), la.MohrCoulomb(50.0, 30.0))
    clay = la.Body(la.meshes.rectangle((-2, 2.5), (-1, 0), 18, 4), CRITERION)

    def beside(x):
        return (np.abs(x[0] - 0.25) <= 0.5 + 1e-9) & (x[1] > -1e-9)

    problem = la.Problem(
        {"cap": cap, "clay": clay},
        [la.Traction("cap", "left", (1, 0))],
        [la.Fix("clay", side) for side in ("left", "right", "bottom")],
        [la.Interface(("cap", "bottom"), ("clay", beside), la.BOND)],
    )
    upper = la.upper_bound(problem)
    assert upper.rigor is la.Rigor.UPPER
    assert upper.load_factor == pytest.approx(0.9 / 0.3, rel=1e-6)


@pytest.mark.parametrize("space", ["p2-vertex", "p2-disc"])
def test_bounds_that_are_not_proven_say_why(monkeypatch, space):
    """Left as the solver found it soil flows a little as it cannot: 1e-9 of the largest rate."""
    monkeypatch.setattr(
        "lacore.bounds.upper.possible_velocity",
        lambda program, velocity, prepare: velocity / float(program.reference_load @ velocity),
    )
    problem = layers(below=(11, 3))
    soil = {
        name: replace(own, criterion=la.MohrCoulomb(1.0, 20.0), space=space)
        for name, own in problem.bodies.items()
    }
    upper = la.upper_bound(replace(problem, bodies=soil))
    assert ("take 'p2-vertex'" in upper.message) == (space != "p2-vertex")
    assert upper.status is la.Status.NOT_CERTIFIED
    assert upper.state.status is la.Status.SOLVED
    assert upper.findings[0].kind is Kind.FLOW_NOT_POSSIBLE
    assert "low" in upper.findings[0].where
    assert "'low' by" in upper.message
    assert upper.message.endswith(upper.state.message)
    assert "dilates too little" in upper.facts().told["status"]


def test_tractions_on_a_jump_share_their_power():
    """Of nodes that are tied the mean of both; beside a block the motion of that."""
    n = 6  # x and y of three nodes: the second follows the first, the third a block at rest
    rows = csr_matrix(([1.0, 1.0], ([0, 2], [0, 1])), shape=(4, n))
    bonds = StaticBonds(np.array([1, 2]), np.array([0, -1]), rows)
    carried = bonds.carried(np.array([1.0, 2.0, 3.0, 6.0, 7.0, 8.0]))
    assert carried.tolist() == [2.0, 4.0, 2.0, 4.0, 0.0, 0.0]
