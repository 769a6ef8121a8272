"""The command ``lacore fuzz``."""

from __future__ import annotations  # Annotations are not evaluated, so they do not load lacore.

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import click

from lacore.reporting.errors import require_known
from lacore_verification.commands.options import (
    drawn_options,
    jobs_option,
    json_option,
    names_option,
    out_option,
    print_json,
    repeat_options,
    resumable,
    show_stored_failures,
    time_limit_option,
)
from lacore_verification.fuzz.drawn.cases import kind_of, known_kinds, runs_of
from lacore_verification.harness.perform.executors import (
    dask_options,
    executor_of,
    require_one_place,
)
from lacore_verification.harness.verdicts.words import FAIL

if TYPE_CHECKING:
    from lacore_verification.harness.campaigns.fuzzing import Tally
    from lacore_verification.harness.campaigns.run_all import Repeat
    from lacore_verification.runs.outcome import Outcome

_MOST_SHOWN = 12


@click.command(short_help="Solve random problems and check the results.")
@drawn_options("problems", "classes", 300)
@names_option("--classes", f"Comma-separated classes. Default: all of {', '.join(known_kinds())}.")
@jobs_option
@dask_options
@time_limit_option
@out_option("reports/fuzz", "Folder for the results and for problems with wrong results.")
@repeat_options
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
    repeat: Repeat,
    as_json: bool,
) -> None:
    """Solve small random problems, and check the results without the code of the solver.

    The problems have one or two deformable bodies in plane or axisymmetric states, soils that vary
    from place to place, footings on arcs, rigid blocks, frames, combinations of these, or short
    loading paths. Each follows from its seed, class and number alone. Independent code checks
    equilibrium and virtual power of each part, friction at each point, yield and dissipation.
    Results are also compared with those of the same problem without friction, with associated
    friction, moved, rescaled, renamed or reordered, weakened by its safety factor, with other
    backends, with equilibrium elements, and with linear programs of block assemblies and frames.

    A problem with a wrong result is reduced to a small problem, which is stored in DIR/wrong/*.py.
    A campaign that was stopped continues when the same command is repeated.

    Exit code: 0 if nothing is wrong, 1 otherwise, 2 for invalid input, 130 after Ctrl-C.

    \b
    Examples:
      lacore fuzz --count 1000
      lacore fuzz --count 10000 --seed 2 --classes blocks,weights --jobs 4
    """  # noqa: D301  # click reads the backspace
    import lacore as la
    from lacore_verification.harness import progress
    from lacore_verification.harness.campaigns.fuzzing import keep_wrong, tallied
    from lacore_verification.harness.campaigns.run_all import run_all
    from lacore_verification.harness.store.provenance import describe
    from lacore_verification.harness.store.results import export, load_results
    from lacore_verification.harness.store.store import NAME

    require_one_place(on_dask, scheduler)
    for name in classes:
        require_known("--classes", name, known_kinds())
    runs = runs_of(list(dict.fromkeys(classes)) or known_kinds(), count, seed)
    with (
        resumable(out / NAME),
        executor_of(jobs, on_dask, scheduler) as executor,
        progress.watching(len(runs)) as watch,
    ):
        outcomes = run_all(
            runs,
            out / NAME,
            watch.start,
            watch.finish,
            executor,
            time_limit,
            repeat,
            show_stored_failures,
        )
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
        click.echo(f"Results: {out / NAME}" + (f"\nWrong:   {out / 'wrong'}" if files else ""))
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
    """Print the final table, reasons, and the first wrong results."""
    from rich.table import Table

    from lacore_verification.commands import screen

    console = screen.table_console()
    table = Table(box=None, pad_edge=False)
    for head in ("class", "problems", "loads", "certified", "%", "no load", "unknown", "rejected"):
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
