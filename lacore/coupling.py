"""Coupling loops: the only place that iterates on contact reactions (T9-T13).

The reaction iteration freezes the friction bounds ``g = mu t_n + limit``, solves the convex
program, reads the normal reactions of that solution and starts again. Exact backends stop when
the recomputed residuals of the Coulomb problem (`lacore.certificate`) are within tolerance;
regularised ones, whose residuals never vanish, when the friction bounds that they were given are
those of the reactions that they return.
"""

from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from numbers import Integral
from typing import Any

import numpy as np

from lacore.anderson import Anderson
from lacore.arrays import Floats
from lacore.backend import InnerSolution, PreparedSolver, checked_answer
from lacore.certificate import Certificate, certify
from lacore.errors import (
    InputError,
    is_number,
    require_count,
    require_known,
    require_positive,
)
from lacore.program import (
    FrozenContact,
    KinematicProgram,
    associated_contact,
    reaction_contact,
)
from lacore.status import Status

STARTS = ("associated", "zero")
_FINISHED = (Status.SOLVED, Status.ALMOST_SOLVED)
_PENALTY_SHARE = 0.1  # of the load factor; about 0.02 at r = 0.1 where they are as meant
_LOOSEST = 1e-3  # residual at which a state still deserves its name
_NO_POWER = 1e-7  # of stress * length * velocity: what interior-point round-off leaves of a zero


@dataclass(frozen=True)
class CouplingOptions:
    """How to couple.

    Attributes:
        start: ``associated`` (reactions of the associated problem) or ``zero`` (the paper's).
        damping: share w of the new reaction in the next one, 0 < w <= 1.
        anderson: depth of Anderson acceleration, 0 for none.
        tolerance: bar for the residuals of the certificate.
        max_iterations: of the loop, not counting the start.
    """

    start: str = "associated"
    damping: float = 0.7
    anderson: int = 10
    tolerance: float = 1e-6
    max_iterations: int = 100

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


@dataclass(frozen=True)
class Iterate:
    """One inner solve of the loop.

    Attributes:
        step: 0 is the start.
        kind: ``associated``, ``zero`` or ``reaction``.
        inner: what the backend answered.
        certificate: residuals against the true friction laws; None without a point.
        mismatch: largest difference between the friction bound given and that of the reaction
            returned, per largest reaction.
    """

    step: int
    kind: str
    inner: InnerSolution
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
            "peak_memory": self.inner.peak_memory,
        }


@dataclass(frozen=True)
class Coupled:
    """End of a coupling loop: its status, and every inner solve on the way."""

    status: Status
    iterates: tuple[Iterate, ...]

    @property
    def last(self) -> Iterate:
        """The iterate that the status speaks of."""
        return self.iterates[-1]


@dataclass
class _Run:
    """The inner solves of one loop, judged as they come."""

    program: KinematicProgram
    solver: PreparedSolver
    regularised: bool
    options: CouplingOptions
    on_iterate: Callable[[Iterate], None]
    iterates: list[Iterate] = field(default_factory=list)

    def solve(self, kind: str, contact: FrozenContact, laws: FrozenContact | None) -> Iterate:
        """Solve for a frozen contact and judge the answer by `laws` (None: the true ones)."""
        inner = checked_answer(self.program, self.regularised, self.solver.solve(contact))
        certificate, mismatch = None, np.nan
        if inner.point is not None:
            certificate = certify(self.program, inner.point, laws)
            mismatch = 0.0
            if laws is None:
                mismatch = self._mismatch(contact, inner.point.normal_reaction)
        iterate = Iterate(len(self.iterates), kind, inner, certificate, mismatch)
        self.iterates.append(iterate)
        self.on_iterate(iterate)
        return iterate

    def _mismatch(self, contact: FrozenContact, normal_reaction: Floats) -> float:
        coulomb = self.program.contact.coulomb
        new = reaction_contact(self.program.contact, normal_reaction).bound[coulomb]
        largest = max(float(np.abs(normal_reaction).max(initial=0.0)), np.finfo(float).tiny)
        return float(np.abs(new - contact.bound[coulomb]).max(initial=0.0)) / largest

    def proven(self, iterate: Iterate) -> bool:
        """Whether the residuals prove the iterate."""
        certificate, tolerance = iterate.certificate, self.options.tolerance
        if certificate is None or iterate.inner.point is None:
            return False
        if not self.regularised:
            return certificate.holds(tolerance)
        # Equilibrium with the load factor P + 2 C proves a minimiser (T19); what the penalties let
        # through (divergence, penetration, flow, gap) is reported and not judged, but their energy
        # C, which bounds the error, must be small: a large dead load can fill it.
        values = iterate.inner.regularised
        assert values is not None
        dissipated = values.plastic + float(self.program.dead_load @ iterate.inner.point.velocity)
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

    def end(self, status: Status) -> Coupled:
        return Coupled(status, tuple(self.iterates))

    def judged(self, iterate: Iterate) -> Coupled:
        """The end of a loop at an iterate that is final."""
        point = iterate.inner.point
        if point is None:
            return self.end(iterate.inner.status)
        if self.free(iterate):
            return self.end(Status.FREE)
        if not self.proven(iterate):
            inner = iterate.inner.status
            return self.end(Status.NOT_CERTIFIED if inner in _FINISHED else inner)
        return self.end(Status.SOLVED)

    def free(self, iterate: Iterate) -> bool:
        """Whether an admissible rigid motion turns over no power at all.

        It is judged before the residuals: those per power, and with no dead load those per total
        load, are 0/0 here. A regularised body gives way under dead load, so that its dead power is
        not zero: what its load factor and its dissipation say has to do.
        """
        point, certificate = iterate.inner.point, iterate.certificate
        if point is None or certificate is None or iterate.inner.status is not Status.SOLVED:
            return False
        program, u, tolerance = self.program, point.velocity, self.options.tolerance
        weight = float(np.abs(program.dead_load).sum())
        dead_power = float(program.dead_load @ u)
        values = iterate.inner.regularised
        if values is not None:
            powers = [values.load_factor, values.plastic + dead_power]
            rigid = weight > 0 or self._rigid(u)
            return rigid and certificate.normalisation <= tolerance and _none(powers, _NO_POWER)
        bound = reaction_contact(program.contact, point.normal_reaction).bound
        powers = [point.load_factor, dead_power, program.friction_dissipation(u, bound)]
        # A light body may slide with little friction: little against its weight, then.
        largest = tolerance * weight * float(np.abs(u).max()) if weight > 0 else _NO_POWER
        admissible = [certificate.penetration, certificate.divergence, certificate.normalisation]
        return (
            self._rigid(u)
            and _none(admissible, tolerance)
            and _none(powers, min(largest, _NO_POWER))
        )

    def _rigid(self, velocity: Floats) -> bool:
        """Whether strain rates are round-off against velocity per body length."""
        groups = self.program.groups
        length = np.sqrt(sum(float(group.weights.sum()) for group in groups))
        strain = max(
            float(np.linalg.norm(group.cone_vectors(velocity), axis=1).max()) for group in groups
        )
        return strain * float(length) <= self.options.tolerance * float(np.abs(velocity).max())


def _none(values: list[float], largest: float) -> bool:
    """Whether all values are at most `largest` in size; false for NaN."""
    return all(abs(value) <= largest for value in values)


def associated(
    program: KinematicProgram,
    solver: PreparedSolver,
    regularised: bool,
    options: CouplingOptions,
    on_iterate: Callable[[Iterate], None],
) -> Coupled:
    """One solve with every Coulomb interface made associated (T4), judged as such."""
    run = _Run(program, solver, regularised, options, on_iterate)
    contact = associated_contact(program.contact)
    return run.judged(run.solve("associated", contact, contact))


def reaction_loop(
    program: KinematicProgram,
    solver: PreparedSolver,
    regularised: bool,
    options: CouplingOptions,
    on_iterate: Callable[[Iterate], None],
) -> Coupled:
    """Successive approximation on the normal reactions (T9), damped and accelerated."""
    run = _Run(program, solver, regularised, options, on_iterate)
    rows = program.contact
    zero = reaction_contact(rows, np.zeros(rows.count))
    if not rows.coulomb.any():
        return run.judged(run.solve("single", zero, None))

    start = options.start
    if start == "associated":
        first = run.solve(start, associated_contact(rows), None)
        if first.inner.status is Status.LOCKED:  # no error: friction may well be finite (T13)
            start = "zero"
    if start == "zero":
        first = run.solve(start, zero, None)
        if first.inner.status is Status.UNSAFE:
            return run.end(Status.INVALID_START)
    if first.inner.point is None:
        return run.end(first.inner.status)

    reaction = np.maximum(first.inner.point.normal_reaction, 0.0)
    mixing = Anderson(options.anderson, options.damping)
    for _ in range(options.max_iterations):
        iterate = run.solve("reaction", reaction_contact(rows, reaction), None)
        point = iterate.inner.point
        if iterate.inner.status is Status.UNSAFE:  # at these bounds only: it proves nothing (T13)
            return run.end(Status.NOT_CONVERGED)
        out_of_budget = iterate.inner.status in (Status.ITERATION_LIMIT, Status.TIME_LIMIT)
        if point is None or out_of_budget or run.proven(iterate) or run.free(iterate):
            return run.judged(iterate)
        reaction = np.maximum(mixing.step(reaction, point.normal_reaction), 0.0)
    inner = run.iterates[-1].inner.status
    return run.end(Status.NOT_CONVERGED if inner in _FINISHED else inner)


COUPLINGS: dict[str, Callable[..., Coupled]] = {
    "reaction": reaction_loop,
    "associated": associated,
}
