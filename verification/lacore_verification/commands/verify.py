"""The command ``lacore verify``."""

# Annotations are not evaluated, so their modules are not loaded.
from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click

from lacore.reporting.errors import InputError
from lacore_verification.catalogue.catalogue import Catalogue
from lacore_verification.commands.options import (
    backends_option,
    cases_option,
    jobs_option,
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

if TYPE_CHECKING:
    from lacore_verification.harness.campaigns.run_all import Repeat


@click.command(short_help="Check the results of all cases.")
@named_cases("[CASE]...")
@click.option(
    "--all",
    "everything",
    is_flag=True,
    help="Also run the expensive combinations: dense backends on meshes and regularised backends"
    " along loading paths, for all variants. Results that are already in the folder are used"
    " again.",
)
@backends_option
@names_option(
    "--meshes",
    "Comma-separated mesh levels: coarse, medium, fine. Default: the levels of each variant for"
    " exact backends, and the coarsest of them for regularised backends. Convergence orders are"
    " measured on separate sequences of meshes.",
)
@jobs_option
@out_option("reports/verify", "Folder for the results and the table of checks, checks.csv.")
@time_limit_option
@repeat_options
@cases_option
@click.option("--full", is_flag=True, help="Print one line for every variant and backend.")
@json_option
@click.pass_context
def verify(
    ctx: click.Context,
    cases: tuple[str, ...],
    everything: bool,
    backends: list[str],
    meshes: list[str],
    jobs: int,
    out: Path,
    time_limit: float,
    repeat: Repeat,
    known: Catalogue,
    full: bool,
    as_json: bool,
) -> None:
    """Check the results of all cases.

    CASE is the name of a case (see `lacore cases`), or NAME:VARIANT for one variant of it. Without
    CASE, all cases are checked; expensive combinations then run for a few variants only, unless
    --all is given.

    \b
    The following is checked for each variant and each backend:
      value      the load factor agrees with the reference
      status     a case without a load factor ends with the expected status
      side       upper bounds lie above the reference, and lower bounds below it
      residuals  equilibrium, friction and yield hold when recomputed from the stored state
      order      the error decreases with the mesh size at the expected rate
      bracket    proven bounds enclose the reference
      gap        the contributions of the elements add up to the distance of the bounds
      range      the lowest and the highest load factor are certified and as expected
      path       every load along a loading path agrees with the reference
      steps      the error along a path decreases with the step size at the expected rate

    `pytest verification` makes the same checks, one test for each.

    Exit code: 0 if at least one check passed and none failed, 1 otherwise, 2 for invalid input.

    \b
    Examples:
      lacore verify
      lacore verify --all
      lacore verify prandtl-punch wall-1:mu-0.65 --backends clarabel,cvxpy
      lacore verify my-case --cases my-folder
    """  # noqa: D301  # click reads the backspace
    from lacore_verification.commands import screen, verify_tables
    from lacore_verification.harness import progress
    from lacore_verification.harness.campaigns.run_all import run_all
    from lacore_verification.harness.perform.processes import run_in_processes
    from lacore_verification.harness.store.provenance import describe
    from lacore_verification.harness.store.results import export
    from lacore_verification.harness.store.store import NAME
    from lacore_verification.harness.verify import (
        FILE,
        answer,
        as_table,
        ask,
        finish,
        left_out,
        runs_of,
        tally,
    )

    if cases and everything:
        raise InputError("--all", None, "a CASE is given, too", "omit one of them")
    named = [case.id for case in known.values() if not case.on_demand] if everything else cases
    questions = ask(named, backends, meshes, known)
    left = len(left_out(named, backends, meshes, known))
    runs = runs_of(questions)
    with resumable(out / NAME), progress.watching(len(runs)) as watch:
        outcomes = run_all(
            runs,
            out / NAME,
            watch.start,
            watch.finish,
            partial(run_in_processes, jobs=jobs),
            time_limit,
            repeat,
            show_stored_failures,
        )
    with progress.status("recomputing residuals"):
        finished = finish(questions, outcomes)
    findings = [answer(question, finished) for question in questions]
    table = as_table(findings)
    export(table, out / FILE)
    count = tally(findings)
    if as_json:
        document = {
            "summary": count,
            "runs": len(runs),
            "not_asked": left,
            "results": str(out / NAME),
            "machine": describe(run.backend for run in runs),
            "checks": table.to_dict("records"),
        }
        print_json(document)
    else:
        console = screen.table_console()
        (verify_tables.show_findings if full else verify_tables.show_cases)(console, findings)
        rare = {"no_result": "without result", "no_reference": "without reference"}
        unjudged = "".join(f", {count[kind]} {text}" for kind, text in rare.items() if count[kind])
        text = (
            f"{count['passed']} checks pass, {count['failed']} FAIL, {count['skipped']} skipped"
            f"{unjudged}; {len(runs)} runs"
        )
        if left:
            text += f"; {left} expensive checks omitted (`lacore verify --all` includes them)"
        places = {"Checks": out / FILE, "Results": out / NAME}
        more = "" if full else "; --full prints every check"
        after = f"`lacore manual` writes a page for each case{more}"
        screen.show_end(console, text, places, after)
    if not count["passed"]:
        click.echo("no check passed, so nothing was verified", err=True)
    ctx.exit(0 if count["passed"] and not count["failed"] else 1)
