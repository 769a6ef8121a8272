"""States between the unknowns and units of a program and those of its problem."""

from dataclasses import replace

import numpy as np
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import spsolve

from lacore.assembly.discretisation import Discretisation
from lacore.claims.judged import Ray
from lacore.program import Scales
from lacore.state import ProgramState


def in_si(scales: Scales, point: ProgramState) -> ProgramState:
    """A state of a program in SI units, with the unknowns that the program has."""
    return ProgramState(
        velocity=point.velocity * scales.velocity,
        load_factor=point.load_factor * scales.load_factor,
        stress=tuple(stress * scales.stress for stress in point.stress),
        mean_stress=tuple(mean * scales.stress for mean in point.mean_stress),
        normal_reaction=point.normal_reaction * scales.stress,
        tangential_reaction=point.tangential_reaction * scales.stress,
    )


def ray_in_si(scales: Scales, ray: Ray, point: ProgramState) -> Ray:
    """A ray per unit of load factor or of power in SI units; its point is in SI units already."""
    unit = 1 / scales.load_factor
    point = ProgramState(
        velocity=unit * point.velocity,
        load_factor=unit * point.load_factor,
        stress=tuple(unit * stress for stress in point.stress),
        mean_stress=tuple(unit * mean for mean in point.mean_stress),
        normal_reaction=unit * point.normal_reaction,
        tangential_reaction=unit * point.tangential_reaction,
    )
    return replace(ray, point=point)


def point_in_si(discretisation: Discretisation, point: ProgramState) -> ProgramState:
    """All unknowns and SI units, from the free unknowns in natural units."""
    scales = discretisation.natural
    velocity = np.asarray(discretisation.free_basis @ point.velocity) * scales.velocity
    return replace(in_si(scales, point), velocity=velocity)


def point_in_program(discretisation: Discretisation, point: ProgramState) -> ProgramState:
    """The inverse of `point_in_si`, to round-off."""
    scales, basis = discretisation.natural, discretisation.free_basis
    free = spsolve(csc_matrix(basis.T @ basis), basis.T @ point.velocity)
    return ProgramState(
        velocity=np.atleast_1d(free) / scales.velocity,
        load_factor=point.load_factor / scales.load_factor,
        stress=tuple(stress / scales.stress for stress in point.stress),
        mean_stress=tuple(mean / scales.stress for mean in point.mean_stress),
        normal_reaction=point.normal_reaction / scales.stress,
        tangential_reaction=point.tangential_reaction / scales.stress,
    )
