"""Options, inner solves and certificates that all coupling loops share.

Only the loops (`lacore.coupling.fixed_point`, `lacore.coupling.certified`) iterate on contact
reactions (T9-T13). With an exact backend a loop stops when the recomputed residuals of the Coulomb
problem (`lacore.program.certificate`) are within the tolerance. The residuals of a regularised
backend never vanish, so its loop stops when the friction bounds of a solve agree with the reactions
that it returns.
"""

import time
from collections.abc import Callable, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np

from lacore.coupling.constants import NO_CHANGE, PENALTY_SHARE
from lacore.coupling.friction_start import FrictionStart
from lacore.coupling.options import CouplingOptions
from lacore.numerics.arrays import Floats
from lacore.program.certificate import Certificate
from lacore.program.free_motion import NO_POWER, without_dissipation
from lacore.program.kinematic import FrozenContact, KinematicProgram, reaction_contact
from lacore.program.residuals import impossible
from lacore.program.state import ProgramState
from lacore.reporting.findings import Finding
from lacore.reporting.showing import Compact
from lacore.reporting.status import Status
from lacore.solvers.backend import InnerSolution, Prepare, PreparedSolver, checked_answer

CENTRAL_PATH = "path"
"""Kind of the iterates that lacore computes itself, along a central path of rigid blocks."""
PATH_FOLLOWING = "lacore (path following)"
"""Name that results report in place of a backend for these iterates."""
_FINISHED = (Status.SOLVED, Status.ALMOST_SOLVED)


@dataclass(frozen=True, repr=False)
class Iterate(Compact):
    """One inner solve of a loop.

    Attributes:
        step: Number of the solve; 0 is the start.
        kind: Problem that was solved: ``associated``, ``reaction``, ``K``, ``S``, ...
        inner: Answer of the backend.
        state: State to which the certificate belongs. In loops that alternate it has the velocity
            of one solve and the stresses, reactions and load factor of another. None without a
            point.
        certificate: Residuals of `state` against the true friction laws.
        mismatch: Largest difference between the given friction bound and that of the returned
            reaction, divided by the largest reaction.
    """

    step: int
    kind: str
    inner: InnerSolution
    state: ProgramState | None
    certificate: Certificate | None
    mismatch: float

    def row(self) -> dict[str, Any]:
        """Return the row of the history, in the units of the program."""
        point = self.inner.point
        residuals = asdict(self.certificate) if self.certificate else {}
        return {
            "iteration": self.step,
            "kind": self.kind,
            "load_factor": np.nan if point is None else point.load_factor,
            "mismatch": self.mismatch,
            **residuals,
            "inner_status": self.inner.status.label,
            "native_status": self.inner.native_status,
            "inner_iterations": self.inner.iterations,
            "solve_time": self.inner.solve_time,
            "reported_time": self.inner.reported_time,
            "peak_memory": self.inner.peak_memory,
        }


@dataclass(frozen=True, repr=False)
class Coupled(Compact):
    """End of a coupling loop: its status and all inner solves.

    Attributes:
        status: Status of the loop.
        iterates: All inner solves.
        final: Iterate to which the status belongs. Its state is the answer if the status is SOLVED.
        laws: Frozen contact that the residuals of `final` refer to; None for the true friction
            laws.
        contraction: Last ratio by which the distance of two reactions (T9, T12) or slip rates
            (T10) changed in a step; NaN without such a ratio.
        bracket: Load factors that enclose every Coulomb load factor of the program (T14), for a
            loop that found no certified state.
        findings: Findings that the loop reports in addition to its status.
        tolerance: Tolerance for the residuals.
    """

    status: Status
    iterates: tuple[Iterate, ...]
    final: Iterate
    laws: FrozenContact | None = None
    contraction: float = float("nan")
    bracket: tuple[float, float] | None = None
    findings: tuple[Finding, ...] = ()
    tolerance: float = 1e-6


def answered_by(coupled: Coupled, backend: str) -> str:
    """Return the name of the solver that found the final state of a loop.

    It is the backend, path following by lacore, or both: the velocity of a pair comes from one
    solve and its reactions from another, and the solves may be by different solvers.

    Args:
        coupled: End of the loop.
        backend: Name of the backend that the loop was given.
    """
    state = coupled.final.state
    if state is None:
        return backend
    owners = {id(own.inner.point.velocity): own for own in coupled.iterates if own.inner.point}
    owners |= {
        id(own.inner.point.normal_reaction): own for own in coupled.iterates if own.inner.point
    }
    halves = (owners.get(id(half)) for half in (state.velocity, state.normal_reaction))
    names = [PATH_FOLLOWING if own and own.kind == CENTRAL_PATH else backend for own in halves]
    return " and ".join(dict.fromkeys(names))


def worst(iterate: Iterate) -> float:
    """Return the largest residual of an iterate; inf without a certificate."""
    if iterate.certificate is None:
        return float("inf")
    return float(np.nan_to_num(iterate.certificate.worst[1], nan=np.inf))


def paired(kinematic: ProgramState, static: ProgramState) -> ProgramState:
    """Return a velocity with the stresses, reactions and load factor of another state (T12)."""
    return replace(static, velocity=kinematic.velocity)


@dataclass
class Run:
    """The inner solves of one loop, each with its certificate.

    Attributes:
        program: Program to solve.
        solver: Solver that is prepared for it.
        regularised: Whether the backend is regularised.
        options: Options of the loop.
        on_iterate: Function that is called after each inner solve.
        prepare: Function that prepares the backend for another program.
        prepare_roughly: The same with a loose tolerance, for answers that only start other solves.
        iterates: Inner solves so far.
        rates: Rates of the fixed-point maps so far, see `mapped`.
        friction_start: Friction of another state, in the units of the program, at which the loop
            may start.
        time_limit: Time limit of an inner solve, s.
    """

    program: KinematicProgram
    solver: PreparedSolver
    regularised: bool
    options: CouplingOptions
    on_iterate: Callable[[Iterate], None]
    prepare: Prepare | None = None
    prepare_roughly: Prepare | None = None
    iterates: list[Iterate] = field(default_factory=list)
    rates: list[float] = field(default_factory=list)
    friction_start: FrictionStart = field(default_factory=FrictionStart)
    time_limit: float = np.inf
    _mapped: dict[str, tuple[Floats, Floats]] = field(default_factory=dict)

    def afresh(self, iterates: Sequence[Iterate] = ()) -> "Run":
        """Return a run of the same problem with its full budget and the given iterates only."""
        return replace(self, iterates=list(iterates), rates=[], _mapped={})

    def solve(
        self,
        kind: str,
        contact: FrozenContact,
        laws: FrozenContact | None = None,
        partner: Callable[[ProgramState], ProgramState] | None = None,
        program: KinematicProgram | None = None,
        solver: PreparedSolver | None = None,
    ) -> Iterate:
        """Solve for a frozen contact, certify the answer and record it.

        Args:
            kind: Kind of the iterate.
            contact: Frozen contact of the solve.
            laws: Contact laws of the certificate; None for the true friction laws.
            partner: Function that pairs the answer with another state. The pair replaces an answer
                whose own residuals exceed the tolerance.
            program: Program with other groups, which a velocity hardens (T29) or whose friction is
                frozen (T52); None for the program of the run.
            solver: Solver to use; None for that of the run, or for one prepared for `program`.
        """
        answer = self._answer(contact, program, solver)
        inner = checked_answer(self.program, self.regularised, answer)
        state, certificate, mismatch = inner.point, None, np.nan
        if state is not None:
            certificate = Certificate.of(self.program, state, laws)
            mismatch = self._mismatch(contact, state.normal_reaction) if laws is None else 0.0
            if partner is not None and not certificate.holds(self.options.tolerance):
                state = partner(state)
                certificate = Certificate.of(self.program, state, laws)
        iterate = Iterate(len(self.iterates), kind, inner, state, certificate, mismatch)
        self.iterates.append(iterate)
        self.on_iterate(iterate)
        return iterate

    def _answer(
        self,
        contact: FrozenContact,
        program: KinematicProgram | None,
        solver: PreparedSolver | None,
    ) -> InnerSolution:
        """Return the answer of a given solver, or of one that is prepared for the program."""
        if solver is not None:
            return solver.solve(contact)
        if program is None or program is self.program or self.prepare is None:
            return self.solver.solve(contact)
        with closing(self.prepare(program)) as prepared:
            return prepared.solve(contact)

    def _mismatch(self, contact: FrozenContact, normal_reaction: Floats) -> float:
        """Return the mismatch of an `Iterate`."""
        coulomb = self.program.contact.coulomb
        new = reaction_contact(self.program.contact, normal_reaction).bound[coulomb]
        largest = max(float(np.abs(normal_reaction).max(initial=0.0)), float(np.finfo(float).tiny))
        return float(np.abs(new - contact.bound[coulomb]).max(initial=0.0)) / largest

    @property
    def exhausted(self) -> bool:
        """Whether the budget of inner solves is spent."""
        return len(self.iterates) > self.options.max_iterations

    @property
    def contraction(self) -> float:
        """The last rate; NaN without one."""
        return self.rates[-1] if self.rates else float("nan")

    def mapped(self, kind: str, argument: Floats, image: Floats) -> None:
        """Record the image of an argument under a fixed-point map, and the rate of the map."""
        if kind in self._mapped:
            last_argument, last_image = self._mapped[kind]
            change = float(np.linalg.norm(argument - last_argument))
            if change > NO_CHANGE * float(np.linalg.norm(argument)):
                self.rates.append(float(np.linalg.norm(image - last_image)) / change)
        self._mapped[kind] = argument, image

    def proven(self, iterate: Iterate) -> bool:
        """Whether the residuals prove the iterate."""
        certificate, tolerance = iterate.certificate, self.options.tolerance
        if certificate is None or iterate.state is None:
            return False
        if not self.regularised:
            return certificate.holds(tolerance)
        # Equilibrium with the load factor P + 2 C proves a minimiser (T19). The violations that
        # penalties allow (divergence, penetration, flow, gap) are reported without a tolerance. But
        # their energy C, which bounds the error, must be small, as large dead loads raise it.
        values = iterate.inner.regularised
        assert values is not None
        dissipated = values.plastic + float(self.program.dead_load @ iterate.state.velocity)
        largest = max(abs(values.load_factor), dissipated)
        residuals = [
            certificate.equilibrium,
            certificate.yield_violation,
            certificate.normalisation,
            iterate.mismatch,
        ]
        if not np.isnan(values.multiplier):  # it equals P + 2 C at a minimiser (T19)
            residuals.append(abs(values.multiplier - values.load_factor) / max(largest, NO_POWER))
        meaningful = values.energy <= PENALTY_SHARE * largest
        return meaningful and all(value <= tolerance for value in residuals)

    def end(
        self,
        status: Status,
        final: Iterate | None = None,
        *,
        laws: FrozenContact | None = None,
        bracket: tuple[float, float] | None = None,
        findings: tuple[Finding, ...] = (),
    ) -> Coupled:
        """Return the end of the loop, at its last iterate unless another one is given."""
        final = final or self.iterates[-1]
        found = tuple(self.iterates), final, laws, self.contraction, bracket, findings
        return Coupled(status, *found, tolerance=self.options.tolerance)

    def relax_tolerance(self) -> bool:
        """Set the tolerance to the accepted one from now on; return whether there is one."""
        if self.options.accepted is None:
            return False
        self.options = replace(self.options, tolerance=self.options.accepted)
        return True

    def best_proven(self) -> Iterate | None:
        """Return the proven iterate with a load that has the least residual; None without one."""
        proven = [one for one in self.iterates if self.proven(one) and not self.free(one)]
        return min(proven, key=worst, default=None)

    def finish(
        self,
        iterate: Iterate,
        laws: FrozenContact | None = None,
        findings: tuple[Finding, ...] = (),
    ) -> Coupled:
        """End the loop at an iterate, with the status that its residuals prove."""
        status = iterate.inner.status
        if iterate.state is not None:
            if self.free(iterate, laws):
                status = Status.FREE
            elif self.proven(iterate):
                status = Status.SOLVED
            elif status in _FINISHED:
                status = Status.NOT_CERTIFIED
        return self.end(status, iterate, laws=laws, findings=findings)

    def free(self, iterate: Iterate, laws: FrozenContact | None = None) -> bool:
        """Whether an iterate is an admissible rigid motion without any power.

        The friction laws are the true ones, or `laws`. This is checked before the residuals: those
        relative to a power, and without dead loads those relative to the total load, are 0/0 here.
        A regularised body yields under dead loads, so the power of its dead loads is not zero, and
        only its load factor and its dissipation are checked.
        """
        state, certificate = iterate.state, iterate.certificate
        if state is None or certificate is None or iterate.inner.status is not Status.SOLVED:
            return False
        program, u, tolerance = self.program, state.velocity, self.options.tolerance
        values = iterate.inner.regularised
        if values is not None:
            dead_power = float(program.dead_load @ u)
            powers = [values.load_factor, values.plastic + dead_power]
            rigid = np.any(program.dead_load) or self._rigid(u)
            return (
                bool(rigid) and certificate.normalisation <= tolerance and _none(powers, NO_POWER)
            )
        frozen = laws or reaction_contact(program.contact, state.normal_reaction)
        # The divergence of soils is relative to a power, so it is 0/0 here as well.
        flow = impossible(program, state)
        admissible = [certificate.penetration, flow, certificate.normalisation]
        return _none(admissible, tolerance) and without_dissipation(
            program, state, frozen, tolerance
        )

    def _rigid(self, velocity: Floats) -> bool:
        """Whether strain rates are round-off compared with velocity over body length."""
        groups = self.program.groups
        length = np.sqrt(sum(float(group.weights.sum()) for group in groups))
        strain = max(
            (float(np.linalg.norm(group.cone_vectors(velocity), axis=1).max()) for group in groups),
            default=0.0,
        )
        return strain * float(length) <= self.options.tolerance * float(np.abs(velocity).max())


def _none(values: list[float], largest: float) -> bool:
    """Whether the absolute values are at most `largest`; false for NaN."""
    return all(abs(value) <= largest for value in values)


class OutOfTime(Exception):  # noqa: N818  # not an error: results found before remain
    """The time of a search is over."""


def until(end: float) -> Callable[[Iterate], None]:
    """Return a function to call after each inner solve.

    It raises `OutOfTime` at the first solve that ends after `end` (s, of `time.perf_counter`).
    """

    def check(_: Iterate) -> None:
        if time.perf_counter() >= end:
            raise OutOfTime

    return check
