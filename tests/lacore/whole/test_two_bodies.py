"""Interfaces of two bodies (T28): matching and not, rigid and deformable, whichever is the slave.

Bars: 1e-6 is that of the certificate. Penetration is 1e-8 of the largest velocity: the solver's
1e-10 on control values, with room for the sum of three of them.
"""

import numpy as np
import pytest

import lacore as la

K = 1.0


def body(x, y, nx, ny, strength=K):
    return la.Body(la.meshes.rectangle(x=x, y=y, nx=nx, ny=ny), la.VonMises(strength))


def stacked(cells, swap=False, friction=0.3, load=None, dead=0.5, width=(0.0, 3.0), upper_k=K):
    """A body on another one that is held below; `cells` along the interface, below and above."""
    sides = [("upper", "bottom"), ("lower", "top")]
    slave, master = sides[::-1] if swap else sides
    return la.Problem(
        bodies={
            "lower": body((0, 4), (0, 1), cells[0], 3),
            "upper": body(width, (1, 2), cells[1], 2, upper_k),
        },
        reference_loads=[load or la.Traction("upper", "left", (1, 0))],
        supports=[la.Fix("lower", "bottom")],
        interfaces=[la.Interface(slave, master, friction)],
        dead_loads=[la.Traction("upper", "top", (0, -dead))] if dead else [],
    )


def jump_along(state, samples=33):
    """Normal velocity jump (upper minus lower) densely along y = 1, per largest velocity."""
    curves = []
    x = np.unique(
        np.concatenate(
            [
                np.linspace(*np.sort(d.nodes[0, d.nodes[1] == 1])[[0, -1]], 40 * samples)
                for d in state.discretisation.continua.values()
            ]
        )
    )
    top = state.discretisation.continua["upper"].nodes
    low, high = top[0].min(), top[0].max()
    x = x[(x >= low) & (x <= high)]
    for name, dofs in state.discretisation.continua.items():
        on = np.flatnonzero(dofs.nodes[1] == 1)
        on = on[np.argsort(dofs.nodes[0, on])]
        at, u = dofs.nodes[0, on], state.velocity[name][1, on]
        edge = np.clip((np.searchsorted(at[::2], x) - 1), 0, at.size // 2 - 1)
        a, b = at[2 * edge], at[2 * edge + 2]
        s = (x - a) / (b - a)
        shape = [(1 - s) * (1 - 2 * s), 4 * s * (1 - s), s * (2 * s - 1)]
        curves.append(sum(n * u[2 * edge + i] for i, n in enumerate(shape)))
    fastest = max(np.abs(u).max() for u in state.velocity.values())
    return (curves[1] - curves[0]) / fastest


@pytest.mark.parametrize("cells", [(4, 3), (4, 7), (9, 2), (5, 11)])
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_patch_of_uniform_pressure(cells, friction):
    """Two squares between smooth platens flow together at 2 k, whatever their meshes."""
    problem = la.Problem(
        bodies={"lower": body((0, 2), (0, 1), *cells), "upper": body((0, 2), (1, 2), cells[1], 3)},
        reference_loads=[la.Traction("upper", "top", (0, -1))],
        supports=[la.Fix("lower", "bottom", "y"), la.Fix("lower", "left", "x")],
        interfaces=[la.Interface(("upper", "bottom"), ("lower", "top"), friction)],
    )
    state = la.solve(problem, throw=True)
    assert state.load_factor == pytest.approx(2 * K, rel=1e-6)
    table = state.reactions
    assert np.sum(table["t_n"] * table["length"]) == pytest.approx(2 * 2 * K, rel=1e-6)
    assert jump_along(state).min() >= -1e-8


@pytest.mark.parametrize("cells", [(4, 3), (4, 7), (9, 2)])
@pytest.mark.parametrize("mu", [0.2, 0.5])
def test_patch_of_sliding(cells, mu):
    """The upper body slides at mu p b; the lower one stays."""
    state = la.solve(stacked(cells, friction=mu), throw=True)
    assert state.load_factor == pytest.approx(mu * 0.5 * 3.0, rel=1e-6)
    table = state.reactions
    assert np.sum(table["t_n"] * table["length"]) == pytest.approx(0.5 * 3.0, rel=1e-6)
    assert np.abs(state.velocity["lower"]).max() <= 1e-6 * np.abs(state.velocity["upper"]).max()


@pytest.mark.parametrize("cells", [(8, 5), (6, 9)])
def test_nothing_depends_on_which_side_is_the_slave(cells):
    """Under a load that makes both bodies flow; the law sees the jump and its sign only."""
    load = la.Traction("upper", "top", (0.2, -1))
    pair = [
        la.solve(stacked(cells, swap, load=load, dead=0, width=(0.7, 2.9), upper_k=2 * K))
        for swap in (False, True)
    ]
    one, other = pair
    assert one.status is other.status is la.Status.SOLVED
    assert one.load_factor == pytest.approx(other.load_factor, rel=1e-6)
    resultants = [
        np.sum(
            s.reactions[["n_x", "n_y"]].to_numpy().T
            * (s.reactions["t_n"] * s.reactions["length"]).to_numpy(),
            axis=1,
        )
        for s in pair
    ]
    assert np.allclose(resultants[0], -resultants[1], rtol=1e-5, atol=1e-6 * one.load_factor)


@pytest.mark.parametrize("cells", [(8, 5), (6, 9), (4, 13)])
def test_non_matching_meshes_do_not_penetrate(cells):
    load = la.Traction("upper", "top", (0.2, -1))
    state = la.solve(stacked(cells, load=load, dead=0, width=(0.7, 2.9)), throw=True)
    assert jump_along(state).min() >= -1e-8


def test_points_follow_the_common_refinement():
    """4 and 3 cells on a common length of 3: vertices at 0, 1, 2, 3 on both sides."""
    d = la.discretise(stacked((4, 3)))
    assert d.full.contact.count == 3 + 3 + 1
    d = la.discretise(stacked((4, 2)))  # 0, 1, 1.5, 2, 3: five ends and four control values
    assert d.full.contact.count == 5 + 4
    assert d.full.contact.weights.sum() == pytest.approx(3.0, rel=1e-12)


def rigid_punch(friction):
    """A rigid block pressed into a soil, in the middle: by symmetry it need not turn."""
    soil = la.Body(la.meshes.rectangle((-3, 3), (-2, 0), 12, 4), la.VonMises(K))
    return la.Problem(
        {"soil": soil, "tool": la.RigidBlock([(-1, 0), (1, 0), (1, 1), (-1, 1)])},
        [la.PointForce("tool", (0, 1), (0, -2))],
        [la.Fix("soil", side) for side in ("bottom", "left", "right")],
        [la.Interface(("tool", "block"), ("soil", "top"), friction)],
    )


@pytest.mark.parametrize("rough", [False, True])
def test_rigid_block_presses_like_a_footing(rough):
    """On one mesh, to the solver's accuracy; the footing neither turns nor lifts off."""
    problem = rigid_punch(la.STICK if rough else la.SMOOTH)

    def under(x):
        return (np.abs(x[0]) <= 1) & (x[1] > -1e-9)

    footing = la.RigidFooting("soil", under, direction=(0, -1), rough=rough)
    reference = la.solve(
        la.Problem({"soil": problem.bodies["soil"]}, [footing], problem.supports), throw=True
    )
    state = la.solve(problem, throw=True)
    assert state.load_factor == pytest.approx(reference.load_factor, rel=1e-6)
    assert abs(state.velocity["tool"][2, 0]) <= 1e-4 * abs(state.velocity["tool"][1, 0])


def test_friction_under_a_tool_lies_between_smooth_and_stuck():
    values = [
        la.solve(rigid_punch(law), throw=True).load_factor
        for law in (la.SMOOTH, 0.05, 0.3, la.STICK)
    ]
    assert np.all(np.diff(values) >= -1e-6 * values[-1])


def refuses(problem, *parts):
    with pytest.raises(la.InputError) as caught:
        problem()
    for part in parts:
        assert part in str(caught.value)


def test_bodies_that_do_not_meet_are_refused():
    refuses(
        lambda: stacked((4, 3), width=(5.0, 8.0)),
        "Problem.interfaces[0]",
        "upper.bottom|lower.top",
        "does not touch lower.top",
    )


def test_a_small_gap_is_refused():
    lower, upper = body((0, 4), (0, 1), 4, 3), body((0, 3), (1.001, 2), 3, 2)
    refuses(
        lambda: la.Problem(
            {"lower": lower, "upper": upper},
            [la.Traction("upper", "left", (1, 0))],
            interfaces=[la.Interface(("upper", "bottom"), ("lower", "top"), 0.3)],
        ),
        "are 0.001 m apart",
    )


def test_interfaces_given_twice_are_refused():
    one = stacked((4, 3))
    again = [
        la.Interface(("lower", "top"), ("upper", "bottom"), 0.1),
        la.Interface(("upper", "bottom"), ("lower", "top"), 0.1),
        la.Interface(("upper", "bottom"), la.RigidObstacle(), 0.1),
    ]
    for second in again:
        refuses(
            lambda second=second: la.Problem(
                one.bodies,
                one.reference_loads,
                one.supports,
                [*one.interfaces, second],
                one.dead_loads,
            ),
            "Problem.interfaces[1]",
            "shares boundary edges with Problem.interfaces[0]",
        )


def test_two_tools_may_share_an_edge_of_the_soil():
    """Each on its own part of one element edge."""
    soil = la.Body(la.meshes.rectangle((0, 4), (-1, 0), 1, 1), la.VonMises(K))
    tools = {
        name: la.RigidBlock([(x, 0), (x + 1, 0), (x + 1, 1), (x, 1)])
        for name, x in (("one", 0.5), ("two", 2.5))
    }
    problem = la.Problem(
        {"soil": soil, **tools},
        [la.PointForce("one", "block", (0, -1))],
        [la.Fix("soil", "bottom")],
        [la.Interface((name, "block"), ("soil", "top"), 0.2) for name in tools],
        [la.BodyForce("two", (0, -1))],
    )
    assert la.discretise(problem).full.contact.count == 6
