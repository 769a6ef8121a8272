"""Velocities that a material whose strength depends on pressure can flow with, exactly (T45).

What a solver leaves of ``theta >= sin(phi) ||d||`` is up to 1e-5 of the largest rate, worst in
small elements. The conditions are convex: between the velocity and one that is strictly inside
everywhere, found with ``theta >= sin(phi) ||d|| + M/w``, the nearest one that meets them all in
floating point costs about 1e-5 of the load factor.
"""

from contextlib import closing
from dataclasses import replace

import numpy as np

from lacore.bounds.velocity_projection import admissible_velocity
from lacore.numerics.arrays import Floats
from lacore.program.kinematic import DissipationGroup, KinematicProgram, associated_contact
from lacore.solvers.backend import Prepare, checked_answer

_MARGINS = (1e-6, 1e-5, 1e-4)  # M, of a dimensionless program: the first is enough as a rule
_ROUND_OFF = 1e-12  # of the largest rate: the margin that is left
_DOUBLED = 8  # times that the share of the inner velocity grows where round-off is left


def possible_velocity(program: KinematicProgram, velocity: Floats, prepare: Prepare) -> Floats:
    """The velocity moved inward until every cone flows as it can; else what came closest.

    Args:
        program: dimensionless.
        velocity: almost possible, shape (n,).
        prepare: sets an exact backend to work on a program.
    """
    velocity = admissible_velocity(program, velocity)
    best = velocity
    for margin in _MARGINS:
        if not _outside(program, best).max(initial=0.0) > 0:
            break
        inside = _inside(program, margin, prepare)
        if inside is not None:
            best = _between(program, velocity, inside)
    return best


def _inside(program: KinematicProgram, margin: float, prepare: Prepare) -> Floats | None:
    """The best velocity that is strictly inside by a margin; None where none is found."""
    groups = tuple(
        group
        if group.surfaces is None
        else replace(
            group,
            surfaces=replace(
                group.surfaces, dilation=margin * _straining(group) / group.volume_weights
            ),
        )
        for group in program.groups
    )
    widened = replace(program, groups=groups)
    with closing(prepare(widened)) as solver:
        point = checked_answer(widened, False, solver.solve(associated_contact(program.contact)))
    return None if point.point is None else admissible_velocity(program, point.point.velocity)


def _straining(group: DissipationGroup) -> Floats:
    """1 of volumetric rows that supports leave something of, else 0: where nothing can strain."""
    entries = np.asarray(abs(group.volumetric).sum(axis=1)).ravel()
    return np.asarray(entries > _ROUND_OFF * entries.max(initial=0.0), dtype=np.float64)


def _between(program: KinematicProgram, velocity: Floats, inside: Floats) -> Floats:
    """The velocity with the least share of another one that makes it possible, and stays so."""
    out, within = _outside(program, velocity), _outside(program, inside)
    # In other units, and with what supports hold, the same rates differ by round-off.
    fastest = max(float(np.abs(g.cone_vectors(velocity)).max(initial=0.0)) for g in program.groups)
    kept = min(_ROUND_OFF * fastest, max(-float(within.max()), 0.0) / 2)
    wrong = out > -kept
    missing, room = out[wrong] + kept, out[wrong] - within[wrong]
    share = float(np.max(missing / np.maximum(room, missing), initial=0.0))
    for _ in range(_DOUBLED):
        moved = (1 - share) * velocity + share * inside
        if not _outside(program, moved).max(initial=0.0) > 0:
            break
        share = min(2 * max(share, 1e-9), 1.0)
    return np.asarray(moved)


def _outside(program: KinematicProgram, velocity: Floats) -> Floats:
    """How far all cones are from flow that is possible, shape (m,); < 0 inside."""
    own = [
        group.surfaces.impossible(
            np.linalg.norm(group.cone_vectors(velocity), axis=1), group.volumetric @ velocity
        )
        for group in program.groups
        if group.surfaces is not None
    ]
    return np.concatenate([np.zeros(0), *own])
