"""A campaign: all problems of all classes, with failures reduced and stored, and the totals."""

import pprint
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import lacore as la
from lacore_verification.fuzz.drawn.cases import kind_of, recipe_of
from lacore_verification.harness.campaigns.shrinking import shrunk
from lacore_verification.harness.perform.processes import Executor
from lacore_verification.harness.perform.random_run import LOAD, UNKNOWN
from lacore_verification.harness.verdicts.words import FAIL, NO_RESULT, PASS, SKIPPED
from lacore_verification.runs.outcome import Outcome
from lacore_verification.runs.run import Run

_MOST_CUT = 20
"""Wrong ones that are cut down, one of each class and check first: a campaign ends."""
_HANG = la.Status.TIME_LIMIT.label
_SNIPPET = '''"""{title}

{why}
"""

import lacore as la
from lacore_verification.fuzz.drawn.recipe import build

RECIPE = {recipe}

if __name__ == "__main__":
    problem = build(RECIPE)
    {solve}
'''


@dataclass(frozen=True)
class Tally:
    """Results of a class.

    Attributes:
        problems: all but those that were refused.
        refused: by an `InputError`: no valid problem.
        loads, certified: those that have a load factor, and those of them with a proven one.
        words: locked, unsafe or free, without contradiction.
        unknown: without a number or such a status, and whether there is a load factor is unknown.
        missing: of those that have a load and no proven one, how many of which status.
        wrong, exceptions, hangs: how many.
    """

    kind: str
    problems: int
    refused: int
    loads: int
    certified: int
    words: int
    unknown: int
    missing: dict[str, int]
    wrong: int
    exceptions: int
    hangs: int

    @property
    def share(self) -> float:
        """Return the share of certified ones with a load factor; 1 if none has."""
        return self.certified / self.loads if self.loads else 1.0


def is_exception(outcome: Outcome) -> bool:
    """Return whether another error than those of lacore was raised, or the process died."""
    row = outcome.row
    return row.verdict == FAIL and (
        row.status in ("exception", "failed") or "exception" in row.check
    )


def is_hang(outcome: Outcome) -> bool:
    """Return whether the run was stopped."""
    return outcome.row.verdict == FAIL and outcome.row.status == _HANG


def tallied(outcomes: Sequence[Outcome]) -> list[Tally]:
    """Return the tally of each class, and of all."""
    kinds = list(dict.fromkeys(kind_of(outcome.run) for outcome in outcomes))
    each = [_tally(kind, [o for o in outcomes if kind_of(o.run) == kind]) for kind in kinds]
    return [*each, _tally("all", list(outcomes))]


def _tally(kind: str, outcomes: Sequence[Outcome]) -> Tally:
    rows = [outcome.row for outcome in outcomes]
    solved = la.Status.SOLVED.label
    loads = [row for row in rows if row.expected == LOAD and row.verdict in (PASS, NO_RESULT)]
    missing = Counter(row.status for row in loads if row.status != solved)
    hangs, exceptions = sum(map(is_hang, outcomes)), sum(map(is_exception, outcomes))
    refused = sum(row.verdict == SKIPPED for row in rows)
    return Tally(
        kind=kind,
        problems=len(rows) - refused,
        refused=refused,
        loads=len(loads),
        certified=sum(row.status == solved for row in loads),
        words=sum(row.verdict == PASS and row.expected != LOAD for row in rows),
        unknown=sum(row.verdict == NO_RESULT and row.expected == UNKNOWN for row in rows),
        missing=dict(missing.most_common()),
        wrong=sum(row.verdict == FAIL for row in rows) - hangs - exceptions,
        exceptions=exceptions,
        hangs=hangs,
    )


def keep_wrong(
    outcomes: Sequence[Outcome],
    folder: Path,
    executor: Executor,
    time_limit: float,
    on_start: Callable[[Run], None],
) -> list[Path]:
    """Reduce failures and write a file for each; existing files stay."""
    wrong = [outcome for outcome in outcomes if outcome.row.verdict == FAIL]
    first: dict[tuple[str, str], Outcome] = {}
    for outcome in wrong:
        first.setdefault((kind_of(outcome.run), outcome.row.check), outcome)
    chosen = list(first.values())
    chosen += [outcome for outcome in wrong if outcome not in chosen]
    files = []
    for outcome in chosen[:_MOST_CUT]:
        kind = kind_of(outcome.run)
        path = folder / f"{kind}-{outcome.run.variant.name}.py"
        files.append(path)
        if not path.exists():
            on_start(outcome.run)
            small = outcome
            if not is_hang(outcome):
                small = shrunk(outcome, kind, executor, time_limit)
            folder.mkdir(parents=True, exist_ok=True)
            path.write_text(snippet(kind, small), encoding="utf-8")
    return files


def snippet(kind: str, outcome: Outcome) -> str:
    """Return a script that builds and solves a problem, and describes its failure."""
    recipe = recipe_of(kind, **outcome.run.parameters)
    follow = 'print(la.sequential(problem, **RECIPE["path"]))'
    return _SNIPPET.format(
        title=f"Random problem {outcome.run.variant.name} of the class {kind!r}.",
        why=outcome.row.why,
        recipe=pprint.pformat(recipe, width=96, sort_dicts=False),
        solve=follow if "path" in recipe else "print(la.solve(problem).message)",
    )
