"""Backend protocol: methods of a solver, and checks of its answers.

A backend prepares a dimensionless `KinematicProgram` once and then solves it for each
`FrozenContact` of the coupling loop. It is registered under its name in the entry-point group
``lacore.backends``; docs/backends.md shows how to write one.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from numbers import Integral
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

from lacore.program.kinematic import FrozenContact, KinematicProgram, require_finite
from lacore.program.regularization import RegularisedValues
from lacore.program.state import ProgramState, fault_of_point
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
_LONGEST_MESSAGE = 2000  # characters; a solver's whole log would make tables unreadable


TRUE_GAP = 25.0
"""Gap of a solve, recomputed, per nominal tolerance: docs/design-decisions.md."""


@dataclass(frozen=True, repr=False)
class Capabilities(Compact):
    """Capabilities of a backend. Duals are always required, because certificates need them.

    Attributes:
        regularised: it solves the regularised program (T17-T20), not the exact one.
        max_unknowns: largest number of velocity unknowns; None: no limit.
        max_cone: largest number of rows in a cone; 1 is a linear program, None: no limit.
        warm_start: a solve starts from the answer of the last one.
        infeasibility: it recognises programs without a limit state (LOCKED, UNSAFE). Without this
            such a program may get any status, and residuals that refute it.
        hardening: it supports groups that harden with the strain rate, a quadratic cost (T29).
        isolated: it may hang beyond its time limit, so it runs in a separate process that can be
            stopped.
        on_demand: comparisons run it only if it is named.
        surfaces: it supports groups whose strength depends on pressure (T39).
        slow_surfaces: it supports them, but much more slowly: checks of all cases use it for the
            first variants only.
        dense: its time grows with the cube of the unknowns, so quick comparisons leave out meshes.
        true_gap: its tolerance is the recomputed gap; that of others is nominal, and their gap ten
            to a hundred times as large.
        paths: it is fast enough for comparisons along paths, with tens of solves each.
        packages: names of the installed packages that it uses. Their versions are stored with its
            results, which are computed again if a version has changed.
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
        native_status: status reported by the solver.
        iterations: number of iterations of the solver.
        solve_time: s, wall clock, measured by the backend, or by lacore if it is isolated.
        point: the velocity and its duals; None if the solver has none.
        regularised: the three values of T19 (regularised backends).
        message: further information.
        peak_memory: MB, resident, of the backend's separate process; NaN without one.
        reported_time: s, reported by an isolated backend; NaN for others.
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
    """Backend prepared for one program."""

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve for a frozen contact; may start from the previous answer.

        Every outcome is an `InnerSolution`, returned within ``options.time_limit``.
        `checked_answer` checks it before it is used.
        """

    def close(self) -> None:
        """Release the resources of the solver (licences, processes, files); no call follows.

        It must not raise, because the answer has been returned.
        """


Prepare = Callable[[KinematicProgram], PreparedSolver]
"""Prepares a backend, whose options are chosen, for a program."""


class Backend(Protocol):
    """A solver that can be plugged in. Properties may also be class attributes."""

    @property
    def name(self) -> str:
        """Name under which it is registered."""

    @property
    def title(self) -> str:
        """A line for tables."""

    @property
    def source(self) -> str:
        """The paper of the method."""

    @property
    def capabilities(self) -> Capabilities:
        """Capabilities of the backend."""

    @property
    def statuses(self) -> Mapping[Any, Status]:
        """Every native status of the solver, with its meaning."""

    @property
    def Options(self) -> type:  # noqa: N802  # it is a class
        """A frozen dataclass, every field with a default; raises `InputError` on bad values.

        ``time_limit`` (s, one inner solve) is always among them.
        """

    def unavailable(self) -> str:
        """Return why it cannot run and how to install it; empty if it can."""

    def version(self) -> str:
        """Return the name and version of the solver: ``Clarabel 0.11.1``."""

    def prepare(self, program: KinematicProgram, options: Any) -> PreparedSolver:
        """Prepare everything that repeated solves share."""


@runtime_checkable
class Family(Protocol):
    """Backend with several solvers, named as ``name:variant``."""

    def variants(self) -> Sequence[str]:
        """Return the known variants; `Backend.unavailable` reports whether one can run."""

    def variant(self, name: str) -> Backend:
        """Return the backend of a variant."""


@runtime_checkable
class WarmsUp(Protocol):
    """Backend with work to do once per process, such as compilation."""

    def warm_up(self) -> None:
        """Do this work. It is called before the first solve in a process and timed separately."""


Writer = Callable[[KinematicProgram, FrozenContact, Path], None]
"""Writes the program of a frozen contact to a file.

Whatever units the backend solves in, the file has the units of the program: ``F0.U = POWER`` (see
`lacore.program`), so that its least value is the load factor in units of the program.
"""


@runtime_checkable
class Writes(Backend, Protocol):
    """Backend that writes its programs to files for other solvers."""

    @property
    def writers(self) -> Mapping[str, Writer]:
        """Functions by format, the extension of the file: ``{"cbf": write_cbf}``."""


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
    """Return the answer of a backend, without its point if that cannot be assessed.

    A point of wrong shape or with NaN proves nothing, whatever its status; "solved" with such a
    point, or without one, is FAILED.
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
    """Return which part of an answer has the wrong type, with value and remedy; empty if none has.

    Shapes and numbers are checked by `checked_answer`, which knows the program.
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
    """Return what is wrong with an answer; empty if nothing is."""
    point = answer.point
    if point is None:
        claims = answer.status in (Status.SOLVED, Status.ALMOST_SOLVED)
        return f"no point with status {answer.status.name}" if claims else ""
    if regularised and answer.regularised is None:
        return "no regularised values (T19)"
    return fault_of_point(program, point)


def read_options(backend: Backend, given: Mapping[str, Any]) -> Any:
    """Return the options of a backend from a mapping; raises `InputError` on unknown names."""
    known = [field.name for field in fields(backend.Options)]
    if not isinstance(given, Mapping):
        raise InputError("options", given, "no mapping", "give {'name': value}")
    for name in given:
        if name not in known:
            require_known(f"options of backend {backend.name!r}", name, known)
    return backend.Options(**given)


def nominal_tolerance(backend: Backend, options: Any) -> float:
    """Return the tolerance in options as a nominal one, for any backend; 0 without one."""
    tolerance = float(getattr(options, "tolerance", 0.0))
    return tolerance / TRUE_GAP if backend.capabilities.true_gap else tolerance
