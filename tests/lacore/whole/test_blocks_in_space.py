"""Rigid blocks in space: closed forms, extruded plane structures, what must not matter (T78)."""

from dataclasses import replace
from math import atan, cos, hypot, sin, sqrt

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.spatial.transform import Rotation

import lacore as la
from tests.lacore.model.bodies.blocks3d.solids import box, moved, prism, triangulated

FLOOR = la.RigidObstacle((0, 0, 0), (0, 0, 1))
# Residuals of states are 1e-9 and less: with isostatic normals, whose sums equilibrium gives, load
# factors are as exact.
CLOSED = 1e-8
SAME = 1e-7  # of one mechanism by another route, whose residuals add up


def low(x):
    return x[2] < 1e-9


def on_floor(blocks, friction, live, dead=None, **options):
    """Solved: blocks that stand on a plane."""
    problem = la.Problem(
        {"b": la.BlockAssembly3D(blocks, friction)},
        live,
        interfaces=[la.Interface(("b", low), FLOOR, friction)],
        dead_loads=[la.BodyForce("b", (0, 0, -1))] if dead is None else dead,
    )
    return la.solve(problem, throw=True, **options)


def twisted(block, mu, arm=0.5):
    """Solved: a block of weight W under two forces about z, 1 N m per load factor."""
    forces = [la.PointForce("b", (s * arm, 0, 0.5), (0, s / (2 * arm), 0)) for s in (1, -1)]
    return on_floor({"b": block}, mu, forces)


@pytest.mark.parametrize("azimuth", [0.0, 0.4, 1.2, 2.5])
@pytest.mark.parametrize(("mu", "h"), [(0.3, 1.0), (0.7, 2.0)])
def test_a_block_slides_or_topples_over_an_edge_whatever_the_azimuth(azimuth, mu, h):
    """S1, moments: it topples over the edge that the push is most across."""
    c, s = cos(azimuth), sin(azimuth)
    found = on_floor({"b": box((0, 0, 0), (1, 1, h))}, mu, [la.BodyForce("b", (c, s, 0))])
    assert found.load_factor == pytest.approx(min(mu, 1 / h / max(abs(c), abs(s))), abs=CLOSED)
    assert found.certificate.holds(1e-6)


def test_a_stack_topples_as_a_whole():
    blocks = {str(n): box((0, 0, n), (1, 1, n + 1)) for n in range(4)}
    assert on_floor(blocks, 0.6, [la.BodyForce("b", (1, 0, 0))]).load_factor == pytest.approx(
        1 / 4, abs=CLOSED
    )


@pytest.mark.parametrize(("mu", "beta"), [(0.7, 0.4), (0.5, 0.2), (0.5, 0.0)])
def test_a_block_is_pushed_across_a_slope(mu, beta):
    """S2: it slips along (sin beta, alpha), of friction mu cos beta in all. At mid-height of a
    flat block on a wide base nothing topples."""
    turn = Rotation.from_euler("y", beta)  # down the slope is +x
    block = moved(box((-1, -1, 0), (1, 1, 0.2)), turn)
    weight = la.BodyForce("b", (0, 0, -1 / block.volume))
    normal = turn.apply((0, 0, 1))
    problem = la.Problem(
        {"b": la.BlockAssembly3D({"b": block}, mu)},
        [la.BodyForce("b", (0, 1 / block.volume, 0))],
        interfaces=[
            la.Interface(
                ("b", lambda x: normal @ x < 1e-6), la.RigidObstacle((0, 0, 0), tuple(normal)), mu
            )
        ],
        dead_loads=[weight],
    )
    state = la.solve(problem, throw=True)
    exact = sqrt((mu * cos(beta)) ** 2 - sin(beta) ** 2)
    assert state.load_factor == pytest.approx(exact, abs=CLOSED)
    down, across = turn.apply((1, 0, 0)), (0, 1, 0)
    u = state.velocity["b"][:3, 0]
    # Of a direction the square counts in a power: half the digits.
    assert atan((u @ down) / (u @ across)) == pytest.approx(atan(sin(beta) / exact), abs=1e-4)


def test_corners_carry_the_most_torque_that_friction_has():
    """S3b, T72: a square on four corners, a triangle on three."""
    mu = 0.5
    square = twisted(box((-0.5, -0.5, 0), (0.5, 0.5, 1)), mu)
    assert square.load_factor == pytest.approx(mu / sqrt(2), abs=CLOSED)
    angles = 2 * np.pi * np.arange(3) / 3
    triangle = prism(np.stack([np.cos(angles), np.sin(angles)], axis=1), 1.0)
    assert twisted(triangle, mu, 0.2).load_factor == pytest.approx(mu * triangle.volume, abs=CLOSED)


def test_torque_on_three_legs_turns_about_their_fermat_weber_point():
    """S3: three isostatic normals; the centre minimises the sum of forces times distances."""
    mu, outline = 0.4, np.array([(0, 0), (3, 0.2), (0.5, 1.1)])
    block = prism(outline, 1.0)
    x, y, z = block.centroid
    forces = [la.PointForce("b", (x + s * 0.1, y, z), (0, s / 0.2, 0)) for s in (1, -1)]
    found = on_floor({"b": block}, mu, forces)
    # The centroid of a triangle presses all three corners alike.
    c = outline.mean(axis=0)
    for _ in range(2000):  # of Weiszfeld's iteration, of linear convergence
        weight = 1 / np.linalg.norm(outline - c, axis=1)
        c = weight @ outline / weight.sum()
    exact = mu * block.volume / 3 * np.linalg.norm(outline - c, axis=1).sum()
    assert found.load_factor == pytest.approx(exact, abs=CLOSED)


@pytest.mark.parametrize("e", [0.1, 0.5, 2.0])
def test_an_eccentric_push_at_floor_level(e):
    """S4: four equal normals, a push along y at x = e, slip about a point (-c, 0)."""
    mu, a = 0.4, 0.5
    push = [la.PointForce("b", (0.5, 0, 0), (0, 1 - (0.5 - e), 0))]
    push += [la.PointForce("b", (-0.5, 0, 0), (0, 0.5 - e, 0))]
    state = on_floor({"b": box((-a, -a, 0), (a, a, 1))}, mu, push)

    def power(c):
        sides = hypot(a, a + c) + hypot(a, a - c)
        return mu / 2 * sides / (e + c)

    exact = minimize_scalar(power, bounds=(0, 50), method="bounded", options={"xatol": 1e-9}).fun
    # Normals may differ in pairs; that all are equal is one state of several.
    assert state.interval().low - CLOSED <= exact <= state.interval().high + CLOSED


def extruded(plane, slices):
    """The blocks of an assembly in the plane x-z, cut into slices of unit depth along y."""
    blocks, up = {}, Rotation.from_euler("x", 90, degrees=True)
    for name, ring in plane.polygons.items():
        for k in range(slices):
            own = moved(prism(ring, 1.0), up, (0, 1 + k, 0))
            blocks[f"{name}.{k}"] = own
    return blocks


def arch(friction, slices):
    """In the plane and in space: nine voussoirs under their weight, pushed by a share of it."""
    plane = la.masonry.arch(9, 0.85, 0.3, friction)
    flat = la.Problem(
        {"arch": plane},
        [la.BodyForce("arch", (1, 0))],
        [la.Fix("arch", ("left", "right"))],
        dead_loads=[la.BodyForce("arch", (0, -1))],
    )
    solid = la.Problem(
        {"arch": la.BlockAssembly3D(extruded(plane, slices), friction)},
        [la.BodyForce("arch", (1, 0, 0))],
        [
            la.Fix(
                "arch", tuple(f"{s}.{k}" for s in ("left", "right") for k in range(slices)), "xyz"
            )
        ],
        dead_loads=[la.BodyForce("arch", (0, 0, -1))],
    )
    return flat, solid


@pytest.mark.parametrize(("mu", "slices"), [(0.6, 1), (0.35, 1), (0.6, 2)])
def test_an_arch_extruded_carries_what_the_plane_one_does(mu, slices):
    """S7, per depth; both with Coulomb and with associated friction. Slices leave each other alone
    or rub without pressure: either way nothing passes between them."""
    for friction in (mu, la.Coulomb(mu, associated=True)):
        flat, solid = (la.solve(own, throw=True) for own in arch(friction, slices))
        assert solid.load_factor == pytest.approx(flat.load_factor, abs=SAME)
        assert solid.certificate.holds(1e-6)


def tower(turn=None, shift=(0, 0, 0), scale=1.0, order=None, cut=lambda block: block):
    """A pier of three courses, two blocks and one by turns, pushed askew."""
    blocks = {
        "base": box((0, 0, -0.2), (1.2, 1, 0)),
        "left": box((0, 0, 0), (0.5, 1, 0.6)),
        "right": box((0.5, 0, 0), (1.2, 1, 0.6)),
        "lintel": box((0, 0, 0.6), (1.2, 1, 1)),
        "top": box((0.1, 0.2, 1), (1.0, 0.9, 1.8)),
    }
    names = list(blocks) if order is None else [list(blocks)[k] for k in order]
    turn = Rotation.identity() if turn is None else turn
    moved_ones = {name: moved(cut(blocks[name]), turn, shift, scale) for name in names}
    push, down = (tuple(turn.apply(v)) for v in ((1.0, 0.5, 0.1), (0.0, 0.0, -1.0)))
    return la.Problem(
        {"pier": la.BlockAssembly3D(moved_ones, 0.5, {("lintel", "top"): 0.7})},
        [la.BodyForce("pier", push)],
        [la.Fix("pier", "base", "xyz")],
        dead_loads=[la.BodyForce("pier", down)],
    )


@pytest.fixture(scope="module")
def standing():
    return la.solve(tower(), throw=True)


@pytest.mark.parametrize(
    "other",
    [
        {"turn": Rotation.from_rotvec((0.3, -1.1, 0.7))},
        {"shift": (3, -2, 1)},
        {"scale": 1e-3},
        {"scale": 1e3},
        {"order": [3, 0, 4, 2, 1]},
        {"cut": triangulated},
        {"turn": Rotation.from_rotvec((2, 0.2, 0.1)), "order": [4, 3, 2, 1, 0], "scale": 10.0},
    ],
    ids=lambda own: "-".join(own),
)
def test_what_must_not_matter(standing, other):
    found = la.solve(tower(**other), throw=True)
    assert found.load_factor == pytest.approx(standing.load_factor, abs=SAME)


def test_units_of_force_do_not_matter(standing):
    problem = tower()
    heavy = [la.BodyForce("pier", (0, 0, -2.4e4))]
    pushed = [problem.reference_loads[0].times(2.4e4)]
    found = la.solve(problem.with_loads(pushed, heavy), throw=True)
    assert found.load_factor == pytest.approx(standing.load_factor, abs=SAME)
    reactions = standing.reactions["t_n"] * standing.reactions["area"]
    assert found.reactions["t_n"] @ found.reactions["area"] == pytest.approx(
        2.4e4 * reactions.sum(), rel=1e-5
    )


def test_two_bodies_are_what_one_assembly_of_both_is(standing):
    """An interface finds the joints between their faces."""
    problem = tower()
    blocks = dict(problem.bodies["pier"].polyhedra)
    top = blocks.pop("top")
    bodies = {"pier": la.BlockAssembly3D(blocks, 0.5), "top": la.BlockAssembly3D({"top": top}, 0.5)}
    stated = la.Problem(
        bodies,
        [la.BodyForce(name, problem.reference_loads[0].vector) for name in bodies],
        [la.Fix("pier", "base", "xyz")],
        [la.Interface(("top", "top"), ("pier", "lintel"), 0.7)],
        [la.BodyForce(name, (0, 0, -1)) for name in bodies],
    )
    found = la.solve(stated, throw=True)
    assert found.load_factor == pytest.approx(standing.load_factor, abs=SAME)
    assert set(found.reactions["slave"]) == {"left", "right", "lintel", "top"}


def test_reactions_and_supports_balance_the_weight(standing):
    table, held = standing.reactions, standing.support_reactions
    problem, alpha = standing.discretisation.problem, standing.load_factor
    volume = problem.bodies["pier"].volume.sum()
    load = volume * (alpha * np.array([1, 0.5, 0.1]) + (0, 0, -1))
    # Per total load 1e-9 is out of balance, and the pier weighs 2.
    assert held[["force_x", "force_y", "force_z"]].to_numpy()[0] == pytest.approx(-load, abs=1e-7)
    on_top = table[table["slave"] == "top"]
    force = on_top["area"].to_numpy() @ np.column_stack(
        [on_top["t_n"] * on_top[f"n_{axis}"] + on_top[f"t_t_{axis}"] for axis in "xyz"]
    )
    top = problem.bodies["pier"].polyhedra["top"].volume
    assert force == pytest.approx(-load * top / volume, abs=1e-7)
    assert set(table["state"]) <= {"open", "slip", "stick"}


def test_a_state_is_certified_anew_and_errors_in_it_are_seen(standing):
    tables = {"reactions": standing.reactions, "velocity": standing.velocity}
    assert standing.certify(**tables).holds(1e-6)
    wrong = standing.reactions.assign(t_t_x=1.01 * standing.reactions["t_t_x"])
    assert not standing.certify(reactions=wrong).holds(1e-6)
    faster = standing.velocity["pier"] * np.array([1, 1, 1, 1, 1.1])  # the block on top
    assert not standing.certify(velocity={"pier": faster}).holds(1e-6)
    assert not standing.certify(load_factor=1.001 * standing.load_factor).holds(1e-6)


@pytest.mark.parametrize("coupling", ["reaction", "shift"])
def test_other_loops_agree(standing, coupling):
    found = la.solve(tower(), coupling=coupling, throw=True)
    interval = standing.interval()
    slack = SAME * abs(standing.load_factor)
    assert interval.low - slack <= found.load_factor <= interval.high + slack


def test_single_solves_bound_it(standing):
    upper, most = (la.solve(tower(), coupling=own).load_factor for own in ("associated", "stick"))
    assert standing.load_factor <= upper + SAME
    assert upper <= most + SAME


def test_what_falls_is_told():
    """A block that overhangs by more than a half, held by a push from its far side; and one that
    nothing holds down."""
    blocks = {"base": box((0, 0, -1), (1, 1, 0)), "top": box((0.6, 0, 0), (1.6, 1, 1))}
    overhanging = replace(tower(), bodies={"pier": la.BlockAssembly3D(blocks, 0.6)})
    state = la.solve(overhanging, throw=True)
    assert state.load_factor < 0
    assert state.stability().standing is la.Standing.FALLS
    lifted = overhanging.with_loads(dead_loads=[la.BodyForce("pier", (0, 0, 1))])
    assert la.solve(lifted).status is la.Status.UNSAFE


def test_what_a_load_factor_depends_on(standing):
    """All slips on the base: mu (W - .1 alpha) = alpha |(1, .5)|, whatever the joint on top."""
    push = hypot(1, 0.5)
    assert standing.load_factor == pytest.approx(0.5 / (push + 0.1 * 0.5), abs=CLOSED)
    table = la.sensitivity(standing).table
    friction = table[table["parameter"] == "pier: friction.mu"]["derivative"].iloc[0]
    top = table[table["parameter"].str.contains("top")]["derivative"].iloc[0]
    dead, live = (
        table[table["parameter"].str.startswith(kind)]["elasticity"].iloc[0]
        for kind in ("dead", "reference")
    )
    # By differences, which are said to be good to 1e-3.
    assert friction == pytest.approx(push / (push + 0.1 * 0.5) ** 2, rel=1e-3)
    assert (dead, live, top) == pytest.approx((1, -1, 0), abs=1e-3)


def test_what_is_not_made_of_blocks_in_space_says_so(tmp_path):
    with pytest.raises(la.InputError, match="BlockAssembly3D"):
        la.write_problem(tower(), tmp_path / "pier.toml")


@pytest.mark.parametrize("coupling", ["certified", "associated"])
def test_what_only_presses_is_locked(coupling):
    """A stone on another, under more of its own weight: no friction is asked for (T13)."""
    blocks = {"low": box((0, 0, 0), (1, 1, 1)), "top": box((0, 0, 1), (1, 1, 2))}
    with pytest.raises(la.SolveError) as told:
        on_floor(blocks, 0.3, [la.BodyForce("b", (0, 0, -1))], coupling=coupling)
    assert told.value.state.status is la.Status.LOCKED
    assert told.value.state.load_factor == np.inf


def test_a_wedge_between_dilatant_walls_is_locked_by_a_proof():
    """Associated friction that dilates more than the walls lean apart holds whatever presses."""
    wedge = prism([(-0.45, 0), (0.45, 0), (0.5, 1), (-0.5, 1)], 1.0)
    left = prism([(-1.5, 0), (-0.45, 0), (-0.5, 1), (-1.5, 1)], 1.0)
    right = prism([(0.45, 0), (1.5, 0), (1.5, 1), (0.5, 1)], 1.0)
    problem = la.Problem(
        {"b": la.BlockAssembly3D({"wedge": wedge, "left": left, "right": right}, 0.5)},
        [la.BodyForce("b", (0, -1, 0), "wedge")],
        supports=[la.Fix("b", ("left", "right"), "xyz")],
        dead_loads=[la.BodyForce("b", (0, -1, 0), "wedge")],
    )
    state = la.solve(problem, coupling="associated", throw=False)
    assert state.status is la.Status.LOCKED


@pytest.mark.parametrize("azimuth", [0.0, 0.7])
def test_mortar_holds_by_its_area(azimuth):
    """Moments and forces: it slides at mu W + c A, or parts at the far corners of its bed."""
    c, s, h, area = cos(azimuth), sin(azimuth), 0.5, 2.0 * 2.0
    block, push = box((0, 0, 0), (2, 2, h)), [la.BodyForce("b", (c, s, 0))]
    weight = area * h
    glued = la.Coulomb(0.4, adhesion=0.3)
    slides = (0.4 * weight + 0.3 * area) / weight
    assert on_floor({"b": block}, glued, push).load_factor == pytest.approx(slides, abs=CLOSED)
    tall = box((0, 0, 0), (1, 1, 3))
    holding = la.Coulomb(0.2, adhesion=9.0, tension=0.7)
    # About the edge on the far side: weight and tension at half a side, the push at half of 3.
    topples = (3 * 0.5 + 0.7 * 0.5) / (3 * 1.5) / max(abs(c), abs(s))
    assert on_floor({"b": tall}, holding, push).load_factor == pytest.approx(topples, abs=CLOSED)
    spun = twisted(box((-0.5, -0.5, 0), (0.5, 0.5, 1)), la.Tresca(0.25))
    assert spun.load_factor == pytest.approx(0.25 / sqrt(2), abs=CLOSED)
