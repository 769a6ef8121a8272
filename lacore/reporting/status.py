"""Statuses of solves. The text of a status says what happened and what to do about it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, Protocol, Self, TypeVar

from lacore.reporting.findings import Finding, Message, Severity
from lacore.reporting.kinds import Kind
from lacore.reporting.showing import Shown

State = TypeVar("State")


class Status(Enum):
    """Outcome of one inner solve, or of the whole coupled problem (T13)."""

    SOLVED = "solved within the requested tolerances"
    ALMOST_SOLVED = "solved to reduced tolerances only: judge it by the recomputed residuals"
    STALLED = (
        "the solver stopped making progress: coarsen the scaling of the mesh, loosen the"
        " tolerance, or try another backend"
    )
    ITERATION_LIMIT = "the solver's iteration limit was reached: raise `max_iterations`"
    TIME_LIMIT = "the time limit was reached: raise `time_limit` or take a coarser mesh"
    FAILED = "the solver failed numerically: its message says how; try another backend"
    NOT_CONVERGED = (
        "the loop did not reach a Coulomb state within its budget: take coupling='certified',"
        " lower `damping`, raise `anderson` or `max_iterations`; the history shows what it did"
    )
    NOT_CERTIFIED = (
        "the loop ended, but the recomputed residuals do not prove the answer: tighten the"
        " backend's tolerance, raise `max_iterations`, or try another backend"
    )
    JAM = (
        "jam?: nothing could be certified, the associated load factor is +inf, and reactions grew"
        " at least as fast as the friction they were given: the structure may lock itself"
    )
    INVALID_START = (
        "without friction the structure collapses under the dead loads, so zero reactions are"
        " not a valid start (every arch): use start='associated'"
    )
    UNSAFE = (
        "no load factor keeps equilibrium: the structure collapses under the dead loads alone;"
        " reduce them, add supports or strength"
    )
    LOCKED = (
        "no admissible mechanism feels the reference load (load factor +inf): supports, obstacles,"
        " incompressibility, or a strength that pressure raises without end block every motion that"
        " it drives"
    )
    FREE = (
        "the structure moves under the reference loads without resistance: a support, friction or"
        " strength is missing"
    )

    @property
    def has_point(self) -> bool:
        """Whether a velocity and a load factor may come with this status; residuals assess them."""
        return self in _WITH_POINT

    @property
    def label(self) -> str:
        """The name as shown in tables: ``not converged``."""
        return self.name.lower().replace("_", " ")

    def report(self, findings: tuple[Finding, ...]) -> Message:
        """Return the text of this status with findings, to be rendered for a reader."""
        return Message(self.label, self.value, findings, plain=self is Status.SOLVED)


class Outcome(Protocol):
    """What a status of any result has: a text for it and its findings."""

    def report(self, findings: tuple[Finding, ...]) -> Message:
        """Return the text, to be rendered for a reader."""
        ...


class Result(Shown):
    """Base of all results: findings, their text, facts to print and a picture.

    Attributes:
        findings: Reports in addition to the numbers; a field or a property.
    """

    if TYPE_CHECKING:  # A declaration would become the default of a field.

        @property
        def findings(self) -> tuple[Finding, ...]:
            """See above."""
            ...

    @property
    def report(self) -> Message:
        """The findings, to be rendered for a reader."""
        return Message("", "", self.findings)

    @property
    def message(self) -> str:
        """Text of the report."""
        return str(self.report)


class Reported(Result):
    """A result with a status, whose text its findings explain.

    Attributes:
        status: How it ended.
    """

    if TYPE_CHECKING:

        @property
        def status(self) -> Outcome:
            """See above."""
            ...

    @property
    def report(self) -> Message:
        """The status with the findings, to be rendered for a reader."""
        return self.status.report(self.findings)

    def checked(self, throw: bool) -> Self:
        """Return the result, or raise `SolveError` if `throw` is set and it is not SOLVED."""
        if throw and self.status is not Status.SOLVED:
            from lacore.reporting.errors import (
                SolveError,  # This loads NumPy, which child processes must not do.
            )

            raise SolveError(self.message, self)
        return self

    def required(self, state: State | None) -> State:
        """Return a state of this result, or raise `ValueError` if there is none."""
        if state is None:
            raise ValueError(f"there is no state to look at: {self.message}")
        return state

    def unanswered(self, backend: str, severity: Severity = Severity.NOTE) -> Finding:
        """Return why there is no bound or state, with the backend unless the problem has none.

        Args:
            backend: Name of the backend whose answer has this status.
            severity: Role of the finding in the result that needs the bound or state.
        """
        if self.status in _OF_THE_PROBLEM:
            return Finding(Kind.STATUS, (), {"report": self.report}, severity)
        values = {"backend": backend, "report": self.report}
        return Finding(Kind.NO_ANSWER, (), values, severity)


_WITH_POINT = frozenset(
    {
        Status.SOLVED,
        Status.ALMOST_SOLVED,
        Status.STALLED,
        Status.ITERATION_LIMIT,
        Status.TIME_LIMIT,
    }
)
_OF_THE_PROBLEM = frozenset({Status.UNSAFE, Status.LOCKED, Status.FREE, Status.JAM})


class Scope(Enum):
    """Problem for which an interval of Coulomb load factors is proven."""

    ITSELF = "the problem: rigid blocks and frames have no discretisation"
    DISCRETE = "the discrete problem: velocities on the mesh, cells of joints that crush"

    @property
    def phrase(self) -> str:
        """Addition to a claim, with a leading blank; empty without a discretisation."""
        return " of the discrete problem" if self is Scope.DISCRETE else ""


class Standing(Enum):
    """Proven status of the dead loads alone."""

    STANDS = "the dead loads alone are carried"
    FALLS = "the dead loads alone are not carried, as a mechanism proves"
    UNDECIDED = "neither equilibrium with the dead loads alone nor their collapse is proven"

    @property
    def label(self) -> str:
        """The name as shown in tables."""
        return self.name.lower()


@dataclass(frozen=True)
class Claim:
    """What a load factor proves, as text.

    Attributes:
        text: Short text for the line of the number.
        reason: Reason; may be empty.
    """

    text: str
    reason: str = ""

    def __str__(self) -> str:
        return ": ".join(filter(None, (self.text, self.reason)))


class Role(Enum):
    """Where other load factors than a given one have equilibrium within the friction cones."""

    CAPACITY = "no equilibrium exists above it"
    MINIMUM = "no equilibrium exists below it"
    BOTH_SIDES = "neither a capacity nor a minimum holding load"
    ONLY = "no other load factor has equilibrium"
    UNDECIDED = "not a bound: other load factors may be possible"

    @property
    def label(self) -> str:
        """The name as shown in tables."""
        return _ROLES[self]

    def qualified(self, claim: Claim) -> Claim:
        """Return the claim of a load factor with this role."""
        return Claim(f"{claim.text}, {self.label}", self.value)


_ROLES = {
    Role.CAPACITY: "capacity",
    Role.MINIMUM: "minimum holding load",
    Role.BOTH_SIDES: "equilibrium on both sides",
    Role.ONLY: "only load factor with equilibrium",
    Role.UNDECIDED: "side of equilibrium undecided",
}


class Rigor(Enum):
    """What a load factor proves (T16). No number is printed without one."""

    UPPER = "strict upper bound of the continuum problem"
    LOWER = "strict lower bound of the continuum problem"
    DISCRETE = "converged value of the discrete problem, not a bound"
    REGULARISED = "value of the regularised problem"
    NOT_CERTIFIED = "not certified"

    @property
    def claim(self) -> Claim:
        """Claim of a load factor, with the reason."""
        return Claim(self.value, _REASONS.get(self, ""))

    @property
    def label(self) -> str:
        """The name as shown in tables."""
        return self.name.lower().replace("_", " ")


_REASONS = {
    Rigor.LOWER: "equilibrium element, yield at vertices",
    Rigor.REGULARISED: "approaches the discrete one as r -> 0",
}
