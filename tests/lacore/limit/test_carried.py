"""Whether a Coulomb load factor is a capacity, a minimum holding load, or neither of both."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import linprog

import lacore as la
from lacore.reporting.errors import InputError
from lacore.reporting.kinds import Kind
from lacore.reporting.status import Role, Status
from tests.lacore.limit.test_stability import C, S, on_slope, slides

SAME = 1e-5  # ten times the tolerance of the residuals, relative to loads and powers near 1


def wedged(lines, friction, live, dead, floor=False, wall=True):
    """Blocks of height 1 in a row between inclined lines, to the right of a fixed block.

    Args:
        lines: x at the bottom and at the top of each joint.
        friction: Coefficient of all joints.
        live, dead: Force on each movable block, shape (n, 2).
        floor: Whether a fixed block lies below.
        wall: Whether another fixed block is at the right end.
    """
    ends = [(lines[0][0] - 3,) * 2, *lines, (lines[-1][0] + 3,) * 2]
    blocks = {
        f"b{i}": [(a[0], 0.0), (b[0], 0.0), (b[1], 1.0), (a[1], 1.0)]
        for i, (a, b) in enumerate(pairwise(ends))
    }
    fixed = ["b0", f"b{len(lines)}"]
    if not wall:
        del blocks[fixed.pop()]
    if floor:
        blocks["floor"] = la.masonry.rectangle(ends[0][0], ends[-1][0], -1.0, 0.0)
        fixed.append("floor")
    moving = [f"b{i}" for i in range(1, len(lines))]
    return la.Problem(
        bodies={"row": la.BlockAssembly(blocks, friction=friction)},
        supports=[la.Fix("row", tuple(fixed))],
        reference_loads=[
            la.PointForce("row", name, tuple(f)) for name, f in zip(moving, live, strict=True)
        ],
        dead_loads=[
            la.PointForce("row", name, tuple(f)) for name, f in zip(moving, dead, strict=True)
        ],
    )


def centroid(corners):
    """Return the centroid of a polygon by the formula of Gauss."""
    x, y = np.asarray(corners).T
    nx, ny = np.roll(x, -1), np.roll(y, -1)
    cross = x * ny - nx * y
    return np.array([(x + nx) @ cross, (y + ny) @ cross]) / (3 * cross.sum())


def brute_force(lines, friction, live, dead, floor=False, wall=True):
    """Return the smallest and the largest load factor with equilibrium, by linear programs.

    The unknowns are a normal and a tangential force at both ends of each joint and the load factor.
    """
    count = len(lines) - 1
    places = [
        centroid([(a[0], 0.0), (b[0], 0.0), (b[1], 1.0), (a[1], 1.0)]) for a, b in pairwise(lines)
    ]
    joints = [(k - 1, k, (x[0], 0.0), (x[1], 1.0)) for k, x in enumerate(lines)]
    joints = joints if wall else joints[:-1]
    if floor:
        spans = pairwise(lines)
        joints += [(k, None, (a[0], 0.0), (b[0], 0.0)) for k, (a, b) in enumerate(spans)]
    columns = []
    for one, other, start, end in joints:
        along = np.subtract(end, start) / np.linalg.norm(np.subtract(end, start))
        normal = np.array([-along[1], along[0]])  # points into `one`: left of a joint, or above
        for place in (start, end):
            for force in (normal, along):
                own = np.zeros((count, 3))
                for block, sign in ((one, 1.0), (other, -1.0)):
                    if block is not None and 0 <= block < count:
                        arm = np.subtract(place, places[block])
                        moment = arm[0] * force[1] - arm[1] * force[0]
                        own[block] += sign * np.array([*force, moment])
                columns.append(own.ravel())
    forces = np.array(columns).T
    load = np.column_stack([live, np.zeros(count)]).ravel()
    weight = np.column_stack([dead, np.zeros(count)]).ravel()
    points = forces.shape[1] // 2
    cone = np.zeros((2 * points, forces.shape[1] + 1))
    for i in range(points):
        cone[2 * i, [2 * i, 2 * i + 1]] = -friction, 1.0
        cone[2 * i + 1, [2 * i, 2 * i + 1]] = -friction, -1.0
    bounds = [(0, None), (None, None)] * points + [(None, None)]
    ends = []
    for sign in (1.0, -1.0):
        found = linprog(
            np.r_[np.zeros(2 * points), sign],
            A_ub=cone,
            b_ub=np.zeros(2 * points),
            A_eq=np.column_stack([forces, load]),
            b_eq=-weight,
            bounds=bounds,
        )
        assert found.status in (0, 3), found.message
        ends.append(found.x[-1] if found.status == 0 else -sign * np.inf)
    return tuple(ends)


def role(load_factor, low, high):
    """Return the role of a load factor by the definition."""
    above, below = high > load_factor + SAME, low < load_factor - SAME
    return {
        (False, True): Role.CAPACITY,
        (True, False): Role.MINIMUM,
        (True, True): Role.BOTH_SIDES,
        (False, False): Role.ONLY,
    }[above, below]


KEYSTONE = ([(-0.6, -0.5), (0.6, 0.5)], 0.5, [(1.0, 0.0)], [(0.0, -1.0)])


def test_a_wedged_keystone_has_equilibrium_on_both_sides():
    """One wall alone holds the keystone from a push of 2.625 on; both walls hold it at any push.

    The force of the wall on the keystone is at the friction angle from its normal, which is
    inclined by atan(0.1), so that it balances the weight W = 1.1 x 1 and the push a W/1.1:
    ``a = 1/tan(atan(0.5) - atan(0.1))``.
    """
    state = la.solve(wedged(*KEYSTONE))
    expected = 1 / np.tan(np.arctan(0.5) - np.arctan(0.1))
    assert state.load_factor == pytest.approx(expected, rel=1e-6)
    assert state.carried.role is Role.BOTH_SIDES
    assert brute_force(*KEYSTONE) == (-np.inf, np.inf)
    assert (state.carried.low, state.carried.high) == (-np.inf, np.inf)
    assert Kind.LOCKS_IN_FORCES in {own.kind for own in state.findings}
    assert "equilibrium on both sides" in str(state).splitlines()[0]
    found = state.stability()
    assert (found.low, found.high, found.side) == (-np.inf, np.inf, "both")
    assert not {"proven", "residual"} & state.carried.facts().told.keys()


def test_a_locked_state_has_no_interval():
    state = la.solve(wedged(*KEYSTONE), coupling="associated")
    assert state.status is Status.LOCKED
    with pytest.raises(InputError, match="no mechanism"):
        state.interval()


@pytest.mark.parametrize(
    ("mu", "live", "expected"),
    [
        (0.7, (1, 0), Role.CAPACITY),
        (0.3, (-1, 0), Role.CAPACITY),  # less pull does not hold it, more lifts it
        (0.3, (S - 0.1 * C, -C - 0.1 * S), Role.MINIMUM),  # presses it on, the more the better
    ],
)
def test_a_block_on_a_slope(mu, live, expected):
    state, (low, high) = la.solve(on_slope(mu, live)), slides(mu, live)
    own = state.carried
    assert own.role is expected
    assert [own.low, own.high] == pytest.approx([low, high], rel=1e-6)
    assert [own.least, own.most] == pytest.approx([low, high], rel=1e-5)


def test_the_smallest_load_of_one_direction_is_the_largest_of_the_other():
    one, other = (la.solve(on_slope(0.7, (sign, 0))).carried for sign in (1, -1))
    assert [one.low, one.high] == pytest.approx([-other.high, -other.low], rel=1e-6)


def test_associated_flow_needs_no_role():
    """The load factor is the largest one by duality."""
    assert la.solve(on_slope(0.7, (1, 0)), coupling="associated").carried is None


def random_row(seed):
    """Return the arguments of a random row: between walls, on a floor, or both."""
    rng = np.random.default_rng(seed)
    count, friction = int(rng.integers(1, 5)), float(rng.uniform(0.2, 0.9))
    starts = np.cumsum(rng.uniform(0.8, 1.6, count + 1))
    lines = [(x, x + float(rng.uniform(-0.35, 0.35))) for x in starts]
    tilt = rng.uniform(-0.9, 0.9)  # of the whole structure
    dead = np.outer(rng.uniform(0.3, 1.5, count), (np.sin(tilt), -np.cos(tilt)))
    live = np.zeros((count, 2))
    angle = rng.uniform(0, 2 * np.pi)
    live[rng.integers(count)] = np.cos(angle), np.sin(angle)
    floor, wall = ((True, False), (True, False), (True, True), (False, True))[rng.integers(4)]
    return lines, friction, live, dead, floor, wall


def agreement(seed):
    """Check the role of a random row, and return it; None if no load factor is certified."""
    given = random_row(seed)
    state = la.solve(wedged(*given), max_iterations=12)  # jammed rows need no more
    if state.status is not Status.SOLVED:
        assert state.carried is None
        return None
    low, high = brute_force(*given)
    own = state.carried
    assert own.role is role(state.load_factor, low, high), (seed, state, low, high)
    assert [own.low, own.high] == pytest.approx([low, high], rel=1e-5, abs=1e-5), seed
    assert own.least <= low + SAME, seed
    assert own.most >= high - SAME, seed
    return own.role


def test_roles_of_random_rows_agree_with_linear_programs():
    found = {agreement(seed) for seed in (11, 15, 16, 36)}
    assert found == {Role.CAPACITY, Role.BOTH_SIDES}


@pytest.mark.slow
def test_roles_of_many_random_rows_agree_with_linear_programs():
    found = [agreement(seed) for seed in range(40)]
    assert {Role.CAPACITY, Role.BOTH_SIDES} <= set(found)
