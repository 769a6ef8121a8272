"""Compare backends on cases: plan the runs, run them, keep every row."""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import lacore as la
from lacore.backend import load_backend
from lacore.coupling import Iterate
from lacore.errors import require_known
from verification.catalogue import catalogue, find
from verification.harness import COLUMNS, FAIL, PASS, SKIPPED, Outcome, Run, execute
from verification.store import ResultFile

ON_DEMAND = ("highs", "ipopt-static", "trust-constr")
"""Backends that a comparison leaves out unless they are named: linear programs only, or slow."""

TIME_LIMIT = 600.0  # s, of one inner solve: ten times what the largest default run needs


def plan(
    names: Sequence[str] = (),
    backends: Sequence[str] = (),
    meshes: Sequence[str] = (),
) -> list[Run]:
    """Runs of cases (``id`` or ``id:variant``; none: all) with backends on mesh levels.

    Without `backends` all registered ones but those `ON_DEMAND`; ``all`` is every one of them, and
    variants of a family are named as ``cvxpy:SCS``. Without `meshes` the default levels of each
    variant.

    Raises:
        InputError: an unknown name.
    """
    if list(backends) == ["all"]:
        backends = la.backend_names()
    backends = backends or [name for name in la.backend_names() if name not in ON_DEMAND]
    for name in backends:
        with suppress(la.CapabilityError):  # rows say so
            load_backend(name)
    picked: dict[str, list[str]] = {}
    for name in names or catalogue():
        case, variants = find(name)
        chosen = picked.setdefault(case.id, [])
        chosen += [variant.name for variant in variants if variant.name not in chosen]
    runs = []
    for case_id, chosen in picked.items():
        case = catalogue()[case_id]
        for mesh in meshes:
            require_known(f"mesh of case {case_id!r}", mesh, case.meshes)
        for variant in case.variants:
            if variant.name in chosen:
                runs += [
                    Run(case, variant, mesh, backend)
                    for mesh in dict.fromkeys(meshes or variant.meshes)
                    for backend in dict.fromkeys(backends)
                ]
    return runs


@dataclass(frozen=True)
class Tally:
    """How many runs ended how."""

    passed: int
    failed: int
    skipped: int

    @property
    def text(self) -> str:
        """One line."""
        return f"{self.passed} pass, {self.failed} FAIL, {self.skipped} skipped"


def tally(outcomes: Sequence[Outcome]) -> Tally:
    """Count verdicts."""
    verdicts = [outcome.row.verdict for outcome in outcomes]
    return Tally(verdicts.count(PASS), verdicts.count(FAIL), verdicts.count(SKIPPED))


def run_all(
    runs: Sequence[Run],
    results: Path,
    on_start: Callable[[Run], None] = lambda _: None,
    on_iterate: Callable[[Iterate], None] = lambda _: None,
    on_finish: Callable[[Outcome], None] = lambda _: None,
    time_limit: float = TIME_LIMIT,
) -> list[Outcome]:
    """Run, and write each row to the CSV file `results` as soon as it is finished.

    Backends work in a process of their own, so that one that hangs for longer than `time_limit`
    (s, one inner solve), or crashes, costs its own row and no other.

    Raises:
        InputError: the file cannot be written.
    """
    parameters = {f"param_{name}": None for run in runs for name in run.variant.parameters}
    outcomes = []
    with (
        ResultFile(results, [*COLUMNS, *parameters]) as file,
        la.SolverProcess() as process,
    ):
        for outcome in execute(runs, on_start, on_iterate, process, time_limit):
            file.append(outcome.row.record())
            outcomes.append(outcome)
            on_finish(outcome)
    return outcomes
