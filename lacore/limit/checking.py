"""Recompute the residuals of a limit state, as it is or with parts of it replaced.

The velocities, stresses, reactions and moments of a state, in SI units, are converted back to the
unknowns of its program, and all residuals are recomputed. Users can therefore inject an error into
a state and see that it is detected.
"""

from collections.abc import Mapping
from dataclasses import replace
from numbers import Real

import numpy as np
from numpy.typing import ArrayLike
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import spsolve

from lacore.assembly.discretisation import Discretisation
from lacore.assembly.water import effective_stress, pore_pressures
from lacore.coupling.kinds import COUPLINGS
from lacore.limit.conversion import point_in_program
from lacore.limit.tables.contact_table import Table, column, numbers, reactions_of
from lacore.model.bodies.blocks.dofs import RigidDofs
from lacore.model.bodies.blocks.rigid_blocks import RigidBlocks
from lacore.model.bodies.continuum.nodal import point_values
from lacore.model.bodies.continuum.regions.gathering import by_body, continuum_stress
from lacore.model.bodies.continuum.volume import judged_means
from lacore.model.bodies.frames.dofs import FrameDofs
from lacore.numerics.arrays import Floats
from lacore.program.certificate import Certificate
from lacore.program.kinematic import dimensionless
from lacore.program.state import ProgramState, misfit
from lacore.reporting.errors import InputError, require_known


def recomputed(discretisation: Discretisation, point: ProgramState, coupling: str) -> Certificate:
    """Residuals of a state of a problem, in SI units and all unknowns, by the laws of a coupling.

    A velocity that supports, rigid footings or rigid members forbid counts as penetration.
    """
    kind = COUPLINGS[coupling]
    program = kind.program_of(dimensionless(discretisation.program, discretisation.natural))
    laws = kind.laws_of(program.contact)
    inside = point_in_program(discretisation, point)
    found = Certificate.of(program, inside, laws)
    scale = discretisation.natural.velocity
    forbidden = point.velocity / scale - discretisation.free_basis @ inside.velocity
    largest = float(np.abs(point.velocity).max(initial=0.0)) / scale or 1.0
    against = float(np.abs(forbidden).max(initial=0.0)) / largest
    return replace(found, penetration=float(np.maximum(found.penetration, against)))


def checked(
    discretisation: Discretisation,
    point: ProgramState,
    coupling: str,
    *,
    load_factor: float | None = None,
    velocity: Mapping[str, ArrayLike] | None = None,
    stress: Mapping[str, ArrayLike] | None = None,
    reactions: Table | None = None,
    hinges: Table | None = None,
) -> Certificate:
    """Residuals of a state with parts replaced, see `lacore.LimitState.certify`.

    Raises:
        InputError: a name, a shape or a table that is not one of this state.
    """
    if fault := misfit(discretisation.full, point):
        fix = "change the parts of `state.point` with dataclasses.replace"
        raise InputError("point", None, f"has {fault}", fix)
    unlike = 0.0
    if stress is not None:
        point, unlike = _with_stress(discretisation, point, stress)
    if load_factor is not None:
        if not isinstance(load_factor, Real):
            raise InputError("load_factor", load_factor, "not a number", "give one")
        point = replace(point, load_factor=float(load_factor))
    if velocity is not None:
        point = replace(point, velocity=_velocity(discretisation, point.velocity, velocity))
    if reactions is not None:
        t_n, t_t = reactions_of(discretisation, reactions)
        point = replace(point, normal_reaction=t_n, tangential_reaction=t_t)
    if hinges is not None:
        point = _with_moments(discretisation, point, hinges)
    found = recomputed(discretisation, point, coupling)
    return replace(found, flow=float(np.maximum(found.flow, unlike)))


def _velocity(d: Discretisation, stored: Floats, given: Mapping[str, ArrayLike]) -> Floats:
    """All unknowns from velocities by body as `LimitState.velocity` shows them."""
    u = stored.copy()
    rigid: dict[str, RigidDofs[RigidBlocks] | FrameDofs] = {**d.blocks, **d.frames}
    for name, values in given.items():
        require_known("velocity", name, [*d.continua, *rigid])
        field = f"velocity[{name!r}]"
        if name in d.continua:
            dofs = d.continua[name].dofs
            u[dofs] = numbers(field, values, dofs.shape)
        else:
            part = rigid[name]
            own = part.unknowns(numbers(field, values, part.motion(u).shape))
            u[part.offset : part.offset + own.size] = own  # slides of frames stay
    if d.footings.size:  # their speeds follow from the nodes that they move
        shown = np.setdiff1d(np.arange(u.size), d.footings)
        basis = d.free_basis[shown]
        free = spsolve(csc_matrix(basis.T @ basis), basis.T @ u[shown])
        u[d.footings] = d.free_basis[d.footings] @ np.atleast_1d(free)
    return u


def _with_stress(
    d: Discretisation, point: ProgramState, given: Mapping[str, ArrayLike]
) -> tuple[ProgramState, float]:
    """The state with stresses as `LimitState.stress` shows them, and how far they are from any.

    That is, per largest stress, what no strain rate of the body feels: sigma_zz that plane strain
    or plane stress does not leave free, mean stresses that the elements do not have.
    """
    stresses, means, unlike = list(point.stress), list(point.mean_stress), 0.0
    water = pore_pressures(d.problem, point.load_factor)
    for name, dofs, own_groups in by_body(d.continua, range(len(stresses))):
        if name not in given:
            continue
        count = 6 if dofs.body.dimension == 3 else 4
        total = numbers(f"stress[{name!r}]", given[name], (*dofs.weights.shape, count))
        sigma = effective_stress(total, point_values(dofs, water[name]))
        for number, region in zip(own_groups, dofs.body.regions, strict=True):
            form, dim = region.form, region.form.rows.shape[0]
            parts = np.eye(dim + len(form.volumes))
            back = np.linalg.pinv(form.stress(parts[:, :dim], parts[:, dim:].ravel()))
            own = sigma[region.elements].reshape(-1, count) @ back
            stresses[number], means[number] = own[:, :dim], own[:, dim:].ravel()
        judged = judged_means(dofs.velocity, [means[number] for number in own_groups])
        kept = continuum_stress(dofs, [stresses[number] for number in own_groups], judged)
        largest = float(np.abs(sigma).max(initial=0.0)) or 1.0
        off = float(np.abs(sigma - kept).max(initial=0.0)) / largest
        unlike = float(np.maximum(unlike, off))
    for name in given:
        require_known("stress", name, d.continua)
    return replace(point, stress=tuple(stresses), mean_stress=tuple(means)), unlike


def _with_moments(d: Discretisation, point: ProgramState, hinges: Table) -> ProgramState:
    """The state with moments of hinges as `LimitState.hinges` shows them."""
    mine = [n for n, group in enumerate(d.full.groups) if group.name in d.frames]
    frames = [d.frames[d.full.groups[number].name] for number in mine]
    sizes = [dofs.modes.ends[0].size for dofs in frames]
    moments = np.split(column("hinges", hinges, "moment", sum(sizes)), np.cumsum(sizes)[:-1])
    stresses = list(point.stress)
    for number, dofs, moment in zip(mine, frames, moments, strict=True):
        stresses[number] = dofs.stress_of(stresses[number][:, 0], moment)[:, None]
    return replace(point, stress=tuple(stresses))
