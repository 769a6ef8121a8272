"""Where bodies slip, stick and part: in any direction, along parts of a boundary, at corners."""

from math import inf

import numpy as np
import pytest
from skfem import MeshTri

import lacore as la
from lacore.assembly.discretise import discretise
from lacore.assembly.sticking import opening, yielding
from lacore.assembly.unknowns import Unknowns
from lacore.reporting.kinds import Kind
from lacore.reporting.status import Status
from tests.lacore.assembly.test_shared_corners import turned_square
from tests.lacore.models import CRITERION


@pytest.mark.parametrize("angle", np.linspace(0, 3, 7))
def test_a_body_slips_past_a_support_in_any_direction(angle):
    """Held at its bottom, with smooth contact at its left side: the corner leaves no velocity."""
    problem = la.Problem(
        {"block": la.Body(turned_square(angle, 2), CRITERION)},
        [la.Traction("block", "top", (1, 0.3))],
        [la.Fix("block", "bottom")],
        [la.Interface(("block", "left"), la.RigidObstacle(), la.SMOOTH)],
    )
    slip = discretise(problem).slips["block"]
    assert slip.facets.size == 2
    assert slip.holds_normal.all()
    assert np.all(slip.footing == -1)
    # The tangent is that of the turned bottom.
    along = np.array([np.cos(angle), np.sin(angle)])
    assert np.abs(along @ slip.tangent) == pytest.approx(1.0)


def sides(low):
    """Boundaries of a layer of height 1."""
    return {
        "left": lambda x: x[0] == 0,
        "bottom": lambda x: x[1] == low,
        "top": lambda x: x[1] == low + 1,
    }


def on_low(top_x, low_x, spaces=("p2-vertex", "p2-vertex")):
    """Two layers that are bonded, of meshes with given vertices along the bond."""
    bodies = {
        name: la.Body(
            MeshTri.init_tensor(np.array(x), np.array([y, y + 1])).with_boundaries(sides(y)),
            CRITERION,
            space=space,
        )
        for name, x, y, space in zip(("top", "low"), (top_x, low_x), (0, -1), spaces, strict=True)
    }
    return la.Problem(
        bodies,
        [la.Traction("top", "left", (1, 0))],
        [la.Fix("low", "bottom")],
        [la.Interface(("top", "bottom"), ("low", "top"), la.BOND)],
    )


def cost(problem):
    """Power of the seam as the whole top slides by 1: its length times the strength."""
    d = discretise(problem)
    speed = np.zeros(d.full.n)
    speed[d.continua["top"].dofs[0]] = 1.0
    return sum(float(own.group.dissipation(speed).sum()) for own in d.seams.values())


def test_a_bond_parts_only_where_its_edges_do_not_match():
    """At the last vertex that is tied nothing jumps: the end of a segment counts a third of it."""
    same = [0.0, 0.5, 1.0]
    assert cost(on_low(same, same)) == 0
    assert cost(on_low(same, [0.0, 0.5, 0.75, 1.0])) == pytest.approx(0.5 - 0.25 / 3)
    assert cost(on_low([0.0, 0.4, 1.0], same)) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("spaces", "length"),
    [
        (("p2-vertex", "p2-vertex"), 0.0),
        (("p2-disc", "p2-vertex"), 1.0),
        (("p2-vertex", "p2-disc"), 1.0),
        (("p2-disc", "p2-disc"), 1.0),
    ],
)
def test_a_bond_ties_continuous_velocities_of_the_same_degree(spaces, length):
    """Of others each side has nodes of its own, and the seam may shear."""
    same = [0.0, 0.5, 1.0]
    assert cost(on_low(same, same, spaces)) == pytest.approx(length)


def sticking(beside, friction=la.STICK, soil=CRITERION):
    """A block that sticks to the floor, and touches at its left side what may move or not."""
    left = la.meshes.rectangle((-1, 0), (0, 1), 1, 1)
    bodies = {"block": la.Body(la.meshes.rectangle((0, 1), (0, 1), 2, 2), soil)}
    floor = la.Interface(("block", "bottom"), la.RigidObstacle(), friction)
    supports, others = [], []
    if beside == "body":
        bodies["next"] = la.Body(left, soil)
        supports = [la.Fix("next", "bottom")]
        others = [la.Interface(("block", "left"), ("next", "right"), la.SMOOTH)]
    elif beside == "obstacle":
        others = [la.Interface(("block", "left"), la.RigidObstacle(), la.SMOOTH)]
    elif beside == "footing":
        return la.Problem(
            bodies, [la.RigidFooting("block", "left", (1, 0))], [], [floor], dead_loads=[]
        )
    return la.Problem(bodies, [la.Traction("block", "top", (1, 0))], supports, [floor, *others])


def limit(problem):
    """Limit of the shear on the floor."""
    unknowns = Unknowns.of(problem)
    found = yielding(problem, unknowns.continua, tuple(unknowns.footings))
    assert [own.sides for own in found] == [own.sides for own in problem.interfaces]
    return found[0].law.terms().limit


@pytest.mark.parametrize(
    ("beside", "expected"),
    [("nothing", inf), ("obstacle", inf), ("body", 1.0), ("footing", 1.0)],
)
def test_what_sticks_yields_where_it_meets_what_moves(beside, expected):
    """At the strength of the block, 1; next to rest it holds up to the last vertex."""
    assert limit(sticking(beside)) == expected


def test_friction_and_soil_keep_their_laws():
    assert limit(sticking("body", la.Tresca(0.4))) == 0.4
    assert limit(sticking("body", soil=la.MohrCoulomb(1.0, 20.0))) == inf


@pytest.mark.parametrize(
    ("friction", "status", "reported"),
    [
        (la.STICK, Status.FREE, True),
        (la.STICK, Status.UNSAFE, True),
        (la.STICK, Status.SOLVED, False),
        (la.SMOOTH, Status.FREE, False),
    ],
)
def test_an_interface_that_opens_is_reported_where_the_structure_parts(friction, status, reported):
    found = opening(sticking("nothing", friction), status)
    assert (found is not None) == reported
    assert found is None or found.kind is Kind.OPENS


def test_between_two_bodies_the_weaker_one_yields():
    """Strengths 1 and 3; the other interface of either body is one with a body that moves."""
    for one, other in ((1.0, 3.0), (3.0, 1.0)):
        bodies = {
            "block": la.Body(la.meshes.rectangle((0, 1), (0, 1), 2, 2), la.VonMises(one)),
            "low": la.Body(la.meshes.rectangle((0, 1), (-1, 0), 2, 2), la.VonMises(other)),
            "next": la.Body(la.meshes.rectangle((-1, 0), (0, 1), 1, 1), CRITERION),
        }
        problem = la.Problem(
            bodies,
            [la.Traction("block", "top", (1, 0))],
            [la.Fix("low", "bottom"), la.Fix("next", "bottom")],
            [
                la.Interface(("block", "bottom"), ("low", "top"), la.STICK),
                la.Interface(("block", "left"), ("next", "right"), la.SMOOTH),
            ],
        )
        assert limit(problem) == 1.0


def test_blocks_that_are_bonded_have_one_equilibrium_and_their_neighbours_another():
    """Two assemblies of two blocks, of which one of each is bonded."""

    def pair(x):
        return {
            name: [(x + k, 0), (x + k + 1, 0), (x + k + 1, 1), (x + k, 1)]
            for k, name in enumerate(("near", "far") if x > 0 else ("far", "near"))
        }

    bodies = {"left": la.BlockAssembly(pair(-2.0), 0.3), "right": la.BlockAssembly(pair(1.0), 0.3)}
    middle = la.BlockAssembly({"m": [(0, 0), (1, 0), (1, 1), (0, 1)]}, 0.3)
    bond = {"friction": la.BOND}
    problem = la.Problem(
        {**bodies, "middle": middle},
        [la.BodyForce("middle", (1, 0))],
        [la.Fix("left", "far")],
        [
            la.Interface(("left", lambda x: x[0] == 0), ("middle", lambda x: x[0] == 0), **bond),
            la.Interface(("middle", lambda x: x[0] == 1), ("right", lambda x: x[0] == 1), **bond),
        ],
        dead_loads=[la.BodyForce(name, (0, -1)) for name in (*bodies, "middle")],
    )
    d = discretise(problem)
    part = {
        (name, block): int(d.full.parts[own.offset + 3 * number])
        for name, own in d.blocks.items()
        for number, block in enumerate(own.body.names)
    }
    joined = {part["left", "near"], part["middle", "m"], part["right", "near"]}
    assert len(joined) == 1
    assert len({*joined, part["left", "far"], part["right", "far"]}) == 3
