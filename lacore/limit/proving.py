"""From a problem to its outcome: the loop of a coupling, and the proof of what it claims."""

import time
from collections.abc import Callable, Mapping
from contextlib import closing
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from lacore.assembly.discretisation import Discretisation
from lacore.assembly.discretise import discretise
from lacore.coupling.claims.proving import CLAIMED, prove_claim
from lacore.coupling.friction_start import FrictionStart
from lacore.coupling.kinds import COUPLINGS
from lacore.coupling.options import CouplingOptions
from lacore.coupling.run import Coupled, Iterate, Run
from lacore.limit.backend_choice import backend_for, program_to_solve
from lacore.limit.carried import carried_loads
from lacore.limit.constants import REGULARISED_EXCESS
from lacore.limit.outcome import Outcome, Proof, Times, outcome_of
from lacore.limit.stability import stability_of
from lacore.model.problem.problem import Problem
from lacore.program.kinematic import KinematicProgram, associated_contact, frictionless_contact
from lacore.reporting.showing import Compact
from lacore.reporting.status import Status
from lacore.solvers.backend import Prepare
from lacore.solvers.compilation import SolveClock
from lacore.solvers.inner.preparing import preparer, preparer_named, rough_options
from lacore.solvers.inner.rescaling import good_for
from lacore.solvers.isolation import SolverProcess, make_ready
from lacore.solvers.registry import PROVING_BACKEND


@dataclass(frozen=True, repr=False)
class Request(Compact):
    """How to solve; see `lacore.solve` for all fields but these.

    Attributes:
        coupling: Name; None for the default of the backend.
        loop: Options of the loop.
        friction_start: Friction at which the loop may start, in SI units.
    """

    backend: str
    coupling: str | None
    loop: CouplingOptions
    options: Mapping[str, Any]
    on_iterate: Callable[[Iterate], None]
    process: SolverProcess | None
    friction_start: FrictionStart


def proven_outcome(problem: Problem | Discretisation, request: Request, earlier: Times) -> Outcome:
    """Solve with hinges at the nodes that there are, and prove what the loop claims.

    The durations of the outcome include the earlier ones.
    """
    backend, coupling, options = backend_for(
        request.backend, request.coupling, request.options, request.process
    )
    begin = time.perf_counter()
    if not isinstance(problem, Discretisation):
        problem = discretise(problem)
    program = program_to_solve(problem, backend, coupling, request.coupling)
    start, loop = request.friction_start.within(program), request.loop
    if not program.frictional:
        loop = replace(loop, accepted=None)
    build_time, clock = time.perf_counter() - begin, SolveClock()
    make_ready(backend)
    regularised = backend.capabilities.regularised
    prepare = preparer(backend, options, good_for(loop.tolerance))
    loose = rough_options(backend, options)
    with closing(prepare(program.associated())) as solver:
        run = Run(
            program,
            solver,
            regularised,
            loop,
            request.on_iterate,
            prepare,
            prepare_roughly=lambda own: backend.prepare(own, loose),
            friction_start=start,
            time_limit=options.time_limit,
        )
        coupled = COUPLINGS[coupling].run(run)
    proof = None
    if coupled.status in CLAIMED:
        prove_with = (
            preparer_named(PROVING_BACKEND, {}) if regularised else preparer(backend, options)
        )
        proof = _proof(problem, program, coupled, coupling, prove_with, request)
    carried = None
    if not regularised:
        carried = carried_loads(problem, program, coupled, prepare)
    times = Times(build_time, clock.seconds, clock.compile_time)
    return outcome_of(
        problem,
        program,
        coupled,
        coupling,
        earlier.plus(times),
        regularised=regularised,
        proof=proof,
        allowed_excess=REGULARISED_EXCESS if regularised else request.loop.tolerance,
        carried=carried,
    )


def _proof(
    problem: Discretisation,
    program: KinematicProgram,
    coupled: Coupled,
    coupling: str,
    prepare: Prepare,
    request: Request,
) -> Proof:
    """Prove a claim that needs a solver: LOCKED by a ray, UNSAFE by a mechanism."""
    status, why, ray = prove_claim(
        coupled.status,
        program,
        coupled.laws or frictionless_contact(program.contact),
        coupled.laws or associated_contact(program.contact),
        prepare,
        coupled.tolerance,
    )
    falling = None
    if status is Status.UNSAFE and program.homogeneous:
        falling = stability_of(
            problem,
            request.backend,
            request.options,
            coupling,
            coupled.tolerance,
            load_factor=np.nan,  # none is proven to be carried
        ).point
    return Proof(status, (why,) if why else (), ray, falling)
