"""Convert states between the unknowns and units of a program and those of its problem."""

from dataclasses import replace

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import spsolve

from lacore.assembly.discretisation import Discretisation
from lacore.coupling.claims.proving import Ray
from lacore.program.kinematic import Scales
from lacore.program.state import ProgramState


def in_si(scales: Scales, point: ProgramState) -> ProgramState:
    """Convert a state to SI units, with the unknowns of the program."""
    load_factor, velocity = scales.load_factor, scales.velocity
    return point.scaled(scales.stress, load_factor=load_factor, velocity=velocity)


def ray_in_si(scales: Scales, ray: Ray, point: ProgramState) -> Ray:
    """Normalise a ray to unit load factor or power in SI units.

    `point` is its state, converted by `point_in_si` and not yet normalised.
    """
    unit = 1 / scales.load_factor
    return replace(ray, point=point.scaled(unit, load_factor=unit, velocity=unit))


def point_in_si(discretisation: Discretisation, point: ProgramState) -> ProgramState:
    """Convert a state from the free unknowns in scaled units to all unknowns in SI units."""
    scales = discretisation.natural
    velocity = np.asarray(discretisation.free_basis @ point.velocity) * scales.velocity
    return replace(in_si(scales, point), velocity=velocity)


def point_in_program(discretisation: Discretisation, point: ProgramState) -> ProgramState:
    """Invert `point_in_si`, up to round-off."""
    scales, basis = discretisation.natural, discretisation.free_basis
    free = spsolve(csc_matrix(basis.T @ basis), basis.T @ point.velocity)
    velocity = np.atleast_1d(free) / scales.velocity
    own = point.scaled(1 / scales.stress, load_factor=1 / scales.load_factor)
    return replace(own, velocity=velocity)
