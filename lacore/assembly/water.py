"""Total and effective stresses of bodies with water in their pores (T64)."""

import numpy as np

from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.water import in_pores
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats

_FEELS = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])  # of (xx, yy, zz, xy), in space (.., yz, zx)


def pore_pressures(problem: Problem, load_factor: float) -> dict[str, Floats]:
    """Pressure in the pores at the vertices of continua, by name, Pa, shape (vertices,).

    Args:
        problem: stated.
        load_factor: of its reference loads.
    """
    bodies = of_kind(problem.bodies, Body)
    total = {name: np.zeros(body.mesh.nvertices) for name, body in bodies.items()}
    for loads, factor in ((problem.dead_loads, 1.0), (problem.reference_loads, load_factor)):
        for load in loads:
            if load.body in bodies:
                own = in_pores(load, bodies[load.body], type(load).__name__)
                if own.any():  # a load factor that nobody knows leaves the others as they are
                    total[load.body] += factor * own
    return total


def total_stress(effective: Floats, water: Floats) -> Floats:
    """Stresses (..., 4 or 6) that the skeleton and the water of shape (...) carry together, Pa."""
    return np.asarray(effective - water[..., None] * _FEELS[: effective.shape[-1]])


def effective_stress(total: Floats, water: Floats) -> Floats:
    """What the skeleton carries of stresses (..., 4 or 6), Pa: the inverse of `total_stress`."""
    return np.asarray(total + water[..., None] * _FEELS[: total.shape[-1]])
