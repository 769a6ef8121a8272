"""Exact range of load factors that one mechanism can carry (T14b a).

Coulomb limit loads are not unique: the velocity of a limit state does not determine the reactions
and the load factor. The compatible reactions form a convex set (`lacore.coupling.faces`), so one
conic program each gives the smallest and the largest load factor, and all between are carried.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from lacore.coupling.blocks.slack import Slack
from lacore.coupling.constants import FAR_LOAD, SHARP_END
from lacore.coupling.faces import Face, faces, ray_program
from lacore.program.certificate import Certificate
from lacore.program.kinematic import (
    FrozenContact,
    KinematicProgram,
)
from lacore.program.power import kinematic_power
from lacore.program.state import ProgramState
from lacore.reporting.findings import Finding
from lacore.reporting.kinds import Kind
from lacore.reporting.showing import Facts, Shown
from lacore.reporting.status import Result, Status
from lacore.solvers.backend import Prepare, checked_answer

_FURTHER = 2  # faces tried after one whose end is certified with a larger residual


class EndStatus(Enum):
    """What the end of an interval proves."""

    EXACT = "certified, and a dual solution proves that this mechanism carries nothing beyond it"
    FOUND = "certified, but what lies beyond it is not excluded: the program of the end failed"
    UNBOUNDED = "there is no end: certified reactions grow with the load factor along a ray"
    NOT_CERTIFIED = "the mechanism itself is not certified"

    @property
    def label(self) -> str:
        """The name as shown in tables."""
        return self.name.lower().replace("_", " ")


@dataclass(frozen=True, repr=False)
class End(Shown):
    """One end of an interval.

    Attributes:
        status: What the end proves.
        load_factor: Load factor; +inf for an unbounded end, NaN without a certificate.
        point: Mechanism with the reactions and stresses of this end, or of a state far along the
            ray if the end is unbounded.
        certificate: Residuals of `point` against the true friction laws.
        slack: First-order distance by which the gap between reactions and mechanism moves the end
            outwards; 0 for plane problems, see `lacore.coupling.blocks.slack`.
    """

    status: EndStatus
    load_factor: float
    point: ProgramState
    certificate: Certificate
    slack: float = 0.0

    def facts(self) -> Facts:
        """Return the value of the end and its proof."""
        told = {"status": f"{self.status.label}: {self.status.value}"}
        told["residual"] = self.certificate.summary
        return Facts(f"End: load factor {self.load_factor:.7g}", told)


@dataclass(frozen=True, repr=False)
class Interval(Result):
    """Load factors that one mechanism carries: all of [low, high].

    Ends are rounded outwards, by the tolerance of their proofs and to the load factor of the state,
    so that ``low <= load_factor <= high``. Other mechanisms may carry other load factors. Only the
    upper end can be unbounded: friction dissipates, so the load factor is at least the plastic
    dissipation minus the power of the dead load.

    Attributes:
        lower, upper: Ends of the interval.
    """

    lower: End
    upper: End

    @property
    def low(self) -> float:
        """Smallest load factor."""
        return self.lower.load_factor

    @property
    def high(self) -> float:
        """Largest load factor."""
        return self.upper.load_factor

    @property
    def findings(self) -> tuple[Finding, ...]:
        """The slack of the ends; empty for plane problems."""
        slack = {"lower": self.lower.slack, "upper": self.upper.slack}
        return (Finding(Kind.SLACK, values=slack),) if any(slack.values()) else ()

    @property
    def exact(self) -> bool:
        """Whether both ends are proven, unbounded ones included."""
        proven = (EndStatus.EXACT, EndStatus.UNBOUNDED)
        return self.lower.status in proven and self.upper.status in proven

    def facts(self) -> Facts:
        """Return both ends and their statuses."""
        told = {
            side: f"{end.load_factor:.7g}, {end.status.label}"
            for side, end in (("low", self.lower), ("high", self.upper))
        }
        told["residual"] = f"{self.lower.certificate.summary}; {self.upper.certificate.summary}"
        if self.findings:
            told["slack"] = self.message
        title = f"Interval: this mechanism carries load factors {self.low:.7g} to {self.high:.7g}"
        return Facts(title, told)

    def __str__(self) -> str:
        ends = f"{self.low:.6g} ({self.lower.status.label}), {self.high:.6g}"
        return f"[{ends} ({self.upper.status.label})]" + (
            f", {self.message}" if self.findings else ""
        )


def load_factor_interval(
    program: KinematicProgram, point: ProgramState, prepare: Prepare, tolerance: float = 1e-6
) -> Interval:
    """Compute the smallest and the largest load factor of the mechanism of a certified state.

    Args:
        program: Dimensionless program.
        point: State in the same units, which are those of the interval.
        prepare: Function that prepares an exact backend for a program.
        tolerance: Tolerance for the residuals of the states and the proofs of the ends.
    """
    found = Certificate.of(program, point)
    if not found.holds(tolerance):
        nothing = End(EndStatus.NOT_CERTIFIED, np.nan, point, found)
        return Interval(nothing, nothing)
    if not program.contact.coulomb.any():  # the power balance of the mechanism determines it
        unique = End(EndStatus.EXACT, point.load_factor, point, found)
        return Interval(unique, unique)
    ends = []
    for sign in (-1.0, 1.0):
        end = proven_end(program, point, sign, prepare, tolerance)
        known = End(EndStatus.FOUND, point.load_factor, point, found)
        ends.append(known if end is None else further(end, known, sign))
    return Interval(*ends)


def further(end: End, known: End, sign: float) -> End:
    """Return the end, or the state itself if round-off puts it further out; it is certified too."""
    beyond = sign * (known.load_factor - end.load_factor) > 0
    return replace(known, status=end.status, slack=end.slack) if beyond else end


def proven_end(
    program: KinematicProgram, point: ProgramState, sign: float, prepare: Prepare, tolerance: float
) -> End | None:
    """Return the end on the side of `sign`; None if no face proves one.

    In three dimensions it is the end of the mechanism up to a slack. In two dimensions it is the
    end of the first face with very small residuals, or else the best of a few, because a face that
    is slightly too large may pass the tolerance with an end too far out.
    """
    if program.contact.tangent_dim > 1:
        return _slack_end(program, point, sign, prepare, tolerance)
    ends: list[End] = []
    further = _FURTHER
    for face in faces(program, point):
        solved = replace(face.program, reference_load=sign * face.program.reference_load)
        dual, status = _solve(solved, face.contact, prepare)
        if status is Status.LOCKED:
            end = _unbounded(face, sign, prepare, tolerance)
        elif dual is not None:
            end = _end(face, solved, dual, sign, tolerance)
        else:
            end = None
        if end is not None:
            ends.append(end)
            if end.certificate.holds(min(SHARP_END, tolerance)):
                break
        further -= bool(ends)
        if further < 0:
            break
    return min(ends, key=lambda end: end.certificate.worst[1], default=None)


def _end(
    face: Face, solved: KinematicProgram, dual: ProgramState, sign: float, tolerance: float
) -> End | None:
    bound = _bound(solved, face.contact, dual, tolerance)
    # Rounded outwards by the duality gap.
    alpha = sign * float(np.maximum(dual.load_factor, bound))
    point = face.state(dual, alpha)
    certificate = Certificate.of(face.original, point)
    slack = tolerance * kinematic_power(face.original, point)
    proven = abs(bound - dual.load_factor) <= slack
    if not (proven and certificate.holds(tolerance)):
        return None
    return End(EndStatus.EXACT, alpha, point, certificate)


def _slack_end(
    program: KinematicProgram, point: ProgramState, sign: float, prepare: Prepare, tolerance: float
) -> End | None:
    """Return the end of a three-dimensional mechanism; None without a proven one."""
    own = Slack.of(program, point, sign, tolerance)
    dual, _ = _solve(own.program, own.contact, prepare)
    if dual is None:
        return None
    bound = _bound(own.program, own.contact, dual, tolerance)
    alpha = sign * float(np.maximum(dual.load_factor, bound))
    found = own.state(dual, alpha)
    certificate = Certificate.of(program, found)
    proven = abs(bound - dual.load_factor) <= tolerance * kinematic_power(program, found)
    if not (proven and certificate.holds(tolerance)):
        return None
    return End(EndStatus.EXACT, alpha, found, certificate, own.widening(dual))


def _bound(
    program: KinematicProgram, contact: FrozenContact, dual: ProgramState, tolerance: float
) -> float:
    """Return the bound of the load factors of a face by the velocity of a solution, or NaN.

    Its dissipated power is not a scale, because it can vanish together with the load factor.
    """
    v, seen = dual.velocity, Certificate.of(program, dual, contact)
    admissible = (seen.penetration, seen.divergence, seen.normalisation)
    if not all(value <= tolerance for value in admissible):
        return np.nan
    dissipated = program.plastic_dissipation(v) + program.friction_dissipation(v, contact.bound)
    return dissipated - float(program.dead_load @ v)


def _unbounded(face: Face, sign: float, prepare: Prepare, tolerance: float) -> End | None:
    """Return the proof that there is no end; None if it fails."""
    dual, _ = _solve(*ray_program(face, sign), prepare)
    if dual is None:
        return None
    ray, found = face.ray(dual, sign), face.point
    reach = FAR_LOAD * kinematic_power(face.original, found)
    far = found.plus(ray, reach)
    certificate = Certificate.of(face.original, far)
    if not certificate.holds(tolerance):
        return None
    return End(EndStatus.UNBOUNDED, sign * np.inf, far, certificate)


def _solve(
    program: KinematicProgram, contact: FrozenContact, prepare: Prepare
) -> tuple[ProgramState | None, Status]:
    solver = prepare(program)
    try:
        answer = checked_answer(program, False, solver.solve(contact))
    finally:
        solver.close()
    return answer.point, answer.status
