"""Several solves at a time."""

from collections.abc import Callable, Mapping, Sequence
from queue import SimpleQueue
from typing import Any

from lacore.assembly.discretisation import Discretisation
from lacore.errors import require_count
from lacore.limit.solve import solve
from lacore.limit.state import LimitState
from lacore.numerics.threads import each
from lacore.solvers.isolation import SolverProcess

Told = Callable[[int, LimitState], None]


def solved(
    problems: Sequence[Discretisation],
    given: Mapping[str, Any],
    workers: int = 1,
    on_state: Told | None = None,
) -> list[LimitState]:
    """The limit states of problems, in their order.

    Args:
        problems: assembled ones.
        given: what `lacore.solve` is given besides.
        workers: how many are solved at a time, each by a process of its own. Threads wait for them:
            so problems need not be pickled, and scripts no guard.
        on_state: called with the number and the state of each as it ends.

    Raises:
        InputError: `workers` is no positive whole number; what `lacore.solve` refuses.
        CapabilityError: see `lacore.solve`.
    """
    require_count("workers", workers)
    tell = on_state or (lambda number, state: None)
    count = min(workers, len(problems))
    processes = [SolverProcess() for _ in range(count)] if count > 1 else []
    idle: SimpleQueue[SolverProcess | None] = SimpleQueue()
    for process in processes:
        idle.put(process)
    if not processes:
        idle.put(None)  # as `lacore.solvers.registry.load_backend` decides

    def one(problem: Discretisation) -> LimitState:
        process = idle.get()
        try:
            return solve(problem, process=process, **given)
        finally:
            idle.put(process)

    found: list[LimitState] = []
    try:
        for number, state in enumerate(each(one, problems, count)):
            found.append(state)
            tell(number, state)
    finally:
        for process in processes:
            process.close()
    return found
