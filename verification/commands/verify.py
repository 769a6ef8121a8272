"""The command ``lacore verify``."""

from __future__ import annotations  # not evaluated: what they name is not loaded

from functools import partial
from pathlib import Path

import click

from lacore.errors import InputError
from verification.catalogue.catalogue import Catalogue
from verification.commands.options import (
    backends_option,
    cases_option,
    fresh_option,
    jobs_option,
    json_option,
    named_cases,
    names_option,
    out_option,
    print_json,
    resumable,
    time_limit_option,
)


@click.command()
@named_cases("[CASE]...")
@click.option(
    "--all",
    "everything",
    is_flag=True,
    help="Dense backends on meshes and regularised ones along paths on all variants, too. Goes on"
    " from what is in the folder.",
)
@backends_option
@names_option(
    "--meshes",
    "Mesh levels: coarse, medium, fine; default: those of each variant for exact backends,"
    " the coarsest of them for regularised ones. Orders have ladders of meshes of their own.",
)
@jobs_option
@out_option("reports/verify", "Folder for the results and checks.csv.")
@time_limit_option
@fresh_option
@cases_option
@click.option("--full", is_flag=True, help="Print every variant and backend, not a line a case.")
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
    fresh: bool,
    known: Catalogue,
    full: bool,
    as_json: bool,
) -> None:
    """Check every case: exit code 1 when one is wrong.

    CASE is the id of a case (see `lacore cases`) or id:variant; without any, all cases are checked,
    but dense backends on meshes, and regularised ones along paths, are asked about the first
    variant and one of each status only, unless --all or anything else is named.
    Of each with each backend: is the value (or the status) right, do strict bounds lie on their
    side, do the residuals hold when computed afresh from the stored states, does the error fall
    under refinement as it must; and of deformable bodies, does a proven bracket enclose the
    reference, and do the shares of elements add up to its gap. Of paths: does each end as it must,
    are all loads on the way right, does the error fall with the steps as it must. `pytest
    verification` makes the same checks, one test each.

    \b
    Examples:
      lacore verify
      lacore verify --all
      lacore verify prandtl-punch wall-1:mu-0.65 --backends clarabel,cvxpy
      lacore verify my-case --cases my-folder
    """  # noqa: D301  # click reads the backspace
    from verification import progress
    from verification.campaigns.run_all import run_all
    from verification.commands import screen, tables, verify_tables
    from verification.perform.processes import run_in_processes
    from verification.store.provenance import describe
    from verification.store.results import export
    from verification.store.store import NAME
    from verification.verify import FILE, answer, as_table, ask, finish, left_out, runs_of, tally

    if cases and everything:
        raise InputError("--all", None, "CASE is there too", "leave out one of them")
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
            fresh,
        )
    with progress.status("computing residuals afresh"):
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
        console = tables.table_console()
        (verify_tables.show_findings if full else verify_tables.show_cases)(console, findings)
        rare = {"no_result": "without result", "no_reference": "without reference"}
        unjudged = "".join(f", {count[kind]} {text}" for kind, text in rare.items() if count[kind])
        text = (
            f"{count['passed']} checks pass, {count['failed']} FAIL, {count['skipped']} skipped"
            f"{unjudged}; {len(runs)} runs"
        )
        if left:
            text += f"; {left} dear ones not asked: `lacore verify --all`"
        places = {"Checks": out / FILE, "Results": out / NAME}
        more = "" if full else "--full prints every check; "
        after = f"{more}`lacore manual` writes a page for each case"
        screen.show_end(console, text, places, after)
    if not count["passed"]:
        click.echo("nothing was verified: no check passed", err=True)
    ctx.exit(0 if count["passed"] and not count["failed"] else 1)
