"""Assemblies of blocks in space: what they take and refuse, and loads and supports on them."""

import pickle
from functools import partial

import numpy as np
import pytest

import lacore as la
from lacore.model.bodies.blocks.dofs import RigidDofs
from tests.lacore.model.bodies.blocks3d.solids import (
    L_SHAPE,
    box,
    corners,
    moved,
    prism,
    triangulated,
)

STACK = {str(n): box((0, 0, n), (1, 1, n + 1)) for n in range(3)}
PUSH, WEIGHT = la.BodyForce("stack", (1, 0, 0)), la.BodyForce("stack", (0, 0, -1))
FLOOR = la.RigidObstacle((0, 0, 0), (0, 0, 1))


def low(x):
    return x[2] < 1e-9


def stack(blocks=None, **given):
    stated = {
        "bodies": {"stack": la.BlockAssembly3D(blocks or STACK, 0.6)},
        "reference_loads": [PUSH],
        "dead_loads": [WEIGHT],
        "interfaces": [la.Interface(("stack", low), FLOOR, 0.6)],
    }
    return la.Problem(**(stated | given))


def refused(statement, *parts):
    with pytest.raises(la.InputError) as caught:
        statement()
    assert all(part in str(caught.value) for part in parts), str(caught.value)


def test_names_and_joints():
    body = la.BlockAssembly3D(list(STACK.values()), 0.6, {("1", "0"): la.Tresca(7.0)})
    assert body.names == ("0", "1", "2")
    assert body.joint_names == ("0|1", "1|2")
    assert body.joint_terms.tolist() == [[0, 0.6], [7, 0], [0, 0], [0, 0]]
    assert pickle.loads(pickle.dumps(body)).joint_terms.tolist() == body.joint_terms.tolist()
    assert body.volume == pytest.approx([1, 1, 1])


@pytest.mark.parametrize(
    ("statement", "parts"),
    [
        (partial(la.BlockAssembly3D, {}, 0.6), ("BlockAssembly3D.blocks", "no block")),
        (partial(la.BlockAssembly3D, {"a": corners((0, 0, 0), (1, 1, 1))}, 0.6), ("['a']", "Poly")),
        (partial(la.BlockAssembly3D, {"a|b": STACK["0"]}, 0.6), ("'a|b'", "name of a block")),
        (partial(la.BlockAssembly3D, STACK, -0.1), ("BlockAssembly3D.friction", "coefficient")),
        (partial(la.BlockAssembly3D, STACK, la.BOND), ("BlockAssembly3D.friction", "one block")),
        (partial(la.BlockAssembly3D, STACK, 0.6, {("0", "2"): 0.5}), ("share no joint",)),
        (partial(la.BlockAssembly3D, STACK, 0.6, tolerance=0.0), ("tolerance", "positive")),
        (
            partial(la.BlockAssembly3D, {"a": STACK["0"], "b": moved(STACK["0"])}, 0.6),
            ("('a', 'b')", "overlap"),
        ),
        (
            lambda: stack({**STACK, "far": box((5, 5, 5), (6, 6, 6))}),
            ("Problem.bodies['stack'] = 'far'", "touches nothing"),
        ),
        (
            lambda: stack({**STACK, "edge": box((1, 1, 1), (2, 2, 2))}),
            ("'edge'", "'0'", "touch at (1, 1, 1) m", "makes no joint"),
        ),
        (
            lambda: stack(supports=[la.Fix("stack", "0", "xy")]),
            ("Problem.supports[0].components = 'xy'", "leave z free", "'xyz'"),
        ),
        (
            lambda: stack(supports=[la.Fix("stack", "0", "clamped")]),
            ("supports[0].components = 'clamped'", "space"),
        ),
        (
            lambda: stack(supports=[la.Fix("stack", "4", "xyz")]),
            ("supports[0].where = '4'", "known names: 0, 1, 2"),
        ),
        (
            lambda: stack(supports=[la.Fix("stack", lambda x: x[2] > 9, "z")]),
            ("supports[0].where", "z = 0 to 3"),
        ),
        (
            lambda: stack(reference_loads=[la.BodyForce("stack", (1, 0))]),
            ("Problem.reference_loads[0].vector = (1, 0)", "2 numbers", "(x, y, z)"),
        ),
        (
            lambda: stack(reference_loads=[la.PointForce("stack", (0, 1), (1, 0, 0))]),
            ("Problem.reference_loads[0].at", "(x, y, z)"),
        ),
        (
            lambda: stack(reference_loads=[la.PointForce("stack", (0, 1, 1), (1, 0, 0))]),
            ("reference_loads[0].at", "blocks 0, 1", "`where`"),
        ),
        (
            lambda: stack(reference_loads=[la.PointForce("stack", (0, 1, 4), (1, 0, 0))]),
            ("reference_loads[0].at", "no block", "'2'"),
        ),
        (
            lambda: stack(reference_loads=[la.RigidFooting("stack", "2", (0, -1))]),
            ("reference_loads[0].direction", "(x, y, z)"),
        ),
        (
            lambda: stack(dead_loads=[la.PorePressure("stack", 1.0)]),
            ("rigid blocks, which have no pores",),
        ),
        (
            lambda: stack(dead_loads=[la.BodyForce("stack", (0, 0, lambda x: -(x[2] ** 2)))]),
            ("Problem.dead_loads[0].vector", "not linear in each block"),
        ),
        (
            lambda: stack(
                interfaces=[la.Interface(("stack", low), la.RigidObstacle((0, 0), (0, 1)), 0.6)]
            ),
            ("Problem.interfaces[0].master.point", "(x, y, z)"),
        ),
        (
            lambda: stack(interfaces=[la.Interface(("stack", low), FLOOR, la.BOND)]),
            ("interfaces[0].friction", "BOND"),
        ),
        (
            lambda: stack(interfaces=[la.Interface(("stack", "0"), FLOOR, 0.6)]),
            ("Problem.interfaces[0]", "corner of '0'", "above"),
        ),
        (
            lambda: stack(
                {"base": box((0, 0, 0), (2, 1, 1)), "top": STACK["1"]},
                interfaces=[
                    la.Interface(
                        ("stack", lambda x: (x[2] == 1) & (x[0] == 1)),
                        la.RigidObstacle((0, 0, 1), (0, 0, -1)),
                        0.6,
                    )
                ],
            ),
            ("Problem.interfaces[0]", "block 'base' about (1, 0.5, 1) m", "has a joint"),
        ),
        (
            lambda: stack(
                bodies={
                    "stack": la.BlockAssembly3D(STACK, 0.6),
                    "plate": la.RigidBlock([(0, 0), (1, 0), (1, 1)]),
                }
            ),
            ("Problem.bodies['stack']", "together with 'plate'", "a plane BlockAssembly"),
        ),
    ],
)
def test_wrong_inputs_are_refused_with_place_and_mend(statement, parts):
    refused(statement, *parts)


def test_vectors_of_space_on_bodies_of_the_plane_are_refused():
    wall = la.masonry.stack([(1, 1)], 0.6)
    held = {"bodies": {"wall": wall}, "supports": [la.Fix("wall", wall.names[0])]}
    for load, part in (
        (la.BodyForce("wall", (1, 0, 0)), "vector"),
        (la.PointForce("wall", (0, 1), (1, 0, 0)), "vector"),
        (la.Traction("wall", wall.names[-1], (1, 0, 0)), "vector"),
    ):
        refused(lambda load=load: la.Problem(**held, reference_loads=[load]), part, "(x, y)")


@pytest.mark.parametrize("cut", [triangulated, lambda block: block])
def test_resultants_of_loads(cut):
    """Forces and moments about the centroid, r times over, of a block that is not convex."""
    block = cut(prism(L_SHAPE, 2.0))
    body = la.BlockAssembly3D({"L": block}, 0.5)
    dofs, c, r = RigidDofs(body, 0), block.centroid, block.radius

    def resultant(load):
        total = dofs.force(load)
        return np.concatenate([total[:3], r * total[3:]])

    gravity = la.BodyForce("L", (0, 0, lambda x: 3 + x[0] - 2 * x[2]))
    # int x = 2.5*2, int x^2 = 2*(8/3 + 1/3) and int x z, x y over the L of area 3, height 2.
    force = 3 * 6 + 5 - 2 * 6
    about_y = -(3 * 5 + 6 - 2 * 5)  # - int x f
    about_x = 3 * 5 + 2 * (0.5 * 2 + 0.5 * 1.5) - 2 * 5  # int y f; int x y is 2*(1 + .75)
    moment = np.array([about_x, about_y, 0]) - np.cross(c, (0, 0, force))
    # Sums of four points a tetrahedron: round-off of some twenty terms of the order of ten.
    assert resultant(gravity) == pytest.approx([0, 0, force, *moment], abs=1e-12)
    assert resultant(la.PointForce("L", (0.5, 2, 1), (1, 2, 3))) == pytest.approx(
        [1, 2, 3, *np.cross((0.5, 2, 1) - c, (1, 2, 3))], abs=1e-13
    )
    assert resultant(la.Pressure("L", "L", 5.0)) == pytest.approx(np.zeros(6), abs=1e-12)
    top = la.Traction("L", lambda x: x[2] == 2, (1, 0, -1))
    arm = np.array([5 / 6, 5 / 6, 2]) - c
    assert resultant(top) == pytest.approx([3, 0, -3, *np.cross(arm, (3, 0, -3))], abs=1e-12)
    pressed = la.Pressure("L", lambda x: x[2] == 2, 5.0)
    assert resultant(pressed) == pytest.approx([0, 0, -15, *np.cross(arm, (0, 0, -15))], abs=1e-12)


def test_a_place_in_the_notch_of_a_block_is_no_place_of_it():
    body = {"b": la.BlockAssembly3D({"L": prism(L_SHAPE, 2.0)}, 0.5)}
    loads = [la.PointForce("b", (1.5, 1.5, 1), (1, 0, 0))]
    refused(lambda: la.Problem(body, loads, [la.Fix("b", "L", "z")]), "no block")


@pytest.mark.parametrize(
    ("components", "free"),
    [("x", 4), ("z", 3), ("xz", 1), ("yz", 1), ("xyz", 0), ("normal", 3)],
)
def test_supports_of_a_face_leave_free_what_they_do_not_hold(components, free):
    """Of a bottom z holds two rotations; x the one about z, and of u_x and the one about y, which
    moves all corners of one height alike, their sum."""
    body = la.BlockAssembly3D(STACK, 0.6)
    basis = RigidDofs(body, 0).free([la.Fix("stack", low, components)])
    assert basis.shape == (18, 12 + free)
    own = basis[:6, : basis.shape[1]].toarray()
    assert np.linalg.matrix_rank(own) == free


def test_velocities_of_points_are_those_of_a_rigid_motion():
    body = la.BlockAssembly3D(STACK, 0.6)
    dofs = RigidDofs(body, 2)
    rng = np.random.default_rng(3)
    u, omega, points = rng.random((3, 3)), rng.random((3, 3)), rng.random((3, 5))
    blocks = np.array([0, 2, 1, 1, 0])
    motion = np.concatenate([u, omega])
    velocity = np.concatenate([[7.0, 7.0], dofs.unknowns(motion)])
    assert dofs.motion(velocity) == pytest.approx(motion)
    rows = dofs.velocity_rows(blocks, points, velocity.size)
    arm = points - body.centroid[:, blocks]
    expected = u[:, blocks] + np.cross(omega[:, blocks], arm, axis=0)
    assert np.stack([row @ velocity for row in rows]) == pytest.approx(expected)


def test_a_predicate_may_ask_for_equal_coordinates():
    """Centroids are sums of products; of a face across an axis they keep its coordinate."""
    block = box((-1, -1, 0.1), (1 / 3, 1 / 7, 0.7))
    body = la.BlockAssembly3D([block], 0.5)
    for axis, value in ((0, 1 / 3), (1, 1 / 7), (2, 0.7), (2, 0.1)):
        assert body.outline(lambda x, a=axis, v=value: x[a] == v, "where").size == 1


def test_a_support_holds_all_directions_where_nothing_is_said():
    assert [own.components for own in stack(supports=[la.Fix("stack", "0")]).supports] == ["xyz"]
