"""Requirements on a backend other than its numbers: limits, bad data, repeated solves."""

import warnings
from collections.abc import Callable, Iterator
from dataclasses import MISSING, asdict, dataclass, fields, is_dataclass, replace
from pkgutil import resolve_name
from typing import Any

import numpy as np

import lacore as la
from lacore.program.kinematic import DissipationGroup, FrozenContact, KinematicProgram
from lacore.program.state import ProgramState
from lacore.reporting.errors import InputError
from lacore.reporting.status import Status
from lacore.solvers import plain
from lacore.solvers.backend import (
    Capabilities,
    InnerSolution,
    PreparedSolver,
    WarmsUp,
    check_capable,
    checked_answer,
    read_options,
)
from lacore.solvers.description import describe, read_description
from lacore.solvers.isolation import IsolatedBackend
from lacore.solvers.plain_answers import pack_answer, read_answer
from lacore_verification.conformance.contact_programs import sequence
from lacore_verification.conformance.hardening_programs import (
    closing_and_hardening,
    two_that_harden,
)
from lacore_verification.conformance.judge import FAIL, SKIPPED, Finding, R, Subject, judge, said
from lacore_verification.conformance.plastic_programs import many_cones
from lacore_verification.conformance.programs import WORKED
from lacore_verification.conformance.soil_programs import mohr_coulomb
from lacore_verification.conformance.worked import (
    LENGTH,
    Worked,
    cones,
    frozen,
    nowhere,
    program,
    slope,
)

_PATIENCE = 10.0  # s, limit for a solve of a program with a few unknowns
_NO_HOPE = 1.0  # s, limit for one without a solution
_AT_ONCE = 1e-9  # s
_CLAIMS = (Status.SOLVED, Status.ALMOST_SOLVED, Status.LOCKED, Status.UNSAFE, Status.FREE)


@dataclass(frozen=True)
class Bench:
    """Test bench of a backend."""

    subject: Subject

    def prepare(self, given: KinematicProgram, **options: Any) -> PreparedSolver:
        """Return the backend prepared for a program.

        Raises:
            CapabilityError: it does not support it.
        """
        backend = self.subject.backend
        check_capable(backend, given)
        asked: dict[str, Any] = {"time_limit": _PATIENCE}
        if self.subject.regularised:
            asked["r"] = R
        read = read_options(backend, asked | self.subject.options | options)
        return backend.prepare(given, read)

    def answer(self, given: KinematicProgram, contact: FrozenContact, **options: Any) -> Any:
        """Return the answer of a solver that is used once."""
        solver = self.prepare(given, **options)
        answer = solved(solver, contact)
        solver.close()
        return answer


def solved(solver: PreparedSolver, contact: FrozenContact) -> Any:
    """Return the answer without warnings, as overflow in between is not an error."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        return solver.solve(contact)


def worked_exercise(worked: Worked) -> Callable[[Bench], Iterator[Finding]]:
    """Return the exercise of one program of the table."""

    def exercise(bench: Bench) -> Iterator[Finding]:
        if bench.subject.regularised and worked.unsoftened:
            raise la.CapabilityError(worked.unsoftened)
        yield from judge(bench.subject, worked, bench.answer(worked.program, worked.contact))

    return exercise


def repeated_solves(bench: Bench) -> Iterator[Finding]:
    """Yield findings on whether repeated solves equal those of a new solver."""
    first = sequence()[0]
    solver = bench.prepare(first.program)
    for worked in sequence():
        yield from judge(bench.subject, worked, solved(solver, worked.contact))
    solver.close()


def repeated_steps(bench: Bench) -> Iterator[Finding]:
    """Yield findings as `repeated_solves`, within a step of a path."""
    solver = bench.prepare(closing_and_hardening(0.0).program)
    for limit in (0.7, 0.2, 0.2, 1.1):
        worked = closing_and_hardening(limit)
        again = replace(worked, name=f"repeated: step, friction {limit}")
        yield from judge(bench.subject, again, solved(solver, worked.contact))
    solver.close()


def hardening(bench: Bench) -> Iterator[Finding]:
    """Yield findings on hardening: solved if supported, else rejected with a message."""
    name, can = "hardening", bench.subject.backend.capabilities.hardening
    try:
        bench.prepare(two_that_harden().program).close()
    except la.CapabilityError as error:
        named = "hardening" in str(error)
        yield said(name, "refused", named and not can, f"refused with: {error}")
    else:
        yield said(name, "taken", can, "it was taken by a backend without the capability")


def surfaces(bench: Bench) -> Iterator[Finding]:
    """Yield findings on pressure-dependent strength: solved if supported, else rejected."""
    name, can = "surfaces", bench.subject.backend.capabilities.surfaces
    try:
        bench.prepare(mohr_coulomb().program).close()
    except la.CapabilityError as error:
        named = any(word in str(error) for word in ("pressure", "linear programs"))
        yield said(name, "refused", named and not can, f"refused with: {error}")
    else:
        yield said(name, "taken", can, "it was taken by a backend without the capability")


def two_solvers(bench: Bench) -> Iterator[Finding]:
    """Yield findings on two solvers used in turn, after a third was closed unused."""
    bench.prepare(_FRICTION.program).close()
    steep, other = (
        _friction(1.0, "two solvers: first"),
        _friction(2.0, "two solvers: second"),
    )
    first = bench.prepare(steep.program)
    yield from judge(bench.subject, steep, solved(first, steep.contact))
    second = bench.prepare(other.program)
    yield from judge(bench.subject, other, solved(second, other.contact))
    yield from judge(bench.subject, steep, solved(first, steep.contact))
    first.close()
    yield from judge(bench.subject, other, solved(second, other.contact))
    second.close()


def _friction(load: float, name: str) -> Worked:
    """Return a body pushed up the plane with `load` along x: alpha = (F + 3)/(0.8 load)."""
    g = 0.7
    return Worked(
        name, "", slope([load, 0]), frozen([g]), load_factor=(LENGTH * g + 3) / (0.8 * load)
    )


def iteration_limit(bench: Bench) -> Iterator[Finding]:
    """Yield findings on a limit of one iteration, which must be reported or be sufficient."""
    if not _has_option(bench, "max_iterations"):
        raise la.CapabilityError("it has no option `max_iterations`")
    yield from _limited(bench, Status.ITERATION_LIMIT, max_iterations=1)


def time_limit(bench: Bench) -> Iterator[Finding]:
    """Yield findings on a time limit of a nanosecond, which a clock check per iteration detects."""
    yield from _limited(bench, Status.TIME_LIMIT, time_limit=_AT_ONCE)


def _limited(bench: Bench, wanted: Status, **option: float) -> Iterator[Finding]:
    """Yield findings on a limit: a solver must check its limit in each iteration."""
    can = bench.subject.backend.capabilities
    given = many_cones(1 if can.max_cone == 1 else 2)
    raw = bench.answer(given, frozen(), **option)
    answer = _checked(bench, given, raw)
    # An isolated backend need not stop by itself: its process is stopped.
    excused = answer.iterations <= 1 or (wanted is Status.TIME_LIMIT and can.isolated)
    if answer.status is Status.SOLVED and excused:
        yield from judge(bench.subject, Worked(wanted.label, "", given, frozen()), raw)
        return
    ((name, value),) = option.items()
    came = f"{answer.status.label} ({answer.native_status}) after {answer.iterations} iterations"
    text = f"{wanted.label} was expected of {name} = {value:g}, {came} came"
    yield said(wanted.label, "status", answer.status is wanted, text)


def nan_in_the_program(bench: Bench) -> Iterator[Finding]:
    """Yield findings on NaN in a program, which is rejected before the backend sees it."""
    name = "NaN in the program"
    bad = np.array([0.6, np.nan])
    for what, given in (
        ("reference_load", program([cones([np.eye(2)], [2], [3])], nowhere(2), bad)),
        ("bound", program([cones([np.eye(2)], [2], [np.nan])], nowhere(2), [0.6, 0.8])),
        ("modulus", program([_with_nan_modulus()], nowhere(2), [0.6, 0.8])),
        ("contact.normal", _with_nan_rows(slope([1, 0]))),
    ):
        try:
            bench.prepare(given)
        except InputError as error:
            yield said(name, what, what in str(error), f"refused without naming it: {error}")
        else:
            yield said(name, what, False, f"a program with NaN in {what} was prepared")


def _with_nan_modulus() -> DissipationGroup:
    return replace(cones([np.eye(2)], [2], [3]), modulus=np.array([np.nan]))


def _with_nan_rows(given: KinematicProgram) -> KinematicProgram:
    return replace(given, contact=replace(given.contact, normal=given.contact.normal * np.nan))


def declaration(bench: Bench) -> Iterator[Finding]:
    """Yield findings on the description of a backend: complete and of the correct types."""
    name, backend = "declaration", bench.subject.backend
    for what in ("name", "title", "source"):
        text = getattr(backend, what)
        yield said(name, what, isinstance(text, str) and text != "", f"it is {text!r}")
    version = backend.version()
    known = isinstance(version, str) and any(map(str.isdigit, version))
    yield said(name, "version", known, f"{version!r} names no version")
    yield said(
        name,
        "capabilities",
        isinstance(backend.capabilities, Capabilities),
        f"{backend.capabilities!r} is no Capabilities",
    )
    wrong = {key: value for key, value in backend.statuses.items() if type(value) is not Status}
    yield said(name, "statuses", not wrong, f"no Status: {wrong}")
    meant = set(backend.statuses.values())
    yield said(name, "solved", Status.SOLVED in meant, "no native status means SOLVED")


def options(bench: Bench) -> Iterator[Finding]:
    """Yield findings on options: a frozen dataclass with defaults that rejects invalid values."""
    name, backend = "options", bench.subject.backend
    if not is_dataclass(backend.Options):
        yield said(name, "dataclass", False, f"{backend.Options!r} is no dataclass")
        return
    known = fields(backend.Options)
    bare = [f.name for f in known if f.default is MISSING and f.default_factory is MISSING]
    yield said(name, "defaults", not bare, f"no default: {bare}")
    frozen_class = getattr(backend.Options, "__dataclass_params__").frozen  # noqa: B009
    yield said(name, "frozen", bool(frozen_class), "a solver could change them under the others")
    needed = ["time_limit", *(["r"] if bench.subject.regularised else [])]
    for option in needed:
        yield said(name, option, _has_option(bench, option), f"there is no option {option!r}")
    for option in filter(lambda option: _has_option(bench, option), _POSITIVE):
        for value in (0, -1, float("nan"), "much"):
            yield _refused(bench, option, value)
    for wrong, right in (("time_limt", "time_limit"),):
        try:
            read_options(backend, {wrong: 1.0})
        except InputError as error:
            hint = f"did you mean {right!r}" in str(error)
            yield said(name, "unknown option", hint, f"no hint at {right!r}: {error}")
        else:
            yield said(name, "unknown option", False, f"{wrong!r} was taken")


_POSITIVE = ("time_limit", "tolerance", "max_iterations", "r")


def _refused(bench: Bench, option: str, value: object) -> Finding:
    check = f"{option} = {value}"
    try:
        bench.prepare(_FRICTION.program, **{option: value}).close()
    except InputError as error:
        return said("options", check, option in str(error), f"refused without its name: {error}")
    except Exception as error:
        text = f"{type(error).__name__} instead of InputError: {error}"
        return said("options", check, False, text)
    return said("options", check, False, "was taken; InputError was expected")


def separate_process(bench: Bench) -> Iterator[Finding]:
    """Yield findings on processes: an importable class, with plain data in its answers."""
    name, backend = "separate process", bench.subject.backend
    kind = type(backend)
    try:
        there = resolve_name(f"{kind.__module__}:{kind.__qualname__}") is kind
        why = "another class has its name"
    except (ImportError, AttributeError, ValueError) as error:
        there, why = False, f"{type(error).__name__}: {error}"
    yield said(name, "class", there, f"{kind.__qualname__} cannot be imported by its name: {why}")
    try:
        read_description(plain.loads(plain.dumps(describe(backend))), backend.name, "")
    except (TypeError, ValueError, la.CapabilityError) as error:
        yield said(name, "description", False, str(error))
    else:
        yield said(name, "description", True, "")
    answer = bench.answer(_FRICTION.program, _FRICTION.contact)
    try:
        back = read_answer(plain.loads(plain.dumps(pack_answer(answer))), 0.0, np.nan)
    except (TypeError, ValueError) as error:
        yield said(name, "answer", False, str(error))
        return
    same = isinstance(answer, InnerSolution) and _equal(back.point, answer.point)
    yield said(name, "answer", same, f"came back as {back!r}")


def warm_up(bench: Bench) -> Iterator[Finding]:
    """Yield findings on `warm_up`, if present, which may be called before each solve."""
    name, backend = "warm-up", bench.subject.backend
    fault = ""
    try:
        if isinstance(backend, IsolatedBackend):
            backend.start()
            there = np.isfinite(backend.process.compile_time)
        else:
            there = isinstance(backend, WarmsUp)
            if isinstance(backend, WarmsUp):
                backend.warm_up()
                backend.warm_up()
    except Exception as error:
        there, fault = True, f"{type(error).__name__} was raised: {error}"
    if not there:
        raise la.CapabilityError("it has no `warm_up`: what it compiles counts as solve time")
    yield said(name, "called", not fault, fault)
    yield from judge(
        bench.subject,
        replace(_FRICTION, name=name),
        bench.answer(_FRICTION.program, _FRICTION.contact),
    )


def _equal(one: ProgramState | None, other: ProgramState | None) -> bool:
    """Return whether states are equal to the last bit, with NaN equal to NaN."""
    if one is None or other is None:
        return one is other
    try:
        np.testing.assert_equal(asdict(one), asdict(other))
    except AssertionError:
        return False
    return True


def left_running(bench: Bench) -> Iterator[Finding]:
    """Yield findings on threads and processes that remain after a solver is closed."""
    backend = bench.subject.backend
    if not isinstance(backend, IsolatedBackend):
        raise la.CapabilityError("it works in the process of the caller, which has its own threads")
    backend.process.take_note()
    bench.answer(_FRICTION.program, _FRICTION.contact)
    note = backend.process.take_note()
    left = note is not None and note.left_running
    yield said("left running", "nothing", not left, str(note or ""))


_FRICTION = next(worked for worked in WORKED if worked.name == "friction")

EXERCISES: dict[str, Callable[[Bench], Iterator[Finding]]] = {
    **{worked.name: worked_exercise(worked) for worked in WORKED},
    "hardening": hardening,
    "surfaces": surfaces,
    "repeated solves": repeated_solves,
    "repeated solves that harden": repeated_steps,
    "two solvers": two_solvers,
    "iteration limit": iteration_limit,
    "time limit": time_limit,
    "NaN in the program": nan_in_the_program,
    "declaration": declaration,
    "options": options,
    "separate process": separate_process,
    "warm-up": warm_up,
    "left running": left_running,
}


def _has_option(bench: Bench, option: str) -> bool:
    return option in {field.name for field in fields(bench.subject.backend.Options)}


def _checked(bench: Bench, given: KinematicProgram, raw: object) -> InnerSolution:
    return checked_answer(given, bench.subject.regularised, raw)


def examine(bench: Bench, exercise: str) -> list[Finding]:
    """Return all findings of one exercise, including any error."""
    found: list[Finding] = []
    try:
        found.extend(EXERCISES[exercise](bench))
    except la.CapabilityError as error:
        return [Finding(exercise, "capability", np.nan, np.nan, SKIPPED, str(error))]
    except Exception as error:
        text = f"{type(error).__name__} was raised: {error}"
        found.append(Finding(exercise, "raised", np.nan, np.nan, FAIL, text))
    return found
