"""What an attacker found in assemblies of rigid blocks, and what becomes of it now."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.program.certificate import certify
from tests.rigid_problems import DOWN, RIGHT, box

TWO = {"base": box(-3, 6, -1, 0), "big": box(-2, -1, 0, 1), "small": box(0, 1, 0, 0.5)}


def pushed(blocks, live, dead=(DOWN,), interfaces=(), **friction):
    """Blocks with a base at rest."""
    loads = [load if isinstance(load, la.BodyForce) else la.BodyForce("b", load) for load in dead]
    return la.Problem(
        {"b": la.BlockAssembly(blocks, 0.3, **friction)},
        [live],
        [la.Fix("b", "base")],
        interfaces,
        dead_loads=loads,
    )


@pytest.mark.parametrize("weight", [1e3, 1e5, 1e7, 1e9, 1e12])
def test_a_light_block_beside_a_heavy_one_is_not_free(weight):
    """It slides at 0.3 x 0.5; FREE (load factor 0) from a weight of 1e7 on, brackets without it."""
    dead = [la.BodyForce("b", (0, -weight), "big"), la.BodyForce("b", DOWN, "small")]
    state = la.solve(pushed(TWO, la.PointForce("b", (0.0, 0.2), RIGHT), dead))
    if state.status is la.Status.SOLVED:
        assert state.load_factor == pytest.approx(0.15, rel=1e-6)
        return
    assert state.status is la.Status.NOT_CERTIFIED
    low, high = state.bracket
    assert low < 0.15 < high


@pytest.mark.parametrize("strength", [1e6, 1e8, 1e10])
def test_the_bracket_of_a_light_block_on_strong_ground(strength):
    """It slides at 0.15; brackets were read off solves that prove nothing: [0.016, 0.024]."""
    ground = la.Body(
        la.meshes.rectangle((0, 4), (-1, 0), 8, 2), la.VonMises(shear_strength=strength)
    )
    problem = la.Problem(
        {"ground": ground, "block": la.RigidBlock(box(1, 2, 0, 0.5))},
        [la.PointForce("block", (1.0, 0.1), RIGHT)],
        [la.Fix("ground", "bottom")],
        [la.Interface(("block", lambda x: x[1] == 0), ("ground", "top"), 0.3)],
        dead_loads=[la.BodyForce("block", DOWN)],
    )
    state = la.solve(problem, max_iterations=10)
    if state.status is la.Status.SOLVED:
        assert state.load_factor == pytest.approx(0.15, rel=1e-5)
        return
    low, high = state.bracket
    assert low < 0.15 < high


def test_a_tapering_slit_is_a_slit():
    """Its middle line ran into one of its own two blocks, as if a shim filled it."""
    blocks = {"left": box(0, 1, 0, 1), "right": [(1.001, 0), (2, 0), (2, 1), (1.004, 1)]}
    with pytest.raises(la.InputError, match=r"'left', 'right'.*nearly touch: a gap of 0.004 m"):
        la.BlockAssembly(blocks, 0.3)


def test_an_obstacle_where_a_joint_is():
    """The whole outline of a block that stands on another: it came back as locked."""
    outline = la.Interface(("b", "small"), la.RigidObstacle(), 0.3)
    with pytest.raises(la.InputError, match=r"block 'small' about .* has a joint with another"):
        pushed(TWO, la.BodyForce("b", RIGHT), interfaces=[outline])


@pytest.mark.parametrize(
    ("where", "why"),
    [
        (("small", "small"), "'small': this block is given twice"),  # and weighed twice
        (3, "= 3: no names of blocks"),
        (lambda x: x[0] > 0, "no names of blocks"),
        ((3,), "= 3: no such block"),
    ],
)
def test_blocks_of_a_body_force(where, why):
    with pytest.raises(la.InputError, match=why):
        pushed(TWO, la.BodyForce("b", RIGHT), [la.BodyForce("b", DOWN, where)])


def test_a_point_force_at_one_block_and_on_another():
    with pytest.raises(la.InputError, match="`at` names 'small'; leave `where` out"):
        pushed(TWO, la.PointForce("b", "small", RIGHT, where="base"))


@pytest.mark.parametrize(
    "build",
    [
        lambda: la.BlockAssembly(TWO, 0.3, joint_friction=[("base", "big", 0.3)]),
        lambda: la.BlockAssembly(TWO, 0.3, joint_friction=3),
        lambda: la.masonry.running_bond(3, 0.3),
        lambda: la.masonry.running_bond([1, 1], 0.3),
        lambda: la.masonry.stack(3, 0.3),
        lambda: la.masonry.regular_bond(3, 3, ["door"]),
        lambda: la.masonry.regular_bond(3, 3, [la.masonry.Opening(1, 1, 0.5, 1)]),
        lambda: la.masonry.windows(5, 5, 0),
        lambda: la.masonry.windows("a", 5, 1),
        lambda: la.masonry.random_bond(-1, 3, 3),
        lambda: la.masonry.random_bond("a", 3, 3),
        lambda: la.solve(pushed(TWO, la.BodyForce("b", RIGHT)), options=3),
        lambda: la.solve(None),
        lambda: la.coulomb_range(la.RigidBlock(box(0, 1, 0, 1))),
    ],
)
def test_what_is_none_is_refused_in_words(build):
    with pytest.raises(la.InputError, match="; "):
        build()


def test_rows_of_numpy_arrays():
    body = la.masonry.running_bond(np.array([[0.5, 0.5], [0.25, 0.75]]), 0.3)
    assert len(body.names) == 5


OVERHANG = {
    "base": box(0, 4, -1, 0),
    "left": box(0, 1, 0, 1),
    "held": box(1, 2, 0, 1),
    "right": box(2, 3, 0, 1),
}


@pytest.mark.parametrize("backend", ["clarabel", "highs"])
@pytest.mark.parametrize("coupling", ["certified", "associated", "frictionless", "stick"])
@pytest.mark.parametrize(("end", "status"), [(5.0, "unsafe"), (4.4, "locked")])
def test_what_stands_locked_beside_what_falls(backend, coupling, end, status):
    """A block is loaded that nothing can move; another, from 3.5 to `end`, overhangs from 4 on.

    Tilted over its base it was called locked, load factor +inf.
    """
    problem = la.Problem(
        {"b": la.BlockAssembly({**OVERHANG, "loose": box(3.5, end, 0, 1)}, 0.3)},
        [la.PointForce("b", "held", RIGHT)],
        [la.Fix("b", ("base", "left", "right"))],
        dead_loads=[la.BodyForce("b", DOWN)],
    )
    assert la.solve(problem, backend, coupling).status.label == status


PLANK = {"base": box(-3, 5, -1, 0), "pier": box(0, 1, 0, 1), "plank": box(0, 4, 1, 1.2)}
SPIKE = [(1e-7, 0), (0.1, 0.9), (1.9, 0.9), (1.99, 0), (2, 0), (2, 1), (0, 1), (0, 0)]


@pytest.mark.parametrize(
    ("blocks", "pair"),
    [
        (PLANK | {"roof": [(3, 0), (4, 0), (3.5, 1)]}, "'roof', 'plank'"),
        ({"base": box(-3, 5, -1, 0), "table": SPIKE}, "'table', 'base'"),
    ],
)
def test_a_block_that_rests_on_a_corner(blocks, pair):
    """A plank on an apex, a table on a foot thinner than the tolerance: both fell, unsafe."""
    with pytest.raises(la.InputError, match=rf"{pair}.*without a joint"):
        pushed(blocks, la.BodyForce("b", RIGHT))


def test_the_range_of_what_falls_beside_what_is_locked():
    """No load factor at all; every one in [inf, inf], it said."""
    found = la.coulomb_range(
        la.Problem(
            {"b": la.BlockAssembly({**OVERHANG, "loose": box(3.5, 5, 0, 1)}, 0.3)},
            [la.PointForce("b", "held", RIGHT)],
            [la.Fix("b", ("base", "left", "right"))],
            dead_loads=[la.BodyForce("b", DOWN)],
        ),
        restarts=0,
    )
    assert found.status is la.Status.UNSAFE
    assert np.isnan([found.low, found.high]).all()
    assert found.bracket == (-np.inf, np.inf)
    assert "inf, inf" not in found.summary().replace("-inf, inf", "")


def test_a_short_joint_does_not_hide_what_leaves_the_cone():
    """Its traction is a million times that of the other joint, whose friction is 2 % too large."""
    foot = [(2, 0), (2 + 3e-6, 0), (2.5, 0.2), (2.5, 1), (1.5, 1), (1.5, 0.2)]
    problem = la.Problem(
        {"b": la.BlockAssembly({"base": TWO["base"], "b": box(0, 1, 0, 1), "c": foot}, 0.3)},
        [la.PointForce("b", (0, 0.2), RIGHT)],
        [la.Fix("b", "base"), la.Fix("b", lambda x: (x[1] == 1) & (x[0] >= 1.5), "x")],
        dead_loads=[la.BodyForce("b", DOWN)],
    )
    state = la.solve(problem, throw=True)
    assert state.load_factor == pytest.approx(0.3, rel=1e-6)
    wide = (state.reactions["length"] > 0.1).to_numpy()
    friction = np.where(wide[:, None], 1.02, 1.0) * state.point.tangential_reaction
    planted = replace(state.point, tangential_reaction=friction)
    # 2 % of a share of the total load
    assert certify(state.discretisation.full, planted).cone > 1e-4
