"""Names for authors of backends: the contract with solvers, and the registry of backends."""

from lacore.solvers.contract import (
    TRUE_GAP,
    Backend,
    Capabilities,
    Family,
    InnerSolution,
    Prepare,
    PreparedSolver,
    WarmsUp,
    Writer,
    Writes,
    check_capable,
    checked_answer,
    nominal_tolerance,
    read_options,
)
from lacore.solvers.registry import GROUP, backend_names, find_backend, load_backend

__all__ = [
    "GROUP",
    "TRUE_GAP",
    "Backend",
    "Capabilities",
    "Family",
    "InnerSolution",
    "Prepare",
    "PreparedSolver",
    "WarmsUp",
    "Writer",
    "Writes",
    "backend_names",
    "check_capable",
    "checked_answer",
    "find_backend",
    "load_backend",
    "nominal_tolerance",
    "read_options",
]
