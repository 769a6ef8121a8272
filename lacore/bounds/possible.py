"""Velocities that are exactly admissible for pressure-dependent strength (T45).

A solver violates ``theta >= sin(phi) ||d||`` by up to 1e-5 of the largest rate, worst in small
elements. The conditions are convex. Between the velocity and one that is strictly inside
everywhere, found with ``theta >= sin(phi) ||d|| + M/w``, the nearest one that meets them all in
floating point increases the load factor by about 1e-5.
"""

from contextlib import closing
from dataclasses import replace

import numpy as np

from lacore.bounds.constants import DOUBLINGS, MARGIN_ROUND_OFF, MARGINS
from lacore.bounds.velocity_projection import admissible_velocity
from lacore.numerics.arrays import Floats
from lacore.program.kinematic import DissipationGroup, KinematicProgram, associated_contact
from lacore.solvers.backend import Prepare, checked_answer


def possible_velocity(program: KinematicProgram, velocity: Floats, prepare: Prepare) -> Floats:
    """Return the velocity moved inward until every cone is admissible; else the closest one.

    Args:
        program: dimensionless program.
        velocity: almost admissible velocity, shape (n,).
        prepare: prepares an exact backend for a program.
    """
    velocity = admissible_velocity(program, velocity)
    best = velocity
    for margin in MARGINS:
        if not _outside(program, best).max(initial=0.0) > 0:
            break
        inside = _inside(program, margin, prepare)
        if inside is not None:
            best = _between(program, velocity, inside)
    return best


def _inside(program: KinematicProgram, margin: float, prepare: Prepare) -> Floats | None:
    """Return the best velocity that is strictly inside by a margin; None if none is found."""
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
    """Return 1 for volumetric rows with free unknowns, else 0: supports prevent their strain."""
    entries = np.asarray(abs(group.volumetric).sum(axis=1)).ravel()
    return np.asarray(entries > MARGIN_ROUND_OFF * entries.max(initial=0.0), dtype=np.float64)


def _between(program: KinematicProgram, velocity: Floats, inside: Floats) -> Floats:
    """Return the velocity with the smallest admissible share of another, with some margin."""
    out, within = _outside(program, velocity), _outside(program, inside)
    # In other units, and with fixed unknowns, the same rates differ by round-off.
    fastest = max(float(np.abs(g.cone_vectors(velocity)).max(initial=0.0)) for g in program.groups)
    kept = min(MARGIN_ROUND_OFF * fastest, max(-float(within.max()), 0.0) / 2)
    wrong = out > -kept
    missing, room = out[wrong] + kept, out[wrong] - within[wrong]
    share = float(np.max(missing / np.maximum(room, missing), initial=0.0))
    for _ in range(DOUBLINGS):
        moved = (1 - share) * velocity + share * inside
        if not _outside(program, moved).max(initial=0.0) > 0:
            break
        share = min(2 * max(share, 1e-9), 1.0)
    return np.asarray(moved)


def _outside(program: KinematicProgram, velocity: Floats) -> Floats:
    """Return how far all cones are from admissible flow, shape (m,); < 0 inside."""
    own = [
        group.surfaces.impossible(
            np.linalg.norm(group.cone_vectors(velocity), axis=1), group.volumetric @ velocity
        )
        for group in program.groups
        if group.surfaces is not None
    ]
    return np.concatenate([np.zeros(0), *own])
