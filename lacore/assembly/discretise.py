"""Assembly of the kinematic program (T6) of a `Problem`, vectorised."""

from __future__ import annotations

from collections.abc import Callable, Container, Sequence
from dataclasses import replace

import numpy as np

from lacore.assembly.bonds import joined_parts, ties
from lacore.assembly.discretisation import Discretisation
from lacore.assembly.held_loads import moved_to_holders, require_stated_side
from lacore.assembly.holding import held_by
from lacore.assembly.loading import load_vector, require_load, require_power
from lacore.assembly.natural import natural_scales, with_speeds_of_crushing
from lacore.assembly.ordering import point_order
from lacore.assembly.seams import seams
from lacore.assembly.slips import slips
from lacore.assembly.span_nodes import spanned
from lacore.assembly.sticking import yielding
from lacore.assembly.unknowns import Unknowns
from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.jumps import Jumps, jumps, movable
from lacore.model.bodies.continuum.slip import Slip
from lacore.model.bodies.continuum.solid.face_jumps import face_jumps
from lacore.model.bodies.continuum.solid.holding import slid_past
from lacore.model.bodies.continuum.solid.memory import require_memory, velocity_memory
from lacore.model.conditions.loads import Load
from lacore.model.contact.interfaces import Interface
from lacore.model.contact.rows import ContactPoints, contact_rows
from lacore.model.contact.touching import Touching
from lacore.model.problem.problem import Problem
from lacore.model.problem.wet import acting
from lacore.numerics.arrays import Bools, Floats
from lacore.program.kinematic import ContactRows, KinematicProgram
from lacore.program.reduction import held_shut, kept_points, reduced
from lacore.reporting.errors import InputError, typed

_STRAIGHT = 1 - 1e-9  # mean length of normals of edges on one line

Contact = Callable[
    [Sequence[Interface], Sequence[Touching], Unknowns], tuple[ContactRows, ContactPoints]
]
"""Rows of interfaces for the unknowns of a problem: see `touching`."""


def touching(
    interfaces: Sequence[Interface], segments: Sequence[Touching], unknowns: Unknowns
) -> tuple[ContactRows, ContactPoints]:
    """Return contact where bodies touch: see `lacore.model.contact.rows.contact_rows`."""
    return contact_rows(
        interfaces, segments, unknowns.dofs, unknowns.blocks, unknowns.n, unknowns.dimension
    )


def held_in_members(unknowns: Unknowns) -> Floats:
    """Return the balanced forces of members with unequal tension and compression, (n,), N/m."""
    force = np.zeros(unknowns.n)
    for own in unknowns.frames.values():
        force[own.offset : own.offset + own.count] = own.held
    return force


def _jumps(problem: Problem, unknowns: Unknowns, name: str, slip: Slip | None) -> list[Jumps]:
    """Return the jumps of a continuum, on edges in the plane or on faces in three dimensions."""
    own, footings = unknowns.continua[name], tuple(unknowns.footings)
    if own.body.dimension == 2:
        return jumps(name, own, unknowns.n, slip)
    held = slid_past(own, problem.supports, footings, name)
    return face_jumps(name, own, held, unknowns.speeds, unknowns.n)


@typed()
def discretise(problem: Problem, contact_of: Contact = touching) -> Discretisation:
    """Assemble a problem, with its contact by `contact_of`.

    Raises:
        InputError: a footing that cannot move, a reference load without power because it acts on
            supports alone, rigid bodies without dead load, or tetrahedra whose factors need more
            memory than available.

    Example:
        >>> discrete = la.discretise(la.examples.footing())  # once, for several backends
        >>> backends = ("clarabel", "interior_point")
        >>> [round(la.solve(discrete, name).load_factor, 2) for name in backends]
        [5.93, 5.93]
    """
    require_load(problem.reference_loads)
    problem = spanned(problem)
    solid = of_kind(problem.bodies, Body)
    require_memory(velocity_memory(solid), solid)
    unknowns = Unknowns.of(problem)
    continua, dofs, n = unknowns.continua, unknowns.dofs, unknowns.n
    footings = tuple(unknowns.footings)
    interfaces = yielding(problem, continua, footings)
    contact, points = contact_of(interfaces, problem.touching, unknowns)
    slipping = slips(problem, continua, footings, unknowns.node_dofs.size)
    tied = ties(problem, continua)
    require_stated_side(problem, unknowns, interfaces, tied)
    held = held_by(problem, unknowns, slipping, tied)
    jumping = {
        part.group.name.removesuffix(": jumps"): part
        for name, own in continua.items()
        if own.space.jumps or name in slipping
        for part in _jumps(problem, unknowns, name, slipping.get(name))
    }
    jumping, seaming = (
        {name: part for name, part in found.items() if part.group.weights.size}
        for found in (
            {name: part.kept(movable(part.group, held.basis)) for name, part in given.items()}
            for given in (jumping, seams(problem, continua, dofs, tied, n))
        )
    )
    strained = {name: own.groups(name, n) for name, own in dofs.items()}

    def forces(loads: Sequence[Load]) -> Floats:
        acted = acting(loads, problem.bodies, problem.interfaces)
        stated = load_vector(acted, dofs, continua, unknowns.footings, n)
        return stated + moved_to_holders(loads, problem, unknowns, slipping)

    full = KinematicProgram(
        groups=(
            *(group for name in continua for group in strained.pop(name)),
            *(part.group for part in jumping.values()),
            *(part.group for part in seaming.values()),
            *(group for groups in strained.values() for group in groups),
        ),
        contact=contact,
        reference_load=forces(problem.reference_loads),
        dead_load=held_in_members(unknowns) + forces(problem.dead_loads),
        parts=joined_parts(unknowns.parts, problem, dofs),
    )
    basis = with_speeds_of_crushing(held.basis, unknowns, full.dead_load)
    program = reduced(full, basis)
    order = point_order(contact, points, unknowns.blocks, len(problem.interfaces))
    kept = order[_movable_points(program.contact, points)[order]]
    full, program = (
        held_shut(replace(p, contact=kept_points(p.contact, kept))) for p in (full, program)
    )
    points = points.kept(kept)
    size = unknowns.load_size(full.reference_load)
    require_power(program.reference_load, size)
    return Discretisation(
        problem=problem,
        full=full,
        program=program,
        free_basis=basis,
        held_nodes=held.nodes,
        continua=continua,
        blocks=unknowns.blocks,
        frames=unknowns.frames,
        jumps=jumping,
        slips=slipping,
        seams=seaming,
        points=points,
        shared_corners=shared_corners(program.contact, points, problem, continua),
        footings=unknowns.speeds,
        natural=natural_scales(program, unknowns, 1 / size),
    )


def shared_corners(
    contact: ContactRows, points: ContactPoints, problem: Problem, continua: Container[str]
) -> Bools:
    """Return the Coulomb points at corners with contact of another direction, shape (m,).

    Raises:
        InputError: the other one sticks by law, and so takes an unknown part of the normal force.
    """
    bodies = list(problem.bodies)
    # Joints of rigid blocks, numbered after the interfaces, usually meet at corners.
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
            "end one of the two before the corner, or give the other a friction coefficient",
        )
    return np.asarray(contact.coulomb & turns)


def _movable_points(contact: ContactRows, points: ContactPoints) -> Bools:
    """Return the contact points that supports do not hold completely, shape (m,).

    A held point carries the force of the support: its reaction is undetermined and its slip zero.

    Raises:
        InputError: a point slides with friction while a support takes its normal force, so that its
            friction is undetermined.
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
            "let the support end before the interface, or hold both components",
        )
    return np.asarray(~(held & ~slides))
