"""Scales in which the results are of order one (T20)."""

from collections.abc import Sequence
from math import cbrt, fsum, sqrt

import numpy as np
from scipy.sparse import csr_matrix, diags_array

from lacore.assembly.unknowns import Unknowns
from lacore.model.bodies.continuum.regions.gathering import by_body, region_count
from lacore.numerics.arrays import Floats, Sparse
from lacore.program.dissipation import DissipationGroup
from lacore.program.kinematic import KinematicProgram, Scales
from lacore.reporting.errors import InputError
from lacore.reporting.text import Term, text


def strengths_of(groups: Sequence[DissipationGroup], dead_load: Floats, area: float) -> list[float]:
    """Return the stresses at which groups yield, in tension, Pa: cohesion, or the dead load.

    The apex of a cone is not used, because it is far away if friction is small (T48).

    Args:
        groups: groups of a program.
        dead_load: dead load on its unknowns, N; per unit thickness N/m.
        area: area on which it presses, m^2; m.
    """
    strengths = [_carried(group, dead_load, area) for group in groups]
    if not max(strengths, default=0.0) > 0:  # strength without tension and crushing
        pressure_dependent = [group.surfaces for group in groups if group.surfaces is not None]
        strengths += [float(surfaces.strength.max()) for surfaces in pressure_dependent]
    return strengths


def _carried(group: DissipationGroup, dead_load: Floats, area: float) -> float:
    own = sqrt(3) * float(group.bound.max())
    if group.surfaces is None:
        return own
    return max(own, float(group.surfaces.slope.max()) * fsum(np.abs(dead_load)) / area)


def _between(strengths: Sequence[float]) -> float:
    """Return the geometric mean of the extreme strengths of the regions of a body.

    The load may be that of the weakest region, or of the strongest.
    """
    some = [own for own in strengths if own > 0]
    least, most = min(some, default=0.0), max(some, default=0.0)
    return most if least == most else sqrt(least) * sqrt(most)


def with_speeds_of_crushing(basis: Sparse, unknowns: Unknowns, dead_load: Floats) -> Sparse:
    """Return a basis of free velocities in which crushing costs as much as other motions.

    Joints are far stronger than the pressure on them, so a speed that is small compared with all
    others has a power that is not.
    """
    unit = np.ones(basis.shape[0])
    for dofs in unknowns.blocks.values():
        points, across = dofs.body.crushing_points, cbrt(dofs.extent)
        if points is not None and np.any(dead_load):
            pressure = fsum(np.abs(dead_load)) / across**2
            unit[dofs.crushing] = min(1.0, pressure / points.strength)
    return csr_matrix(diags_array(unit) @ basis)


def natural_scales(program: KinematicProgram, unknowns: Unknowns, velocity: float) -> Scales:
    """Return the scales of the results: from strengths of continua, hinges, or the dead load.

    Joints that crush are far stronger than the pressure on them, and only used without dead load.
    In three dimensions the thickness is the length, as loads are in N.

    Raises:
        InputError: there is no scale of stress; the load factor would be 0 or arbitrary.
    """
    extent = fsum(own.extent for own in unknowns.dofs.values())
    solid = unknowns.dimension == 3
    length = cbrt(extent) if solid else sqrt(extent)
    bodies = unknowns.continua
    across = length if solid else 1.0
    if any(body.axisymmetric for body in bodies.values()):
        volume = sum(float(body.weights.sum()) for body in bodies.values())
        across = volume / sum(body.extent for body in bodies.values())
    pressed = solid and bool(np.any(program.dead_load))
    yielding = program.groups[: region_count(bodies)] or program.groups
    strengths: list[float] = []
    if bodies or not pressed:
        strengths = strengths_of(yielding, program.dead_load, length * across)
    if bodies and len(strengths) == len(yielding):
        strengths = [_between(own) for _, _, own in by_body(bodies, strengths)]
    if not strengths:
        limit = program.contact.limit
        strengths = [
            fsum(np.abs(program.dead_load)) / (length * across),  # independent of the order
            float(limit[np.isfinite(limit)].max(initial=0.0)),
        ]
    if not max(strengths) > 0:
        raise InputError(
            "Problem.dead_loads",
            None,
            "bodies without cohesion under no dead load: nothing sets a scale of forces, the load"
            " factor would be 0, or have no limit",
            text(
                "give dead_loads (the own weight: {}), a Tresca friction, or a body that yields:"
                " a cohesion, a compressive_strength",
                Term("BodyForce", 'load = "weight"'),
            ),
        )
    return Scales(length, max(strengths), velocity, across)
