"""Where the sides of interfaces touch, and sides that do not touch as contact can."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import lacore as la
from lacore.model.contact import faces, patches, segments
from lacore.model.contact.interfaces import Interface
from lacore.model.contact.obstacles import Obstacle
from lacore.model.contact.profiles import InnerCorner
from lacore.model.contact.shapes import outline, wedge
from lacore.model.contact.touching import where_touching
from tests.lacore.model.bodies.blocks3d.solids import box
from tests.lacore.models import CRITERION

R = la.masonry.rectangle
SQUARE = la.Body(la.meshes.rectangle((0, 1), (0, 1), 2, 2), CRITERION)


def block(*sides, **given):
    return la.BlockAssembly({"block": R(*sides)}, 0.5, **given)


def frame(*ends):
    nodes = dict(zip("ABC", ends, strict=False))
    members = {"one": ("A", "B")} | ({"two": ("B", "C")} if len(ends) > 2 else {})
    return la.Frame(nodes=nodes, members=members, plastic_moment=1.0)


def on(side, value):
    return lambda x: np.abs(x[side] - value) < 1e-9


def touching(slave, master, bodies, friction=0.3):
    return where_touching(Interface(slave, master, friction), bodies, "Interface")


def test_blocks_touch_where_their_edges_overlap():
    bodies = {"low": block(0, 2, 0, 1), "top": block(1, 3, 1, 2)}
    found = touching(("top", on(1, 1)), ("low", on(1, 1)), bodies)
    assert isinstance(found, segments.Segments)
    ends = np.sort(np.concatenate([found.start[0], found.end[0]]))
    assert ends == pytest.approx([1, 2])
    assert found.normal[:, 0] == pytest.approx([0, 1])
    turned = touching(("low", on(1, 1)), ("top", on(1, 1)), bodies)
    assert turned.normal[:, 0] == pytest.approx([0, -1])


@pytest.mark.parametrize(
    ("left", "height", "why"),
    [
        (1.0, 1 + 1e-4, "its two sides are 0.0001 m apart"),
        (1.0, 1.5, "does not touch low"),
        (4.0, 1.0, "does not touch low"),
    ],
)
def test_sides_apart_are_rejected(left, height, why):
    bodies = {"low": block(0, 2, 0, 1), "top": block(left, left + 2, height, 2)}
    with pytest.raises(la.InputError, match=why):
        touching(("top", on(1, height)), ("low", on(1, 1)), bodies)


def test_a_corner_alone_on_an_edge_is_rejected():
    """A square on its flat base, and one on its tip next to it, in one interface."""
    blocks = {"flat": R(0, 1, 1, 2), "tip": [(3, 1), (4, 2), (2, 2)]}
    bodies = {"low": block(-1, 5, 0, 1), "top": la.BlockAssembly(blocks, 0.5)}
    with pytest.raises(la.InputError, match=r"touch with a corner only at \[3.* 1.*\]"):
        touching(("top", lambda x: x[1] < 3), ("low", on(1, 1)), bodies)


def test_nodes_of_frames_touch_faces_on_either_side():
    """A node has the outward normal of the face that it stands on, whichever side is the slave."""
    bodies = {"frame": frame((0.5, 1.0), (0.5, 3.0)), "low": block(0, 2, 0, 1)}
    found = touching(("frame", "A"), ("low", on(1, 1)), bodies)
    assert found.normal[:, 0] == pytest.approx([0, 1])
    assert found.start[:, 0] == pytest.approx([0.5, 1])
    turned = touching(("low", on(1, 1)), ("frame", "A"), bodies)
    assert turned.normal[:, 0] == pytest.approx([0, -1])
    assert (turned.slave[0], turned.master[0]) == (found.master[0], found.slave[0])


def test_nodes_stand_on_the_face_that_carries_them():
    """Two faces of a step: each node finds its own, also beyond the middle of the other."""
    corners = [(0, 0), (4, 0), (4, 1), (2, 1), (2, 2), (0, 2)]
    bodies = {
        "frame": frame((1.0, 2.0), (3.0, 4.0), (3.0, 1.0)),
        "low": la.BlockAssembly({"step": corners}, 0.5),
    }
    level = lambda x: (x[1] > 0.5) & (np.abs(x[0] - 4) > 1e-3) & (np.abs(x[0]) > 1e-3)  # noqa: E731
    found = touching(("frame", ("A", "C")), ("low", level), bodies)
    assert found.normal == pytest.approx(np.array([[0, 0], [1, 1]]))
    assert found.master[0] != found.master[1]


@pytest.mark.parametrize(
    ("place", "why"),
    [
        ((0.5, 1.001), r"its node at \(0\.5, 1\.001\) m is 0\.001 m from the other side"),
        ((2.5, 1.0), r"its node at .* is 0\.5 m from the other side"),
        ((-0.25, 1.0), r"is 0\.25 m from the other side"),
        ((2.0, 1.0), "stands on a corner, which has no normal"),
    ],
)
def test_nodes_that_no_single_face_carries_are_rejected(place, why):
    bodies = {"frame": frame(place, (0.5, 3.0)), "low": block(0, 2, 0, 1)}
    everywhere = lambda x: x[1] > -1.0  # noqa: E731
    with pytest.raises(la.InputError, match=why):
        touching(("frame", "A"), ("low", everywhere), bodies)


def test_a_node_where_two_faces_meet_on_one_line_has_their_normal():
    bodies = {
        "frame": frame((1.0, 1.0), (1.0, 3.0)),
        "low": la.BlockAssembly({"one": R(0, 1, 0, 1), "two": R(1, 2, 0, 1)}, 0.5),
    }
    found = touching(("frame", "A"), ("low", on(1, 1)), bodies)
    assert found.normal[:, 0] == pytest.approx([0, 1])


def test_nodes_of_two_frames_are_rejected():
    bodies = {"one": frame((0, 0), (0, 1)), "two": frame((0, 0), (1, 0))}
    with pytest.raises(la.InputError, match="nodes of two frames"):
        touching(("one", "A"), ("two", "A"), bodies)


def test_nodes_have_the_normal_of_their_obstacle_and_none_without_a_face():
    bodies = {"frame": frame((0, 0), (0, 1))}
    plane = la.RigidObstacle((0, 0), (0, 2))
    assert touching(("frame", "A"), plane, bodies).normal[:, 0] == pytest.approx([0, 1])
    with pytest.raises(la.InputError, match="no shape that an obstacle could follow"):
        touching(("frame", "A"), la.RigidObstacle(), bodies)


@pytest.mark.parametrize(
    ("height", "normal", "why"),
    [
        (-0.01, (0, 1), r"a node lies 0\.01 m above it"),
        (0.01, (0, 1), r"a node lies 0\.01 m inside it"),
        (0.0, (0, -1), "the obstacle's normal points out of the body"),
    ],
)
@pytest.mark.parametrize(("body", "where"), [(block(0, 1, 0, 1), on(1, 0)), (SQUARE, "bottom")])
def test_a_plane_that_a_side_is_not_on_is_rejected(body, where, height, normal, why):
    plane = la.RigidObstacle((0, height), normal)
    with pytest.raises(la.InputError, match=why):
        touching(("b", where), plane, {"b": body})


def test_sides_touch_a_plane_from_the_direction_of_its_normal():
    for body, where in ((block(0, 1, 0, 1), on(1, 0)), (SQUARE, "bottom")):
        found = touching(("b", where), la.RigidObstacle((0, 0), (0, 3)), {"b": body})
        assert found.normal == pytest.approx(np.tile([[0.0], [1.0]], found.slave.size))
        assert np.all(found.master == -1)


@pytest.mark.parametrize("tilt", [0.0, 0.3])
def test_faces_of_tetrahedra_touch_planes(tilt):
    cube = la.meshes.box((0, 1), (0, 1), (0, 1), 1, 1, 1)
    body = la.Body(cube, la.VonMises(1.0), "3d")
    found = touching(("b", "bottom"), la.RigidObstacle((0, 0, 0), (0, 0, 2)), {"b": body})
    assert isinstance(found, faces.Faces)
    assert found.normal == pytest.approx(np.tile([[0.0], [0.0], [1.0]], found.slave.size))
    assert found.edges[1].tolist() == [-1] * found.slave.size
    for point, normal, why in (
        ((0, 0, 0.1), (0, 0, 1), r"is -0\.1 m off the plane"),
        ((0, 0, -0.1), (0, 0, 1), r"is 0\.1 m off the plane"),
        ((0, 0, 0), (tilt, 0, -1), "behind the plane" if tilt == 0 else "off the plane"),
    ):
        with pytest.raises(la.InputError, match=why):
            touching(("b", "bottom"), la.RigidObstacle(point, normal), {"b": body})
    other = {"b": body, "c": la.Body(cube, la.VonMises(1.0), "3d")}
    with pytest.raises(la.InputError, match="bodies of tetrahedra touch rigid obstacles"):
        touching(("b", "bottom"), ("c", "top"), other)


def test_blocks_in_space_touch_planes_and_each_other():
    low = la.BlockAssembly3D({"low": box((0, 0, 0), (2, 2, 1))}, 0.5)
    top = la.BlockAssembly3D({"top": box((1, 1, 1), (3, 2, 2))}, 0.5)
    bodies = {"low": low, "top": top}
    found = touching(("top", on(2, 1)), ("low", on(2, 1)), bodies)
    assert isinstance(found, patches.Patches)
    assert found.normal[:, 0] == pytest.approx([0, 0, 1])
    assert found.weight.sum() == pytest.approx(1.0)
    assert found.point.min(axis=1) == pytest.approx([1, 1, 1])
    assert found.point.max(axis=1) == pytest.approx([2, 2, 1])
    whole = touching(("low", on(2, 0)), la.RigidObstacle((5, 5, 0), (0, 0, 1)), bodies)
    assert whole.normal[:, 0] == pytest.approx([0, 0, 1])
    assert whole.weight == pytest.approx(1.0)
    for height, direction, why in (
        (0.1, 1, r"lies 0\.1 m inside"),
        (-0.1, 1, r"lies 0\.1 m above"),
        (0.0, -1, "points out of the body"),
    ):
        plane = la.RigidObstacle((0, 0, height), (0, 0, direction))
        with pytest.raises(la.InputError, match=why):
            touching(("low", on(2, 0)), plane, bodies)
    apart = {"low": low, "top": la.BlockAssembly3D({"top": box((1, 1, 3), (3, 2, 4))}, 0.5)}
    with pytest.raises(la.InputError, match=r"does not touch low"):
        touching(("top", on(2, 3)), ("low", on(2, 1)), apart)
    sideways = {"low": low, "top": la.BlockAssembly3D({"top": box((1, 1, 1), (3, 2, 2))}, 0.5)}
    with pytest.raises(la.InputError, match=r"does not touch low"):
        touching(("top", on(2, 2)), ("low", on(2, 1)), sideways)


def test_inner_corners_of_a_container():
    """An L: its only hollow corner, with both normals out of the solid and the shorter edge."""
    corners = [(0, 0), (4, 0), (4, 1), (1, 1), (1, 3), (0, 3)]
    (found,) = outline(corners).inner
    assert isinstance(found, InnerCorner)
    assert found.place == pytest.approx([1, 1])
    assert np.sort(found.normals, axis=0) == pytest.approx(np.array([[0, 0], [1, 1]]))
    assert found.reach == pytest.approx(2.0)
    assert found.bisector == pytest.approx([np.sqrt(0.5)] * 2)
    assert outline(corners, rounding=[0, 0, 0, 0.2, 0, 0]).inner == []
    # Roundings at the far ends of the edges shorten them.
    (short,) = outline(corners, rounding=[0, 0, 0, 0, 0.3, 0]).inner
    assert short.reach == pytest.approx(1.7)
    shorter = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 3), (0, 3)]
    (short,) = outline(shorter, rounding=[0, 0, 0.3, 0, 0, 0]).inner
    assert short.reach == pytest.approx(0.7)


def test_roundings_that_fit_exactly_are_accepted():
    outline([(0, 0), (1, 0), (1, 2), (0, 2)], rounding=[0.5, 0.5, 0, 0])
    with pytest.raises(la.InputError, match=r"take 0\.002 m more than the edge from"):
        outline([(0, 0), (1, 0), (1, 2), (0, 2)], rounding=[0.501, 0.501, 0, 0])


@pytest.mark.parametrize("swapped", [False, True])
def test_the_larger_of_two_bodies_sets_the_round_off_of_places(swapped):
    """A small block on a large one, apart by less than the round-off of the latter."""
    large = block(-500, 500, -1000, 0)
    gap = large.allowed / 2
    small = block(0, 1, gap, 1 + gap)
    assert small.allowed < gap
    bodies = {"large": large, "small": small}
    sides = (("small", "block"), ("large", "block"))
    found = touching(*(sides[::-1] if swapped else sides), bodies)
    length = np.linalg.norm(found.end - found.start, axis=0).sum()
    assert length == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("rounding", "named"),
    [([0.1, 0.8, 0.9, 0.2], (0.8, 0.9)), ([0.9, 0.1, 0.2, 0.8], (0.8, 0.9))],
)
def test_roundings_that_do_not_fit_are_those_at_both_ends_of_an_edge(rounding, named):
    with pytest.raises(la.InputError) as refused:
        outline([(0, 0), (3, 0), (3, 1), (0, 1)], rounding)
    assert refused.value.value == named


@pytest.mark.parametrize("angle", [0, 90, -10, np.nan, "30"])
def test_wedges_have_an_angle_between_0_and_90_degrees(angle):
    with pytest.raises(la.InputError, match="half_angle"):
        wedge((0, 0), angle)


@pytest.mark.parametrize("given", [(0, 0), (1, 0, 0), "up", (np.nan, 1)])
def test_directions_are_two_numbers_that_are_not_both_zero(given):
    with pytest.raises(la.InputError, match="not a direction"):
        wedge((0, 0), 30, axis=given)


@pytest.mark.parametrize("rounding", [-0.1, [0.1], [0.1, 0.1, 0.1, -0.1], "0.1", None])
def test_roundings_are_radii(rounding):
    with pytest.raises(la.InputError, match=r"shapes\.outline\.rounding"):
        outline([(0, 0), (1, 0), (1, 1), (0, 1)], rounding=rounding)


def test_an_interface_has_one_side_of_an_obstacle_and_two_of_bodies():
    plane = la.RigidObstacle((0, 0), (0, 1))
    floor = Interface(("a", "bottom"), plane, 0.3)
    assert floor.sides == (("a", "bottom"),)
    assert floor.obstacle is plane
    assert floor.face.direction == (0.0, 1.0)
    assert floor.law == la.Coulomb(0.3)
    assert (floor.name, floor.self_contact, floor.bonded) == ("a.bottom", False, False)
    joint = Interface(("a", "bottom"), ("b", "top"), la.BOND)
    assert joint.sides == (("a", "bottom"), ("b", "top"))
    assert (joint.obstacle, joint.face) == (None, None)
    assert (joint.name, joint.self_contact, joint.bonded) == ("a.bottom|b.top", False, True)
    assert Interface(("a", "bottom"), ("a", "top"), 0.3).self_contact
    assert Interface(("a", "bottom"), la.RigidObstacle(), 0.3).face is None


@pytest.mark.parametrize("wrong", ["bottom", ("a",), ("a", "b", "c"), (1, "bottom"), None])
def test_sides_of_interfaces_are_boundaries(wrong):
    with pytest.raises(la.InputError, match=r"Interface\.slave"):
        Interface(wrong, la.RigidObstacle(), 0.3)
    with pytest.raises(la.InputError, match=r"Interface\.master"):
        Interface(("a", "bottom"), wrong, 0.3)


@pytest.mark.parametrize(
    ("point", "normal"),
    [
        ((0, 0), None),
        (None, (0, 1)),
        ((0, 0), (0, 0)),
        ((0, 0), (0, 0, 1)),
        ((0, 0), (0, np.nan)),
        ("ab", (0, 1)),
        ((0, np.inf), (0, 1)),
    ],
)
def test_planes_of_obstacles_have_a_point_and_a_normal(point, normal):
    with pytest.raises(la.InputError, match="RigidObstacle"):
        la.RigidObstacle(point, normal)


def test_points_count_as_touching_by_shares_of_the_size_of_the_body():
    shape = la.RigidObstacle((0, 0), (0, 1)).face
    own = Obstacle("i", "b", "bottom", np.zeros(0, dtype=int), shape, la.SMOOTH.terms(), 2.0)
    assert own.near == 2e-6
    assert 0 < own.touch <= own.near
    large = replace(own, size=2e3)
    assert (large.near, large.touch) == pytest.approx((1e3 * own.near, 1e3 * own.touch))


def test_a_plane_is_drawn_as_long_as_a_box_is_wide_to_either_side():
    plane = la.RigidObstacle((5, 1), (0, 2)).face
    found = plane.outline(np.array([1.0, -2.0]), np.array([4.0, 2.0]))
    assert np.sort(found, axis=1) == pytest.approx(np.array([[2.5 - 5, 2.5 + 5], [1, 1]]))


@pytest.mark.parametrize("radius", [0.0, 0.5])
def test_shapes_are_drawn_on_their_faces(radius):
    """Points of a drawing have no distance from the shape, and it is closed."""
    low, high = np.array([-1.0, -1.0]), np.array([3.0, 3.0])
    corners = [(0, 0), (4, 0), (4, 1), (2, 1), (2, 3), (0, 3)]
    for shape in (outline(corners, rounding=radius), la.shapes.disc((1, 2), 0.5 + radius)):
        drawn = shape.outline(low, high)
        assert np.abs(shape.distance(drawn)).max() <= 1e-12
        assert drawn[:, 0] == pytest.approx(drawn[:, -1])
    open_ended = wedge((1, 1), 30.0, axis=(0, 2))
    drawn = open_ended.outline(low, high)
    assert np.abs(open_ended.distance(drawn)).max() <= 1e-12
    assert drawn[:, 1] == pytest.approx([1, 1])
    assert drawn[1, [0, 2]].min() > 3.0
    assert drawn[0, 0] < -1.0 < 3.0 < drawn[0, 2]


@pytest.mark.parametrize("tip", [(1, 1), (-50, 1), (1, -80), (404, 404)])
@pytest.mark.parametrize("shift", [0.0, 100.0])
def test_faces_of_a_wedge_are_drawn_beyond_a_box(tip, shift):
    """As far from the tip as any corner of the box, at least."""
    ends = shift - 1.0, shift + 3.0
    drawn = wedge(tip, 30.0).outline(*(np.full(2, end) for end in ends))
    farthest = max(np.hypot(x - tip[0], y - tip[1]) for x in ends for y in ends)
    lengths = np.linalg.norm(drawn[:, [0, 2]] - drawn[:, [1]], axis=0)
    assert lengths.min() >= farthest


def test_joints_within_an_assembly_are_not_those_of_its_interface():
    """Boxes next to each other on others: only what touches across counts, on either side."""

    def row(height, *names):
        return la.BlockAssembly3D(
            {name: box((i, 0, height), (i + 1, 1, height + 1)) for i, name in enumerate(names)},
            0.5,
        )

    for below, above in (("a", "bc"), ("ab", "c"), ("ab", "cd")):
        bodies = {"low": row(0, *below), "top": row(1, *above)}
        found = touching(("top", on(2, 1)), ("low", on(2, 1)), bodies)
        shared = min(len(below), len(above))
        assert found.slave.size == shared
        assert found.weight.sum() == pytest.approx(shared)
        turned = touching(("low", on(2, 1)), ("top", on(2, 1)), bodies)
        assert turned.weight.sum() == pytest.approx(shared)
        assert turned.normal == pytest.approx(-found.normal)


def test_all_blocks_at_a_plane_are_on_the_side_of_its_normal():
    """Two blocks side by side, the second below the plane: its face would be pulled."""
    low, high = ((0, 0, 0), (1, 1, 1)), ((2, 0, -1), (3, 1, 0))
    above = {"one": box(*low), "two": box((2, 0, 0), (3, 1, 1))}
    plane = la.RigidObstacle((0, 0, 0), (0, 0, 1))
    found = touching(("b", on(2, 0)), plane, {"b": la.BlockAssembly3D(above, 0.5)})
    assert found.normal == pytest.approx(np.tile([[0.0], [0.0], [1.0]], 2))
    both_sides = la.BlockAssembly3D({"one": box(*low), "two": box(*high)}, 0.5)
    with pytest.raises(la.InputError, match="points out of the body"):
        touching(("b", on(2, 0)), plane, {"b": both_sides})


def test_whole_faces_of_blocks_touch_where_they_are():
    """A box away from the origin: its contact points are the corners of its base."""
    bodies = {"b": la.BlockAssembly3D({"b": box((3, 4, 0.7), (6.5, 7, 2))}, 0.5)}
    plane = la.RigidObstacle((0, 0, 0.7), (0, 0, 1))
    for obstacle in (plane, la.RigidObstacle()):
        found = touching(("b", on(2, 0.7)), obstacle, bodies)
        assert sorted(map(tuple, found.point.T.round(9))) == [
            (3.0, 4.0, 0.7),
            (3.0, 7.0, 0.7),
            (6.5, 4.0, 0.7),
            (6.5, 7.0, 0.7),
        ]
        assert found.weight == pytest.approx(3.5 * 3 / 4)
        assert found.normal[:, 0] == pytest.approx([0, 0, 1])


@pytest.mark.parametrize(("slope", "side"), [(-0.1, "above"), (0.1, "inside")])
def test_a_plane_that_a_face_only_meets_along_an_edge_is_rejected(slope, side):
    """It passes through the edge at x = 0, and the corners at x = 2 are off it."""
    bodies = {"b": la.BlockAssembly3D({"b": box((0, 0, 0), (2, 1, 1))}, 0.5)}
    plane = la.RigidObstacle((0, 0, 0), (-slope, 0, 1))
    with pytest.raises(la.InputError, match=rf"at \(2, .*\) m lies 0\.199 m {side} it"):
        touching(("b", on(2, 0)), plane, bodies)
    square = {"b": block(0, 2, 0, 1)}
    with pytest.raises(la.InputError, match=rf"a node lies 0\.199 m {side} it"):
        touching(("b", on(1, 0)), la.RigidObstacle((0, 0), (-slope, 1)), square)


@pytest.mark.parametrize("points", [5, None, "abc", {1: 2}, [(0, 0), (1, 1)], []])
def test_fewer_than_three_corners_are_no_outline(points):
    with pytest.raises(la.InputError, match=r"shapes\.outline\.points"):
        outline(points)


@pytest.mark.parametrize("given", [{"point": (0, 0)}, {"normal": (0, 1)}])
def test_an_obstacle_with_a_shape_has_no_part_of_a_plane(given):
    with pytest.raises(la.InputError, match="a plane and another shape"):
        la.RigidObstacle(**given, shape=la.shapes.disc((0, 0), 1))


@pytest.mark.parametrize("turn", [0.3, 1.1, 2.5])
def test_faces_of_tetrahedra_touch_planes_that_are_turned_with_them(turn):
    """Normals differ by round-off alone."""
    cube = la.meshes.box((0, 1), (0, 1), (0, 1), 2, 2, 2)
    rotation = Rotation.from_rotvec(turn * np.array([0.6, 0.8, 0.3])).as_matrix()
    body = la.Body(
        replace(cube, doflocs=rotation @ cube.p + np.array([[0.1], [0.2], [0.3]])),
        la.VonMises(1.0),
        "3d",
    )
    up = rotation[:, 2]
    found = touching(("b", "bottom"), la.RigidObstacle((0.1, 0.2, 0.3), tuple(up)), {"b": body})
    assert found.normal == pytest.approx(np.tile(up[:, None], found.slave.size))


@pytest.mark.parametrize("clockwise", [False, True])
@pytest.mark.parametrize("corner", range(4))
def test_a_corner_on_a_straight_edge_changes_nothing_when_it_is_rounded(corner, clockwise):
    corners = [(0.0, 0.0), (4.0, 0.0), (4.0, 2.0), (0.0, 2.0)]
    middle = tuple(np.add(corners[corner], corners[(corner + 1) % 4]) / 2)
    more = [*corners[: corner + 1], middle, *corners[corner + 1 :]]
    one, other = (outline(own[:: -1 if clockwise else 1], 0.25) for own in (corners, more))
    places = np.random.default_rng(corner).uniform(-3, 7, (2, 500))
    assert other.distance(places) == pytest.approx(one.distance(places))
    assert other.normal(places) == pytest.approx(one.normal(places))
    drawn = other.outline(np.zeros(2), np.ones(2))
    assert other.distance(drawn) == pytest.approx(np.zeros(drawn.shape[1]), abs=1e-12)


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e4])
@pytest.mark.parametrize("corners", range(3, 12))
def test_a_regular_polygon_may_be_rounded_to_a_disc(corners, size):
    """By the radius of its inscribed circle the edges are used up, but for round-off."""
    angle = 2 * np.pi * (np.arange(corners) + 0.1) / corners
    points = size * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    inner = size * np.cos(np.pi / corners)
    found = outline(points.tolist(), rounding=inner)
    assert found.distance(np.zeros((2, 1)))[0] == pytest.approx(-inner)
    with pytest.raises(la.InputError, match="more than the edge"):
        outline(points.tolist(), rounding=inner * (1 + 1e-9))


def test_a_body_around_a_disc_touches_it_from_outside():
    """Normals of the obstacle are those at the edges, wherever its centre is."""
    flat = la.meshes.quadrilaterals((1, 2), (0, 1), 1, 3)
    centre = np.array([[5.0], [3.0]])
    mesh = la.meshes.isoparametric(
        flat, lambda x: centre + x[0] * np.stack([np.cos(x[1]), np.sin(x[1])])
    )
    body = la.Body(mesh, CRITERION, space="q2")
    disc = la.RigidObstacle(shape=la.shapes.disc((5, 3), 1))
    found = touching(("b", "left"), disc, {"b": body})
    middle = (found.start + found.end) / 2 - centre
    assert found.normal == pytest.approx(middle / np.linalg.norm(middle, axis=0), abs=1e-6)


@pytest.mark.parametrize("points", [[(0, 0), (2, 0), (0, 2), (3, 1)], [(0, 0), (1, 0), (2, 0)]])
def test_outlines_that_cross_themselves_or_enclose_nothing_are_rejected(points):
    with pytest.raises(la.InputError, match="not a polygon"):
        outline(points)


def test_a_wedge_points_upwards_unless_it_has_another_axis():
    assert la.shapes.Wedge(tip=(0.0, 0.0), half_angle=30.0) == wedge((0, 0), 30)
    assert wedge((0, 0), 30).axis == (0.0, 1.0)
