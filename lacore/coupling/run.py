"""What all coupling loops share: options, the inner solves as they come, and their judgement.

The loops (`lacore.coupling.fixed_point`, `lacore.coupling.certified`) are the only place that
iterates on contact reactions (T9-T13). Exact backends stop when the recomputed residuals of the
Coulomb problem (`lacore.program.certificate`) are within tolerance; regularised ones, whose
residuals never vanish, when the friction bounds that they were given are those of the reactions
that they return.
"""

from collections.abc import Callable
from contextlib import closing
from dataclasses import asdict, dataclass, field, replace
from numbers import Integral
from typing import Any

import numpy as np

from lacore.coupling.claims.free_motion import without_dissipation
from lacore.coupling.nearby import Nearby
from lacore.numerics.arrays import Floats
from lacore.program.certificate import Certificate, certify
from lacore.program.kinematic import FrozenContact, KinematicProgram, reaction_contact
from lacore.program.state import ProgramState
from lacore.reporting.errors import (
    InputError,
    is_number,
    require_count,
    require_known,
    require_positive,
)
from lacore.reporting.findings import Finding
from lacore.reporting.showing import Compact
from lacore.reporting.status import Status
from lacore.solvers.backend import InnerSolution, Prepare, PreparedSolver, checked_answer
from lacore.solvers.inner.left_over import impossible

STARTS = ("associated", "zero")
PATH = "path"
"""Kind of the iterates that lacore finds itself, by following a path of rigid blocks."""
PATH_FOLLOWING = "lacore (path following)"
"""What answered there, in results."""
_FINISHED = (Status.SOLVED, Status.ALMOST_SOLVED)
_PENALTY_SHARE = 0.1  # of the load factor; about 0.02 at r = 0.1 where they are as meant
_LOOSEST = 1e-3  # residual at which a state still deserves its name
_NO_POWER = 1e-7  # of stress * length * velocity: what interior-point round-off leaves of a zero
_NO_CHANGE = 1e-6  # relative: smaller changes of what is frozen say nothing of a rate


@dataclass(frozen=True, repr=False)
class CouplingOptions(Compact):
    """How to couple.

    Attributes:
        start: ``associated`` (reactions of the associated problem) or ``zero`` (the paper's).
        damping: share w of the new values in the next ones, 0 < w <= 1.
        anderson: depth of Anderson acceleration, 0 for none.
        tolerance: bar for the residuals of the certificate.
        max_iterations: of the loop, not counting the start.
        accepted: bar that is good enough of soils whose flow is not associated, where `tolerance`
            is not reached soon: their residuals may come down slowly (T58). None: none is.
    """

    start: str = "associated"
    damping: float = 0.7
    anderson: int = 10
    tolerance: float = 1e-6
    max_iterations: int = 100
    accepted: float | None = None

    def __post_init__(self) -> None:
        require_known("start", self.start, STARTS)
        if not (is_number(self.damping) and 0 < self.damping <= 1):
            raise InputError("damping", self.damping, "outside (0, 1]", "1 is no damping")
        if not (isinstance(self.anderson, Integral) and self.anderson >= 0):
            raise InputError(
                "anderson", self.anderson, "not a depth", "give a whole number, 0 for none"
            )
        require_positive("tolerance", self.tolerance)
        require_count("max_iterations", self.max_iterations)
        if self.tolerance > _LOOSEST:
            raise InputError(
                "tolerance", self.tolerance, "proves nothing", f"give at most {_LOOSEST:g}"
            )


@dataclass(frozen=True, repr=False)
class Iterate(Compact):
    """One inner solve of a loop.

    Attributes:
        step: 0 is the start.
        kind: what was solved: ``associated``, ``reaction``, ``K``, ``S``, ...
        inner: what the backend answered.
        state: what is judged; of loops that alternate, a velocity from one solve with the stresses,
            reactions and load factor of another. None without a point.
        certificate: residuals of `state` against the true friction laws.
        mismatch: largest difference between the friction bound given and that of the reaction
            returned, per largest reaction.
    """

    step: int
    kind: str
    inner: InnerSolution
    state: ProgramState | None
    certificate: Certificate | None
    mismatch: float

    def row(self) -> dict[str, Any]:
        """As a row of the history, in the units of the program."""
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
    """End of a coupling loop: its status, and every inner solve on the way.

    Attributes:
        status: outcome.
        iterates: all inner solves.
        final: the iterate that the status speaks of; its state is the answer where SOLVED.
        laws: the frozen contact that `final` is judged by; None: the true friction laws.
        contraction: how much closer to each other two reactions (T9, T12) or slip rates (T10)
            come in a step: the last ratio seen; NaN where there is none.
        bracket: load factors that enclose every Coulomb one of the program (T14), for a loop that
            found none.
        findings: What the loop reports in addition to its status.
        tolerance: bar that residuals were judged by.
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
    """Say who found the final state of a loop: its backend, path following of lacore, or both.

    A pair has its velocity from one solve and its reactions from another, which may be by
    different solvers.

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
    names = [PATH_FOLLOWING if own and own.kind == PATH else backend for own in halves]
    return " and ".join(dict.fromkeys(names))


def worst(iterate: Iterate) -> float:
    """The largest residual of an iterate; inf where there is none."""
    if iterate.certificate is None:
        return float("inf")
    return float(np.nan_to_num(iterate.certificate.worst[1], nan=np.inf))


def paired(kinematic: ProgramState, static: ProgramState) -> ProgramState:
    """The velocity of one state with the stresses, reactions and load factor of another (T12)."""
    return replace(static, velocity=kinematic.velocity)


@dataclass
class Run:
    """The inner solves of one loop, judged as they come.

    `prepare` sets a solver to work on a program of its own, `roughly` one whose answers are only
    where others begin. `near` is the friction of a state nearby, in the units of the program.
    `time_limit` is that of an inner solve, s.
    """

    program: KinematicProgram
    solver: PreparedSolver
    regularised: bool
    options: CouplingOptions
    on_iterate: Callable[[Iterate], None]
    prepare: Prepare | None = None
    roughly: Prepare | None = None
    iterates: list[Iterate] = field(default_factory=list)
    rates: list[float] = field(default_factory=list)
    near: Nearby = field(default_factory=Nearby)
    time_limit: float = np.inf
    _mapped: dict[str, tuple[Floats, Floats]] = field(default_factory=dict)

    def solve(
        self,
        kind: str,
        contact: FrozenContact,
        laws: FrozenContact | None = None,
        partner: Callable[[ProgramState], ProgramState] | None = None,
        program: KinematicProgram | None = None,
        solver: PreparedSolver | None = None,
    ) -> Iterate:
        """Solve for a frozen contact and judge the answer by `laws` (None: the true ones).

        With `partner`, judge the pair that it makes of the answer, unless the answer itself holds.
        With `program`, groups are those of it: of a velocity that hardens them (T29), or with
        friction that is frozen (T52). With `solver` it is asked, and not that of the loop.
        """
        if solver is not None:
            answer = solver.solve(contact)
        elif program is None or program is self.program or self.prepare is None:
            answer = self.solver.solve(contact)
        else:
            with closing(self.prepare(program)) as own:
                answer = own.solve(contact)
        inner = checked_answer(self.program, self.regularised, answer)
        state, certificate, mismatch = inner.point, None, np.nan
        if state is not None:
            certificate = certify(self.program, state, laws)
            mismatch = self._mismatch(contact, state.normal_reaction) if laws is None else 0.0
            if partner is not None and not certificate.holds(self.options.tolerance):
                state = partner(state)
                certificate = certify(self.program, state, laws)
        iterate = Iterate(len(self.iterates), kind, inner, state, certificate, mismatch)
        self.iterates.append(iterate)
        self.on_iterate(iterate)
        return iterate

    def _mismatch(self, contact: FrozenContact, normal_reaction: Floats) -> float:
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
        """The last rate seen; NaN where there is none."""
        return self.rates[-1] if self.rates else float("nan")

    def mapped(self, kind: str, argument: Floats, image: Floats) -> None:
        """Note what a fixed-point map made of an argument, for its rate."""
        if kind in self._mapped:
            last_argument, last_image = self._mapped[kind]
            change = float(np.linalg.norm(argument - last_argument))
            if change > _NO_CHANGE * float(np.linalg.norm(argument)):
                self.rates.append(float(np.linalg.norm(image - last_image)) / change)
        self._mapped[kind] = argument, image

    def proven(self, iterate: Iterate) -> bool:
        """Whether the residuals prove the iterate."""
        certificate, tolerance = iterate.certificate, self.options.tolerance
        if certificate is None or iterate.state is None:
            return False
        if not self.regularised:
            return certificate.holds(tolerance)
        # Equilibrium with the load factor P + 2 C proves a minimiser (T19); what the penalties let
        # through (divergence, penetration, flow, gap) is reported and not judged, but their energy
        # C, which bounds the error, must be small: a large dead load can fill it.
        values = iterate.inner.regularised
        assert values is not None
        dissipated = values.plastic + float(self.program.dead_load @ iterate.state.velocity)
        largest = max(abs(values.load_factor), dissipated)
        judged = [
            certificate.equilibrium,
            certificate.yield_violation,
            certificate.normalisation,
            iterate.mismatch,
        ]
        if not np.isnan(values.multiplier):  # what the solver found is P + 2 C at a minimiser (T19)
            judged.append(abs(values.multiplier - values.load_factor) / max(largest, _NO_POWER))
        meaningful = values.energy <= _PENALTY_SHARE * largest
        return meaningful and all(value <= tolerance for value in judged)

    def end(
        self,
        status: Status,
        final: Iterate | None = None,
        *,
        laws: FrozenContact | None = None,
        bracket: tuple[float, float] | None = None,
        findings: tuple[Finding, ...] = (),
    ) -> Coupled:
        """The end of the loop, at its last iterate unless another is given."""
        final = final or self.iterates[-1]
        found = tuple(self.iterates), final, laws, self.contraction, bracket, findings
        return Coupled(status, *found, tolerance=self.options.tolerance)

    def accept(self) -> Iterate | None:
        """The pair with the least residual, where that is accepted; it is the bar from then on."""
        if self.options.accepted is None:
            return None
        self.options = replace(self.options, tolerance=self.options.accepted)
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
        """Whether an admissible rigid motion turns over no power at all.

        By the true friction laws, or by `laws`.

        It is judged before the residuals: those per power, and with no dead load those per total
        load, are 0/0 here. A regularised body gives way under dead load, so that its dead power is
        not zero: what its load factor and its dissipation say has to do.
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
                bool(rigid) and certificate.normalisation <= tolerance and _none(powers, _NO_POWER)
            )
        frozen = laws or reaction_contact(program.contact, state.normal_reaction)
        # The divergence of soils is a power, which here is 0/0 as well.
        flow = impossible(program, state)
        admissible = [certificate.penetration, flow, certificate.normalisation]
        return _none(admissible, tolerance) and without_dissipation(
            program, state, frozen, tolerance
        )

    def _rigid(self, velocity: Floats) -> bool:
        """Whether strain rates are round-off against velocity per body length."""
        groups = self.program.groups
        length = np.sqrt(sum(float(group.weights.sum()) for group in groups))
        strain = max(
            (float(np.linalg.norm(group.cone_vectors(velocity), axis=1).max()) for group in groups),
            default=0.0,
        )
        return strain * float(length) <= self.options.tolerance * float(np.abs(velocity).max())


def _none(values: list[float], largest: float) -> bool:
    """Whether all values are at most `largest` in size; false for NaN."""
    return all(abs(value) <= largest for value in values)
