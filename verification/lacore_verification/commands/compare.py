"""The command ``lacore compare``."""

# Annotations are not evaluated, so their modules are not loaded.
from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from lacore.coupling.kinds import COUPLINGS
from lacore.reporting.errors import InputError
from lacore_verification.case import BRACKET, RANGE
from lacore_verification.catalogue.catalogue import Catalogue
from lacore_verification.commands.options import (
    backends_option,
    cases_option,
    jobs_option_with,
    json_option,
    named_cases,
    names_option,
    out_option,
    print_json,
    repeat_options,
    resumable,
    show_stored_failures,
    time_limit_option,
)
from lacore_verification.defaults import RAW
from lacore_verification.harness.verdicts.words import tally

if TYPE_CHECKING:
    from lacore_verification.harness.campaigns.run_all import Repeat
    from lacore_verification.runs.outcome import Outcome
    from lacore_verification.runs.run import Run


@click.command(short_help="Compare solvers with reference collapse loads.")
@named_cases("[CASE]...")
@click.option(
    "--all",
    "everything",
    is_flag=True,
    help="Run every combination of variant, mesh level and backend.",
)
@click.option("--full", is_flag=True, help="Print one line for every run.")
@backends_option
@names_option(
    "--meshes",
    "Comma-separated mesh levels: coarse, medium, fine. Default: all levels of the given cases, or,"
    " without CASE, the levels of the selection. Cases of rigid bodies have no mesh.",
)
@names_option(
    "--couplings",
    "Comma-separated iteration methods for Coulomb friction; a table compares how often each"
    f" succeeds. Methods: {', '.join(COUPLINGS)}. The methods {', '.join(RAW)} use no damping or"
    f" acceleration. Two further values are not iteration methods: {BRACKET!r} computes a lower and"
    f" an upper bound, and {RANGE!r} the lowest and the highest load factor of soil with"
    " non-associated flow. Default: the method of each backend.",
)
@click.option(
    "--option",
    "options",
    multiple=True,
    metavar="NAME.OPTION=VALUE",
    help="Change an option of the backend NAME; separate several by commas. Can be given several"
    " times. An option that is given again begins another setting of the backend, and all settings"
    " are compared. NAME.OPTION=VALUE,VALUE,... compares several values of one option; the report"
    " draws three or more of them as a curve of accuracy against time. Brackets ignore it.",
)
@out_option("reports/compare", "Folder for the results and the report, index.html.")
@click.option(
    "--export/--no-export",
    "exports",
    default=None,
    help="Write the optimisation programs of the runs to DIR/instances, where the pages link to"
    " them, or leave them out. Default: --export if a CASE or --all is given.",
)
@time_limit_option
@cases_option
@jobs_option_with(" To compare solution times, use --jobs 1 --fresh.")
@repeat_options
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
    options: tuple[str, ...],
    out: Path,
    exports: bool | None,
    time_limit: float,
    known: Catalogue,
    jobs: int,
    repeat: Repeat,
    as_json: bool,
) -> None:
    """Compare solvers with each other and with reference collapse loads.

    A case is a problem whose collapse load is known, such as a strip footing on clay; it has
    several variants, such as a smooth and a rough footing. A backend is a solver. `lacore cases`
    and `lacore backends` list them.

    CASE is the name of a case, or NAME:VARIANT for one variant of it. Without CASE, a selection of
    variants from all cases runs, on meshes that are solved quickly and with small errors.

    Each run solves one variant on one mesh with one backend. It passes if its load factor agrees
    with the reference value within the tolerance of the case. A table on the terminal summarises
    the errors. The folder DIR contains the report, index.html, with a page for each case, and all
    runs in results.csv. Results are stored as soon as they are computed, and a repeated command
    only computes what is missing. Failures and runs that exceed their time limit are results,
    too; --retry failed repeats them. If Ctrl-C or SIGTERM stops the command, it writes the report
    of the runs that have finished.

    Exit code: 0 if at least one run passed and none failed, 1 otherwise, 2 for invalid input.

    \b
    Examples:
      lacore compare
      lacore compare prandtl-punch deformable-block:sliding --backends clarabel
      lacore compare prandtl-punch --meshes coarse,medium,fine --out /tmp/punch
      lacore compare wall-1 wall-3 --backends clarabel --couplings certified,reaction,shift
      lacore compare prandtl-punch --option clarabel.tolerance=1e-2,1e-4,1e-6,1e-8
      lacore compare --all --jobs 1
    """  # noqa: D301  # click reads the backspace
    from lacore_verification.harness import progress
    from lacore_verification.harness.campaigns.compared_programs import sources_of, write_programs
    from lacore_verification.harness.campaigns.run_all import run_all
    from lacore_verification.harness.perform.processes import run_in_processes
    from lacore_verification.harness.store.provenance import describe
    from lacore_verification.harness.store.store import NAME
    from lacore_verification.report.reporting import GrowingReport, write_report

    if cases and everything:
        raise InputError("--all", None, "a CASE is given, too", "omit one of them")
    first_look = not (cases or everything or couplings)
    runs = _planned(cases, everything, backends, meshes, couplings, options, known)
    growing = GrowingReport(runs, out)
    with resumable(out / NAME, growing.write):
        with progress.watching(len(runs)) as watch:

            def finish(outcome: Outcome) -> None:
                watch.finish(outcome)
                growing.add(outcome)

            outcomes = run_all(
                runs,
                out / NAME,
                watch.start,
                finish,
                partial(run_in_processes, jobs=jobs),
                time_limit,
                repeat,
                show_stored_failures,
            )
        if exports or (exports is None and not first_look):
            sources = sources_of(outcomes)
            with progress.patiently("writing programs", len(sources)) as on_done:
                write_programs(sources, out, on_done)
        about = describe(run.backend for run in runs)
        page = write_report(outcomes, about, out)
    if as_json:
        print_json(_document(outcomes, about, page))
    else:
        _show(outcomes, full, bool(couplings), page, out, _after(cases, first_look))
    count = tally(outcomes)
    checked = count.passed + count.bound_only
    if not checked:
        click.echo("no run passed, so nothing was verified", err=True)
    ctx.exit(0 if checked and not count.failed else 1)


def _planned(
    cases: Sequence[str],
    everything: bool,
    backends: Sequence[str],
    meshes: Sequence[str],
    couplings: Sequence[str],
    options: Sequence[str],
    known: Catalogue,
) -> list[Run]:
    """Return the planned runs of a comparison, including those of unusable backends."""
    from lacore_verification.harness.campaigns.comparison import with_unusable

    if cases or couplings:
        from lacore_verification.harness.campaigns.comparison import plan

        runs = plan(cases, backends, meshes, couplings, known)
    else:
        from lacore_verification.harness.campaigns import overview

        planned = overview.everything if everything else overview.overview
        runs = planned(backends, meshes, known)
    runs = with_unusable(runs, backends)
    if not options:
        return runs
    from lacore_verification.harness.campaigns.backend_options import with_options

    return with_options(runs, options)


def _document(outcomes: Sequence[Outcome], about: Mapping[str, str], page: Path) -> dict[str, Any]:
    """Return the results of a comparison as a document."""
    from lacore_verification.harness.analysis.effort import couplings
    from lacore_verification.harness.analysis.noise import noise
    from lacore_verification.harness.analysis.profiles import rates
    from lacore_verification.harness.analysis.settings import settings
    from lacore_verification.harness.analysis.summary import summaries
    from lacore_verification.harness.store.results import as_table

    results = as_table(outcome.record() for outcome in outcomes)
    return {
        "summary": vars(tally(outcomes)),
        "cases": [one.record() for one in summaries(outcomes)],
        "settings": settings(outcome.run for outcome in outcomes).to_dict("records"),
        "noise": noise(results).record(),
        "rates": rates(results, ["backend"]).to_dict("records"),
        "couplings": couplings(results).to_dict("records"),
        "report": str(page),
        "machine": dict(about),
        "rows": [outcome.row.record() for outcome in outcomes],
    }


def _show(
    outcomes: Sequence[Outcome], full: bool, by_coupling: bool, page: Path, out: Path, after: str
) -> None:
    """Print the results of a comparison: a line for each variant, or in full for each run."""
    from lacore_verification.commands import screen
    from lacore_verification.harness.analysis.effort import couplings
    from lacore_verification.harness.analysis.profiles import rates
    from lacore_verification.harness.analysis.summary import summaries
    from lacore_verification.harness.store.results import RESULTS, as_table

    results = as_table(outcome.record() for outcome in outcomes)
    console = screen.table_console()
    if full:
        from lacore_verification.commands import tables

        tables.show_results(console, outcomes)
    else:
        screen.show_overview(console, summaries(outcomes))
        after += "; --full prints every run"
    screen.show_rates(console, rates(results, ["backend"]))
    if by_coupling:
        from lacore_verification.commands import tables

        tables.show_couplings(console, couplings(results))
    places = {"Report": page, "Results": out / RESULTS}
    screen.show_end(console, tally(outcomes).text, places, after)


def _after(cases: Sequence[str], first_look: bool) -> str:
    """Return the commands that a reader may want next."""
    if first_look:
        return "`lacore compare --all` runs all combinations; `lacore verify` checks every case"
    command = " ".join(["lacore verify", *cases[:1]])
    return f"`{command}` also checks residuals, convergence orders and bounds"
