"""Bounds of a body with rigid blocks in contact with it: footings that turn and slide (T26b)."""

from dataclasses import replace
from math import cos, pi, sin

import numpy as np
import pytest

import lacore as la
from lacore.bounds.bracket.singular_points import singular_points
from lacore.bounds.velocity_projection import admissible_velocity
from lacore.limit.conversion import point_in_program
from lacore.program.kinematic import dimensionless
from tests.lacore.models import punch

PRANDTL = 2 + pi
# Of the load factor, as in test_static_bound: the backend's tolerance, and the margin off all
# strengths that dead loads and dilating friction cost, 1e-7 of the internal power.
SOLVED = 1e-9
WITH_MARGIN = 2e-7
LAWS = [la.SMOOTH, la.Tresca(0.4), la.Coulomb(0.3, associated=True), la.STICK]


def turned(points, angle):
    """Points of shape (2, n) about the origin."""
    return np.array([[cos(angle), -sin(angle)], [sin(angle), cos(angle)]]) @ points


def footing(
    friction,
    *,
    load=(0, -2),
    at=(0, 0.5),
    n=(8, 2),
    k=1.0,
    dead=(),
    angle=0.0,
    size=1.0,
    slave="punch",
    blocks=((-1, 1),),
    joint=la.SMOOTH,
):
    """Rigid blocks side by side on a stratum [-4, 4] x [-2, 0]: the load acts on the last one.

    Turned about by an angle, and as large as said.
    """

    def placed(points):
        return size * turned(points, angle)

    mesh = la.meshes.rectangle((-4, 4), (-2, 0), *n)
    named = {
        name: mesh.facets_satisfying(lambda x, at=at, axis=axis: x[axis] == at)
        for name, axis, at in (("bottom", 1, -2), ("left", 0, -4), ("right", 0, 4), ("top", 1, 0))
    }
    mesh = replace(mesh, doflocs=np.ascontiguousarray(placed(mesh.p)), _boundaries=named)
    outlines = {
        f"b{i}": placed(np.array([(a, 0), (b, 0), (b, 1), (a, 1)], dtype=float).T).T
        for i, (a, b) in enumerate(blocks)
    }
    last = f"b{len(blocks) - 1}"
    place = tuple(placed(np.reshape(at, (2, 1)).astype(float)).ravel().tolist())
    sides = (("punch", lambda x: abs(turned(x, -angle)[1]) < 1e-9 * size), ("soil", "top"))
    if slave == "soil":
        sides = sides[::-1]
    force = tuple(turned(np.reshape(load, (2, 1)).astype(float), angle).ravel().tolist())
    return la.Problem(
        {
            "soil": la.Body(mesh, la.VonMises(shear_strength=k)),
            "punch": la.BlockAssembly(outlines, joint),
        },
        [la.PointForce("punch", place, force, where=last)],
        [la.Fix("soil", side) for side in ("bottom", "left", "right")],
        [la.Interface(*sides, friction)],
        [la.PointForce("punch", name, force) for name, force in dead],
    )


def proven(bound):
    assert bound.status is la.Status.SOLVED, bound.message
    assert bound.certificate.equilibrium <= 1e-12
    assert bound.certificate.yield_violation <= 0
    assert bound.certificate.cone <= 0
    assert bound.rigor is la.Rigor.LOWER
    return bound.load_factor


def pair(problem):
    """Both bounds, which add up (T26)."""
    lower, upper = la.lower_bound(problem), la.upper_bound(problem)
    identity = la.gap_identity(upper, lower)
    power = sum(float(part.sum()) for part in upper.dissipation.values())
    size = max(abs(upper.load_factor), power)
    # Both are projected: equilibrium and admissible velocities to round-off of the sums.
    assert identity.total == pytest.approx(upper.load_factor - lower.load_factor, abs=1e-10 * size)
    assert identity.least >= -1e-10 * size
    return proven(lower), upper.load_factor


@pytest.mark.parametrize(("law", "rough"), [(la.SMOOTH, False), (la.STICK, True)])
def test_a_guided_block_is_a_rigid_footing(law, rough):
    """Held against sliding and turning it is what `RigidFooting` says, by other rows."""
    stated = punch(rough=rough)
    block = la.RigidBlock([(0, 0), (1, 0), (1, 1), (0, 1)])
    guided = replace(
        stated,
        bodies={**stated.bodies, "block": block},
        reference_loads=[la.PointForce("block", "block", (0, -1))],
        supports=[*stated.supports, la.Fix("block", lambda x: x[0] == 0, "x")],
        interfaces=[la.Interface(("block", lambda x: x[1] == 0), ("soil", "top"), law)],
    )
    one, other = proven(la.lower_bound(guided)), proven(la.lower_bound(stated))
    assert one == pytest.approx(other, rel=1e-8)  # two solves at 1e-10, each scaled anew
    assert singular_points(guided, "soil") == singular_points(stated, "soil")


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("slave", ["punch", "soil"])
def test_gaps_add_up_whoever_is_the_slave(law, slave):
    """Oblique and eccentric: the block turns and slides."""
    sideways = 0.0 if law is la.SMOOTH else 0.3
    lower, upper = pair(footing(law, load=(sideways, -2), at=(0.25, 1), slave=slave))
    assert 0 < lower < upper


def test_it_does_not_matter_who_is_the_slave_nor_how_it_is_turned_and_sized():
    law = la.Coulomb(0.3, associated=True)
    given = {"load": (0.3, -2), "at": (0.25, 1)}
    one = proven(la.lower_bound(footing(law, **given)))
    for change in ({"slave": "soil"}, {"angle": 0.7}, {"size": 1e3}, {"angle": -2.1, "size": 1e-2}):
        other = proven(la.lower_bound(footing(law, **given, **change)))
        assert other == pytest.approx(one * change.get("size", 1.0), rel=WITH_MARGIN)


def test_blocks_that_meet_inside_an_edge_of_the_mesh():
    """Tractions are linear over both; each gets what acts on its part."""
    blocks = ((-1, 0.3), (0.3, 1))
    dead = [("b0", (0, -1.0)), ("b1", (0, -0.5))]
    for law in LAWS:
        stated = footing(law, at=(0.65, 0.5), blocks=blocks, dead=dead, joint=la.Tresca(0.2))
        lower, upper = pair(stated)
        assert lower < upper


def test_parts_that_only_move_together_are_one_block():
    """Held against sliding and turning, one block or two under their shares of the load."""
    law = la.Tresca(0.3)
    values = []
    for blocks in (((0, 1),), ((0, 0.3), (0.3, 1))):
        stated = punch()
        outlines = {f"b{i}": [(a, 0), (b, 0), (b, 1), (a, 1)] for i, (a, b) in enumerate(blocks)}
        guided = replace(
            stated,
            bodies={**stated.bodies, "punch": la.BlockAssembly(outlines, la.STICK)},
            reference_loads=[la.PointForce("punch", (0.9, 1), (0, -1))],
            supports=[
                *stated.supports,
                la.Fix("punch", lambda x: x[1] == 1, "x"),
                la.Fix("punch", lambda x: x[1] == 0, "x"),
            ],
            interfaces=[la.Interface(("punch", lambda x: x[1] == 0), ("soil", "top"), law)],
        )
        values.append(proven(la.lower_bound(guided)))
    # The joint sticks, and opens nowhere: the load is on the part that pulls the other along.
    assert values[1] == pytest.approx(values[0], rel=1e-7)


@pytest.mark.parametrize(
    ("law", "expected"),
    [(la.Tresca(0.1), 0.2), (la.Coulomb(0.3, associated=True), 0.3), (la.SMOOTH, 0.0)],
)
def test_a_heavy_block_slides_on_strong_ground(law, expected):
    """CLOSED_FORMS C1: mu W, or the limit over the base; pushed just above its base."""
    stated = footing(law, load=(1, 0), at=(-1, 0.01), k=5.0, dead=[("b0", (0, -1.0))])
    lower = proven(la.lower_bound(stated))
    assert lower <= expected + 1e-15
    # 1e-10 of the strength of the ground is what the solver leaves.
    assert lower == pytest.approx(expected, rel=WITH_MARGIN, abs=4e-9)
    if expected > 0:  # else it is free to move
        assert la.upper_bound(stated).load_factor == pytest.approx(expected, rel=1e-6, abs=4e-9)


def test_a_heavy_block_topples_on_strong_ground():
    """CLOSED_FORMS C1: W b/(2 y), where reactions reach the corner: from below, order 1.

    Linear tractions on the last edge of length h have their resultant h/3 before the corner.
    """
    errors = []
    for nx in (8, 16, 32):
        stated = footing(
            la.Coulomb(3.0, associated=True),
            load=(1, 0),
            at=(-1, 1),
            k=1e3,
            n=(nx, 2),
            dead=[("b0", (0, -1.0))],
        )
        errors.append(1 - proven(la.lower_bound(stated)))
        assert errors[-1] == pytest.approx(8 / nx / 3, rel=0.02)  # the ground yields a little
    assert la.upper_bound(stated).load_factor >= 1 - 1e-9


def test_the_contact_of_a_block_must_end_at_vertices():
    with pytest.raises(la.InputError, match=r"ends at \[-1\.\s+0\. *\]") as refused:
        la.lower_bound(footing(la.SMOOTH, n=(9, 2)))
    assert refused.value.field == "Problem.interfaces[0]"
    assert refused.value.fix == "put a vertex of the mesh there"
    with pytest.raises(la.InputError, match=r"ends at \[0\.3\s+0\. *\]"):
        la.lower_bound(footing(la.SMOOTH, blocks=((1, 2), (-1, 0.3))))
    with pytest.raises(la.InputError, match="inside an edge"):
        la.bracket(footing(la.SMOOTH, n=(9, 2)))


def test_coulomb_friction_of_joints_has_no_bounds():
    stated = footing(la.SMOOTH, blocks=((-1, 0), (0, 1)), joint=0.3)
    with pytest.raises(la.InputError, match="joints is not associated"):
        la.lower_bound(stated)


def test_a_bracket_of_a_block_that_slides():
    found = la.bracket(footing(la.Tresca(0.5)), 0.04)
    assert found.status is la.Ending.REACHED
    assert found.strict
    assert not found.coulomb
    assert found.lower <= PRANDTL <= found.upper
    assert found.gaps().total == pytest.approx(found.upper - found.gaps().lower, rel=1e-6)


@pytest.mark.parametrize("seed", range(3))
def test_a_loose_velocity_that_sticks_is_projected_all_the_same(seed):
    """Slip that is noise of the solve turns round by the projection, and its dilatancy with it."""
    state = la.solve(footing(la.Coulomb(0.3, associated=True), n=(16, 4)))
    d, rng = state.discretisation, np.random.default_rng(seed)
    program = dimensionless(d.program, d.natural)
    exact = point_in_program(d, state.point).velocity
    noise = 1e-5 * np.abs(exact).max()  # as a tolerance of 1e-5 leaves, in any direction
    moved = admissible_velocity(program, exact + noise * rng.standard_normal(exact.size))
    rows = program.contact
    beyond = 0.3 * np.abs(rows.slip(moved)[:, 0]) - rows.opening(moved)
    assert beyond.max() <= 1e-12 * np.abs(moved).max()
    assert program.reference_load @ moved == pytest.approx(1, rel=1e-12)
    # No further away than the noise, but for the scale.
    assert np.abs(moved - exact).max() <= 100 * noise
