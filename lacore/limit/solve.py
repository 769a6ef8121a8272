"""`solve`: from a problem to its limit state."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import pandas as pd

from lacore.assembly.discretisation import Discretisation
from lacore.coupling.friction_start import FrictionStart
from lacore.coupling.options import CouplingOptions
from lacore.coupling.run import Iterate, answered_by
from lacore.limit.constants import ACCEPTED, SOLVES_IN_SPACE, TOLERANCE
from lacore.limit.conversion import point_in_si, ray_in_si
from lacore.limit.hinging import with_hinges
from lacore.limit.judges.judging import judged
from lacore.limit.outcome import Outcome
from lacore.limit.proving import Request, proven_outcome
from lacore.limit.state import LimitState
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats
from lacore.program.kinematic import Scales
from lacore.program.regularization import RegularisedValues
from lacore.reporting.errors import renamed_argument, typed
from lacore.reporting.status import Status
from lacore.solvers.isolation import SolverProcess


@renamed_argument("pressed", "normal_reaction")
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
    options: Mapping[str, Any] | None = None,
    on_iterate: Callable[[Iterate], None] | None = None,
    throw: bool = False,
    process: SolverProcess | None = None,
    normal_reaction: Floats | None = None,
    slip: Floats | None = None,
) -> LimitState:
    """Compute the collapse load and the mechanism of a problem.

    Args:
        problem: The problem, or its discretisation if several backends share it.
        backend: A name from `lacore.backend_names()`.
        coupling: A loop for Coulomb friction: ``certified`` (the default, T12), ``reaction`` (T9;
            the default and the only loop of regularised backends) or ``shift`` (T10). Or one solve
            of another problem: ``associated`` (associated friction) or ``stick`` (no slip), both
            upper bounds of every Coulomb load factor, or ``frictionless``, a lower bound (T14).
            With deformable bodies these are bounds for the discrete problem. Or ``davis``,
            associated flow with Davis's reduced strength of soils (T55), which is not a bound.
        start: First reactions of ``reaction`` and ``shift``: ``associated`` (T14) or ``zero``.
        damping: Share of the new reactions in the next ones of these loops, above 0, at most 1.
        anderson: Depth of Anderson acceleration of these loops, 0 for none.
        tolerance: Tolerance for the residuals of the certificate, for all loops. None: 1e-6, or
            5e-5 for soils with non-associated flow if 1e-6 is not reached soon (T58).
        max_iterations: Largest number of solves of a loop. None: 100, or 300 for three-dimensional
            blocks, which need more (T74).
        options: Options of the backend, by name.
        on_iterate: Function that is called after each inner solve, for progress.
        throw: Raise `SolveError` unless the status is SOLVED; else return the state as it is.
        process: Process in which the backend works. If the backend hangs or crashes, only this
            process ends. Without it, a backend of another package, and one that requests
            isolation, works in a process that is kept for it; any other works in this process.
        normal_reaction: Normal reactions, Pa, of another state of the same step of a path, at which
            the ``certified`` loop starts. The certificate does not depend on it.
        slip: Slip rates, m/s at ``F0.u = 1``, of the step before, at which the rough solves for
            these reactions start.

    Raises:
        InputError: A name is unknown or an option is out of range.
        CapabilityError: The backend is missing, or does not support the problem.
        SolveError: See `throw`.

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
    loop = CouplingOptions(start, damping, anderson, tolerance, max_iterations, accepted)
    request = Request(
        backend=backend,
        coupling=coupling,
        loop=loop,
        options=options or {},
        on_iterate=on_iterate or (lambda _: None),
        process=process,
        friction_start=FrictionStart(normal_reaction, slip),
    )
    outcome = with_hinges(
        given, problem, lambda own, earlier: proven_outcome(own, request, earlier)
    )
    return limit_state(outcome, backend, options or {}).checked(throw)


def limit_state(
    outcome: Outcome, backend: str, options: Mapping[str, Any], load_factor: float | None = None
) -> LimitState:
    """Judge an outcome and build its state: the only place where states of a problem are built.

    Args:
        outcome: What was found, and what is proven of it.
        backend: Name of the backend.
        options: Of the backend, as they were given.
        load_factor: Reported in place of that of the point, where the status is SOLVED.
    """
    status, findings = judged(outcome)
    coupled, scales, ray = outcome.coupled, outcome.program.scales, None
    if outcome.ray is not None and status is outcome.status:
        point = point_in_si(outcome.discretisation, outcome.ray.point)
        ray = ray_in_si(scales, outcome.ray, point)
    history = pd.DataFrame([iterate.row() for iterate in coupled.iterates])
    history["load_factor"] *= scales.load_factor
    if load_factor is None or status is not Status.SOLVED:
        load_factor = outcome.load_factor(status)
    return LimitState(
        status=status,
        load_factor=float(load_factor),
        rigor=outcome.rigor(status),
        backend=backend,
        coupling=outcome.coupling,
        certificate=outcome.certificate,
        contraction=coupled.contraction,
        bracket=outcome.bracket,
        regularised=_in_si(coupled.final.inner.regularised, scales),
        history=history,
        build_time=outcome.times.build,
        solve_time=outcome.times.solve,
        compile_time=outcome.times.compile,
        options=dict(options),
        tolerance=coupled.tolerance,
        findings=findings,
        discretisation=outcome.discretisation,
        point=outcome.point,
        ray=ray,
        carried=outcome.carried if status is Status.SOLVED else None,
        answered_by=answered_by(coupled, backend),
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
