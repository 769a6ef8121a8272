"""Contact points that supports hold, and corners where reactions are not unique."""

from collections.abc import Container

import numpy as np

from lacore.arrays import Bools
from lacore.contact.rows import ContactPoints
from lacore.errors import InputError
from lacore.problem.problem import Problem
from lacore.program import ContactRows

_STRAIGHT = 1 - 1e-9  # mean length of normals of edges on one line


def shared_corners(
    contact: ContactRows, points: ContactPoints, problem: Problem, continua: Container[str]
) -> Bools:
    """Coulomb points at corners of continua that meet contact of another direction, shape (m,).

    Raises:
        InputError: the other one sticks by law, and so takes an unknown part of the normal force.
    """
    bodies = list(problem.bodies)
    # Joints of rigid blocks, numbered after the interfaces, meet at corners as a rule.
    own = contact.interface < len(problem.interfaces)
    owner = [
        bodies.index(interface.slave[0]) if interface.slave[0] in continua else -1
        for interface in problem.interfaces
    ]
    body = np.full(contact.count, -1.0)
    body[own] = np.array(owner, dtype=float)[contact.interface[own]]
    place = np.column_stack([body, points.moving[:, 0], points.position])
    _, node, count = np.unique(place, axis=0, return_inverse=True, return_counts=True)
    node = node.ravel()
    resultant = np.zeros((count.size, points.normal.shape[1]))
    np.add.at(resultant, node, points.normal)
    turns = (np.linalg.norm(resultant, axis=1) < count * _STRAIGHT)[node] & (body >= 0)
    sticking = np.bincount(node, np.isinf(contact.limit), minlength=count.size)[node] > 0
    wrong = np.flatnonzero(contact.coulomb & turns & sticking)
    if wrong.size:
        raise InputError(
            "Problem.interfaces",
            points.names[int(contact.interface[wrong[0]])],
            f"meets an interface that sticks at {points.position[wrong[0]]}, which holds the normal"
            " velocity where friction needs the normal reaction",
            "end one of the two beside the corner, or give the other a friction coefficient",
        )
    return np.asarray(contact.coulomb & turns)


def movable_points(contact: ContactRows, points: ContactPoints) -> Bools:
    """Contact points that no support holds altogether, shape (m,).

    A held point carries what the support carries: its reaction is undetermined and its slip zero.

    Raises:
        InputError: a point that slides with friction, while a support takes its normal force: any
            friction would be as good as any other.
    """
    held = np.diff(contact.normal.indptr) == 0
    slides = np.diff(contact.tangential.indptr).reshape(-1, contact.tangent_dim).any(axis=1)
    loose = np.flatnonzero(held & slides & contact.coulomb)
    if loose.size:
        raise InputError(
            "Problem.interfaces",
            points.names[int(contact.interface[loose[0]])],
            f"a support holds the normal velocity at {points.position[loose[0]]}, where friction"
            " needs the normal reaction",
            "let the support end beside the interface, or hold both components",
        )
    return np.asarray(~(held & ~slides))
