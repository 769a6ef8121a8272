"""The command ``lacore verify``."""

from __future__ import annotations  # not evaluated: what they name is not loaded

from collections.abc import Mapping, Sequence
from functools import partial
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

import click

from lacore.errors import require_positive
from verification.catalogue import Catalogue
from verification.defaults import ON_DEMAND
from verification.judging import FAIL, NO_REFERENCE, NO_RESULT, PASS, SKIPPED
from verification.options import (
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

if TYPE_CHECKING:
    from rich.console import Console

    from verification.verify import Finding


@click.command()
@named_cases("[CASE]...")
@names_option(
    "--backends",
    f"Backends, or 'all'; default: all but {', '.join(ON_DEMAND)}; highs on rigid bodies.",
)
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
@json_option
@click.pass_context
def verify(
    ctx: click.Context,
    cases: tuple[str, ...],
    backends: list[str],
    meshes: list[str],
    jobs: int,
    out: Path,
    time_limit: float,
    fresh: bool,
    known: Catalogue,
    as_json: bool,
) -> None:
    """Check every case: exit code 1 when one is wrong.

    CASE is the id of a case (see `lacore cases`) or id:variant; without any, all cases are checked.
    Of each with each backend: is the value (or the status) right, do strict bounds lie on their
    side, do the residuals hold when computed afresh from the stored states, does the error fall
    under refinement as it must; and of deformable bodies, does a proven bracket enclose the
    reference, and do the shares of elements add up to its gap. Of paths: does each end as it must,
    are all loads on the way right, does the error fall with the steps as it must. `pytest
    verification` makes the same checks, one test each.

    \b
    Examples:
      lacore verify
      lacore verify prandtl-punch wall-1:mu-0.65 --backends clarabel,cvxpy
      lacore verify my-case --cases my-folder
    """  # noqa: D301  # click reads the backspace
    from verification import terminal
    from verification.compare import run_all
    from verification.execution import execute
    from verification.provenance import describe
    from verification.results import export
    from verification.store import NAME
    from verification.verify import FILE, answer, as_table, ask, finish, runs_of, tally

    require_positive("--time-limit", time_limit)
    questions = ask(cases, backends, meshes, known)
    runs = runs_of(questions)
    with resumable(out / NAME), terminal.watching(len(runs)) as watch:
        outcomes = run_all(
            runs,
            out / NAME,
            watch.start,
            watch.finish,
            partial(execute, jobs=jobs),
            time_limit,
            fresh,
        )
    with terminal.status("computing residuals afresh"):
        finished = finish(questions, outcomes)
    findings = [answer(question, finished) for question in questions]
    table = as_table(findings)
    export(table, out / FILE)
    count = tally(findings)
    if as_json:
        document = {
            "summary": count,
            "runs": len(runs),
            "results": str(out / NAME),
            "machine": describe(),
            "checks": table.to_dict("records"),
        }
        print_json(document)
    else:
        _show(terminal.table_console(), findings)
        rare = {"no_result": "without result", "no_reference": "without reference"}
        unjudged = "".join(f", {count[kind]} {text}" for kind, text in rare.items() if count[kind])
        click.echo(
            f"\n{count['passed']} checks pass, {count['failed']} FAIL, {count['skipped']} skipped"
            f"{unjudged}; {len(runs)} runs\nChecks:  {out / FILE}\nResults: {out / NAME}"
        )
    if not count["passed"]:
        click.echo("nothing was verified: no check passed", err=True)
    ctx.exit(0 if count["passed"] and not count["failed"] else 1)


def _show(console: Console, findings: Sequence[Finding]) -> None:
    """A line a variant, backend and coupling, all its checks in it; then what failed, and why.

    Of a path the value is the largest error on the way, and the order that of its steps.
    """
    from verification.terminal import print_line

    line = "  {:20} {:12} {:22} {:>12} {:>9} {:>9} {:>6} {:>7} {:>7}  {}".format
    head = (
        *("backend", "coupling", "meshes", "value %", "side", "residuals", "order"),
        *("width %", "gap", "verdict"),
    )
    print_line(console, line(*head), "bold")
    groups: dict[tuple[str, str, str], dict[str, Finding]] = {}
    for found in findings:
        key = (f"{found.case}:{found.variant}", found.backend, found.coupling)
        groups.setdefault(key, {})[found.check] = found
    before = ""
    for (name, backend, coupling), checks in groups.items():
        if name != before:
            print_line(console, name, "cyan")
        before = name
        failed = [check for check, found in checks.items() if found.verdict == FAIL]
        meshes = next(found.meshes for found in checks.values())
        cells = (
            _cell(checks, "status", "")
            or _cell(checks, "value", "+.4f", 100)
            or _cell(checks, "path", ".4f", 100),
            _cell(checks, "side", "+.1e"),
            _cell(checks, "residuals", ".1e"),
            _cell(checks, "order", ".2f") or _cell(checks, "steps", ".2f"),
            _cell(checks, "bracket", ".2f", 100),
            _cell(checks, "gap", ".0e"),
        )
        verdict = f"FAIL: {', '.join(failed)}" if failed else _verdict(checks)
        style = "bold red" if failed else "" if verdict == PASS else "dim"
        print_line(console, line(backend, coupling, meshes, *cells, verdict), style)
    for found in findings:
        if found.verdict == FAIL:
            print_line(console, f"\nFAIL {found.check}: {found.why}", "red")
    reasons = [found.why for found in findings if found.verdict == SKIPPED]
    for why in dict.fromkeys(reasons):
        print_line(console, f"\nskipped, {reasons.count(why)} checks: {why}", "dim")


def _verdict(checks: Mapping[str, Finding]) -> str:
    """Of checks none of which failed: what has no result or no reference has not passed."""
    verdicts = {found.verdict for found in checks.values()}
    return next(kind for kind in (NO_RESULT, NO_REFERENCE, PASS, SKIPPED) if kind in verdicts)


def _cell(checks: Mapping[str, Finding], check: str, how: str, scale: float = 1.0) -> str:
    """What a check measured, or the status that was expected and found."""
    found = checks.get(check)
    if found is None or found.verdict == SKIPPED:
        return ""
    if isfinite(found.measured):
        return format(scale * found.measured, how)
    return found.verdict if found.verdict == FAIL or how else found.allowed
