"""The backend protocol: what a solver provides, and how its answers are checked.

A backend prepares a dimensionless `KinematicProgram` once and then solves it for each
`FrozenContact` that the coupling loop gives it. It is registered under its name in the entry-point
group ``lacore.backends``; docs/backends.md shows how to write one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from numbers import Integral
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import numpy as np

from lacore.program.kinematic import FrozenContact, KinematicProgram, require_finite
from lacore.program.regularization import RegularisedValues
from lacore.program.state import ProgramState, misfit, shapes
from lacore.reporting.errors import CapabilityError, InputError, is_number, require_known
from lacore.reporting.showing import Compact
from lacore.reporting.status import Status

REPORTED = (
    *(Status.SOLVED, Status.ALMOST_SOLVED, Status.STALLED, Status.ITERATION_LIMIT),
    *(Status.TIME_LIMIT, Status.LOCKED, Status.UNSAFE, Status.FAILED),
)
"""Statuses of one solve; the others are those of the whole computation."""
NO_ANSWER = "no answer"
"""Native status of a solve whose answer cannot be used."""
_NO_POWER = 1e-12  # of the sum of sizes: what round-off leaves of a power that vanishes
_LONGEST_MESSAGE = 2000  # characters; a solver's whole log would swamp every table


TRUE_GAP = 25.0
"""Gap of a solve, recomputed, per nominal tolerance: docs/design-decisions.md."""


@dataclass(frozen=True, repr=False)
class Capabilities(Compact):
    """What a backend can do, and what to ask of it. Duals are no choice: certificates live on them.

    Attributes:
        regularised: it solves the regularised program (T17-T20), not the exact one.
        max_unknowns: largest number of velocity unknowns that it takes; None: no limit.
        max_cone: most rows that one of its cones may have; 1 is a linear program, None: no limit.
        warm_start: a solve starts from the answer of the one before.
        infeasibility: it recognises programs without a limit state (LOCKED, UNSAFE); from one that
            does not, such a program may get any status, and residuals that refute it.
        hardening: it takes groups that harden with the strain rate, a quadratic cost (T29).
        isolated: it may hang where its time limit does not reach, so that it runs in a process of
            its own, which can be stopped.
        on_demand: comparisons run it only where it is named.
        surfaces: it takes groups whose strength depends on pressure (T39).
        slow_surfaces: it takes them, in many times its usual time: checks of all cases ask it about
            the first variants only.
        dense: its time grows with the cube of the unknowns: a first look leaves meshes out.
        true_gap: its tolerance is the gap, recomputed; that of others is nominal, and their gap ten
            to a hundred times as large.
        paths: it is quick enough for comparisons to follow paths with it, tens of solves each.
        packages: that it computes with, as they are installed. Their versions are recorded beside
            its numbers, which are found again where one has changed.
    """

    regularised: bool
    max_unknowns: int | None = None
    max_cone: int | None = None
    warm_start: bool = False
    infeasibility: bool = True
    hardening: bool = False
    isolated: bool = False
    on_demand: bool = False
    surfaces: bool = False
    slow_surfaces: bool = False
    dense: bool = False
    true_gap: bool = False
    paths: bool = False
    packages: tuple[str, ...] = ()

    @property
    def linear_only(self) -> bool:
        """It takes linear programs only, those of rigid bodies: comparisons run it on no others."""
        return self.max_cone == 1


@dataclass(frozen=True, repr=False)
class InnerSolution(Compact):
    """Answer of one inner solve, in the units of the program.

    Attributes:
        status: outcome.
        native_status: the solver's own word for it.
        iterations: of the solver.
        solve_time: s, wall clock, as the backend measures it; of an isolated one as lacore does.
        point: the velocity and its duals; None where the solver has none to give.
        regularised: the three values of T19 (regularised backends).
        message: anything else worth knowing.
        peak_memory: MB, resident, of the backend's own process; NaN where it has none.
        reported_time: s, as an isolated backend reports it; NaN where `solve_time` is that.
    """

    status: Status
    native_status: str
    iterations: int
    solve_time: float
    point: ProgramState | None
    regularised: RegularisedValues | None = None
    message: str = ""
    peak_memory: float = float("nan")
    reported_time: float = float("nan")


class PreparedSolver(Protocol):
    """A backend at work on one program."""

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve for a frozen contact; may start from the previous answer.

        Whatever becomes of it is an `InnerSolution`; no later than ``options.time_limit``.
        `checked_answer` looks at it before anyone else does.
        """

    def close(self) -> None:
        """Give back what the solver holds (licences, processes, files); nothing is asked after.

        It must not raise: the answer is already there.
        """


Prepare = Callable[[KinematicProgram], PreparedSolver]
"""Prepares a backend, whose options are chosen, for a program."""


class Backend(Protocol):
    """A solver that can be plugged in; what is a property here may be a class attribute."""

    @property
    def name(self) -> str:
        """As registered."""

    @property
    def title(self) -> str:
        """A line for tables."""

    @property
    def source(self) -> str:
        """The paper of the method."""

    @property
    def capabilities(self) -> Capabilities:
        """What it can do."""

    @property
    def statuses(self) -> Mapping[Any, Status]:
        """Every native status of the solver, and what it means here."""

    @property
    def Options(self) -> type:  # noqa: N802  # it is a class
        """A frozen dataclass, every field with a default; raises `InputError` on bad values.

        ``time_limit`` (s, one inner solve) is always among them.
        """

    def unavailable(self) -> str:
        """Why it cannot run here and how to get it; empty where it can."""

    def version(self) -> str:
        """The solver and its version: ``Clarabel 0.11.1``."""

    def prepare(self, program: KinematicProgram, options: Any) -> PreparedSolver:
        """Everything that repeated solves share."""


@runtime_checkable
class Family(Protocol):
    """A backend that stands for several solvers, asked for as ``name:variant``."""

    def variants(self) -> Sequence[str]:
        """Those that it knows of; `Backend.unavailable` says whether one can run here."""

    def variant(self, name: str) -> Backend:
        """The backend of one of them."""


@runtime_checkable
class WarmsUp(Protocol):
    """A backend with something to do once in a process, such as compilation."""

    def warm_up(self) -> None:
        """Do it. It is called before the first solve in a process, and its time is kept apart."""


Writer = Callable[[KinematicProgram, FrozenContact, Path], None]
"""Writes the program of a frozen contact to a file.

Whatever units the backend solves in, the file has the units of the program: ``F0.U = POWER`` (see
`lacore.program`), so that its least value is the load factor in units of the program.
"""


@runtime_checkable
class Writes(Backend, Protocol):
    """A backend that writes the programs which it solves to files, for other solvers."""

    @property
    def writers(self) -> Mapping[str, Writer]:
        """By format, as files of it end: ``{"cbf": write_cbf}``."""


def check_capable(backend: Backend, program: KinematicProgram) -> None:
    """Raise where a backend cannot take a program.

    Raises:
        CapabilityError: too large, cones that the backend does not have, hardening, or strength
            that depends on pressure.
        InputError: the program holds NaN or infinite numbers.
    """
    require_finite(program)
    can = backend.capabilities
    if can.max_unknowns is not None and program.n > can.max_unknowns:
        raise CapabilityError(
            f"backend {backend.name!r} takes at most {can.max_unknowns} velocity unknowns, this"
            f" problem has {program.n}: take a coarser mesh, or a sparse backend such as 'clarabel'"
        )
    if can.max_cone is not None and program.largest_cone > can.max_cone:
        takes = "linear programs" if can.linear_only else f"cones of up to {can.max_cone} rows"
        raise CapabilityError(
            f"backend {backend.name!r} takes {takes}, this problem has cones of"
            f" {program.largest_cone} rows (plane or solid bodies): take 'clarabel'"
        )
    if program.pressure_dependent and not can.surfaces:
        fix = (
            "'clarabel-regularised' or 'newton'"
            if can.regularised
            else "'clarabel' or 'ipopt-static'"
        )
        raise CapabilityError(
            f"backend {backend.name!r} takes strengths that do not depend on pressure, and this"
            f" problem has a material with friction or a cut-off: take {fix}"
        )
    if program.hardens and not can.hardening:
        states = "solves linear programs" if can.linear_only else "has costs linear in them only"
        raise CapabilityError(
            "hardening within a step of a path costs the square of strain rates (T29), and backend"
            f" {backend.name!r} {states}: take 'clarabel'"
        )


def checked_answer(program: KinematicProgram, regularised: bool, answer: object) -> InnerSolution:
    """The answer of a backend, without its point where that is none that can be judged.

    A point of wrong shapes or of NaN says nothing whatever status comes with it; "solved" with
    such a point, or with none, is FAILED.
    """
    if fault := fault_of_kinds(answer):
        seconds = getattr(answer, "solve_time", 0.0)
        return failed_answer(fault, seconds if is_number(seconds) and seconds >= 0 else 0.0)
    assert isinstance(answer, InnerSolution)
    answer = replace(answer, message=answer.message[:_LONGEST_MESSAGE])
    fault = _fault(program, regularised, answer)
    if not fault:
        return answer
    claims = answer.status in (Status.SOLVED, Status.ALMOST_SOLVED)
    return replace(
        answer,
        status=Status.FAILED if claims else answer.status,
        point=None,
        regularised=None,
        message="; ".join(filter(None, [answer.message, f"the backend's answer has {fault}"])),
    )


def failed_answer(message: str, seconds: float) -> InnerSolution:
    """The result of a solve whose answer cannot be used."""
    return InnerSolution(Status.FAILED, NO_ANSWER, 0, seconds, None, message=message)


def fault_of(program: KinematicProgram, regularised: bool, answer: object) -> str:
    """Return what breaks the protocol in an answer; empty if nothing does."""
    if fault := fault_of_kinds(answer):
        return fault
    assert isinstance(answer, InnerSolution)
    if answer.native_status == NO_ANSWER:
        return answer.message
    fault = _fault(program, regularised, answer)
    return fault and f"the backend's answer has {fault}"


def fault_of_kinds(answer: object) -> str:
    """What is of the wrong kind in an answer, with its value and the remedy; empty if nothing is.

    Shapes and numbers are for `checked_answer`, which knows the program.
    """
    if not isinstance(answer, InnerSolution):
        return f"the backend answered {str(answer)[:60]!r} instead of an InnerSolution"
    point, values = answer.point, answer.regularised
    faults = {
        "status": (isinstance(answer.status, Status), "a member of lacore.Status"),
        "native_status": (isinstance(answer.native_status, str), "text"),
        "iterations": (
            isinstance(answer.iterations, Integral) and answer.iterations >= 0,
            "a whole number, 0 or more",
        ),
        "solve_time": (
            is_number(answer.solve_time) and answer.solve_time >= 0,
            "seconds, 0 or more",
        ),
        "message": (isinstance(answer.message, str), "text"),
        "point": (point is None or isinstance(point, ProgramState), "a ProgramState or None"),
        "regularised": (
            values is None or isinstance(values, RegularisedValues),
            "RegularisedValues or None",
        ),
    }
    for name, (right, wanted) in faults.items():
        if not right:
            return _wrong(name, getattr(answer, name), wanted)
    if answer.status not in REPORTED:
        names = ", ".join(status.name for status in REPORTED)
        return _wrong("status", answer.status.name, f"the status of one solve ({names})")
    for name in ("stress", "mean_stress") if point is not None else ():
        if not isinstance(own := getattr(point, name), tuple):
            return _wrong(f"point.{name}", own, "a tuple with one array for each group")
    return ""


def _wrong(name: str, value: object, wanted: str) -> str:
    return f"the backend's answer has {name} = {str(value)[:60]!r}: give {wanted}"


def _fault(program: KinematicProgram, regularised: bool, answer: InnerSolution) -> str:
    """What is wrong with an answer; empty where nothing is."""
    point = answer.point
    if point is None:
        claims = answer.status in (Status.SOLVED, Status.ALMOST_SOLVED)
        return f"no point with status {answer.status.name}" if claims else ""
    if regularised and answer.regularised is None:
        return "no regularised values (T19)"
    if fault := misfit(program, point):
        return fault
    for name, values, _ in shapes(program, point):
        array = np.asarray(values)
        if array.dtype.kind not in "fiu" or not np.isfinite(array).all():
            return f"a {name} with NaN, infinity or no numbers at all"
    power = float(program.reference_load @ point.velocity)
    size = float(np.abs(program.reference_load) @ np.abs(point.velocity))
    if not abs(power) > _NO_POWER * size:
        return f"a velocity with F0.U = {power:.3g}, where the program requires F0.U = 1"
    return ""


def read_options(backend: Backend, given: Mapping[str, Any]) -> Any:
    """Options of a backend from a mapping; raises `InputError` on unknown names."""
    known = [field.name for field in fields(backend.Options)]
    if not isinstance(given, Mapping):
        raise InputError("options", given, "no mapping", "give {'name': value}")
    for name in given:
        if name not in known:
            require_known(f"options of backend {backend.name!r}", name, known)
    return backend.Options(**given)


def nominal_tolerance(backend: Backend, options: Any) -> float:
    """The tolerance in options as a nominal one, whatever the backend means by it; 0 without."""
    tolerance = float(getattr(options, "tolerance", 0.0))
    return tolerance / TRUE_GAP if backend.capabilities.true_gap else tolerance
