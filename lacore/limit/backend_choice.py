"""Choose the backend, the coupling and the program of a solve.

Unsupported combinations are rejected before anything is solved.
"""

from __future__ import annotations  # not evaluated: what they name is not loaded

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from lacore.coupling.kinds import CERTIFIED, COUPLINGS, coupling_for
from lacore.program.kinematic import KinematicProgram, dimensionless
from lacore.reporting.errors import InputError, require_known
from lacore.solvers.backend import Backend, check_capable, find_backend, read_options
from lacore.solvers.isolation import SolverProcess

if TYPE_CHECKING:
    from lacore.assembly.discretisation import Discretisation


def backend_for(
    backend: str,
    coupling: str | None,
    options: Mapping[str, Any],
    process: SolverProcess | None = None,
) -> tuple[Backend, str, Any]:
    """Return a backend, the requested coupling or its default one, and its options.

    Args:
        backend: Name of the backend.
        coupling: Name of the coupling; None selects the default of the backend.
        options: Options of the backend, by name.
        process: Process in which the backend works; None lets
            `lacore.solvers.registry.load_backend` decide.

    Raises:
        InputError: A name is unknown, an option is out of range, or the backend does not support
            the coupling.
        CapabilityError: The backend is missing.
    """
    if coupling is not None:
        require_known("coupling", coupling, COUPLINGS)
    found = find_backend(backend, process)
    return found, coupling_for(found, coupling), read_options(found, options)


def program_to_solve(
    problem: Discretisation, backend: Backend, coupling: str, requested: str | None
) -> KinematicProgram:
    """Return the dimensionless program that a coupling solves.

    Args:
        problem: The discretised problem.
        backend: Backend that solves the program.
        coupling: Name of the coupling.
        requested: Coupling that the caller gave; None where `coupling` is the default.

    Raises:
        InputError: The coupling iterates on contact reactions only, and a soil has non-associated
            flow; or a number of the problem is not finite.
        CapabilityError: The backend does not support the program.
    """
    natural = dimensionless(problem.program, problem.natural)
    program = COUPLINGS[coupling].program_of(natural)
    check_capable(backend, program)
    if not program.frictional or coupling == CERTIFIED:
        return program
    why = "iterates on contact reactions, and a soil here has non-associated flow"
    single = "'associated' or 'davis' for a single solve"
    if requested is None:
        raise InputError(
            "backend",
            backend.name,
            f"is regularised, so that coupling={coupling!r} was chosen, which {why}",
            f"take an exact backend such as 'clarabel', or coupling={single}",
        )
    raise InputError(
        "coupling",
        coupling,
        why,
        f"take 'certified' and an exact backend such as 'clarabel', or {single}",
    )
