"""Several solves at a time."""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from queue import SimpleQueue
from typing import Any

from lacore.assembly.discretisation import Discretisation
from lacore.errors import require_count
from lacore.limit.solve import solve
from lacore.limit.state import LimitState
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
    found: dict[int, LimitState] = {}
    if min(workers, len(problems)) < 2:
        for number, problem in enumerate(problems):
            found[number] = solve(problem, **given)
            tell(number, found[number])
        return list(found.values())
    processes = [SolverProcess() for _ in range(min(workers, len(problems)))]
    idle: SimpleQueue[SolverProcess] = SimpleQueue()
    for process in processes:
        idle.put(process)

    def one(number: int) -> None:
        process = idle.get()
        try:
            found[number] = solve(problems[number], process=process, **given)
        finally:
            idle.put(process)

    try:
        with ThreadPoolExecutor(len(processes)) as pool:
            waiting = [pool.submit(one, number) for number in range(len(problems))]
            for number, result in enumerate(waiting):
                result.result()
                tell(number, found[number])
    finally:
        for process in processes:
            process.close()
    return [found[number] for number in range(len(problems))]
