"""Work on several items in processes, each within a time limit."""

from collections.abc import Generator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from contextlib import ExitStack
from pkgutil import resolve_name
from queue import SimpleQueue
from typing import Any, TypeVar

from lacore.solvers.child_process import ChildProcess
from lacore_verification.harness.perform.processes import ONE_THREAD

TOGETHER = 4
"""Items for which another process takes as long to start as the work on them."""
_Item = TypeVar("_Item")


def processes(items: int, jobs: int) -> int:
    """Return the number of processes for items, `jobs` at most; 0 is this process."""
    return min(jobs, items // TOGETHER)


def answers(
    worker: str, method: str, items: Sequence[_Item], jobs: int, limit: float, isolate: bool
) -> Generator[tuple[_Item, Any]]:
    """Yield each item with its result, or with the exception in its place.

    Args:
        worker: ``module:Class`` of the worker.
        method: Name of its method, whose argument is an item.
        items: Items in the order of the results, if all are done in this process.
        jobs: Processes at most. A few items are done in this process.
        limit: Seconds for each item, in another process.
        isolate: Whether even a few items are done in another process, because they run code of
            users, which could end this one.
    """
    count = max(int(isolate), processes(len(items), jobs))
    if count < 1:
        own = resolve_name(worker)()
        for item in items:
            yield item, _answer(getattr(own, method), item)
        return
    idle: SimpleQueue[ChildProcess] = SimpleQueue()

    def task(item: _Item) -> Any:
        child = idle.get()
        try:
            return _answer(child.ask, limit, method, item)
        finally:
            idle.put(child)

    with ExitStack() as stack:
        children = [ChildProcess(worker, ONE_THREAD) for _ in range(count)]
        for child in children:
            stack.callback(child.close)
            idle.put(child)
        pool = stack.enter_context(ThreadPoolExecutor(count))

        def abandon() -> None:
            pool.shutdown(wait=False, cancel_futures=True)
            for child in children:
                child.kill()

        stack.callback(abandon)
        tasks: dict[Future[Any], _Item] = {pool.submit(task, item): item for item in items}
        for future in as_completed(tasks):
            yield tasks[future], future.result()


def _answer(ask: Any, *arguments: Any) -> Any:
    try:
        return ask(*arguments)
    except Exception as error:  # Its process ended, or the item cannot be sent.
        return error
