"""Plane frames: textbook collapse loads, feet that slide, moments in balance.

1e-6 relative is the bar of the certificate: of load factors, and of moments per M_p.
"""

import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lacore as la
from tests.frame_problems import (
    DOWN,
    FLOOR,
    RIGHT,
    portal,
    pressed,
    pressed_exact,
    pushed,
    pushed_exact,
    static_load_factor,
)
from tests.rigid_problems import box
from tests.shares import one_in

BAR = 1e-6
ROUND_OFF = 1e-12  # of numbers of order one
BACKENDS = ("clarabel", "highs")


def solved(problem, backend="clarabel", **options):
    return la.solve(problem, backend=backend, throw=True, **options)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("loads", "expected"),
    [
        ([la.PointForce("frame", "B", RIGHT)], 4 * 1.5 / 3),
        ([la.PointForce("frame", (2.5, 3.0), DOWN)], 8 * 1.5 / 5),
        (
            [la.PointForce("frame", "B", RIGHT), la.PointForce("frame", (2.5, 3.0), DOWN)],
            6 * 1.5 / (3 + 5 / 2),
        ),
    ],
)
def test_fixed_portal(loads, expected, backend):
    """Sway 4 M_p/h, beam 8 M_p/L, both at once: 6 M_p theta = alpha (h + L/2) theta."""
    clamped = [la.Fix("frame", ("A", "D"), "clamped")]
    state = solved(la.Problem({"frame": portal(3.0, 5.0, 1.5)}, loads, clamped), backend)
    assert state.load_factor == pytest.approx(expected, rel=BAR)
    assert state.rigor is la.Rigor.UPPER


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("mu", "p", "expected"),
    [
        (0.1, 1, 0.2),
        (0.25, 1, 0.5),
        (0.35, 1.5, 0.872340),
        (0.9, 1.5, 1.0),
        (0.9, 0.3, 0.531034),
    ],
)
def test_portal_pushed(mu, p, expected, backend):
    """C11: rigid sliding, one foot and a hinge, sway; the values listed have six digits."""
    assert pushed_exact(mu, p) == pytest.approx(expected, abs=5e-7)
    state = solved(pushed(mu, p), backend)
    assert state.load_factor == pytest.approx(pushed_exact(mu, p), rel=BAR)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("mu", "p", "expected"),
    [(0.1, 0, 1.111111), (0.1, 1, 1.333333), (0.3, 0.5, 1.857143), (0.8, 1, 2.0)],
)
def test_portal_pressed(mu, p, expected, backend):
    """C12: the feet are thrust outwards, or the beam breaks; the values listed have six digits."""
    assert pressed_exact(mu, p) == pytest.approx(expected, abs=5e-7)
    state = solved(pressed(mu, p), backend)
    assert state.load_factor == pytest.approx(pressed_exact(mu, p), rel=BAR)


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    ("mu", "expected"), [(0.0, 2.0), (0.2, 2.5), (0.4, 10 / 3), (0.5, 4.0), (0.7, 4.0)]
)
def test_frame_feet(mu, expected, backend):
    """REFERENCES frame-feet: no dead load, the plastic moment sets the scale."""
    problem = pressed(mu, 0, h=1.0, span=2.0)
    assert solved(problem, backend).load_factor == pytest.approx(expected, rel=BAR)


def test_frame_feet_start_from_no_reaction():
    """The paper's start is valid here: with frictionless feet the frame still carries load."""
    state = solved(pressed(0.4, 0, h=1.0, span=2.0), coupling="reaction", start="zero")
    assert state.load_factor == pytest.approx(10 / 3, rel=BAR)


@pytest.mark.parametrize("seed", one_in(3, range(20)))
@pytest.mark.parametrize(("problem", "exact"), [(pushed, pushed_exact), (pressed, pressed_exact)])
def test_random_portals(problem, exact, seed):
    """C11 and C12 at 20 random sets each."""
    draw = np.random.default_rng(seed)
    values = {
        "mu": draw.uniform(0.05, 1.2),
        "p": draw.uniform(0.1, 3.0),
        "h": draw.uniform(0.5, 4.0),
        "span": draw.uniform(1.0, 6.0),
        "m_p": draw.uniform(0.3, 3.0),
    }
    load_factors = [solved(problem(**values), backend).load_factor for backend in BACKENDS]
    assert load_factors == pytest.approx([exact(**values)] * 2, rel=BAR)


@given(
    length=st.floats(-3, 3),
    force=st.floats(-3, 3),
    angle=st.floats(0, 6.28),
    shift=st.tuples(st.floats(-10, 10), st.floats(-10, 10)),
)
def test_units_axes_and_place_do_not_matter(length, force, angle, shift):
    """C11 with one foot that slides, in other units (powers of ten), turned and moved."""
    unit, weight = 10.0**length, 10.0**force
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])

    def place(x):
        return tuple(unit * (turn @ np.array(x, dtype=float) + shift))

    def vector(x):
        return tuple(weight * (turn @ np.array(x)))

    plain = portal()
    frame = la.Frame(
        {name: place(at) for name, at in plain.nodes.items()}, plain.members, unit * weight
    )
    floor = la.RigidObstacle(place((0, 0)), tuple(turn @ [0.0, 1.0]))
    problem = la.Problem(
        {"frame": frame},
        [la.PointForce("frame", "B", vector(RIGHT))],
        interfaces=[la.Interface(("frame", ("A", "D")), floor, 0.35)],
        dead_loads=[la.PointForce("frame", node, vector((0, -1.5))) for node in "BC"],
    )
    assert solved(problem).load_factor == pytest.approx(pushed_exact(0.35, 1.5), rel=BAR)


@pytest.mark.parametrize("problem", [pushed(0.35, 1.5), pushed(0.9, 1.5), pressed(0.3, 0.5)])
@pytest.mark.parametrize("backend", BACKENDS)
def test_hinges_by_hand(problem, backend):
    """Moments and reactions from the tables alone, by the free bodies that one draws by hand."""
    state = solved(problem, backend)
    hinges, feet = state.hinges, state.reactions
    h, span = 2.0, 4.0
    assert np.all(np.abs(hinges.moment) <= hinges.plastic_moment * (1 + BAR))
    # The member ends at each node are in balance.
    assert hinges.groupby("node").moment.sum().abs().max() <= BAR
    ends = hinges.set_index(["member", "node"]).moment
    assert abs(ends["left", "A"].item()) + abs(ends["right", "D"].item()) <= BAR
    # Columns: the horizontal force of the floor on the foot, -t_t, turns about the top.
    assert ends["left", "B"].item() == pytest.approx(-h * feet.t_t[0], abs=BAR)
    assert ends["right", "C"].item() == pytest.approx(-h * feet.t_t[1], abs=BAR)
    # All of the frame: forces, and moments about A.
    alpha, dead = state.load_factor, sum(load.vector[1] for load in problem.dead_loads)
    live = problem.reference_loads[0]
    at = (0.0, h) if live.at == "B" else live.at
    horizontal, vertical = (alpha * component for component in live.vector)
    assert feet.t_t.sum() == pytest.approx(horizontal, abs=BAR)
    assert feet.t_n.sum() == pytest.approx(-vertical - dead, abs=BAR)
    turning = at[0] * vertical - at[1] * horizontal + span * (dead / 2 + feet.t_n[1])
    assert turning == pytest.approx(0, abs=4 * BAR)  # arms of up to 4 m
    # Power: hinges and sliding feet take what the loads give.
    turns = hinges[hinges.state == "turns"]
    assert np.all(turns.moment * turns.rotation_rate > 0)
    assert np.allclose(np.abs(turns.moment), turns.plastic_moment, rtol=BAR, atol=0)
    u = state.velocity["frame"]
    frame = state.discretisation.frames["frame"].body
    columns = [frame.names.index("B"), frame.names.index("C")]
    given = alpha + dead / 2 * u[1, columns].sum()  # F0.u = 1
    taken = (hinges.moment * hinges.rotation_rate).sum() - (feet.t_t * feet.u_t).sum()
    assert taken == pytest.approx(given, rel=BAR)


@pytest.mark.parametrize("backend", BACKENDS)
def test_support_reactions(backend):
    """Clamped portal, h = 2, L = 4, under alpha (1, -1): H + V mechanism, alpha = 6/(h + L/2).

    Both feet at M_p; the leeward column at M_p at its top too, so that its foot carries 2 M_p/h.
    """
    loads = [la.PointForce("frame", "B", RIGHT), la.PointForce("frame", (2.0, 2.0), DOWN)]
    clamped = [la.Fix("frame", ("A", "D"), "clamped")]
    state = solved(la.Problem({"frame": portal()}, loads, clamped), backend)
    feet = state.support_reactions
    assert feet[["x", "y"]].to_numpy().tolist() == [[0, 0], [4, 0]]
    assert np.allclose(feet.moment, 1.0, rtol=BAR)  # against the sway, which is clockwise
    assert feet.force_x[1] == pytest.approx(-1.0, rel=BAR)
    assert feet.force_x.sum() == pytest.approx(-1.5, rel=BAR)
    assert feet.force_y.sum() == pytest.approx(1.5, rel=BAR)
    about_a = feet.moment.sum() + 4 * feet.force_y[1] - 1.5 * 2 - 1.5 * 2
    assert about_a == pytest.approx(0, abs=8 * BAR)  # powers of up to 8


@pytest.mark.parametrize("slope", [0.0, 0.4])
def test_support_reactions_of_blocks(slope):
    """The base under a block that is pushed: weight, push and the moment of both."""
    turn = np.array([[np.cos(slope), -np.sin(slope)], [np.sin(slope), np.cos(slope)]])
    outlines = {"base": box(-1, 3, -1, 0) @ turn.T, "block": box(0, 2, 0, 1) @ turn.T}
    problem = la.Problem(
        {"blocks": la.BlockAssembly(outlines, 0.5)},
        [la.PointForce("blocks", tuple(turn @ [0.0, 0.5]), tuple(turn @ RIGHT))],
        [la.Fix("blocks", "base")],
        dead_loads=[la.BodyForce("blocks", DOWN)],
    )
    state = solved(problem)
    reaction, push = state.support_reactions.iloc[0], state.load_factor * (turn @ RIGHT)
    forces = reaction[["force_x", "force_y"]].to_numpy(dtype=float)
    assert forces == pytest.approx([-push[0], -push[1] + 6], abs=6 * BAR)
    x, y = turn @ [0.0, 1.0]  # from the centre of the base to that of the block
    moment = reaction.moment + (x * (push[1] - 2) - y * push[0])
    assert moment == pytest.approx(0, abs=6 * BAR)


def test_velocity_is_that_of_rigid_pieces():
    state = solved(pushed(0.35, 1.5))
    frame, u = portal(), state.velocity["frame"]
    pieces = frame.pieces
    assert u.shape == (3, 4)
    stretch = (u[:2, pieces.end] - u[:2, pieces.start]) * pieces.along
    assert np.abs(stretch.sum(axis=0)).max() <= ROUND_OFF * np.abs(u).max()
    across = np.stack([-pieces.along[1], pieces.along[0]]) / pieces.length
    rate = ((u[:2, pieces.end] - u[:2, pieces.start]) * across).sum(axis=0)
    turned = (rate[:, None] - u[2, pieces.nodes]).ravel()
    assert state.hinges.rotation_rate.to_numpy() == pytest.approx(turned, abs=ROUND_OFF)
    assert state.stress == {}
    assert state.dissipation == {}


def storeys(draw):
    """Two bays and two storeys, braced or not, members of different strength, nodes in beams."""
    x, y = np.cumsum(draw.uniform(2, 5, 3)), np.concatenate([[0], np.cumsum(draw.uniform(2, 4, 2))])
    nodes = {f"{i}{j}": (x[i], y[j]) for i in range(3) for j in range(3)}
    members = {f"column {i}": (f"{i}0", f"{i}2") for i in range(3)}
    members |= {f"beam {j}": (f"0{j}", f"2{j}") for j in (1, 2)}
    members["brace"] = ("00", "11")
    for i in range(2):
        for j in (1, 2):
            share = draw.uniform(0.2, 0.8)
            nodes[f"load {i}{j}"] = (share * x[i] + (1 - share) * x[i + 1], y[j])
    if draw.uniform() < 0.5:
        del members["brace"]
    moments = {name: draw.uniform(0.5, 2.0) for name in members}
    return la.Frame(nodes, members, moments)


@pytest.mark.parametrize("seed", one_in(2, range(12)))
def test_storeys_against_the_static_theorem(seed):
    """The kinematic load factor is the static one of an LP in forces that shares no code."""
    draw = np.random.default_rng(seed)
    frame = storeys(draw)
    names = [name for name in frame.names if not name.endswith("0")]
    live = {name: tuple(draw.uniform((0, -2), (1, 0))) for name in names}
    dead = {name: (0.0, draw.uniform(-0.05, -0.01)) for name in names}

    def forces(by_name):
        return np.array([by_name.get(name, (0.0, 0.0)) for name in frame.names])

    clamped = np.array([name in ("00", "10", "20") for name in frame.names])
    expected = static_load_factor(frame, forces(live), forces(dead), clamped)
    problem = la.Problem(
        {"frame": frame},
        [la.PointForce("frame", name, vector) for name, vector in live.items()],
        [la.Fix("frame", ("00", "10", "20"), "clamped")],
        dead_loads=[la.PointForce("frame", name, vector) for name, vector in dead.items()],
    )
    found = [solved(problem, backend).load_factor for backend in BACKENDS]
    assert found == pytest.approx([expected] * 2, rel=BAR)


def beam(nodes, loads, supports, m_p=1.0, **given):
    """A straight member of length 3 from "a" to "b"."""
    frame = la.Frame({"a": (0, 0), "b": (3, 0), **nodes}, {"beam": ("a", "b")}, m_p, **given)
    return la.Problem({"beam": frame}, loads, [la.Fix("beam", *given) for given in supports])


CLAMPED = [("a", "clamped"), ("b", "clamped")]
PROPPED = [("a", "clamped"), ("b", "xy")]


@pytest.mark.parametrize(
    ("supports", "expected"),
    [(CLAMPED, 3.0), (PROPPED, 2.5), ([("a", "clamped")], 1.0)],
)
def test_force_at_a_third_of_a_beam(supports, expected):
    """It moves by 1 at x = 1 of 3: hinges turn by 1 at a, 3/2 under it, 1/2 at b, if clamped."""
    state = solved(beam({}, [la.PointForce("beam", (1.0, 0.0), DOWN)], supports))
    assert state.load_factor == pytest.approx(expected, rel=BAR)


@pytest.mark.parametrize("at", [0.5, np.sqrt(2) - 1])
def test_load_along_a_beam(at):
    """Propped, w L^2/M_p = 2 (3 + 2 sqrt 2), wherever nodes are: it hinges (sqrt 2 - 1) L away."""
    nodes = {"m": (3 * (1 - at), 0.0)}
    state = solved(beam(nodes, [la.Traction("beam", "beam", DOWN)], PROPPED))
    assert state.load_factor == pytest.approx(2 * (3 + 2 * np.sqrt(2)) / 3**2, rel=BAR)


def test_guided_end():
    """Half of a clamped beam under a force at mid-span: x and the rotation held, y free."""
    half = beam({}, [la.PointForce("beam", "b", (0, -0.5))], [("a", "clamped"), ("b", "rotation")])
    assert solved(half).load_factor == pytest.approx(8 / 6, rel=BAR)


def test_a_node_nearly_on_a_member_splits_it():
    """Seven digits are as good as the number: no arch arises from 3e-7 of rise."""
    nodes = {"a": (0, 0), "b": (3, 1), "m": (1, 0.333333)}
    frame = la.Frame(nodes, {"beam": ("a", "b")}, 1.0)
    across = (1 / np.sqrt(10), -3 / np.sqrt(10))
    clamped = [la.Fix("beam", node, "clamped") for node in "ab"]
    state = solved(la.Problem({"beam": frame}, [la.PointForce("beam", "m", across)], clamped))
    # Clamped, at a third: 3 M_p/(L/3) for L = sqrt 10; the place is off by 1e-7 of L.
    assert state.load_factor == pytest.approx(9 / np.sqrt(10), rel=BAR)


def test_the_weaker_member_yields():
    """A column of M_p = 1 on a beam of M_p = 5: sway at 4 * 1/h, and only columns turn."""
    m_p = {"left": 1.0, "right": 1.0, "beam": 5.0}
    clamped = [la.Fix("frame", ("A", "D"), "clamped")]
    problem = la.Problem({"frame": portal(m_p=m_p)}, [la.PointForce("frame", "B", RIGHT)], clamped)
    state = solved(problem)
    assert state.load_factor == pytest.approx(4 / 2, rel=BAR)
    turns = state.hinges[state.hinges.state == "turns"]
    assert sorted(zip(turns.member, turns.node, strict=True)) == [
        ("left", "A"),
        ("left", "B"),
        ("right", "C"),
        ("right", "D"),
    ]


def test_releases():
    """A portal with pinned feet, and then a pin at one corner: 2 M_p/h and M_p/h."""
    hinged = [la.Fix("frame", ("A", "D"), "xy")]
    push = [la.PointForce("frame", "B", RIGHT)]
    for releases, expected in (((), 1.0), ((("beam", "B"),), 0.5)):
        problem = la.Problem({"frame": portal(releases=releases)}, push, hinged)
        state = solved(problem)
        assert state.load_factor == pytest.approx(expected, rel=BAR)
        assert len(state.hinges) == 6 - len(releases)


@pytest.mark.parametrize("swap", [False, True])
@pytest.mark.parametrize(
    ("mu", "mu_block", "expected"),
    [(0.35, 2.0, pushed_exact(0.35, 1.5)), (0.35, 0.05, None), (0.1, 2.0, 0.3)],
)
def test_foot_on_a_block(mu, mu_block, expected, swap):
    """C11 with the windward foot on a block: the same while the block rests, whoever is slave.

    On a slippery floor the block goes with the foot, mu_b (t_n + W) instead of mu t_n:
    alpha = (mu_b (P + W) + M_p/h)/(1 + mu_b h/L).
    """
    weight = 0.5
    if expected is None:
        expected = (mu_block * (1.5 + weight) + 0.5) / (1 + mu_block * 0.5)

    def interface(one, other, friction):
        return la.Interface(*((other, one) if swap else (one, other)), friction)

    bodies = {"frame": portal(), "block": la.RigidBlock(box(-1, 1, -1, 0))}
    problem = la.Problem(
        bodies,
        [la.PointForce("frame", "B", RIGHT)],
        interfaces=[
            interface(("frame", "A"), ("block", lambda x: x[1] == 0), mu),
            la.Interface(("frame", "D"), FLOOR, mu),
            la.Interface(("block", lambda x: x[1] == -1), la.RigidObstacle(), mu_block),
        ],
        dead_loads=[
            *(la.PointForce("frame", node, (0, -1.5)) for node in "BC"),
            la.BodyForce("block", (0, -weight / 2)),
        ],
    )
    for backend in BACKENDS:
        assert solved(problem, backend).load_factor == pytest.approx(expected, rel=BAR)


@pytest.mark.parametrize("swap", [False, True])
def test_feet_on_soil(swap):
    """C11 on a soil too strong to yield: the same as on a floor."""
    mesh = la.meshes.rectangle((-2, 6), (-4, 0), 8, 4)
    sides = [("frame", ("A", "D")), ("soil", "top")]
    problem = la.Problem(
        {"frame": portal(), "soil": la.Body(mesh, la.VonMises(shear_strength=5.0))},
        [la.PointForce("frame", "B", RIGHT)],
        [la.Fix("soil", "bottom")],
        [la.Interface(*(sides[::-1] if swap else sides), 0.35)],
        [la.PointForce("frame", node, (0, -1.5)) for node in "BC"],
    )
    state = solved(problem)
    assert state.load_factor == pytest.approx(pushed_exact(0.35, 1.5), rel=BAR)
    assert set(state.stress) == set(state.dissipation) == {"soil"}
    assert set(state.velocity) == {"soil", "frame"}


def test_foot_in_a_corner():
    """Against floor and wall at once: the portal that is pushed away from the wall leaves it."""
    wall = la.RigidObstacle((0.0, 0.0), (1.0, 0.0))
    push = [la.PointForce("frame", "B", RIGHT)]
    dead = [la.PointForce("frame", node, (0, -1.5)) for node in "BC"]
    feet = [
        la.Interface(("frame", "A"), FLOOR, 0.1),
        la.Interface(("frame", "A"), wall, 0.1),
        la.Interface(("frame", "D"), FLOOR, 0.1),
    ]
    state = solved(la.Problem({"frame": portal()}, push, interfaces=feet, dead_loads=dead))
    assert state.load_factor == pytest.approx(pushed_exact(0.1, 1.5), rel=BAR)
    back = [la.PointForce("frame", "C", (-1.0, 0.0))]
    held = solved(la.Problem({"frame": portal()}, back, interfaces=feet, dead_loads=dead))
    assert held.load_factor > state.load_factor * (1 + BAR)


@pytest.mark.parametrize("mu", [0.2, 0.6])
def test_bracket_of_friction(mu):
    """alpha_frictionless <= alpha_Coulomb = alpha_associated <= alpha_stick (T14)."""
    coulomb, associated = (
        solved(pressed(mu, 1.5), coupling=coupling).load_factor for coupling in (None, "associated")
    )
    low, high = (solved(pressed(law, 1.5)).load_factor for law in (la.SMOOTH, la.STICK))
    assert low * (1 - BAR) <= coulomb <= high * (1 + BAR)
    assert coulomb == pytest.approx(associated, rel=BAR)


def test_copies_and_pickles():
    problem = pressed(0.3, 0.5)
    twin = pickle.loads(pickle.dumps(problem))
    assert list(twin.bodies["frame"].nodes) == ["A", "B", "C", "D", "beam(2, 2)"]
    assert solved(twin).load_factor == pytest.approx(solved(problem).load_factor, rel=ROUND_OFF)
    assert twin.bodies["frame"] != problem.bodies["frame"]


def test_nothing_is_discretised_so_the_value_is_exact():
    beam = la.Frame({"A": (0, 0), "B": (2, 0), "C": (4, 0)}, [("A", "B"), ("B", "C")], 1.0)
    loads = [la.PointForce("beam", "B", (0, -1))]
    supports = [la.Fix("beam", "A", "xy"), la.Fix("beam", "C", "y")]
    state = la.solve(la.Problem({"beam": beam}, reference_loads=loads, supports=supports))
    assert "exact" in repr(state)
    assert "continuum" not in f"{state!r} {state}"
