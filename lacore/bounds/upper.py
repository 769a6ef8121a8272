"""Strict upper bounds from velocities that are admissible to round-off (T15b, T22, T26c)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.sparse.linalg import lsqr

from lacore.assembly.discretisation import Discretisation
from lacore.bounds.constants import EDGE_PARTS, INSIDE_RESIDUAL, RIGID_STRAIN
from lacore.bounds.enclosing import (
    require_associated_flow,
    require_chords,
    require_known_fields,
)
from lacore.bounds.possible import possible_velocity
from lacore.bounds.precision import exactness
from lacore.bounds.velocity_projection import admissible_velocity
from lacore.coupling.claims.proving import Ray
from lacore.limit.conversion import point_in_program
from lacore.limit.judges.driven_corners import driven_corners
from lacore.limit.judges.reached import reached_supports
from lacore.limit.solve import solve
from lacore.limit.state import LimitState
from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.regions.gathering import (
    by_body,
    element_sums,
    gathered,
    region_count,
)
from lacore.model.bodies.continuum.regions.lattices import on_lattice
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Bools, Floats
from lacore.program.certificate import Certificate
from lacore.program.kinematic import (
    DissipationGroup,
    KinematicProgram,
    associated_contact,
    dimensionless,
    require_homogeneous,
)
from lacore.program.reduction import reduced
from lacore.program.state import ProgramState
from lacore.reporting import terms
from lacore.reporting.errors import InputError, typed
from lacore.reporting.findings import Finding, Severity
from lacore.reporting.kinds import Kind
from lacore.reporting.showing import Facts, Picture
from lacore.reporting.status import Reported, Rigor, Status
from lacore.reporting.text import PYTHON, number, text
from lacore.solvers.inner.preparing import preparer_named
from lacore.solvers.inner.rigid_motions import motions_without_strain

_BOUNDED = "ask for the bound of a problem, or of a state of lacore.solve"


@dataclass(frozen=True, repr=False)
class UpperBound(Reported):
    """A kinematically admissible velocity, and the load factor that it proves.

    Attributes:
        status: SOLVED if the velocity is admissible, optimal or not; else the status of the solve.
        load_factor: alpha, no smaller than that of the continuum where `rigor` says so; NaN unless
            SOLVED, or +inf where LOCKED.
        rigor: what the load factor proves.
        divergence: volume change, ``sum w |theta|``, per largest velocity and body length; at most
            1e-12, or the precision of coordinates far from the origin, where SOLVED.
        penetration: recomputed as in `Certificate`; at most the same.
        velocity: all unknowns, m/s at ``F0.u = 1``, shape (n,).
        dissipation: plastic power of each element by continuum, shape (elements,), in the unit of
            load factors; half of that of a velocity jump on either side, all of it at a boundary.
        state: the solve that it was made from; its load factor is that of the vertex rule.
        findings: further findings; `message` is their text.
    """

    status: Status
    load_factor: float
    rigor: Rigor
    divergence: float
    penetration: float
    velocity: Floats
    dissipation: Mapping[str, Floats]
    state: LimitState
    findings: tuple[Finding, ...]

    @property
    def discretisation(self) -> Discretisation:
        """The assembled problem."""
        return self.state.discretisation

    @property
    def ray(self) -> Ray | None:
        """Proof that the problem of `state` is LOCKED or UNSAFE: see `LimitState`."""
        return self.state.ray

    @property
    def lost(self) -> float:
        """Increase of the load factor when the solver's velocity is made admissible.

        A finer rule for the dissipation reduces it; NaN if either is missing.
        """
        point = self.state.point
        return np.nan if point is None else self.load_factor - point.load_factor

    def facts(self) -> Facts:
        """Return the proven load factor and its residuals, for printing."""
        told = {
            "status": self.report.summary_for(PYTHON),
            "residual": f"divergence {self.divergence:.1e}, penetration {self.penetration:.1e}",
            "solved by": f"{self.state.backend} in {self.state.solve_time:.3g} s,"
            f" after {self.state.build_time:.3g} s of assembly",
            "size": self.discretisation.contents,
        }
        size = number(self.load_factor, ".7g")
        return Facts(f"UpperBound: load factor {size}, {self.rigor.value}", told)

    def picture(self) -> Picture:
        """Return the picture of the solve."""
        drawn = self.state.picture()
        return Picture(drawn.figure, drawn.caption or "the solve that the bound was made of")


@typed()
def upper_bound(
    problem: Problem | Discretisation | LimitState,
    backend: str = "auto",
    *,
    options: Mapping[str, Any] | None = None,
    throw: bool = False,
) -> UpperBound:
    """Compute a strict upper bound of the load factor, with the velocity that proves it.

    The solver's velocity is projected onto the admissible ones, and its dissipation is integrated
    again: on a lattice in each element the vertex rule of T22 is still above the integral of the
    convex dissipation, and much closer. Velocities of ``p2-gauss`` therefore have strict bounds as
    well, and often closer ones than those of ``p2-vertex``, because their objective is closer to
    the bound. Unlike a lower bound, it needs no `lent_cohesion`: velocities are admissible in
    bodies without cohesion or tension as well, and a lent strength would only raise the bound.

    Args:
        problem: the problem, its discretisation, or a state found before.
        backend, options, throw: see `lacore.solve`; unused with a state.

    Raises:
        InputError: Coulomb friction, which has no bounds; a state within a step of a path with
            hardening or a closing distance; pressure-dependent strength in a velocity space that is
            not strict by itself; anything that `lacore.solve` rejects.
        SolveError: see `throw`.

    Example:
        >>> bound = la.upper_bound(la.examples.footing())
        >>> bound.rigor.name, round(bound.load_factor, 2)  # exact: 2 + pi
        ('UPPER', 5.84)
    """
    if isinstance(problem, LimitState | Discretisation):
        stated = problem.discretisation if isinstance(problem, LimitState) else problem
        require_homogeneous(stated.program, "problem", _BOUNDED)
        given = stated.problem
    else:
        given = problem
    require_associated_flow(of_kind(given.bodies, Body))
    if isinstance(problem, LimitState):
        state = problem
    else:
        state = solve(problem, backend, "associated", options=options, throw=throw)
    discretisation = state.discretisation
    if discretisation.full.contact.coulomb.any():
        raise InputError(
            "Problem.interfaces",
            state.coupling,
            "Coulomb friction is not associated, and the bound theorems do not hold with it",
            text(
                "give {}; `solve` with coupling='associated' has an upper bound of every Coulomb"
                " load factor",
                terms.ASSOCIATED,
            ),
        )
    require_known_fields(given)
    require_chords(given)
    for name, dofs in discretisation.continua.items():
        if dofs.body.pressure_dependent and not dofs.space.strict:
            raise InputError(
                f"Problem.bodies[{name!r}].space",
                dofs.body.space,
                "what flows as it can at interior points may not do so in their corners",
                "take 'p2-vertex', 'p2-disc' or 'p1-disc'; `bracket` does by itself",
            )
    judged = state.status.has_point or state.status is Status.NOT_CERTIFIED
    if state.point is None or not judged:
        return _unbounded(state)
    program = dimensionless(discretisation.program, discretisation.natural)
    point = point_in_program(discretisation, state.point)
    candidates = _candidates(state, program, point.velocity)
    bounds = [
        _bound(state, program, replace(point, velocity=velocity), rigid)
        for velocity, rigid in candidates
    ]
    bound = min(bounds, key=lambda one: one.load_factor if one.status is Status.SOLVED else np.inf)
    return bound.checked(throw)


def _candidates(
    state: LimitState, program: KinematicProgram, velocity: Floats
) -> list[tuple[Floats, Bools]]:
    """Return admissible velocities near one, shape (n,), and which groups are rigid in them."""
    none = np.zeros(len(program.groups), dtype=bool)
    if not program.pressure_dependent:
        nearest = (admissible_velocity(program, velocity), none)
        return [nearest, *_without_noise(program, velocity, admissible_velocity)]
    prepare = preparer_named(state.backend, state.options, good=INSIDE_RESIDUAL)

    def possible(stated: KinematicProgram, motion: Floats) -> Floats:
        return possible_velocity(stated, motion, prepare)

    nearest = (possible(program, velocity), none)
    return [nearest, *_without_noise(program, velocity, possible)]


def _without_noise(
    program: KinematicProgram,
    velocity: Floats,
    admissible: Callable[[KinematicProgram, Floats], Floats],
) -> list[tuple[Floats, Bools]]:
    """Return the admissible velocity with almost unstrained groups rigid; none if all strain.

    A body far stronger than the rest would dissipate power in strains that are only noise, and in
    soils noise is not admissible flow.

    Returns:
        The velocity, shape (n,), and which groups are rigid.
    """
    fastest = np.abs(velocity).max()
    still = np.zeros(len(program.groups), dtype=bool)
    for at, group in enumerate(program.groups):
        most = np.linalg.norm(group.cone_vectors(velocity), axis=1).max(initial=0.0)
        term = np.abs(group.rows.data).max(initial=0.0) * fastest
        still[at] = most <= RIGID_STRAIN * term
    resting = [group for group, rests in zip(program.groups, still, strict=True) if rests]
    strained = [group for group, rests in zip(program.groups, still, strict=True) if not rests]
    if not any(group.weights.size for group in resting):
        return []
    basis = motions_without_strain(resting)
    if not basis.shape[1]:  # All moving parts strain as little as noise, so this is the motion.
        return []
    rigid = reduced(replace(program, groups=tuple(strained)), basis)
    motion = lsqr(basis, velocity, atol=0.0, btol=0.0)[0]
    return [(np.asarray(basis @ admissible(rigid, motion)), still)]


def _bound(
    state: LimitState, program: KinematicProgram, point: ProgramState, rigid: Bools
) -> UpperBound:
    """Return the bound of an admissible velocity.

    Args:
        state: the state that it was made from.
        program, point: dimensionless program and point.
        rigid: groups that move as rigid bodies, whose strains must be round-off.
    """
    discretisation = state.discretisation
    velocity = discretisation.free_basis @ point.velocity * discretisation.natural.velocity
    velocity /= float(discretisation.full.reference_load @ velocity)
    penetration = Certificate.of(program, point, associated_contact(program.contact)).penetration
    # With pressure-dependent strength flow is admissible or not: nothing is round-off, except that
    # of rigid parts.
    groups = zip(discretisation.full.groups, rigid, strict=True)
    soil = [(group, still) for group, still in groups if group.surfaces is not None]
    pressed = [group for group, still in soil if not still]
    beyond = sum(float(group.weights @ group.impossible(velocity)) for group in pressed)
    strain = _strain([group for group, still in soil if still], velocity)
    leak = _leak(program, point.velocity) + (beyond + strain) / float(np.abs(velocity).max())
    exact = exactness(d.body for d in discretisation.continua.values())
    corners = driven_corners(discretisation, velocity, state.tolerance)
    possible = beyond <= 0  # false for NaN
    proves = max(leak, penetration) <= exact and possible and not corners
    power = plastic_power(discretisation, velocity, EDGE_PARTS)
    if proves:
        reached = reached_supports(discretisation, velocity)
        findings: tuple[Finding, ...] = (reached,) if reached else ()
    else:
        leaks = {"leak": float(leak), "penetration": float(penetration)}
        why = corners or _impossible(discretisation, pressed, velocity)
        why = why or Finding(Kind.VELOCITY_NOT_ADMISSIBLE, (), leaks, Severity.REASON)
        findings = (why, Finding(Kind.SOLVE, values={"report": state.report}))
    return UpperBound(
        status=Status.SOLVED if proves else Status.NOT_CERTIFIED,
        load_factor=_load_factor(discretisation, velocity, power) if proves else np.nan,
        rigor=_rigor(discretisation) if proves else Rigor.NOT_CERTIFIED,
        divergence=leak,
        penetration=float(penetration),
        velocity=velocity,
        dissipation=power,
        state=state,
        findings=findings,
    )


def _leak(program: KinematicProgram, velocity: Floats) -> float:
    """Return the volume change of incompressible parts, by the largest velocity."""
    gained = sum(
        float(group.weights @ np.abs(group.volumetric @ velocity))
        for group in program.groups
        if group.surfaces is None
    )
    return gained / float(np.abs(velocity).max())


def _strain(groups: Sequence[DissipationGroup], velocity: Floats) -> float:
    """Return the integral of the strain rates of groups."""
    return sum(
        float(group.weights @ np.linalg.norm(group.cone_vectors(velocity), axis=1))
        for group in groups
    )


def _rigor(discretisation: Discretisation) -> Rigor:
    """Return what an admissible velocity proves: for the continuum only if edges are straight."""
    inside = any("inner" in one.body.polygons for one in discretisation.frames.values())
    strict = all(
        one.linear and one.body.geometry == "exact" for one in discretisation.continua.values()
    )
    return Rigor.UPPER if strict and not inside else Rigor.DISCRETE


def _load_factor(
    discretisation: Discretisation, velocity: Floats, power: Mapping[str, Floats]
) -> float:
    """Return the dissipated power minus that of the dead load (T5)."""
    full = discretisation.full
    hinges = full.groups[region_count(discretisation.continua) + len(discretisation.jumping) :]
    return (
        sum(float(part.sum()) for part in power.values())
        + sum(float(group.dissipation(velocity).sum()) for group in hinges)
        + full.friction_dissipation(velocity, full.contact.limit)
        - float(full.dead_load @ velocity)
    )


def _impossible(
    stated: Discretisation, pressed: Sequence[DissipationGroup], velocity: Floats
) -> Finding | None:
    """Return the soil whose flow is inadmissible, and by how much; None if there is none."""
    fastest = max(np.abs(g.cone_vectors(velocity)).max(initial=0.0) for g in stated.full.groups)
    most = {group.name: group.impossible(velocity).max(initial=0.0) for group in pressed}
    beyond = {name: float(size / fastest) for name, size in most.items() if not size <= 0}
    if not beyond:
        return None
    regions = tuple(
        Finding(Kind.REGION_BEYOND, (name,), {"size": size}) for name, size in beyond.items()
    )
    jumps = any(dofs.space.jumps for dofs in stated.continua.values())
    advice = ", or take 'p2-vertex', whose velocities do not jump" if jumps else ""
    values = {"regions": regions, "space": advice}
    return Finding(Kind.FLOW_NOT_POSSIBLE, tuple(beyond), values, Severity.REASON)


def _unbounded(state: LimitState) -> UpperBound:
    return UpperBound(
        status=state.status,
        load_factor=state.load_factor,
        rigor=Rigor.NOT_CERTIFIED,
        divergence=np.nan,
        penetration=np.nan,
        velocity=np.full(state.discretisation.full.n, np.nan),
        dissipation={},
        state=state,
        findings=state.findings,
    )


def plastic_power(
    discretisation: Discretisation, velocity: Floats, parts: int
) -> dict[str, Floats]:
    """Return the plastic power of elements by continuum, with that of jumps half to either side.

    Args:
        discretisation: the problem.
        velocity: velocity of all unknowns.
        parts: number of parts of each edge: on their lattice the vertex rule is above the integral
            of the convex dissipation. 1 is the rule of the program with any strain points.
    """
    power = {}
    for name, dofs, groups in by_body(discretisation.continua, discretisation.full.groups):
        if parts > 1 and dofs.linear:
            regions = zip(dofs.body.regions, groups, strict=True)
            own = [on_lattice(region, g, velocity, dofs.space, parts) for region, g in regions]
            power[name] = gathered(dofs.body, own)
        else:
            power[name] = element_sums(dofs.body, [g.dissipation(velocity) for g in groups])
    for jumps in discretisation.jumping:
        elements, along = jumps.power(velocity, parts)
        for name, side in zip(jumps.bodies, elements, strict=True):
            np.add.at(power[name], side, along / 2)
    return power
