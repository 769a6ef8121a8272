"""The command ``lacore compare``."""

from __future__ import annotations  # not evaluated: what they name is not loaded

from collections.abc import Sequence
from functools import partial
from pathlib import Path

import click

from lacore.coupling.names import COUPLINGS
from lacore.errors import InputError
from verification.case.beside import RANGE
from verification.case.bracketing import BRACKET
from verification.catalogue.catalogue import Catalogue
from verification.commands.options import (
    backends_option,
    cases_option,
    fresh_option,
    json_option,
    named_cases,
    names_option,
    out_option,
    print_json,
    resumable,
    time_limit_option,
)
from verification.defaults import RAW, cores


@click.command()
@named_cases("[CASE]...")
@click.option(
    "--all",
    "everything",
    is_flag=True,
    help="Everything against everything: all variants, all of their meshes and backends. Goes on"
    " from what a first look has in the folder.",
)
@click.option("--full", is_flag=True, help="Print every run, not a line a case.")
@backends_option
@names_option(
    "--meshes",
    "Mesh levels: coarse, medium, fine; default: those of each variant. Rigid bodies have none.",
)
@names_option(
    "--couplings",
    f"Coupling loops: {', '.join(COUPLINGS)}; without damping and acceleration"
    f" {', '.join(RAW)}; {BRACKET!r} for a lower and an upper bound, {RANGE!r} for the lowest"
    " and the highest load factor of a soil that dilates less; default: that of each backend."
    " Where they are named, a table says how many runs each certified.",
)
@out_option("reports/compare", "Folder for the results, and the pages: open index.html.")
@time_limit_option
@cases_option
@click.option(
    "--jobs",
    type=click.IntRange(min=1),
    default=cores,
    metavar="N",
    help="Runs at a time, each in a process of its own on one thread; default: number of cores."
    " More than one blurs the times: compare speeds with --jobs 1 --fresh.",
)
@fresh_option
@json_option
@click.pass_context
def compare(
    ctx: click.Context,
    cases: tuple[str, ...],
    everything: bool,
    full: bool,
    backends: list[str],
    meshes: list[str],
    couplings: list[str],
    out: Path,
    time_limit: float,
    known: Catalogue,
    jobs: int,
    fresh: bool,
    as_json: bool,
) -> None:
    """Compare backends with each other and with reference collapse loads.

    CASE is the id of a case (see `lacore cases`) or id:variant. Without any comes a first look: of
    each case its first variant and one of each status, all backends on the coarsest mesh, the exact
    one on a finer one; with --all, or couplings that are named, every variant. Each result is kept
    in the folder as soon as it is there, and not run again by the same code; at the end come a line
    a case, results.csv and the page index.html, with a page beside it that explains each case.

    \b
    Examples:
      lacore compare
      lacore compare prandtl-punch deformable-block:sliding --backends clarabel
      lacore compare prandtl-punch --meshes coarse,medium,fine --out /tmp/punch
      lacore compare wall-1 wall-3 --backends clarabel --couplings certified,reaction,shift,kappa
      lacore compare --all --jobs 1
    """  # noqa: D301  # click reads the backspace
    from verification import analysis, progress
    from verification.analysis.summary import summaries
    from verification.campaigns import comparison, overview
    from verification.campaigns.run_all import run_all
    from verification.commands import screen, tables
    from verification.perform.processes import run_in_processes
    from verification.report.reporting import write_report
    from verification.store.provenance import describe
    from verification.store.results import as_table, export
    from verification.store.store import NAME
    from verification.verdicts.tally import tally

    if cases and everything:
        raise InputError("--all", None, "CASE is there too", "leave out one of them")
    first_look = not (cases or everything or couplings)
    runs = (
        overview.overview(backends, meshes, known)
        if first_look
        else comparison.plan(cases, backends, meshes, couplings, known)
    )
    with resumable(out / NAME), progress.watching(len(runs)) as watch:
        outcomes = run_all(
            runs,
            out / NAME,
            watch.start,
            watch.finish,
            partial(run_in_processes, jobs=jobs),
            time_limit,
            fresh,
        )
    results = as_table(outcome.record() for outcome in outcomes)
    export(results, out / "results.csv")
    about = describe(run.backend for run in runs)
    page = write_report(outcomes, about, out)
    count = tally(outcomes)
    if as_json:
        rows = [outcome.row.record() for outcome in outcomes]
        document = {
            "summary": vars(count),
            "cases": [one.record() for one in summaries(outcomes)],
            "couplings": analysis.couplings(results).to_dict("records"),
            "report": str(page),
            "machine": about,
            "rows": rows,
        }
        print_json(document)
    else:
        places = {"Report": page, "Results": out / "results.csv"}
        after = f"{'' if full else '--full prints every run; '}{_after(cases, first_look)}"
        console = tables.table_console()
        if full:
            tables.show_results(console, outcomes)
        else:
            screen.show_overview(console, summaries(outcomes))
        if couplings:
            tables.show_couplings(console, analysis.couplings(results))
        screen.show_end(console, count.text, places, after)
    if not count.passed:
        click.echo("nothing was verified: no run passed", err=True)
    ctx.exit(0 if count.passed and not count.failed else 1)


def _after(cases: Sequence[str], first_look: bool) -> str:
    """What to ask next."""
    if first_look:
        return "`lacore compare --all` runs the rest; `lacore verify` checks every case"
    asked = " ".join(["lacore verify", *cases[:1]])
    return f"`{asked}` checks orders, residuals and brackets, too"
