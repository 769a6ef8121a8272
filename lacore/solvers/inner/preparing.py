"""Prepare backends for one program after another, in scaled units."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from lacore.program.kinematic import KinematicProgram
from lacore.reporting.errors import CapabilityError
from lacore.solvers.backend import (
    TRUE_GAP,
    Backend,
    Prepare,
    PreparedSolver,
    find_backend,
    read_options,
)
from lacore.solvers.inner.local_speeds import LocalSpeedSolver
from lacore.solvers.inner.rescaling import GOOD, RescalingSolver
from lacore.solvers.inner.strong_bodies import StrongBodySolver

ROUGH = 1e-4
"""Nominal tolerance of rough solves, whose answers only start more accurate ones."""


def rough_options(backend: Backend, options: Any) -> Any:
    """Return the options of a rough solve.

    They are the given ones if the backend has no tolerance, or if theirs is looser.
    """
    if not hasattr(options, "tolerance"):
        return options
    loose = ROUGH * (TRUE_GAP if backend.capabilities.true_gap else 1.0)
    return replace(options, tolerance=max(loose, options.tolerance))


def preparer(backend: Backend, options: Any, good: float = GOOD) -> Prepare:
    """Return the function that prepares a backend for a program.

    Args:
        backend: Exact backends first solve with strong bodies as rigid
            (`lacore.solvers.inner.strong_bodies`), and in units of the parts of a program
            (`lacore.solvers.inner.rescaling`). Penalties of regularised backends (T20) must not be
            scaled.
        options: Options of the backend.
        good: Residual below which a solve is not repeated in other units.
    """

    def plain(program: KinematicProgram) -> PreparedSolver:
        return backend.prepare(program, options)

    if backend.capabilities.regularised:
        return plain

    def local(program: KinematicProgram) -> PreparedSolver:
        return LocalSpeedSolver(program, plain, good)

    return lambda program: StrongBodySolver(program, lambda own: RescalingSolver(own, local, good))


def preparer_named(name: str, options: Mapping[str, Any], good: float = GOOD) -> Prepare:
    """Find a backend, read its options, and return the function that prepares it.

    Args:
        name: Name of the backend.
        options: Options of the backend, by name.
        good: See `preparer`.

    Raises:
        InputError: There is no such backend, or an option is invalid.
        CapabilityError: The backend is missing.
    """
    backend = find_backend(name)
    return preparer(backend, read_options(backend, options), good)


def require_exact(name: str, result: str) -> Backend:
    """Find a backend and raise an error unless it is exact.

    Args:
        name: Name of the backend.
        result: Result that the backend is to prove, for the message: ``a lower bound``.

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
