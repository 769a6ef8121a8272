"""Nodes inside members under loads along them, as hinges are at nodes only."""

from dataclasses import replace
from typing import Any

import numpy as np

from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.frames.dofs import FrameDofs
from lacore.model.bodies.frames.frame import Frame
from lacore.model.conditions.loads import Fix
from lacore.model.contact.interfaces import Interface
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Bools, Floats, Ints

_BESIDE = 4.0  # distance, in tolerances, from which another member crosses


def spanned(problem: Problem) -> Problem:
    """Return the problem with a node midway in loaded pieces without one between joints.

    Supports count as joints. A second call changes nothing.
    """
    places = {}
    for name, frame in of_kind(problem.bodies, Frame).items():
        loaded = np.zeros(frame.pieces.length.size, dtype=bool)
        dofs = FrameDofs(frame, 0)
        for loads in (problem.reference_loads, problem.dead_loads):
            loaded |= dofs.load_across([load for load in loads if load.body == name]) != 0
        loaded &= ~_passing(problem, name, frame)[frame.pieces.nodes].any(axis=1)
        half = np.full(int(loaded.sum()), 0.5)
        places[name] = places_on(frame, np.flatnonzero(loaded), half)
    return with_nodes(problem, problem, places)


def with_nodes(given: Problem, problem: Problem, places: dict[str, Floats]) -> Problem:
    """Return `given` with nodes at places (2, k) in its frames, and supports as in `problem`."""
    if not any(place.size for place in places.values()):
        return given
    bodies = dict(given.bodies)
    for name, place in places.items():
        bodies[name] = bodies[name].with_points(place.T.tolist())
    return replace(
        given,
        bodies=bodies,
        supports=[_named(support, problem) for support in given.supports],
        interfaces=[_named_interface(interface, problem) for interface in given.interfaces],
    )


def _named(support: Fix, problem: Problem) -> Fix:
    """Return a support by node names, because a predicate would also hold new nodes."""
    frame = of_kind(problem.bodies, Frame).get(support.body)
    if frame is None or not callable(support.where):
        return support
    nodes = frame.find(support.where, "Fix.where")
    return replace(support, where=tuple(frame.names[node] for node in nodes))


def _named_interface(interface: Interface, problem: Problem) -> Interface:
    sides: dict[str, Any] = {}
    for side, part in zip(("slave", "master"), interface.sides, strict=False):
        if not callable(part[1]):
            continue
        frame = of_kind(problem.bodies, Frame).get(part[0])
        if frame is not None:
            nodes = frame.find(part[1], "Interface")
            sides[side] = (part[0], tuple(frame.names[node] for node in nodes))
    return replace(interface, **sides) if sides else interface


def _passing(problem: Problem, name: str, frame: Frame) -> Bools:
    """Return the nodes inside one member that have no other connection, (N,)."""
    pieces, count = frame.pieces, len(frame.names)
    nodes = pieces.nodes.ravel()
    member = np.repeat(pieces.member, 2)
    ends = np.bincount(nodes, minlength=count)
    low, high = np.full(count, member.max() + 1), np.full(count, -1)
    np.minimum.at(low, nodes, member)
    np.maximum.at(high, nodes, member)
    held = np.zeros(count, dtype=bool)
    for number in _held(problem, name, frame):
        held[number] = True
    return np.asarray((ends == 2) & (low == high) & ~held)


def _held(problem: Problem, name: str, frame: Frame) -> list[Ints]:
    """Return the nodes of supports and interfaces."""
    parts = [support.where for support in problem.supports if support.body == name]
    for interface in problem.interfaces:
        parts += [where for own, where in interface.sides if own == name]
    return [frame.find(where, "where") for where in parts]


def places_on(frame: Frame, pieces: Ints, share: Floats) -> Floats:
    """Return the places at shares of pieces, (2, k), except where another member crosses."""
    start = frame.position[:, frame.pieces.start[pieces]]
    along, length = frame.pieces.along[:, pieces], frame.pieces.length[pieces]
    assert frame.tolerance is not None
    places = start + along * length * share
    aside = np.array([frame.crossed_at(place) for place in places.T.tolist()], dtype=bool)
    return np.asarray(places + np.where(aside, _BESIDE * frame.tolerance, 0.0) * along)
