"""Backends that lie, break things or describe themselves wrongly, each in one way; else Clarabel.

`register` writes the metadata of a package that registers them into a folder for ``sys.path``. Each
`Lie` states how its defect is reported; no lie may make a wrong number pass, or change the results
of another backend.
"""

import os
import subprocess
import sys
import threading
import time
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

import lacore as la
from lacore.numerics.read_only import arrays_of
from lacore_backends.clarabel_socp import Clarabel, ClarabelOptions


class Honest:
    """The base of all: no defect."""

    title = source = "made for tests"
    capabilities = Clarabel.capabilities
    statuses = Clarabel.statuses
    Options = ClarabelOptions

    @property
    def name(self):
        return type(self).__name__

    def unavailable(self):
        return ""

    def version(self):
        return "1"

    def before(self, program):
        """Called with the program before it is prepared."""

    def told(self, answer):
        """What is answered in place of an honest answer."""
        return answer

    def prepare(self, program, options):
        self.before(program)
        return Solver(Clarabel().prepare(program, options), self)


class Solver:
    def __init__(self, solver, backend):
        self.solver, self.backend = solver, backend

    def solve(self, contact):
        return self.backend.told(self.solver.solve(contact))

    def close(self):
        self.solver.close()


@dataclass(frozen=True)
class Lie:
    """A lying backend, and a pattern of the message that reports it."""

    kind: type
    message: str


LIES: dict[str, Lie] = {}


def lie(message):
    """Register a class as a lie that is reported with a message."""

    def registered(kind):
        LIES[kind.__name__] = Lie(kind, message)
        return kind

    return registered


# Programs changed in place, with and without force: one backend for each array.
ARRAYS = (
    *("reference_load", "dead_load"),
    *("groups[0].rows.data", "groups[0].volumetric.data", "groups[0].weights", "groups[0].bound"),
    *("contact.normal.data", "contact.tangential.data", "contact.weights"),
    *("contact.coefficient", "contact.limit", "contact.dilatancy"),
)


def _doubling(name, forced):
    def before(self, program):
        array = dict(arrays_of(program)).get(f"program.{name}")
        if array is None:
            return
        if forced:
            array.flags.writeable = True
        array[:] = 2.0 * array + 0.5

    title = "".join(part.title() for part in name.replace("[0]", "").replace("_", ".").split("."))
    kind = type(f"{'Forces' if forced else 'Doubles'}{title}", (Honest,), {"before": before})
    globals()[kind.__name__] = kind
    lie("changed the program|cannot set WRITEABLE" if forced else "read-only")(kind)


for _name in ARRAYS:
    _doubling(_name, forced=False)
    _doubling(_name, forced=True)


# Wrong numbers.
@lie("do not prove the answer")
class DoublesTheLoadFactor(Honest):
    def told(self, answer):
        return replace(
            answer, point=replace(answer.point, load_factor=2 * answer.point.load_factor)
        )


@lie(r"F0\.U = 0")
class ZeroVelocity(Honest):
    def told(self, answer):
        return replace(answer, point=replace(answer.point, velocity=0 * answer.point.velocity))


@lie("do not prove the answer")
class DoublesTheVelocity(Honest):
    def told(self, answer):
        return replace(answer, point=replace(answer.point, velocity=2 * answer.point.velocity))


@lie("do not prove the answer")
class TurnsStresses(Honest):
    def told(self, answer):
        turned = tuple(-own for own in answer.point.stress)
        return replace(answer, point=replace(answer.point, stress=turned))


@lie("do not prove the answer")
class PullsAtContact(Honest):
    def told(self, answer):
        pulled = -answer.point.normal_reaction
        return replace(answer, point=replace(answer.point, normal_reaction=pulled))


@lie("do not prove the answer")
class RandomPoint(Honest):
    def told(self, answer):
        draw = np.random.default_rng(1).standard_normal
        velocity = draw(answer.point.velocity.shape)
        return replace(answer, point=replace(answer.point, velocity=velocity))


@lie("do not prove the answer")
class AlmostSolvedNonsense(TurnsStresses):
    def told(self, answer):
        return replace(super().told(answer), status=la.Status.ALMOST_SOLVED)


# Wrong words.
@lie("calls the load locked, but the program is feasible")
class ClaimsLocked(Honest):
    def told(self, answer):
        return replace(answer, status=la.Status.LOCKED, point=None)


@lie("calls the structure unsafe, and no mechanism of the dead load proves it")
class ClaimsUnsafe(Honest):
    def told(self, answer):
        return replace(answer, status=la.Status.UNSAFE, point=None)


@lie(r"status = 'FREE': give the status of one solve")
class ClaimsFree(Honest):
    def told(self, answer):
        return replace(answer, status=la.Status.FREE, point=None)


# Answers of the wrong kind.
@lie(r"status = 'SOLVED': give a member of lacore\.Status")
class StatusAsText(Honest):
    def told(self, answer):
        return replace(answer, status="SOLVED")


@lie(r"point\.stress = 'None': give a tuple")
class NoStress(Honest):
    def told(self, answer):
        return replace(answer, point=replace(answer.point, stress=None))


@lie(r"iterations = '-3': give a whole number")
class NegativeIterations(Honest):
    def told(self, answer):
        return replace(answer, iterations=-3)


@lie(r"iterations = 'nan': give a whole number")
class NoIterations(Honest):
    def told(self, answer):
        return replace(answer, iterations=float("nan"))


@lie(r"solve_time = '-1\.0': give seconds")
class NegativeTime(Honest):
    def told(self, answer):
        return replace(answer, solve_time=-1.0)


@lie(r"message = 'None': give text")
class NoMessage(Honest):
    def told(self, answer):
        return replace(answer, message=None)


@lie("no point with status SOLVED")
class NoPoint(Honest):
    def told(self, answer):
        return replace(answer, point=None)


@lie("instead of an InnerSolution")
class AnswersText(Honest):
    def told(self, answer):
        return "solved"


@lie("a velocity with NaN")
class VelocityOfNaN(Honest):
    def told(self, answer):
        velocity = np.nan * answer.point.velocity
        return replace(answer, point=replace(answer.point, velocity=velocity))


@lie(r"velocity of shape")
class ShortVelocity(Honest):
    def told(self, answer):
        return replace(answer, point=replace(answer.point, velocity=answer.point.velocity[:-1]))


@lie("a velocity with NaN")
class ComplexVelocity(Honest):
    def told(self, answer):
        velocity = answer.point.velocity * (1 + 1j)
        return replace(answer, point=replace(answer.point, velocity=velocity))


@lie("a velocity with NaN")
class VelocityOfObjects(Honest):
    def told(self, answer):
        velocity = answer.point.velocity.astype(object)
        velocity[0] = "a"
        return replace(answer, point=replace(answer.point, velocity=velocity))


@lie("stresses for 0 of 1 groups")
class StressesOfNoGroup(Honest):
    def told(self, answer):
        return replace(answer, point=replace(answer.point, stress=(), mean_stress=()))


class Runs:
    """An answer that runs code where it is unpickled."""

    def __reduce__(self):
        return Path.touch, (Path(os.environ.get("LACORE_TEST_TRACE", os.devnull)),)


@lie("give text")
class RunsCodeWhereItIsRead(Honest):
    def told(self, answer):
        return replace(answer, message=Runs())


@lie("instead of an InnerSolution")
class AnswersAnotherClass(Honest):
    def told(self, answer):
        return Runs()


# Code of the judge patched, in the interpreter that the backend can reach.
@lie("do not prove the answer")
class PatchesHolds(DoublesTheLoadFactor):
    def before(self, program):
        from lacore.program.certificate import Certificate

        Certificate.holds = lambda self, tolerance: True


@lie("do not prove the answer")
class PatchesCertify(DoublesTheLoadFactor):
    def before(self, program):
        import lacore.coupling.run
        import lacore.program.certificate

        lacore.coupling.run.Certificate.of = lacore.program.certificate.certify = lambda *args: None


@lie("do not prove the answer")
class PatchesTheCheck(DoublesTheLoadFactor):
    def before(self, program):
        import lacore.solvers.contract
        import lacore.solvers.solver_worker

        lacore.solvers.contract.checked_answer = lambda program, regularised, answer: answer
        lacore.solvers.solver_worker.changed = lambda *args: []


@lie("do not prove the answer")
class PatchesNumPy(DoublesTheLoadFactor):
    def before(self, program):
        np.linalg.norm = lambda *args, **kwargs: 0.0


# Errors.
@lie("ZeroDivisionError: made for tests")
class Raises(Honest):
    def told(self, answer):
        raise ZeroDivisionError("made for tests")


@lie(r"its process ended by itself \(exit code 7\)")
class Exits(Honest):
    def told(self, answer):
        sys.exit(7)


@lie("MemoryError")
class RunsOutOfMemory(Honest):
    def told(self, answer):
        np.ones(2**50)


@lie(r"prepare\(\) returned 'None', which has no method solve")
class PreparesNothing(Honest):
    def prepare(self, program, options):
        return None


# Traces that are left behind; the answers are honest.
class Untidy(Honest):
    """What it leaves behind must cost nobody else anything."""


@lie(r"left with \d threads \(Thread-")
class LeavesThreads(Untidy):
    def told(self, answer):
        for _ in range(4):
            threading.Thread(target=_compute, daemon=True).start()
        return answer


def _compute():
    while True:
        sum(range(10_000))


@lie(r"left with \d child processes")
class LeavesAProcess(Untidy):
    def told(self, answer):
        subprocess.Popen([sys.executable, "-c", "import time; time.sleep(60)"])
        return answer


@lie("")
class Talks(Untidy):
    def told(self, answer):
        print("noise", flush=True)  # noqa: T201
        os.write(1, b"noise\n")
        return answer


@lie("")
class ChangesTheInterpreter(Untidy):
    def told(self, answer):
        os.chdir("/")
        os.environ["OMP_NUM_THREADS"] = "7"
        np.seterr(all="raise")
        sys.setrecursionlimit(150)
        np.random.seed(1)  # noqa: NPY002
        sys.path.clear()
        return answer


@lie("")
class FalseTime(Untidy):
    """Its own time is not the one that counts."""

    def told(self, answer):
        time.sleep(0.3)
        return replace(answer, solve_time=1e-9)


# What a backend says of itself.
class Undescribed(Honest):
    """It cannot be used, and a row says why."""


@lie(r"unavailable\(\) raised RuntimeError: no licence server")
class UnavailableRaises(Undescribed):
    def unavailable(self):
        raise RuntimeError("no licence server")


@lie(r"unavailable\(\) raised TypeError: it is None, not text")
class UnavailableIsNone(Undescribed):
    def unavailable(self):
        return None


@lie(r"version\(\) raised KeyError")
class VersionRaises(Undescribed):
    def version(self):
        raise KeyError("version")


@lie(r"version\(\) raised TypeError: it is None, not text")
class VersionIsNone(Undescribed):
    def version(self):
        return None


@lie(r"capabilities raised TypeError: it is \{\}")
class CapabilitiesAreADict(Undescribed):
    capabilities = {}  # noqa: RUF012


@lie(r"statuses raised TypeError: not a lacore\.Status")
class StatusesAreText(Undescribed):
    statuses = {"Solved": "solved"}  # noqa: RUF012


@lie(r"Options raised TypeError: it is .*not a dataclass")
class OptionsAreADict(Undescribed):
    Options = dict


@dataclass(frozen=True)
class _Bare:
    time_limit: float


@lie(r"the option 'time_limit' has no default")
class OptionsWithoutDefaults(Undescribed):
    Options = _Bare


@dataclass(frozen=True)
class _Limitless:
    tolerance: float = 1e-8


@lie(r"no option 'time_limit'")
class NoTimeLimit(Undescribed):
    Options = _Limitless


@dataclass(frozen=True)
class _Unplain:
    time_limit: float = 60.0
    made: object = field(default_factory=object)


@lie(r"is a object|cannot be loaded")
class OptionsOfObjects(Undescribed):
    Options = _Unplain


@lie(r"its class is named 'clarabel'")
class NamedOtherwise(Undescribed):
    name = "clarabel"


@lie("title is None, not text")
class NoTitle(Undescribed):
    title = None


@lie("FileNotFoundError: no licence")
class CannotStart(Undescribed):
    def __init__(self):
        raise FileNotFoundError("no licence")


def register(folder, extra: dict[str, str] | None = None):
    """Register all of them, and `extra` names, for processes with the folder on ``sys.path``."""
    info = folder / "lying_backends-1.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: lying-backends\nVersion: 1\n")
    names = {name: f"{__name__}:{name}" for name in ("Honest", *LIES)} | (extra or {})
    lines = [f"{name} = {target}" for name, target in names.items()]
    (info / "entry_points.txt").write_text("\n".join(["[lacore.backends]", *lines, ""]))
