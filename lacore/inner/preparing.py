"""A backend ready for one program after the other: in its process, and asked in good units."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

from lacore.backend import TRUE_GAP, Backend, PreparedSolver
from lacore.inner.local_speeds import LocalSpeedSolver
from lacore.inner.rescaling import GOOD, RescalingSolver
from lacore.inner.strong_bodies import StrongBodySolver
from lacore.process.isolation import SolverProcess
from lacore.program import KinematicProgram

Prepare = Callable[[KinematicProgram], PreparedSolver]
JUDGE = "auto"
"""Exact backend that proves what others claim, where these prove no equilibrium; by two solvers."""


ROUGH = 1e-4
"""Nominal tolerance of solves whose answers are only where others begin."""


def rough(backend: Backend, options: Any) -> Any:
    """Options of such a solve; those given where the backend has no tolerance, or a looser one."""
    if not hasattr(options, "tolerance"):
        return options
    loose = ROUGH * (TRUE_GAP if backend.capabilities.true_gap else 1.0)
    return replace(options, tolerance=max(loose, options.tolerance))


@contextmanager
def preparing(
    backend: Backend,
    options: Any,
    process: SolverProcess | None = None,
    good: float = GOOD,
) -> Iterator[Prepare]:
    """A backend at work on one program after the other, isolated where it asks for it.

    Args:
        backend: exact ones are asked for strong bodies as rigid ones first
            (`lacore.inner.strong_bodies`), and in units of the parts of a program
            (`lacore.inner.rescaling`); penalties of regularised ones (T20) are not to be scaled.
        options: of the backend.
        process: to work in, one program at a time; None: one of its own where it needs one.
        good: residual of a solve with which it is not asked again in other units.
    """
    if process is None and backend.capabilities.isolated:
        with SolverProcess() as own, preparing(backend, options, own, good) as prepare:
            yield prepare
        return

    def plain(program: KinematicProgram) -> PreparedSolver:
        if process is None:
            return backend.prepare(program, options)
        return process.prepare(backend, program, options)

    if backend.capabilities.regularised:
        yield plain
    else:

        def local(program: KinematicProgram) -> PreparedSolver:
            return LocalSpeedSolver(program, plain, good)

        yield lambda program: StrongBodySolver(
            program, lambda own: RescalingSolver(own, local, good)
        )
