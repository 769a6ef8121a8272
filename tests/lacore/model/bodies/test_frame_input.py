"""Frames as stated: pieces, hinges, and what is refused by name."""

import copy
import pickle
from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from tests.frame_problems import DOWN, FLOOR, RIGHT, portal, pushed

NODES = {"A": (0, 0), "B": (0, 2), "C": (4, 2), "D": (4, 0)}
MEMBERS = {"left": ("A", "B"), "beam": ("B", "C"), "right": ("D", "C")}


def refuses(statement, *parts):
    with pytest.raises(la.InputError) as caught:
        statement()
    message = str(caught.value)
    assert all(part in message for part in parts), message


def test_pieces():
    frame = portal()
    assert frame.names == ("A", "B", "C", "D")
    assert frame.size == pytest.approx(np.hypot(4, 2))
    assert frame.pieces.length == pytest.approx([2, 4, 2])
    assert frame.pieces.along == pytest.approx(np.array([[0, 1, 0], [1, 0, 1]]))
    assert frame.pieces.stiff.all()


def test_members_of_a_sequence_are_named_by_their_nodes():
    frame = la.Frame(NODES, [("A", "B"), ["B", "C"], ("C", "D")], 1.0)
    assert frame.member_names == ("A-B", "B-C", "C-D")
    assert dict(frame.members)["B-C"] == ("B", "C")


def test_nodes_on_a_member_split_it():
    nodes = {"far": (3, 0), "a": (0, 0), "near": (1, 0), "b": (4, 0), "above": (1, 1)}
    members = {"beam": ("b", "a"), "post": ("near", "above")}
    frame = la.Frame(nodes, members, {"beam": 2.0, "post": 1.0})
    names = [tuple(frame.names[node] for node in pair) for pair in frame.pieces.nodes]
    assert names == [("b", "far"), ("far", "near"), ("near", "a"), ("near", "above")]
    assert frame.pieces.length == pytest.approx([1, 2, 1, 1])
    assert frame.pieces.plastic_moment == pytest.approx([2, 2, 2, 1])
    assert frame.pieces.along[0] == pytest.approx([-1, -1, -1, 0])


def test_crossing_members_pass_each_other():
    nodes = {"a": (0, 0), "b": (2, 2), "c": (0, 2), "d": (2, 0)}
    members = {"up": ("a", "b"), "down": ("c", "d"), "side": ("a", "c")}
    assert la.Frame(nodes, members, 1.0).pieces.start.size == 3
    joined = la.Frame({**nodes, "m": (1, 1)}, members, 1.0)
    assert joined.pieces.start.size == 5
    bodies = {"frame": la.Frame(nodes, members, 1.0)}
    refuses(
        lambda: la.Problem(bodies, [la.PointForce("frame", (1.0, 1.0), DOWN)]),
        "PointForce.at = (1.0, 1.0)",
        "up, down cross",
    )
    la.Problem({"frame": joined}, [la.PointForce("frame", (1.0, 1.0), DOWN)])


def test_point_forces_make_nodes():
    loads = [la.PointForce("frame", (1.0, 2.0), DOWN), la.PointForce("frame", (0.0, 2.0), RIGHT)]
    dead = [la.PointForce("frame", (0.0, 1.5), RIGHT), la.PointForce("frame", (1.0, 2.0), DOWN)]
    problem = la.Problem({"frame": portal()}, loads, dead_loads=dead)
    frame = problem.bodies["frame"]
    assert frame.names[4:] == ("beam(1, 2)", "left(0, 1.5)")
    assert frame.pieces.start.size == 5
    assert portal().split_at([(9.0, 9.0)]).names == portal().names


def test_releases_reach_both_sides_of_a_node():
    frame = la.Frame({**NODES, "m": (2, 2)}, MEMBERS, 1.0, [("beam", "m"), ("left", "A")])
    assert frame.pieces.stiff.tolist() == [
        [False, True],
        [True, False],
        [False, True],
        [True, True],
    ]


def test_find():
    frame = portal()
    assert frame.find("C", "where").tolist() == [2]
    assert frame.find(("D", "A"), "where").tolist() == [0, 3]
    assert frame.find(lambda x: x[1] > 1, "where").tolist() == [1, 2]
    for where, part in (
        ("E", "known names"),
        (lambda x: x[1] > 9, "no node"),
        (lambda x: 1.0, "one bool a node"),
        (3, "no nodes"),
        ((), "no node"),
    ):
        refuses(lambda where=where: frame.find(where, "Fix.where"), "Fix.where", part)


def test_copies_and_pickles():
    frame = portal(m_p={"left": 1.0, "beam": 2.0, "right": 3.0}, releases=[("beam", "B")])
    for twin in (pickle.loads(pickle.dumps(frame)), copy.deepcopy(frame), replace(frame)):
        assert twin.names == frame.names
        assert twin.releases == frame.releases
        assert np.array_equal(twin.pieces.plastic_moment, [1, 2, 3])
        assert np.array_equal(twin.pieces.stiff, frame.pieces.stiff)


@pytest.mark.parametrize(
    ("given", "parts"),
    [
        ({"nodes": {}}, ("Frame.nodes", "there is none")),
        ({"nodes": [(0, 0)]}, ("Frame.nodes", "give {'A': (x, y)}")),
        ({"nodes": {**NODES, 3: (0, 1)}}, ("3", "not the name of a node")),
        ({"nodes": {**NODES, "A": (0, np.nan)}}, ("Frame.nodes['A']", "not a place")),
        ({"nodes": {**NODES, "A": (0, 0, 0)}}, ("Frame.nodes['A']", "not a place")),
        ({"nodes": {**NODES, "E": (0, 2)}}, ("('B', 'E')", "at one place", "releases")),
        ({"nodes": {**NODES, "E": (2, 2.1)}}, ("'E'", "no member", "'beam'", "0.1 m")),
        ({"members": {}}, ("Frame.members", "there is no member")),
        ({"members": "beam"}, ("Frame.members = 'beam'", "no members")),
        ({"members": {**MEMBERS, "": ("A", "C")}}, ("not the name of a member",)),
        ({"members": {**MEMBERS, "x": ("A",)}}, ("Frame.members['x']", "not two nodes")),
        ({"members": {**MEMBERS, "x": ("A", "Z")}}, ("Frame.members['x'] = 'Z'", "known names")),
        ({"members": {**MEMBERS, "x": ("A", "A")}}, ("['x']", "without length")),
        ({"members": [("A", "B"), ("A", "B")]}, ("'A-B'", "given twice")),
        ({"members": {**MEMBERS, "x": ("C", "B")}}, ("('beam', 'x')", "on top", "'B'", "'C'")),
        (
            {"nodes": {**NODES, "E": (9, 2)}, "members": {**MEMBERS, "x": ("B", "E")}},
            ("('beam', 'x')", "on top of each other"),
        ),
        (
            {"nodes": {**NODES, "E": (9, 2), "F": (9, 3)}, "members": {**MEMBERS, "x": ("E", "F")}},
            ("'E'", "'A'", "parts: 2", "a Frame of its own"),
        ),
        ({"plastic_moment": 0.0}, ("Frame.plastic_moment = 0.0", "M_p > 0")),
        ({"plastic_moment": np.nan}, ("Frame.plastic_moment = nan",)),
        ({"plastic_moment": np.inf}, ("Frame.plastic_moment = inf",)),
        ({"plastic_moment": "S235"}, ("'S235'", "not a plastic moment")),
        ({"plastic_moment": {"left": 1.0, "beam": 1.0}}, ("['right']", "without one")),
        (
            {"plastic_moment": {"left": 1.0, "beam": -1.0, "right": 1.0}},
            ("Frame.plastic_moment['beam'] = -1.0",),
        ),
        ({"plastic_moment": {"lfet": 1.0}}, ("'lfet'", "did you mean 'left'?")),
        ({"releases": "beam"}, ("Frame.releases", "not a list")),
        ({"releases": ["beam"]}, ("Frame.releases", "not a pair")),
        ({"releases": [("baem", "B")]}, ("'baem'", "did you mean 'beam'?")),
        ({"releases": [("beam", "Z")]}, ("'Z' is unknown",)),
        ({"releases": [("beam", "A")]}, ("does not reach",)),
        ({"tolerance": 0.0}, ("Frame.tolerance",)),
        ({"tolerance": 3.0}, ("('A', 'B')", "at one place")),
    ],
)
def test_frames_that_cannot_be(given, parts):
    arguments = {"nodes": NODES, "members": MEMBERS, "plastic_moment": 1.0, **given}
    refuses(lambda: la.Frame(**arguments), *parts)


PUSH = la.PointForce("frame", "B", RIGHT)
BLOCK = la.RigidBlock([(-1, -1), (0, -1), (0, 0), (-1, 0)])


def foot(node, master, friction=0.3):
    return la.Interface(("frame", node), master, friction)


@pytest.mark.parametrize(
    ("given", "parts"),
    [
        (
            {"reference_loads": [la.PointForce("frame", "Z", RIGHT)]},
            ("Problem.reference_loads[0].at = 'Z'", "known"),
        ),
        (
            {"reference_loads": [la.PointForce("frame", (2.0, 1.0), RIGHT)]},
            ("Problem.reference_loads[0].at = (2.0, 1.0)", "on no member", "nearest"),
        ),
        (
            {"reference_loads": [la.PointForce("frame", "B", RIGHT, where="beam")]},
            ("Problem.reference_loads[0].where = 'beam'", "needs none"),
        ),
        (
            {"dead_loads": [la.BodyForce("frame", DOWN)]},
            ("Problem.dead_loads[0].body", "neither width"),
        ),
        (
            {"dead_loads": [la.Pressure("frame", "beam")]},
            ("Problem.dead_loads[0].body", "Traction"),
        ),
        ({"dead_loads": [la.RigidFooting("frame", "beam", DOWN)]}, ("Problem.dead_loads[0].body",)),
        ({"dead_loads": [la.Traction("frame", "baem", DOWN)]}, ("'baem'", "did you mean 'beam'?")),
        ({"dead_loads": [la.Traction("frame", lambda x: x[0] > 1, DOWN)]}, ("not a member",)),
        ({"supports": [la.Fix("frame", "Z")]}, ("Problem.supports[0].where = 'Z'", "known names")),
        (
            {"supports": [la.Fix("frame", "A", "normal")]},
            ("supports[0].components = 'normal'", "clamped"),
        ),
        (
            {
                "bodies": {"frame": portal(), "block": BLOCK},
                "supports": [la.Fix("block", "block", "clamped")],
            },
            ("supports[0].components = 'clamped'", "only nodes of a frame"),
        ),
        ({"interfaces": [foot("Z", FLOOR)]}, ("Problem.interfaces[0].slave = 'Z'", "known names")),
        ({"interfaces": [foot("A", la.RigidObstacle())]}, ("frame.A", "has no shape", "normal=")),
        ({"interfaces": [foot("B", FLOOR)]}, ("frame.B", "2 m above")),
        (
            {"interfaces": [foot("A", FLOOR), foot(("A", "D"), FLOOR)]},
            ("Problem.interfaces[1] = 'frame.A+D'", "shares", "interfaces[0]"),
        ),
        (
            {
                "bodies": {"frame": portal(), "block": BLOCK},
                "interfaces": [foot("D", ("block", "block"))],
            },
            ("'frame.D|block.block'", "is 4 m from the other side"),
        ),
        (
            {
                "bodies": {"frame": portal(), "block": BLOCK},
                "interfaces": [foot("A", ("block", "block"))],
            },
            ("stands on a corner", "select the face"),
        ),
        (
            {
                "bodies": {"frame": portal(), "other": portal()},
                "interfaces": [foot("A", ("other", "A"))],
            },
            ("'frame.A|other.A'", "nodes of two frames"),
        ),
    ],
)
def test_problems_that_cannot_be(given, parts):
    arguments = {"bodies": {"frame": portal()}, "reference_loads": [PUSH], **given}
    refuses(lambda: la.Problem(**arguments), *parts)


def test_nothing_moves():
    held = [la.Fix("frame", ("A", "B", "C", "D"), "xy")]
    problem = la.Problem({"frame": portal()}, [PUSH], held)
    refuses(lambda: la.discretise(problem), "Problem.reference_loads", "they do no power")


def test_nothing_sets_a_scale():
    pins = [(m, n) for m, pair in MEMBERS.items() for n in pair]
    problem = la.Problem(
        {"frame": portal(releases=pins)}, [PUSH], [la.Fix("frame", ("A", "D"), "xy")]
    )
    refuses(lambda: la.discretise(problem), "nothing sets a scale")


def test_inextensible_members_leave_no_equality_to_solvers():
    """8 translations less 3 members, and the rotations of 4 nodes; no row of theta."""
    program = la.discretise(pushed(0.3, 1.0)).program
    assert program.n == 8 - 3 + 4
    assert [group.volumetric.nnz for group in program.groups] == [0]
    assert program.contact.weights.tolist() == [1.0, 1.0]
