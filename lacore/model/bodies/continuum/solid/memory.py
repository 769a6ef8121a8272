"""Estimate of the memory of factors for problems of tetrahedra.

Fill grows as ``n**1.4`` with the unknowns n, by nested dissection. Measured with 588 to 10 692
tetrahedra: 1.0 to 57.8 million entries for lower bounds, with 21 unknowns per tetrahedron; 3.0 and
19.2 million for discontinuous velocities, with 18 unknowns, for 588 and 2 100. An entry takes
twenty bytes in total. Solvers other than ``interior_point`` take several times as much.
"""

import os
from collections.abc import Mapping
from math import inf

from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.spaces import spaces_of
from lacore.reporting.errors import InputError

_POWER = 1.4
_STRESSES, _VELOCITIES = 1.9, 7.5  # entries by the unknowns to that power
_BYTES = 20.0
_SHARE = 0.8  # largest share of the memory of a computer for one problem
_GB = 1e9


def velocity_memory(bodies: Mapping[str, Body]) -> float:
    """Return the estimated bytes for factors of velocities of tetrahedra; 0 without any."""
    count = 0
    for body in bodies.values():
        if body.dimension == 3:
            mesh, space = body.mesh, spaces_of(body.kinematics)[body.space]
            if space.jumps and body.pressure_dependent:
                count += 3 * (4 if space.degree == 1 else 10) * mesh.nelements
            elif space.jumps:
                count += 3 * mesh.nfacets * space.degree + 6 * mesh.nelements * (space.degree - 1)
            else:
                count += 3 * (mesh.nvertices + mesh.nedges)
    return _taken(_VELOCITIES, count)


def stress_memory(bodies: Mapping[str, Body]) -> float:
    """Return the estimated bytes for factors of equilibrium elements of a lower bound."""
    meshes = [body.mesh for body in bodies.values() if body.dimension == 3]
    return _taken(_STRESSES, sum(9 * mesh.nfacets + 3 * mesh.nelements for mesh in meshes))


def told_memory(needed: float) -> str:
    """Return a text such as ``about 0.3 GB for factors``."""
    return f"about {needed / _GB:.1g} GB for factors"


def require_memory(needed: float, bodies: Mapping[str, Body]) -> None:
    """Raise `InputError` if factors would need more memory than available."""
    there = physical_memory()
    if needed > _SHARE * there:
        elements = sum(body.mesh.nelements for body in bodies.values())
        raise InputError(
            "Problem.bodies",
            f"{elements} tetrahedra",
            f"factors would take about {needed / _GB:.3g} GB, where this computer has"
            f" {there / _GB:.3g} GB",
            "take a coarser mesh and refine it by lacore.bracket, a symmetric part of the bodies,"
            " or the space 'p1-disc'",
        )


def physical_memory() -> float:
    """Return the memory of the computer in bytes; inf if unknown."""
    try:
        return float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    except (AttributeError, ValueError, OSError):
        return inf


def _taken(fill: float, unknowns: int) -> float:
    entries: float = fill * unknowns**_POWER
    return _BYTES * entries
