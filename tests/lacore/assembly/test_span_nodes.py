"""Nodes that loads along members need where bending moments may peak between joints."""

import numpy as np
import pytest

import lacore as la
from lacore.assembly.discretise import discretise
from lacore.assembly.span_nodes import _held, _passing, places_on, spanned, with_nodes

LENGTH = 4.0


def beam(nodes=None, members=None, loads=None, supports=None, **more):
    """A beam of two members from "a" over "m" to "b", loaded across the first one only."""
    frame = la.Frame(
        {"a": (0, 0), "m": (LENGTH / 2, 0), "b": (LENGTH, 0), **(nodes or {})},
        members or {"left": ("a", "m"), "right": ("m", "b")},
        1.0,
    )
    return la.Problem(
        {"beam": frame},
        loads or [la.Traction("beam", "left", (0, -1))],
        supports or [la.Fix("beam", "a", "clamped"), la.Fix("beam", "b", "clamped")],
        **more,
    )


def added(problem, name="beam"):
    """Places of the nodes that `spanned` adds to a frame, sorted."""
    before, after = problem.bodies[name], spanned(problem).bodies[name]
    assert np.array_equal(after.position[:, : len(before.names)], before.position)
    return sorted(map(tuple, after.position[:, len(before.names) :].T.tolist()))


def test_only_loaded_pieces_get_a_node_midway():
    assert added(beam()) == [(1.0, 0.0)]
    assert added(beam(dead_loads=[la.Traction("beam", "right", (0, -1))])) == [
        (1.0, 0.0),
        (3.0, 0.0),
    ]
    only_dead = beam(
        loads=[la.PointForce("beam", "m", (0, -1))],
        dead_loads=[la.Traction("beam", "right", (0, -1))],
    )
    assert added(only_dead) == [(3.0, 0.0)]


def test_a_frame_without_load_keeps_its_nodes_beside_one_with_load():
    """Whichever of the two comes first."""
    one = beam()
    far = la.Frame({"a": (9, 0), "b": (12, 0)}, {"left": ("a", "b")}, 1.0)
    for bodies in ({**one.bodies, "far": far}, {"far": far, **one.bodies}):
        supports = [*one.supports, la.Fix("far", "a", "clamped")]
        problem = la.Problem(bodies, one.reference_loads, supports)
        assert added(problem) == [(1.0, 0.0)]
        assert added(problem, "far") == []


def test_nodes_are_added_once():
    problem = spanned(beam())
    assert spanned(problem) is problem


@pytest.mark.parametrize(
    "held",
    [
        {},
        {"supports": [la.Fix("beam", x, "clamped") for x in "ab"] + [la.Fix("beam", "p", "y")]},
    ],
    ids=["free", "supported"],
)
def test_a_node_inside_a_member_serves_unless_something_holds_it(held):
    """A support at the quarter point splits the member into two spans, each with its own peak."""
    frame = la.Frame({"a": (0, 0), "b": (LENGTH, 0), "p": (1, 0)}, {"left": ("a", "b")}, 1.0)
    problem = la.Problem(
        {"beam": frame},
        [la.Traction("beam", "left", (0, -1))],
        held.get("supports", [la.Fix("beam", x, "clamped") for x in "ab"]),
    )
    assert added(problem) == ([(0.5, 0.0), (2.5, 0.0)] if held else [])


def test_a_joint_of_two_members_is_no_node_inside_a_member():
    """At a joint in a straight line moments may peak as at any other; so may they at its sides."""
    problem = beam()
    frame = problem.bodies["beam"]
    assert not _passing(problem, "beam", frame).any()
    refined = spanned(problem)
    inside = _passing(refined, "beam", refined.bodies["beam"])
    assert inside.tolist() == [False, False, False, True]


def test_a_node_inside_any_of_many_members_serves():
    """In each of four beams, one on top of another."""
    places = {"a": 0, "p": 1, "b": LENGTH}
    nodes = {f"{name}{k}": (x, k) for k in range(4) for name, x in places.items()}
    members = {f"beam {k}": (f"a{k}", f"b{k}") for k in range(4)}
    members |= {f"post {k}": (f"a{k}", f"a{k + 1}") for k in range(3)}
    frame = la.Frame(nodes, members, 1.0)
    problem = la.Problem(
        {"beam": frame},
        [la.Traction("beam", f"beam {k}", (0, -1)) for k in range(4)],
        [la.Fix("beam", f"a{k}", "clamped") for k in range(4)],
    )
    inside = _passing(problem, "beam", frame)
    assert {frame.names[node] for node in np.flatnonzero(inside)} == {f"p{k}" for k in range(4)}
    assert added(problem) == []


def predicate(place):
    return lambda x: np.abs(x[0] - place) < 1e-9


def test_supports_keep_the_nodes_that_they_held():
    """A predicate that finds every node on a line would hold the added ones as well."""
    everywhere = la.Fix("beam", lambda x: x[1] == 0, "clamped")
    problem = beam(
        nodes={"top": (2, 2)},
        members={"left": ("a", "m"), "right": ("m", "b"), "post": ("m", "top")},
        loads=[la.Traction("beam", "left", (0, -1)), la.PointForce("beam", "top", (1, 0))],
        supports=[everywhere],
    )
    refined = spanned(problem)
    assert refined.supports[0].where == ("a", "m", "b")
    named = beam(supports=[la.Fix("beam", ("a", "b"), "clamped")])
    assert spanned(named).supports[0] is named.supports[0]


def test_interfaces_keep_the_nodes_that_they_touched():
    mesh = la.meshes.rectangle((0, LENGTH), (-1, 0), 4, 1)
    problem = la.Problem(
        {"beam": beam().bodies["beam"], "soil": la.Body(mesh, la.VonMises(1.0))},
        [la.Traction("beam", "left", (0, -1))],
        [la.Fix("soil", "bottom"), la.Fix("beam", predicate(0.0), "clamped")],
        [la.Interface(("beam", predicate(LENGTH)), ("soil", "top"), 0.3)],
    )
    frame = problem.bodies["beam"]
    assert [own.tolist() for own in _held(problem, "beam", frame)] == [[0], [2]]
    refined = with_nodes(problem, problem, {"beam": np.array([[1.0], [0.0]])})
    (interface,) = refined.interfaces
    assert interface.slave == ("beam", ("b",))
    assert interface.master == ("soil", "top")
    assert refined.supports[0] is problem.supports[0]
    assert refined.supports[1].where == ("a",)


def test_a_place_where_another_member_crosses_moves_along_the_piece():
    """A node there would join the two: the place moves along the axis by four tolerances."""
    frame = la.Frame(
        {"a": (0, 0), "b": (LENGTH, 0), "c": (2, -1), "d": (2, 1)},
        {"beam": ("a", "b"), "tie": ("c", "d"), "stay": ("a", "c")},
        1.0,
    )
    pieces = np.flatnonzero(frame.pieces.member == 0)
    crossing = places_on(frame, pieces, np.full(pieces.size, 0.5))
    assert crossing[1] == pytest.approx(0.0, abs=0)
    assert abs(crossing[0, 0] - 2) == pytest.approx(4 * frame.tolerance)
    free = places_on(frame, pieces, np.full(pieces.size, 0.25))
    assert free.T.tolist() == [[1.0, 0.0]]


def test_elements_are_those_of_meshes_blocks_and_pieces():
    """Eight triangles or four squares, two blocks, and three pieces of the loaded beam."""
    mesh = la.meshes.rectangle((0, 1), (0, 1), 2, 2)
    blocks = {
        name: [(x, 5), (x + 1, 5), (x + 1, 6), (x, 6)] for name, x in (("one", 0), ("two", 3))
    }
    own = beam()
    problem = la.Problem(
        {
            **own.bodies,
            "square": la.Body(mesh, la.VonMises(1.0)),
            "blocks": la.BlockAssembly(blocks, 0.3),
        },
        own.reference_loads,
        [*own.supports, la.Fix("square", "bottom"), la.Fix("blocks", ("one", "two"))],
    )
    assert discretise(problem).n_elements == mesh.nelements + 2 + 3
