"""The backend protocol: how a solver is plugged in, found and asked.

A backend prepares a dimensionless `KinematicProgram` once and then solves it for each
`FrozenContact` that the coupling loop gives it. It is registered under its name in the entry-point
group ``lacore.backends`` and written about nowhere else.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from importlib.metadata import entry_points
from typing import Any, ClassVar, Protocol

from lacore.errors import CapabilityError, require_known
from lacore.program import FrozenContact, KinematicProgram
from lacore.regularization import RegularisedValues
from lacore.state import ProgramState
from lacore.status import Status

GROUP = "lacore.backends"


@dataclass(frozen=True)
class Capabilities:
    """What a backend can do.

    Attributes:
        regularised: it solves the regularised program (T17-T20), not the exact one.
        max_unknowns: largest number of velocity unknowns it takes; None: no limit.
    """

    regularised: bool
    max_unknowns: int | None = None


@dataclass(frozen=True)
class InnerSolution:
    """Answer of one inner solve, in the units of the program.

    Attributes:
        status: outcome.
        native_status: the solver's own word for it.
        iterations: of the solver.
        solve_time: s, wall clock, inside the solver.
        point: the velocity and its duals; None where the solver has none to give.
        regularised: the three values of T19 (regularised backends).
        message: anything else worth knowing.
    """

    status: Status
    native_status: str
    iterations: int
    solve_time: float
    point: ProgramState | None
    regularised: RegularisedValues | None = None
    message: str = ""


class PreparedSolver(Protocol):
    """A backend at work on one program."""

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve for a frozen contact; may start from the previous answer."""


class Backend(Protocol):
    """A solver that can be plugged in. `Options` is a frozen dataclass with a default a field."""

    name: ClassVar[str]
    title: ClassVar[str]
    source: ClassVar[str]
    capabilities: ClassVar[Capabilities]
    Options: ClassVar[type]

    def unavailable(self) -> str:
        """Why it cannot run here and how to get it; empty where it can."""

    def prepare(self, program: KinematicProgram, options: Any) -> PreparedSolver:
        """Everything that repeated solves share."""


def backend_names() -> list[str]:
    """Names of all registered backends, sorted."""
    return sorted({entry.name for entry in entry_points(group=GROUP)})


def find_backend(name: str) -> Backend:
    """The backend registered under a name.

    Raises:
        InputError: no such name.
        CapabilityError: it is registered, but cannot be loaded or run here.
    """
    require_known("backend", name, backend_names())
    (entry, *_) = entry_points(group=GROUP, name=name)
    try:
        backend: Backend = entry.load()()
    except ImportError as error:
        raise CapabilityError(f"backend {name!r} cannot be loaded: {error}") from error
    if reason := backend.unavailable():
        raise CapabilityError(f"backend {name!r} is not available: {reason}")
    return backend


def check_capable(backend: Backend, program: KinematicProgram) -> None:
    """Raise `CapabilityError` where a backend cannot take a program."""
    limit = backend.capabilities.max_unknowns
    if limit is not None and program.n > limit:
        raise CapabilityError(
            f"backend {backend.name!r} takes at most {limit} velocity unknowns, this problem has"
            f" {program.n}: take a coarser mesh, or a sparse backend such as 'clarabel'"
        )


def read_options(backend: Backend, given: Mapping[str, Any]) -> Any:
    """Options of a backend from a mapping; raises `InputError` on unknown names."""
    known = [field.name for field in fields(backend.Options)]
    for name in given:
        if name not in known:
            require_known(f"options of backend {backend.name!r}", name, known)
    return backend.Options(**given)
