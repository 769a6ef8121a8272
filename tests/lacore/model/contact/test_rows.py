"""Rows of contact points: what rigid motions and polynomial velocities make of them."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.assembly.unknowns import Unknowns
from lacore.model.contact.rows import tangents
from tests.lacore.model.bodies.blocks3d.solids import box
from tests.lacore.models import CRITERION, square

MU, LIMIT = 0.3, 0.7


def on_obstacle(space="p2-vertex"):
    return la.Problem(
        {"block": square(3, space=space)},
        [la.Traction("block", "top", (1, 0))],
        interfaces=[la.Interface(("block", "bottom"), la.RigidObstacle(), MU)],
        dead_loads=[la.Pressure("block", "top", 1.0)],
    )


def on_each_other(low=5, high=3, make=la.meshes.rectangle, space="p2-vertex"):
    """Edges do not match: they meet on the common refinement of both."""
    bodies = {
        "low": la.Body(make((0, 1), (0, 1), low, 1), CRITERION, space=space),
        "top": la.Body(make((0, 1), (1, 2), high, 1), CRITERION, space=space),
    }
    return la.Problem(
        bodies,
        [la.Traction("top", "top", (1, 0))],
        [la.Fix("low", "bottom")],
        [la.Interface(("top", "bottom"), ("low", "top"), la.Tresca(LIMIT))],
        [la.Pressure("top", "top", 1.0)],
    )


def on_a_block():
    block = la.RigidBlock([(-1, -1), (2, -1), (2, 0), (-1, 0)])
    return la.Problem(
        {"block": square(3), "base": block},
        [la.Traction("block", "top", (1, 0))],
        [la.Fix("base", lambda x: x[1] == -1)],
        [la.Interface(("block", "bottom"), ("base", lambda x: x[1] == 0), MU)],
        [la.Pressure("block", "top", 1.0)],
    )


PLANE = {
    "obstacle": on_obstacle(),
    "discontinuous": on_obstacle("p1-disc"),
    "bodies": on_each_other(),
    "isoparametric": on_each_other(make=la.meshes.quadrilaterals, space="q2"),
    "block": on_a_block(),
}


def velocity(d, fields):
    """The velocity of all unknowns by fields of place, of bodies by name; of others zero."""
    u = np.zeros(d.full.n)
    for name, field in fields.items():
        dofs = d.continua[name]
        u[dofs.dofs] = field(dofs.nodes)
    return u


def slave(problem):
    return problem.interfaces[0].slave[0]


@pytest.mark.parametrize("problem", PLANE.values(), ids=PLANE)
def test_weights_are_shares_of_the_contact(problem):
    """Its length is 1, and their first moment that of its middle."""
    d = la.discretise(problem)
    weights, x = d.full.contact.weights, d.points.position[:, 0]
    assert weights.min() > 0
    assert weights.sum() == pytest.approx(1.0)
    assert weights @ x == pytest.approx(0.5)


@pytest.mark.parametrize("problem", PLANE.values(), ids=PLANE)
def test_a_rigid_motion_of_the_slave_opens_and_slips(problem):
    """By (0.2, 0.5): it opens by 0.5 everywhere and slips by 0.2, to the left of its normal."""
    d = la.discretise(problem)
    rows = d.full.contact
    u = velocity(d, {slave(problem): lambda x: np.array([[0.2], [0.5]]) + 0 * x})
    assert rows.opening(u) == pytest.approx(0.5)
    assert rows.slip(u)[:, 0] == pytest.approx(-0.2)
    # It turns about a point of the contact: what is right of it opens by the distance.
    u = velocity(d, {slave(problem): lambda x: np.stack([-x[1], x[0] - 0.25])})
    height = 1.0 if "top" in problem.bodies else 0.0
    assert rows.opening(u) == pytest.approx(d.points.position[:, 0] - 0.25)
    assert rows.slip(u)[:, 0] == pytest.approx(height)


def test_bodies_that_move_as_one_neither_open_nor_slip():
    d = la.discretise(PLANE["bodies"])
    turn = dict.fromkeys(("low", "top"), lambda x: np.stack([0.3 - x[1], 0.1 + x[0]]))
    u = velocity(d, turn)
    assert np.abs(d.full.contact.opening(u)).max() <= 1e-13
    assert np.abs(d.full.contact.slip(u)).max() <= 1e-13
    # The master moves the other way.
    u = velocity(d, {"low": lambda x: np.array([[0.2], [0.5]]) + 0 * x})
    assert d.full.contact.opening(u) == pytest.approx(-0.5)
    assert d.full.contact.slip(u)[:, 0] == pytest.approx(0.2)


@pytest.mark.parametrize("problem", PLANE.values(), ids=PLANE)
def test_a_uniform_pressure_does_the_power_of_the_mean_opening(problem):
    """Of a linear jump in any space, of a quadratic one in spaces that have it."""
    d = la.discretise(problem)
    rows = d.full.contact
    for degree in (1, 2):
        if degree > d.continua[slave(problem)].degree:
            continue

        def field(x, degree=degree):
            return np.stack([0 * x[0], x[0] ** degree])

        u = velocity(d, {slave(problem): field})
        assert rows.weights @ rows.opening(u) == pytest.approx(1 / (degree + 1))


def test_control_values_enclose_the_opening():
    """Of ``(x - a)^2`` on each edge some value is negative where the edge itself only touches."""
    d = la.discretise(on_obstacle())
    rows = d.full.contact
    u = velocity(d, {"block": lambda x: np.stack([0 * x[0], (x[0] - 0.5) ** 2])})
    # On the middle edge from 1/3 to 2/3: 2 u_mid - (u_start + u_end)/2 = -1/36.
    assert rows.opening(u).min() == pytest.approx(-1 / 36)
    assert np.sort(rows.opening(u))[1] == pytest.approx(1 / 36)


@pytest.mark.parametrize("turn", [0.0, 0.7, 2.0, np.pi])
def test_tangents_are_to_the_left_of_normals(turn):
    normal = np.array([[np.cos(turn), np.sin(turn)]])
    (along,) = tangents(normal)
    assert along[0] == pytest.approx([-np.sin(turn), np.cos(turn)])


def test_tangents_in_space_are_a_right_handed_frame():
    normal = np.random.default_rng(0).normal(size=(50, 3))
    normal[:3] = np.eye(3)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    first, second = tangents(normal)
    frames = np.stack([first, second, normal], axis=1)
    assert np.allclose(frames @ frames.transpose(0, 2, 1), np.eye(3), atol=1e-12)
    assert np.linalg.det(frames) == pytest.approx(1.0)


def test_laws_are_those_of_each_interface_and_joint():
    blocks = la.BlockAssembly(
        {"a": la.masonry.rectangle(0, 1, 0, 1), "b": la.masonry.rectangle(0, 1, 1, 2)},
        friction=la.Coulomb(0.5, adhesion=0.3, tension=0.2),
    )
    problem = la.Problem(
        {"stack": blocks, "soil": la.Body(la.meshes.rectangle((0, 1), (-1, 0), 2, 2), CRITERION)},
        [la.BodyForce("stack", (1, 0))],
        [la.Fix("soil", "bottom")],
        [
            la.Interface(("stack", lambda x: x[1] == 0), ("soil", "top"), la.Coulomb(MU, True)),
            la.Interface(("stack", lambda x: x[1] == 2), la.RigidObstacle(), la.Tresca(LIMIT)),
        ],
        [la.BodyForce("stack", (0, -1))],
    )
    rows = la.discretise(problem).full.contact
    for number, expected in enumerate(
        # coefficient, limit, dilatancy, tension
        [(0.0, 0.0, MU, 0.0), (0.0, LIMIT, 0.0, 0.0), (0.5, 0.3 - 0.5 * 0.2, 0.0, 0.2)]
    ):
        own = rows.interface == number
        assert own.any()
        for name, value in zip(
            ("coefficient", "limit", "dilatancy", "tension"), expected, strict=True
        ):
            assert getattr(rows, name)[own] == pytest.approx(value), (number, name)
        assert rows.weights[own].sum() == pytest.approx(1.0)


def test_joints_of_blocks_have_their_ends():
    """A stack of two: both ends of the joint open as one is lifted, and one of them as it turns."""
    blocks = la.BlockAssembly(
        {"a": la.masonry.rectangle(0, 2, 0, 1), "b": la.masonry.rectangle(0, 2, 1, 2)}, 0.5
    )
    problem = la.Problem(
        {"stack": blocks},
        [la.BodyForce("stack", (1, 0))],
        [la.Fix("stack", "a")],
        dead_loads=[la.BodyForce("stack", (0, -1))],
    )
    d = la.discretise(problem)
    rows, dofs = d.full.contact, d.assemblies["stack"]
    assert np.sort(d.points.position[:, 0]) == pytest.approx([0, 2])
    assert rows.weights == pytest.approx([1.0, 1.0])
    for motion, opening in (((0, 1, 0), (1, 1)), ((0, 0, 1), (-1, 1))):
        u = np.zeros(d.full.n)
        u[dofs.offset + 3 :][:3] = dofs.unknowns(np.array([(0, 0, 0), motion], float).T)[3:]
        order = np.argsort(d.points.position[:, 0])
        assert np.abs(rows.opening(u)[order]) == pytest.approx(np.abs(opening))
        if motion[2]:
            assert rows.opening(u)[order][0] == pytest.approx(-rows.opening(u)[order][1])


def solid_blocks():
    body = la.BlockAssembly3D({"a": box((0, 0, 0), (2, 1, 1)), "b": box((0, 0, 1), (2, 1, 2))}, 0.5)
    return la.Problem(
        {"b": body},
        [la.BodyForce("b", (1, 0, 0))],
        [la.Fix("b", "a")],
        dead_loads=[la.BodyForce("b", (0, 0, -1))],
    )


def solid_body():
    mesh = la.meshes.box((0, 2), (0, 1), (0, 1), 2, 1, 1)
    return la.Problem(
        {"b": la.Body(mesh, CRITERION, kinematics="3d")},
        [la.Traction("b", "top", (1, 0, 0))],
        interfaces=[la.Interface(("b", "bottom"), la.RigidObstacle((0, 0, 0), (0, 0, 1)), MU)],
        dead_loads=[la.Pressure("b", "top", 1.0)],
    )


@pytest.mark.parametrize("problem", [solid_blocks(), solid_body()], ids=["blocks", "body"])
def test_contact_in_space_has_the_area_and_the_moments_of_its_face(problem):
    """A face of 2 x 1: area 2, centroid (1, 1/2)."""
    d = la.discretise(problem)
    rows, place = d.full.contact, d.points.position
    assert rows.weights.sum() == pytest.approx(2.0)
    assert rows.weights @ place[:, :2] / 2 == pytest.approx([1.0, 0.5])
    assert rows.tangent_dim == 2


@pytest.mark.parametrize("space", ["p2-gauss", "q2"])
def test_axisymmetric_contact_has_the_area_and_the_moment_of_a_ring(space):
    """Radii 1 and 2: area 3 pi, and the integral of r over it 14 pi/3."""
    mesh = la.meshes.rectangle((1, 2), (0, 1), 3, 1)
    if space == "q2":
        mesh = la.meshes.quadrilaterals((1, 2), (0, 1), 3, 1)
    body = la.Body(mesh, CRITERION, space=space, kinematics="axisymmetric")
    problem = la.Problem(
        {"b": body},
        [la.Pressure("b", "left")],
        interfaces=[la.Interface(("b", "bottom"), la.RigidObstacle(), MU)],
        dead_loads=[la.Pressure("b", "top", 1.0)],
    )
    d = la.discretise(problem)
    rows = d.full.contact
    assert rows.weights.sum() == pytest.approx(3 * np.pi)
    assert rows.weights @ d.points.position[:, 0] == pytest.approx(14 * np.pi / 3)
    u = velocity(d, {"b": lambda x: np.stack([0 * x[0], x[0]])})
    assert rows.weights @ rows.opening(u) == pytest.approx(14 * np.pi / 3)


def two_assemblies(shift):
    """A box of 2 x 1 x 1 on another, moved along it; the overlap is 2 - shift long."""
    bodies = {
        "low": la.BlockAssembly3D({"a": box((0, 0, 0), (2, 1, 1))}, 0.5),
        "top": la.BlockAssembly3D({"b": box((shift, 0, 1), (2 + shift, 1, 2))}, 0.5),
    }
    return la.Problem(
        bodies,
        [la.BodyForce("top", (1, 0, 0))],
        [la.Fix("low", "a")],
        [
            la.Interface(
                ("top", lambda x: np.abs(x[2] - 1) < 1e-9),
                ("low", lambda x: np.abs(x[2] - 1) < 1e-9),
                MU,
            )
        ],
        [la.BodyForce("top", (0, 0, -1))],
    )


@pytest.mark.parametrize("shift", [0.0, 0.5, -1.2])
def test_boxes_touch_where_they_overlap(shift):
    problem = two_assemblies(shift)
    d, dofs = la.discretise(problem), Unknowns.of(problem).blocks["top"]
    rows = d.full.contact
    length = 2 - abs(shift)
    middle = 1 + shift / 2
    assert rows.weights.sum() == pytest.approx(length)
    assert rows.weights @ d.points.position / length == pytest.approx([middle, 0.5, 1.0])
    assert np.allclose(d.points.normal, [0, 0, 1])
    lifted = np.zeros(d.full.n)
    motion = np.zeros((6, 1))
    motion[:3, 0] = 0.2, 0.3, 0.5
    lifted[dofs.offset : dofs.offset + dofs.count] = dofs.unknowns(motion)
    assert rows.opening(lifted) == pytest.approx(0.5)
    assert np.linalg.norm(rows.slip(lifted), axis=1) == pytest.approx(np.hypot(0.2, 0.3))


def test_a_box_on_a_floor_in_space():
    body = la.BlockAssembly3D({"a": box((0, 0, 0), (2, 1, 1))}, 0.5)
    floor = la.RigidObstacle((0, 0, 0), (0, 0, 1))

    def stands(where, obstacle=floor):
        return la.Problem(
            {"b": body},
            [la.BodyForce("b", (1, 0, 0))],
            interfaces=[la.Interface(("b", where), obstacle, MU)],
            dead_loads=[la.BodyForce("b", (0, 0, -1))],
        )

    d = la.discretise(stands(lambda x: np.abs(x[2]) < 1e-9))
    assert d.full.contact.weights.sum() == pytest.approx(2.0)
    assert d.full.contact.coefficient == pytest.approx(MU)
    assert (d.points.moving == [[0, -1]]).all()
    with pytest.raises(la.InputError):  # the face is 1 above it
        stands(lambda x: np.abs(x[2] - 1) < 1e-9)
    with pytest.raises(la.InputError):  # the block is on its other side
        stands(lambda x: np.abs(x[2]) < 1e-9, la.RigidObstacle((0, 0, 0), (0, 0, -1)))


@pytest.mark.parametrize("edges", [2, 3])
def test_contact_along_an_arc_has_its_length_its_moment_and_its_normals(edges):
    """A sector of 1 rad around a circle of radius 1, by quadratic edges."""
    flat = la.meshes.quadrilaterals((1, 2), (0, 1), 2, edges)
    mesh = la.meshes.isoparametric(flat, lambda x: x[0] * np.stack([np.cos(x[1]), np.sin(x[1])]))
    problem = la.Problem(
        {"ring": la.Body(mesh, CRITERION, space="q2")},
        [la.Pressure("ring", "right")],
        interfaces=[la.Interface(("ring", "left"), la.RigidObstacle(), MU)],
    )
    d = la.discretise(problem)
    rows, place = d.full.contact, d.points.position
    error = (1 / edges) ** 4 / 50  # of quadratic edges
    assert rows.weights.sum() == pytest.approx(1.0, abs=error)
    moment = np.array([np.sin(1), 1 - np.cos(1)])
    radial = place / np.linalg.norm(place, axis=1, keepdims=True)
    assert d.points.normal == pytest.approx(radial, abs=20 * error)
    # The opening by a uniform velocity is its part along the normal.
    for axis in (0, 1):
        u = velocity(d, {"ring": lambda x, axis=axis: np.eye(2)[axis][:, None] + 0 * x})
        assert rows.weights @ rows.opening(u) == pytest.approx(moment[axis], abs=20 * error)


def test_crushing_lets_blocks_approach_each_other():
    """At each point its own speed of crushing adds to the opening of the joint."""
    blocks = {"low": box((0, 0, 0), (2, 2, 1)), "top": box((0, 0, 1), (2, 2, 2))}
    assembly = la.BlockAssembly3D(blocks, 0.5, crushing=la.Crushing(1.0, 2))
    problem = la.Problem(
        {"b": assembly},
        [la.PointForce("b", "top", (0, 0, -1))],
        [la.Fix("b", "low")],
    )
    d = la.discretise(problem)
    rows, dofs = d.full.contact, d.blocks["b"]
    crushing, u = np.asarray(dofs.crushing), np.zeros(d.full.n)
    assert crushing.size == rows.count
    u[crushing] = np.arange(1.0, crushing.size + 1)
    assert np.sort(rows.opening(u)) == pytest.approx(u[crushing])
    assert np.abs(rows.slip(u)).max() <= 1e-12


def test_a_node_of_a_frame_on_a_body_is_one_point_whose_tractions_are_forces():
    frame = la.Frame({"A": (0.5, 1), "B": (0.5, 3)}, {"column": ("A", "B")}, plastic_moment=1.0)
    for slave, master in ((("frame", "A"), ("b", "top")), (("b", "top"), ("frame", "A"))):
        problem = la.Problem(
            {"b": square(2), "frame": frame},
            [la.PointForce("frame", "B", (1.0, 0.0))],
            [la.Fix("b", "bottom")],
            [la.Interface(slave, master, MU)],
            [la.PointForce("frame", "B", (0.0, -1.0))],
        )
        d = la.discretise(problem)
        assert d.full.contact.weights.tolist() == [1.0]
        assert d.points.position.tolist() == [[0.5, 1.0]]
        upward = 1.0 if slave[0] == "frame" else -1.0
        assert d.points.normal[0] == pytest.approx([0.0, upward])


def test_contact_along_a_straight_edge_and_a_curved_one_has_the_length_of_both():
    """Half of the side is straight, and the other half a parabola."""
    flat = la.meshes.quadrilaterals((1, 2), (0, 1), 1, 2)
    mesh = la.meshes.isoparametric(
        flat, lambda x: np.stack([x[0] + np.maximum(x[1] - 0.5, 0) ** 2, x[1]])
    )
    problem = la.Problem(
        {"b": la.Body(mesh, CRITERION, space="q2")},
        [la.Pressure("b", "right")],
        interfaces=[la.Interface(("b", "left"), la.RigidObstacle(), MU)],
    )
    weights = la.discretise(problem).full.contact.weights
    curved = np.sqrt(2) / 4 + np.arcsinh(1) / 4
    assert weights.sum() == pytest.approx(0.5 + curved, abs=1e-4)


def test_contact_along_parts_of_straight_edges_of_a_barrel_is_where_they_touch():
    """Its sides are curved, and its two edges on top share the three edges of a body on it."""
    stated = on_each_other(2, 3, la.meshes.quadrilaterals, "q2")
    flat = stated.bodies["low"].mesh
    barrel = la.meshes.isoparametric(
        flat, lambda x: np.stack([x[0] * (1 + 0.4 * x[1] * (1 - x[1])), x[1]])
    )
    bodies = {**stated.bodies, "low": la.Body(barrel, CRITERION, space="q2")}
    place = la.discretise(replace(stated, bodies=bodies)).points.position
    ends = np.array([0, 1 / 3, 1 / 2, 2 / 3, 1])
    wanted = np.sort(np.concatenate([ends, (ends[1:] + ends[:-1]) / 2]))
    assert np.sort(place[:, 0]) == pytest.approx(wanted)
    assert place[:, 1] == pytest.approx(1.0)


def test_weights_of_control_values_on_a_cone_are_integrals_of_their_functions():
    """Along a radius from 1 to 2 the area is that of a ring: (1 - s)^2, 2 s (1 - s) and s^2."""
    problem = la.Problem(
        {
            "b": la.Body(
                la.meshes.rectangle((1, 2), (0, 1), 1, 1), CRITERION, "axisymmetric", "p2-gauss"
            )
        },
        [la.Pressure("b", "top")],
        [la.Fix("b", "right", "x")],
        [la.Interface(("b", "bottom"), la.RigidObstacle(), MU)],
    )
    d = la.discretise(problem)
    found = d.full.contact.weights[np.argsort(d.points.position[:, 0])]
    # Times the radius 1 + s.
    assert found / found.sum() == pytest.approx(np.array([5 / 12, 1 / 2, 7 / 12]) / 1.5)
