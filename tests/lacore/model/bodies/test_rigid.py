"""Rigid blocks as unknowns, supports and loads; what cannot be right is refused by name.

1e-6 relative is the bar of the certificate.
"""

import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lacore as la
from lacore.model.bodies.blocks.dofs import RigidDofs
from tests.rigid_problems import box, problem

BAR = 1e-6
ROUND_OFF = 1e-12  # of numbers of order one
FLOOR = la.RigidObstacle((0, 0), (0, 1))


def bottom(x):
    return x[1] < 1e-9


def block_on_floor(b=1.0, h=4.0, mu=0.3, y=0.5, weight=1.0):
    return la.Problem(
        {"block": la.RigidBlock(box(0, b, 0, h))},
        [la.PointForce("block", (0.0, y), (1, 0))],
        interfaces=[la.Interface(("block", bottom), FLOOR, mu)],
        dead_loads=[la.BodyForce("block", (0, -weight / (b * h)))],
    )


@pytest.mark.parametrize("backend", ["clarabel", "highs", "cvxpy", "newton", "ipopt", "slsqp"])
@pytest.mark.parametrize(("mu", "y", "expected"), [(0.3, 0.5, 0.3), (0.6, 2.0, 0.25)])
def test_block_slides_or_topples(mu, y, expected, backend):
    """C1, by every kind of backend; the regularised ones lose less than 2 % at r = 1e-3 (T19)."""
    state = la.solve(block_on_floor(mu=mu, y=y), backend=backend, throw=True)
    exact = state.rigor is la.Rigor.DISCRETE
    assert state.load_factor == pytest.approx(expected, rel=BAR if exact else 0.02)


@pytest.mark.parametrize("components", ["x", "y", "xy", "normal", "tangential"])
@given(seed=st.integers(0, 2**32 - 1))
def test_what_is_held_does_not_move(components, seed):
    """At both ends of an edge of a block of any shape, whatever motions supports leave free."""
    rng = np.random.default_rng(seed)
    turn = np.sort(rng.uniform(0, 2 * np.pi, 3)) + np.array([0, 2.0, 4.0])
    block = la.RigidBlock(np.column_stack([np.cos(turn), rng.uniform(0.5, 1.5) * np.sin(turn)]))
    start, end = block.edges.start[:, 0], block.edges.end[:, 0]
    along = (end - start) / np.linalg.norm(end - start)

    def edge(x):
        away = x - start[:, None]
        return np.abs(along[0] * away[1] - along[1] * away[0]) < 1e-9

    dofs = RigidDofs(block, 0)
    free = dofs.free([la.Fix("block", edge, components)])
    x, y = (
        (rows @ free).toarray()
        for rows in dofs.velocity_rows(np.zeros(2, np.int64), np.stack([start, end], axis=1), 3)
    )
    normal = block.edges.normal[:, 0]
    across, past = normal[0] * x + normal[1] * y, normal[0] * y - normal[1] * x
    held = {"x": [x], "y": [y], "xy": [x, y], "normal": [across], "tangential": [past]}
    for own in held[components]:
        assert own == pytest.approx(np.zeros(own.shape), abs=1e-9)  # directions are told apart so
    assert free.shape[1] == (0 if components == "xy" else 2 if components == "tangential" else 1)


@given(
    length=st.floats(-3, 3),
    force=st.floats(-3, 3),
    angle=st.floats(0, 6.28),
    shift=st.tuples(st.floats(-10, 10), st.floats(-10, 10)),
)
def test_units_axes_and_place_do_not_matter(length, force, angle, shift):
    """A wall of six blocks, in other units (powers of ten), turned and moved."""
    unit, weight = 10.0**length, 10.0**force
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])

    def value(place):
        wall = la.masonry.running_bond([[1, 1], [0.5, 1, 0.5], [1, 1]], 0.5)
        blocks = {name: place(outline) for name, outline in wall.polygons.items()}
        return la.solve(
            la.Problem(
                {"blocks": la.BlockAssembly(blocks, 0.5)},
                [la.BodyForce("blocks", tuple(weight * (turn @ [1.0, 0.0])))],
                [la.Fix("blocks", "base")],
                dead_loads=[la.BodyForce("blocks", tuple(weight * (turn @ [0.0, -1.0])))],
            ),
            coupling="associated",
            throw=True,
        ).load_factor

    plain = la.masonry.running_bond([[1, 1], [0.5, 1, 0.5], [1, 1]], 0.5)
    reference = la.solve(
        la.Problem(
            {"blocks": plain},
            [la.BodyForce("blocks", (1, 0))],
            [la.Fix("blocks", "base")],
            dead_loads=[la.BodyForce("blocks", (0, -1))],
        ),
        coupling="associated",
        throw=True,
    ).load_factor
    moved = value(lambda outline: unit * (outline @ turn.T + np.array(shift)))
    assert moved == pytest.approx(reference, rel=BAR)


def test_velocities_are_those_of_the_blocks():
    """A toppling block turns about its leading corner, clockwise under a load to the right."""
    state = la.solve(block_on_floor(mu=0.6, y=2.0), throw=True)
    u_x, u_y, omega = state.velocity["block"][:, 0]
    assert omega == pytest.approx(-1 / 2, rel=BAR)  # u_x at y = 2 is 1
    assert (u_x, u_y) == pytest.approx((1.0, 0.25), rel=BAR)  # centroid (0.5, 2) about (1, 0)


def test_virtual_power_of_all_loads():
    """Each load's force is the gradient of its power, computed here from the outline."""
    outline = np.array([(0.0, 0.0), (2.0, 0.3), (1.7, 1.9), (0.4, 1.1)])
    body = la.RigidBlock(outline)
    centre = body.centroid[:, 0]

    def right_side(x):
        return np.abs(x[0] - 2 + 0.3 / 1.6 * (x[1] - 0.3)) < 1e-9

    loads = {
        "body": la.BodyForce("b", (0.3, -0.7)),
        "point": la.PointForce("b", (1.0, 0.8), (0.3, -0.7)),
        "named": la.PointForce("b", "block", (0.3, -0.7)),
        "traction": la.Traction("b", right_side, (0.3, -0.7)),
        "pressure": la.Pressure("b", "block", 2.0),
    }
    q = np.array([0.4, -1.1, 0.6])
    u = q * [1, 1, body.radius[0]]  # w = omega r

    def velocity(x):
        arm = np.asarray(x) - centre
        return q[:2] + q[2] * np.array([-arm[1], arm[0]])

    right = (outline[1] + outline[2]) / 2
    length = np.linalg.norm(outline[2] - outline[1])
    f = np.array([0.3, -0.7])
    expected = {
        "body": body.area[0] * f @ velocity(centre),
        "point": f @ velocity((1.0, 0.8)),
        "named": f @ velocity(centre),
        "traction": length * f @ velocity(right),
        "pressure": 0.0,  # the forces of a pressure all round balance
    }
    for name, load in loads.items():
        one = la.Problem(
            {"b": body},
            [load] if name != "pressure" else [loads["body"]],
            interfaces=[la.Interface(("b", "block"), la.RigidObstacle(), 0.1)],
            dead_loads=[loads["body"], load],
        )
        full = la.discretise(one).full
        power = full.dead_load @ u - expected["body"]
        assert power == pytest.approx(expected[name], abs=ROUND_OFF), name


@pytest.mark.parametrize(
    ("components", "free"), [("xy", 0), ("x", 1), ("y", 1), ("normal", 0), ("tangential", 0)]
)
def test_supports_of_a_whole_block(components, free):
    """Held in x at four corners a block moves in y only; normals of four sides hold all."""
    body = la.BlockAssembly({"a": box(0, 2, 0, 1), "b": box(2, 3, 0, 1)}, 0.3)
    held = la.Problem(
        {"blocks": body},
        [la.BodyForce("blocks", (1, 0))],
        [la.Fix("blocks", "a", components)],
        dead_loads=[la.BodyForce("blocks", (0, -1))],
    )
    assert la.discretise(held).program.n == 3 + free


def test_a_side_on_rollers():
    """Held along y at its bottom side, a block moves along x only."""
    roller = la.Problem(
        {"blocks": la.RigidBlock(box(0, 2, 0, 1))},
        [la.BodyForce("blocks", (1, 0))],
        [la.Fix("blocks", bottom, "y")],
        interfaces=[la.Interface(("blocks", lambda x: x[0] > 2 - 1e-9), la.RigidObstacle(), 0.2)],
        dead_loads=[la.BodyForce("blocks", (0.5, -1))],
    )
    basis = la.discretise(roller).free_basis.toarray()
    assert basis.shape == (3, 1)
    assert np.abs(basis[:, 0]) == pytest.approx([1, 0, 0], abs=ROUND_OFF)


def test_wall_on_a_deformable_ground():
    """A strong ground changes nothing; one that cannot carry the wall's push gives way earlier."""

    def on(strength):
        ground = la.Body(la.meshes.rectangle((-0.4, 1.2), (-0.4, 0), 8, 2), la.VonMises(strength))
        wall = la.masonry.running_bond([[1, 1], [0.5, 1, 0.5]], 0.4, base=False)
        return la.Problem(
            {"ground": ground, "wall": wall},
            [la.BodyForce("wall", (1, 0))],
            [la.Fix("ground", "bottom")],
            [la.Interface(("wall", bottom), ("ground", "top"), 0.4)],
            [la.BodyForce("wall", (0, -1))],
        )

    rigid = la.solve(
        la.Problem(
            {"wall": la.masonry.running_bond([[1, 1], [0.5, 1, 0.5]], 0.4)},
            [la.BodyForce("wall", (1, 0))],
            [la.Fix("wall", "base")],
            dead_loads=[la.BodyForce("wall", (0, -1))],
        ),
        throw=True,
    ).load_factor
    strong = la.solve(on(10.0), throw=True).load_factor
    weak = la.solve(on(0.14), throw=True).load_factor
    assert strong == pytest.approx(rigid, rel=1e-5)  # two certificates
    assert 0 < weak < 0.99 * rigid


def test_states_of_blocks_pickle():
    state = la.solve(block_on_floor(), throw=True)
    again = pickle.loads(pickle.dumps(state.velocity))
    assert np.array_equal(again["block"], state.velocity["block"])


def refuses(statement, *parts):
    with pytest.raises(la.InputError) as caught:
        statement()
    for part in parts:
        assert part in str(caught.value)


def two_blocks(**changes):
    given = {
        "bodies": {"blocks": la.BlockAssembly({"a": box(0, 2, 0, 1), "b": box(0, 2, 1, 2)}, 0.3)},
        "reference_loads": [la.BodyForce("blocks", (1, 0))],
        "supports": [la.Fix("blocks", "a")],
        "dead_loads": [la.BodyForce("blocks", (0, -1))],
    }
    return la.Problem(**(given | changes))


@pytest.mark.parametrize(
    ("statement", "parts"),
    [
        (
            lambda: problem(
                {"base": box(0, 1, -1, 0), "one": box(0, 1, 0, 1), "far": box(5, 6, 0, 1)},
                [la.BodyForce("blocks", (1, 0))],
                0.3,
            ),
            ("'far'", "touches nothing", "interface or a support"),
        ),
        (
            lambda: la.discretise(two_blocks(dead_loads=[])),
            ("Problem.dead_loads", "nothing sets a scale", "own weight"),
        ),
        (
            lambda: la.discretise(two_blocks(dead_loads=[la.BodyForce("blocks", (0, -1), "a")])),
            ("Problem.dead_loads", "nothing sets a scale"),
        ),
        (
            lambda: two_blocks(reference_loads=[la.BodyForce("blocks", (1, 0), "c")]),
            ("Problem.reference_loads[0].where = 'c'", "no such block"),
        ),
        (
            lambda: two_blocks(reference_loads=[la.PointForce("blocks", (9, 9), (1, 0))]),
            ("Problem.reference_loads[0].at = (9, 9)", "lies on no block", "the nearest is 'b'"),
        ),
        (
            lambda: two_blocks(reference_loads=[la.PointForce("blocks", (1, 1), (1, 0))]),
            ("Problem.reference_loads[0].at = (1, 1)", "lies on the blocks a, b", "`where`"),
        ),
        (
            lambda: two_blocks(reference_loads=[la.RigidFooting("blocks", "b", (0, -1))]),
            ("Problem.reference_loads[0].body = 'blocks'", "rigid already"),
        ),
        (
            lambda: two_blocks(supports=[la.Fix("blocks", "c")]),
            ("Problem.supports[0].where = 'c'",),
        ),
        (
            lambda: la.discretise(
                two_blocks(reference_loads=[la.BodyForce("blocks", (1, 0), "a")])
            ),
            ("Problem.reference_loads", "they do no power"),
        ),
        (
            lambda: la.Problem(
                {"soil": la.Body(la.meshes.rectangle((0, 1), (0, 1), 1, 1), la.VonMises(1.0))},
                [la.BodyForce("soil", (1, 0), where="a")],
            ),
            ("reference_loads[0].where = 'a'", "no such region of the mesh; the mesh has none"),
        ),
        (
            lambda: la.Problem(
                {"soil": la.Body(la.meshes.rectangle((0, 1), (0, 1), 1, 1), la.VonMises(1.0))},
                [la.PointForce("soil", "a", (1, 0))],
            ),
            ("reference_loads[0].at = 'a'", "no named points", "give (x, y)"),
        ),
    ],
)
def test_bad_input_is_refused_before_any_solve(statement, parts):
    refuses(statement, *parts)


def test_a_point_on_a_joint_acts_on_the_block_that_is_named():
    top = two_blocks(reference_loads=[la.PointForce("blocks", (1, 1), (1, 0), where="b")])
    state = la.solve(top, throw=True)
    assert state.load_factor == pytest.approx(0.3 * 2, rel=BAR)


def test_an_isolated_block_may_have_a_support_or_an_interface():
    body = la.BlockAssembly({"a": box(0, 1, 0, 1), "b": box(5, 6, 0, 1)}, 0.3)
    la.Problem(
        {"blocks": body},
        [la.BodyForce("blocks", (1, 0))],
        [la.Fix("blocks", "b")],
        [la.Interface(("blocks", lambda x: bottom(x) & (x[0] < 2)), FLOOR, 0.3)],
        [la.BodyForce("blocks", (0, -1))],
    )


@pytest.mark.parametrize("height", [2.0, 6.0])
def test_a_force_outside_its_block_acts_on_an_arm(height):
    """A stone of W = 4, half as wide as 1, topples at W/2 over the height of the force."""
    block = la.RigidBlock([(0, 0), (1, 0), (1, 4), (0, 4)])
    floor = la.Interface(("stone", lambda x: x[1] == 0), la.RigidObstacle(), 2.0)
    (name,) = block.names

    def pushed(where):
        push = la.PointForce("stone", (0.5, height), (1, 0), where=where)
        weight = la.BodyForce("stone", (0, -1))
        return la.Problem({"stone": block}, [push], interfaces=[floor], dead_loads=[weight])

    assert la.solve(pushed(name)).load_factor == pytest.approx(2 / height, rel=1e-6)
    if height > 4:
        with pytest.raises(la.InputError, match="name it by `where`"):
            la.discretise(pushed(None))


def test_a_force_outside_its_block_in_space_has_its_couple():
    """A pier of 1 x 0.5 x 0.5 m, 0.25 of weight, pushed 2 m above its base, along its length."""
    pier = la.masonry3d.wall([[1]], friction=0.9, block=(1.0, 0.5, 0.5))
    (name,) = (own for own in pier.names if own != "base")
    x, y, _ = pier.centroid[:, pier.names.index(name)]
    base = pier.centroid[2, pier.names.index(name)] - 0.25
    push = la.PointForce("pier", (x, y, base + 2.0), (1, 0, 0), where=name)
    problem = la.Problem(
        {"pier": pier},
        [push],
        [la.Fix("pier", "base")],
        dead_loads=[la.BodyForce("pier", (0, 0, -1))],
    )
    assert la.solve(problem).load_factor == pytest.approx(0.25 * 0.5 / 2.0, rel=1e-5)
