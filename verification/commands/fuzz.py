"""The command ``lacore fuzz``."""

from __future__ import annotations  # not evaluated: names of lacore in them load nothing

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import click

from lacore.errors import require_known
from verification.commands.options import (
    drawn_options,
    fresh_option,
    jobs_option,
    json_option,
    names_option,
    out_option,
    print_json,
    resumable,
    time_limit_option,
)
from verification.fuzz.drawn.cases import kind_of, known_kinds, runs_of
from verification.perform.executors import dask_options, executor_of, require_one_place
from verification.verdicts.words import FAIL

if TYPE_CHECKING:
    from verification.campaigns.fuzzing import Tally
    from verification.runs.outcome import Outcome

_MOST_SHOWN = 12


@click.command()
@drawn_options("problems", "classes", 300)
@names_option("--classes", f"Classes; default: all of {', '.join(known_kinds())}.")
@jobs_option
@dask_options
@time_limit_option
@out_option("reports/fuzz", "Folder for the results and for what is wrong.")
@fresh_option
@json_option
@click.pass_context
def fuzz(
    ctx: click.Context,
    count: int,
    seed: int,
    classes: list[str],
    jobs: int,
    on_dask: bool,
    scheduler: str | None,
    time_limit: float,
    out: Path,
    fresh: bool,
    as_json: bool,
) -> None:
    """Solve random small problems and judge each by checks that share no code with the solver.

    Continua in three kinematics and all spaces, two bodies, rigid blocks of any weights, frames,
    mixtures and short paths, each a pure function of seed, class and number. Checked are balance
    and virtual power part by part, friction point by point, yield, powers; that without friction no
    load factor is larger, associated none smaller; copies that are moved, rescaled, renamed or
    reordered; other backends, equilibrium elements, and linear programs of assemblies that are
    written from their polygons.

    What is wrong is cut down to a small problem and kept as DIR/wrong/*.py. A campaign that was
    stopped goes on where it was when the same command is given again. Exit code 0 when nothing is
    wrong, else 1; 130 after Ctrl-C.

    \b
    Examples:
      lacore fuzz --count 1000
      lacore fuzz --count 10000 --seed 2 --classes blocks,weights --jobs 4
    """  # noqa: D301  # click reads the backspace
    import lacore as la
    from verification import progress
    from verification.campaigns.fuzzing import keep_wrong, tallied
    from verification.campaigns.run_all import run_all
    from verification.store.provenance import describe
    from verification.store.results import export, load_results
    from verification.store.store import NAME

    require_one_place(on_dask, scheduler)
    for name in classes:
        require_known("--classes", name, known_kinds())
    runs = runs_of(list(dict.fromkeys(classes)) or known_kinds(), count, seed)
    with (
        resumable(out / NAME),
        executor_of(jobs, on_dask, scheduler) as executor,
        progress.watching(len(runs)) as watch,
    ):
        outcomes = run_all(runs, out / NAME, watch.start, watch.finish, executor, time_limit, fresh)
        files = keep_wrong(outcomes, out / "wrong", executor, time_limit, watch.start)
    export(load_results(out), out / "results.csv")
    tallies = tallied(outcomes)
    if as_json:
        document = {
            "summary": [{**asdict(tally), "share": tally.share} for tally in tallies],
            "wrong": [_record(outcome) for outcome in outcomes if outcome.row.verdict == FAIL],
            "files": [str(path) for path in files],
            "store": str(out / NAME),
            "machine": {**describe(la.backend_names()), "seed": str(seed)},
        }
        print_json(document)
    else:
        _show(tallies, outcomes)
        click.echo(f"Store: {out / NAME}" + (f"\nWrong: {out / 'wrong'}" if files else ""))
    ctx.exit(1 if any(outcome.row.verdict == FAIL for outcome in outcomes) else 0)


def _record(outcome: Outcome) -> dict[str, object]:
    row = outcome.row
    return {
        "class": kind_of(outcome.run),
        "number": outcome.run.parameters["number"],
        "status": row.status,
        "load_factor": row.load_factor,
        "why": row.why,
    }


def _show(tallies: Sequence[Tally], outcomes: Sequence[Outcome]) -> None:
    """Final table, reasons, and the first of what is wrong."""
    from rich.table import Table

    from verification.commands import tables

    console = tables.table_console()
    table = Table(box=None, pad_edge=False)
    for head in ("class", "problems", "a load", "certified", "%", "no load", "unknown", "refused"):
        table.add_column(head, justify="left" if head == "class" else "right")
    for head in ("wrong", "exceptions", "hangs"):
        table.add_column(head, justify="right")
    for one in tallies:
        numbers = (one.problems, one.loads, one.certified, f"{100 * one.share:.1f}", one.words)
        rest = (one.unknown, one.refused, one.wrong, one.exceptions, one.hangs)
        table.add_row(one.kind, *map(str, (*numbers, *rest)))
    console.print(table)
    for one in tallies:
        if one.missing and one.kind != "all":
            reasons = ", ".join(f"{count} {status}" for status, count in one.missing.items())
            console.print(f"not certified, {one.kind}: {reasons}", markup=False, highlight=False)
    wrong = [outcome for outcome in outcomes if outcome.row.verdict == FAIL]
    for outcome in wrong[:_MOST_SHOWN]:
        name = f"{kind_of(outcome.run)} {outcome.run.parameters['number']}"
        console.print(f"WRONG {name}: {outcome.row.why[:160]}", markup=False, highlight=False,
                      no_wrap=True, overflow="ellipsis")  # fmt: skip
    if len(wrong) > _MOST_SHOWN:
        console.print(f"... and {len(wrong) - _MOST_SHOWN} more")
