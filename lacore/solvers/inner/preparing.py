"""A backend ready for one program after another, asked in scaled units."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from lacore.program.kinematic import KinematicProgram
from lacore.reporting.errors import CapabilityError
from lacore.solvers.backend import TRUE_GAP, Backend, PreparedSolver, find_backend, read_options
from lacore.solvers.inner.local_speeds import LocalSpeedSolver
from lacore.solvers.inner.rescaling import GOOD, RescalingSolver
from lacore.solvers.inner.strong_bodies import StrongBodySolver

Prepare = Callable[[KinematicProgram], PreparedSolver]
ROUGH = 1e-4
"""Nominal tolerance of solves whose answers are only where others begin."""


def rough(backend: Backend, options: Any) -> Any:
    """Options of such a solve; those given where the backend has no tolerance, or a looser one."""
    if not hasattr(options, "tolerance"):
        return options
    loose = ROUGH * (TRUE_GAP if backend.capabilities.true_gap else 1.0)
    return replace(options, tolerance=max(loose, options.tolerance))


def preparing(backend: Backend, options: Any, good: float = GOOD) -> Prepare:
    """Return the function that puts a backend to work on a program.

    Args:
        backend: Exact ones are asked for strong bodies as rigid ones first
            (`lacore.solvers.inner.strong_bodies`), and in units of the parts of a program
            (`lacore.solvers.inner.rescaling`); penalties of regularised ones (T20) are not to be
            scaled.
        options: Of the backend.
        good: Residual of a solve with which it is not asked again in other units.
    """

    def plain(program: KinematicProgram) -> PreparedSolver:
        return backend.prepare(program, options)

    if backend.capabilities.regularised:
        return plain

    def local(program: KinematicProgram) -> PreparedSolver:
        return LocalSpeedSolver(program, plain, good)

    return lambda program: StrongBodySolver(program, lambda own: RescalingSolver(own, local, good))


def prepared_by(name: str, options: Mapping[str, Any], good: float = GOOD) -> Prepare:
    """Find a backend, read its options, and return the function that puts it to work.

    Args:
        name: Of the backend.
        options: By name.
        good: See `preparing`.

    Raises:
        InputError: There is no such backend, or an option is invalid.
        CapabilityError: The backend is missing.
    """
    backend = find_backend(name)
    return preparing(backend, read_options(backend, options), good)


def require_exact(name: str, result: str) -> Backend:
    """Return a backend that is exact.

    Args:
        name: Of the backend.
        result: What is to be proven: ``a lower bound``.

    Raises:
        InputError: There is no such backend.
        CapabilityError: It is missing or regularised.
    """
    backend = find_backend(name)
    if backend.capabilities.regularised:
        raise CapabilityError(
            f"backend {name!r} is regularised and cannot prove {result}: use an exact backend such"
            " as 'clarabel'"
        )
    return backend
