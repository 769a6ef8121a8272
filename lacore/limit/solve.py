"""`solve`: from a problem to its limit state."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import closing
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from lacore.arrays import Floats
from lacore.assembly.discretisation import Discretisation
from lacore.assembly.discretise import discretise
from lacore.assembly.sticking import opening
from lacore.backend import find_backend, read_options
from lacore.bodies.continuum.body_forces import linear
from lacore.bodies.continuum.spaces import SPACES
from lacore.certificate import certify
from lacore.claims.judged import CLAIMED, judged_claim
from lacore.coupling.bounds import kinematic_load_factor
from lacore.coupling.kinds import COUPLINGS
from lacore.coupling.nearby import Nearby
from lacore.coupling.run import Coupled, CouplingOptions, Iterate, Run, answered_by
from lacore.errors import SolveError, typed
from lacore.inner.preparing import preparing, rough
from lacore.inner.rescaling import good_for
from lacore.limit import cells
from lacore.limit.conversion import point_in_si, ray_in_si
from lacore.limit.driven_corners import driven_corners
from lacore.limit.engines import engine_for, stated
from lacore.limit.hinging import ROUNDS, excess, hinged
from lacore.limit.reached import reached_supports
from lacore.limit.stability import warning
from lacore.limit.state import LimitState
from lacore.problem.problem import Problem
from lacore.program import (
    KinematicProgram,
    Scales,
    associated_contact,
    frictionless_contact,
)
from lacore.regularization import RegularisedValues
from lacore.reporting.findings import Finding, Severity
from lacore.reporting.kinds import Kind
from lacore.solvers.compilation import SolveClock
from lacore.solvers.isolation import SolverProcess, make_ready
from lacore.solvers.registry import JUDGE
from lacore.status import Rigor, Scope, Status

TOLERANCE = 1e-6
ACCEPTED = 5e-5  # of soils whose flow is not associated: of the power turned over (T53, T58)
SOLVES_IN_SPACE = 300  # of the loops: domes and vaults need ten times what walls do
_HINGED = 1e-3  # excess of moments in regularised states, whose hinges are no sharper
_MOVING = (Status.SOLVED, Status.FREE)  # claims that a mechanism makes


@typed()
def solve(
    problem: Problem | Discretisation,
    backend: str = "auto",
    coupling: str | None = None,
    *,
    start: str = "associated",
    damping: float = 0.7,
    anderson: int = 10,
    tolerance: float | None = None,
    max_iterations: int | None = None,
    kappa: float = 0.5,
    options: Mapping[str, Any] | None = None,
    on_iterate: Callable[[Iterate], None] | None = None,
    throw: bool = False,
    process: SolverProcess | None = None,
    pressed: Floats | None = None,
    slip: Floats | None = None,
) -> LimitState:
    """Collapse load and mechanism of a problem.

    Args:
        problem: the problem, or its discretisation where several backends share it.
        backend: a name from `lacore.backend_names()`.
        coupling: a loop for Coulomb friction, ``certified`` (the default, T12), ``reaction`` (T9;
            the default and only one of regularised backends), ``shift`` (T10) or ``kappa`` (T11);
            or one solve of another problem: ``associated``, friction made associated, or ``stick``,
            no slip, both upper bounds of every Coulomb load factor, or ``frictionless``, a lower
            one (T14); of those of the discrete problem, where bodies deform; or ``davis``,
            associated flow with Davis's reduced strength of soils (T55), no bound of anything.
        start: of the other loops, reactions: ``associated`` ones (T14), or ``zero``.
        damping: of these, share of the new reactions in the next ones, above 0, at most 1.
        anderson: of these, depth of Anderson's acceleration, 0 for none.
        kappa: of ``kappa``, from 0, which is ``reaction``, to 1, which is ``shift``.
        tolerance: bar for the residuals of the certificate, of all loops; None: 1e-6, and of soils
            whose flow is not associated 5e-5 where that is not reached soon (T58).
        max_iterations: of all loops; None: 100, and 300 of blocks in space, which need more (T74).
        options: of the backend, by name.
        on_iterate: called after each inner solve, for progress.
        throw: raise `SolveError` unless the status is SOLVED; else return the state as it is.
        process: Let the backend work in this process, which survives neither hanging nor crashing
            of it, but everything else does. Without it, a backend of another package, and one
            that asks for isolation, works in a process that is kept for it; any other works here.
        pressed: normal reactions at the contact points of a state nearby, Pa, within a step of a
            path: its ``certified`` loop begins there. What is certified does not depend on it.
        slip: slip rates there, m/s at ``F0.u = 1``, of a state that is less near, as of the step
            before: the rough solves that find reactions begin with them.

    Raises:
        InputError: an unknown name or an option out of range, before any solve.
        CapabilityError: the backend is missing, or cannot take the problem.
        SolveError: see `throw`.

    Example:
        >>> state = la.solve(la.examples.column(friction=0.3))
        >>> state.status.name, round(state.load_factor, 3)
        ('SOLVED', 0.3)
    """
    accepted = ACCEPTED if tolerance is None else None
    tolerance = TOLERANCE if tolerance is None else tolerance
    given = problem.problem if isinstance(problem, Discretisation) else problem
    if max_iterations is None:
        in_space = given.dimension == 3
        max_iterations = SOLVES_IN_SPACE if in_space else CouplingOptions.max_iterations
    coupling_options = CouplingOptions(
        start, damping, anderson, tolerance, max_iterations, kappa, accepted
    )
    asked = partial(
        _solved,
        backend=backend,
        coupling=coupling,
        coupling_options=coupling_options,
        options=options,
        on_iterate=on_iterate,
        process=process,
        near=Nearby(pressed, slip),
    )
    state = asked(problem)
    bar = _HINGED if state.rigor is Rigor.REGULARISED else tolerance
    for _ in range(ROUNDS):
        if state.status is not Status.SOLVED or excess(state) <= bar:
            break
        last, finer = state, hinged(state, given, bar)
        state = asked(finer)
        times = ("build_time", "solve_time", "compile_time")
        state = replace(state, **{own: getattr(last, own) + getattr(state, own) for own in times})
    if state.status is Status.SOLVED and excess(state) > bar:
        why = Finding(Kind.MOMENTS_INSIDE, (), {"excess": excess(state)}, Severity.REASON)
        state = replace(
            state,
            status=Status.NOT_CERTIFIED,
            load_factor=np.nan,
            rigor=Rigor.NOT_CERTIFIED,
            findings=(why,),
        )
    if throw and state.status is not Status.SOLVED:
        raise SolveError(state.message, state)
    return state


def _solved(
    problem: Problem | Discretisation,
    backend: str,
    coupling: str | None,
    coupling_options: CouplingOptions,
    options: Mapping[str, Any] | None,
    on_iterate: Callable[[Iterate], None] | None,
    process: SolverProcess | None,
    near: Nearby,
) -> LimitState:
    """The state with hinges at the nodes that there are."""
    asked = coupling
    engine, coupling, engine_options = engine_for(backend, coupling, options or {}, process)
    begin = time.perf_counter()
    if not isinstance(problem, Discretisation):
        problem = discretise(problem)
    program = stated(problem, engine, coupling, asked)
    near = near.within(program)
    if not program.frictional:
        coupling_options = replace(coupling_options, accepted=None)
    build_time, clock = time.perf_counter() - begin, SolveClock()
    make_ready(engine)
    regularised = engine.capabilities.regularised
    prepare = preparing(engine, engine_options, good_for(coupling_options.tolerance))
    loose = rough(engine, engine_options)
    with closing(prepare(program.associated())) as solver:
        run = Run(
            program,
            solver,
            regularised,
            coupling_options,
            on_iterate or (lambda _: None),
            prepare,
            roughly=lambda own: engine.prepare(own, loose),
            near=near,
            time_limit=engine_options.time_limit,
        )
        coupled = COUPLINGS[coupling].run(run)
    tolerance, ray = coupled.tolerance, None
    if coupled.status in CLAIMED:
        judge = find_backend(JUDGE) if regularised else engine
        settings = read_options(judge, {}) if regularised else engine_options
        prepare = preparing(judge, settings)
        status, why, ray = judged_claim(
            coupled.status,
            program,
            coupled.laws or frictionless_contact(program.contact),
            coupled.laws or associated_contact(program.contact),
            prepare,
            tolerance,
        )
        coupled = replace(coupled, status=status, findings=(why,) if why else ())
    state = limit_state(
        problem,
        program,
        coupled,
        backend=backend,
        coupling=coupling,
        regularised=regularised,
        build_time=build_time,
        options=options or {},
        tolerance=tolerance,
    )
    if state.status is Status.UNSAFE and program.homogeneous:
        state = _falling(state)
    if ray is not None and state.status is coupled.status:
        ray = ray_in_si(program.scales, ray, point_in_si(problem, ray.point))
        state = replace(state, ray=ray)
    return replace(state, solve_time=clock.seconds, compile_time=clock.compile_time)


def _falling(state: LimitState) -> LimitState:
    """An unsafe state with the mechanism that falls, unless it drives corners together."""
    state = replace(state, point=state.stability().point)
    moved = None if state.point is None else state.point.velocity
    corners = driven_corners(state.discretisation, moved, state.tolerance)
    if not corners:
        return state
    return replace(state, status=Status.NOT_CERTIFIED, findings=(corners, *state.findings))


def limit_state(
    discretisation: Discretisation,
    program: KinematicProgram,
    coupled: Coupled,
    *,
    backend: str,
    coupling: str,
    regularised: bool,
    build_time: float,
    options: Mapping[str, Any],
    tolerance: float,
) -> LimitState:
    """The end of a loop on a dimensionless program as a state of its problem, in SI units.

    Its `solve_time` is NaN: the solve has not ended yet.
    """
    final, scales = coupled.final, program.scales
    inner, point, certificate = final.inner, final.state, final.certificate
    corners = reached = None
    if coupled.status in _MOVING:
        moved = None if point is None else discretisation.free_basis @ point.velocity
        corners = driven_corners(discretisation, moved, tolerance)
        reached = reached_supports(discretisation, moved)
    if corners:
        coupled = replace(coupled, status=Status.NOT_CERTIFIED)
    load_factor = np.inf if coupled.status is Status.LOCKED else np.nan
    bound = coupled.laws is not None or program.associated_flow
    if bound and point is not None and certificate is not None and not regularised:
        # Of a Coulomb state the static value is reported, with which equilibrium holds.
        point = replace(point, load_factor=kinematic_load_factor(program, point, coupled.laws))
        # The gap stays that between the two values; everything else must hold for the reported one.
        certificate = replace(certify(program, point, coupled.laws), gap=certificate.gap)
    if point is not None and coupled.status is Status.SOLVED:
        load_factor = point.load_factor * scales.load_factor
    history = pd.DataFrame([iterate.row() for iterate in coupled.iterates])
    history["load_factor"] *= scales.load_factor
    bracket = None
    if coupled.bracket is not None:
        lower, upper = (end * scales.load_factor for end in coupled.bracket)
        if driven_corners(discretisation, None, tolerance):  # contact there may carry more
            upper = np.inf
        bracket = (lower, upper)
    rigor = _rigor(discretisation, coupled.status, coupling, regularised)
    findings = (
        corners,
        *_scope(discretisation, program, coupled, rigor, bracket),
        reached,
        opening(discretisation.problem, coupled.status),
        warning(coupled, load_factor),
        cells.fall_of_cells(discretisation.problem, coupled.status),
        *coupled.findings,
        Finding(Kind.BACKEND, (), {"text": inner.message}) if inner.message else None,
    )
    return LimitState(
        status=coupled.status,
        load_factor=float(load_factor),
        rigor=rigor,
        backend=backend,
        coupling=coupling,
        certificate=certificate,
        contraction=coupled.contraction,
        bracket=bracket,
        regularised=_in_si(inner.regularised, scales),
        history=history,
        build_time=build_time,
        solve_time=np.nan,
        options=dict(options),
        tolerance=tolerance,
        findings=tuple(own for own in findings if own is not None),
        discretisation=discretisation,
        point=None if point is None else point_in_si(discretisation, point),
        answered_by=answered_by(coupled, backend),
    )


def _scope(
    discretisation: Discretisation,
    program: KinematicProgram,
    coupled: Coupled,
    rigor: Rigor,
    bracket: tuple[float, float] | None,
) -> Iterator[Finding]:
    """Yield what is proven, and of which problem."""
    inner, solved = coupled.final.inner, coupled.status is Status.SOLVED
    if solved and inner.status is not Status.SOLVED:
        yield Finding(Kind.NATIVE_STATUS, values={"native": inner.native_status})
    if bracket is not None:
        discrete = discretisation.scope is Scope.DISCRETE
        kind = Kind.BRACKET_OF_MESH if discrete else Kind.BRACKET
        yield Finding(kind, values={"lower": float(bracket[0]), "upper": float(bracket[1])})
    bodies = [dofs.body for dofs in discretisation.continua.values()]
    if rigor is Rigor.DISCRETE and any(body.geometry != "exact" for body in bodies):
        yield Finding(Kind.POLYGON, severity=Severity.WARNING)
    if program.frictional and solved:
        yield Finding(Kind.OTHER_LOAD_FACTORS, severity=Severity.WARNING)
    if coupled.status is Status.LOCKED and discretisation.continua:
        yield Finding(Kind.LOCKED_ON_MESH)
    if solved and discretisation.shared_corners.any():
        yield Finding(Kind.SHARED_CORNERS, severity=Severity.WARNING)


def _rigor(
    discretisation: Discretisation, status: Status, coupling: str, regularised: bool
) -> Rigor:
    if status is not Status.SOLVED:
        return Rigor.NOT_CERTIFIED
    if regularised:
        return Rigor.REGULARISED
    normal = COUPLINGS[coupling].bounds == "upper" or discretisation.full.associated_flow
    return Rigor.UPPER if strict_bound(discretisation) and normal else Rigor.DISCRETE


def strict_bound(discretisation: Discretisation) -> bool:
    """Whether dissipation is nowhere below that of the continuum, and the power of loads exact."""
    bodies = {name: dofs.body for name, dofs in discretisation.continua.items()}
    loads = [load for load in discretisation.problem.loads.values() if load.body in bodies]
    return (
        not cells.from_below(discretisation.problem)
        and all(
            SPACES[own.space].strict and own.geometry == "exact" and own.bounded
            for own in bodies.values()
        )
        and all(linear(load, bodies[load.body]) for load in loads)
    )


def _in_si(values: RegularisedValues | None, scales: Scales) -> RegularisedValues | None:
    if values is None:
        return None
    return RegularisedValues(
        *(
            value * scales.load_factor
            for value in (values.plastic, values.alpha_reg, values.load_factor, values.multiplier)
        )
    )
