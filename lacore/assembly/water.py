"""Total and effective stresses of bodies with water in their pores (T64)."""

import numpy as np

from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.water import in_pores
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats

# components of (xx, yy, zz, xy), in three dimensions (.., yz, zx), with water pressure
_FEELS = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])


def pore_pressures(problem: Problem, load_factor: float) -> dict[str, Floats]:
    """Return the pore pressure at the vertices of continua, by name, Pa, shape (vertices,).

    Args:
        problem: the problem.
        load_factor: factor of its reference loads.
    """
    bodies = of_kind(problem.bodies, Body)
    total = {name: np.zeros(body.mesh.nvertices) for name, body in bodies.items()}
    for loads, factor in ((problem.dead_loads, 1.0), (problem.reference_loads, load_factor)):
        for load in loads:
            if load.body in bodies:
                own = in_pores(load, bodies[load.body].mesh, type(load).__name__)
                if own.any():  # An unknown load factor does not affect the other loads.
                    total[load.body] += factor * own
    return total


def total_stress(effective: Floats, water: Floats) -> Floats:
    """Return the total stresses (..., 4 or 6) of the skeleton and the water (...), Pa."""
    return np.asarray(effective - water[..., None] * _FEELS[: effective.shape[-1]])


def effective_stress(total: Floats, water: Floats) -> Floats:
    """Return the effective part of stresses (..., 4 or 6), Pa: the inverse of `total_stress`."""
    return np.asarray(total + water[..., None] * _FEELS[: total.shape[-1]])
