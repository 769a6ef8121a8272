"""Which backend answers which coupling, and what is refused before anything is solved."""

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


def engine_for(
    backend: str,
    coupling: str | None,
    options: Mapping[str, Any],
    process: SolverProcess | None = None,
) -> tuple[Backend, str, Any]:
    """A backend, the coupling that it is asked for or its default, and its options.

    Args:
        backend: Its name.
        coupling: None for the default of the backend.
        options: Of the backend, by name.
        process: In which it is to work; None: as `lacore.solvers.registry.load_backend` decides.

    Raises:
        InputError: an unknown name, an option out of range, or a coupling that it cannot do.
        CapabilityError: it is missing.
    """
    if coupling is not None:
        require_known("coupling", coupling, COUPLINGS)
    engine = find_backend(backend, process)
    return engine, coupling_for(engine, coupling), read_options(engine, options)


def stated(
    problem: Discretisation, engine: Backend, coupling: str, asked: str | None
) -> KinematicProgram:
    """The program that a coupling answers, dimensionless; `asked`: None, where it is the default.

    Raises:
        InputError: a loop on contact reactions alone, beside soils whose flow is not associated;
            numbers that are none.
        CapabilityError: the backend cannot take it.
    """
    natural = dimensionless(problem.program, problem.natural)
    program = COUPLINGS[coupling].program_of(natural)
    check_capable(engine, program)
    if not program.frictional or coupling == CERTIFIED:
        return program
    why = "iterates on contact reactions, and a soil here dilates less than its friction"
    single = "'associated' or 'davis' for a single solve"
    if asked is None:
        raise InputError(
            "backend",
            engine.name,
            f"is regularised, so that coupling={coupling!r} was chosen, which {why}",
            f"take an exact backend such as 'clarabel', or coupling={single}",
        )
    raise InputError(
        "coupling",
        coupling,
        why,
        f"take 'certified' and an exact backend such as 'clarabel', or {single}",
    )
