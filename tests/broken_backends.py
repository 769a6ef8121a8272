"""Backends with one defect each, Clarabel otherwise; child processes find them as installed ones.

`plant` writes the metadata of a package that registers them into a folder for ``sys.path``.
"""

import ctypes
import os
import signal
import subprocess
import sys
import time
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

import lacore as la
from lacore.solvers.backend import Capabilities, InnerSolution

SLEEP = 3600.0
COMPILE = 1.5


@dataclass(frozen=True)
class Options:
    time_limit: float = 60.0
    tell: str = ""  # a file that gets the process id when the solve begins


class Works:
    """The base of all: no defect."""

    title = source = "planted"
    capabilities = Capabilities(regularised=False, isolated=True)
    statuses = {}  # noqa: RUF012
    Options = Options

    @property
    def name(self):
        return type(self).__name__

    def unavailable(self):
        return ""

    def version(self):
        return "0"

    def prepare(self, program, options):
        clarabel = la.find_backend("clarabel")
        return Solver(clarabel.prepare(program, clarabel.Options()), self, options)

    def solve(self, solver, contact):
        return solver.solve(contact)


class Solver:
    def __init__(self, solver, backend, options):
        self.solver, self.backend, self.options = solver, backend, options

    def solve(self, contact):
        if self.options.tell:
            Path(self.options.tell).write_text(str(os.getpid()))
        return self.backend.solve(self.solver, contact)

    def close(self):
        pass


class SleepsInPrepare(Works):
    def prepare(self, program, options):
        time.sleep(SLEEP)


class Sleeps(Works):
    def solve(self, solver, contact):
        time.sleep(SLEEP)


class SleepsInClose(Works):
    def prepare(self, program, options):
        solver = super().prepare(program, options)
        solver.close = lambda: time.sleep(SLEEP)
        return solver


class HoldsTheInterpreter(Works):
    """As a solver in C does: no other Python thread runs meanwhile."""

    def solve(self, solver, contact):
        ctypes.PyDLL(None).sleep(int(SLEEP))


class IgnoresSignals(Works):
    def solve(self, solver, contact):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, signal.SIG_IGN)
        time.sleep(SLEEP)


class StartsAProgram(Works):
    """As a solver with an executable of its own does; that one hangs, and holds every pipe."""

    def solve(self, solver, contact):
        if os.fork() == 0:
            time.sleep(SLEEP)
        subprocess.run([sys.executable, "-c", f"import time; time.sleep({SLEEP})"])


class Exits(Works):
    def solve(self, solver, contact):
        os._exit(3)


class ExitsInPrepare(Works):
    def prepare(self, program, options):
        sys.exit(4)


class Segfaults(Works):
    def solve(self, solver, contact):
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        ctypes.string_at(0)


class Raises(Works):
    def solve(self, solver, contact):
        raise ZeroDivisionError("planted")


class OddError(Exception):
    """It cannot be built from its own arguments, so it does not pickle."""

    def __init__(self, one, two):
        super().__init__(f"{one} and {two}")


class RaisesOddly(Works):
    def solve(self, solver, contact):
        raise OddError("this", "that")


class RunsOutOfMemory(Works):
    def solve(self, solver, contact):
        np.ones(2**50)


class AnswersNone(Works):
    def solve(self, solver, contact):
        return None


class AnswersALambda(Works):
    def solve(self, solver, contact):
        return replace(solver.solve(contact), message=lambda: None)


class AnswersNoPoint(Works):
    def solve(self, solver, contact):
        return replace(solver.solve(contact), point=None)


class AnswersNaN(Works):
    def solve(self, solver, contact):
        answer = solver.solve(contact)
        return replace(
            answer,
            point=replace(
                answer.point,
                **{
                    "velocity": answer.point.velocity * np.nan,
                    "load_factor": np.nan,
                    "normal_reaction": answer.point.normal_reaction * np.nan,
                },
            ),
        )


class AnswersWrongShapes(Works):
    def solve(self, solver, contact):
        answer = solver.solve(contact)
        short = answer.point.velocity[:-1]
        return replace(answer, point=replace(answer.point, velocity=short))


class AnswersWrongStress(Works):
    """Right shapes, wrong numbers: only residuals can tell."""

    def solve(self, solver, contact):
        answer = solver.solve(contact)
        wrong = tuple(-stress for stress in answer.point.stress)
        return replace(answer, point=replace(answer.point, stress=wrong))


class Talks(Works):
    """On every channel that the protocol could be using, and reads from the other."""

    def solve(self, solver, contact):
        print("noise", flush=True)  # noqa: T201
        os.write(1, b"noise\n")
        subprocess.run([sys.executable, "-c", "print('noise')"], check=True)
        assert sys.stdin.read() == ""
        return solver.solve(contact)


class AnswersAtLength(Works):
    """More than any pipe holds."""

    def solve(self, solver, contact):
        answer: InnerSolution = solver.solve(contact)
        return replace(answer, message="x" * 2**25)


class TakesMemory(Works):
    """200 MB, for a moment."""

    def solve(self, solver, contact):
        np.ones(25_000_000).sum()
        return solver.solve(contact)


class CompilesSlowly(Works):
    compiled = 0

    def warm_up(self):
        time.sleep(COMPILE)
        self.compiled += 1

    def version(self):
        return f"compiled {self.compiled} times"

    def solve(self, solver, contact):
        assert self.compiled == 1
        return solver.solve(contact)


class CompilesInVain(Works):
    def warm_up(self):
        raise ValueError("no compiler")


class CompilesForEver(Works):
    def warm_up(self):
        time.sleep(SLEEP)


BACKENDS = [Works, *Works.__subclasses__()]


class CannotStart:
    def __init__(self):
        raise FileNotFoundError("no licence")


UNUSABLE = {  # class, and what is to be said of it
    "CannotStart": ("CannotStart", "FileNotFoundError: no licence"),
    "IsNotThere": ("Misspelt", "no attribute 'Misspelt'"),
}


def plant(folder):
    """Register all of them for processes that have the folder on ``sys.path``."""
    info = folder / "broken_backends-0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: broken-backends\nVersion: 0\n")
    classes = {kind.__name__: kind.__name__ for kind in BACKENDS}
    classes |= {name: found for name, (found, _) in UNUSABLE.items()}
    lines = [f"{name} = {__name__}:{found}" for name, found in classes.items()]
    (info / "entry_points.txt").write_text("\n".join(["[lacore.backends]", *lines, ""]))
