"""The command line: ``lacore``, also ``python -m verification``.

Exit codes: 0 good, 1 a result is wrong or failed, 2 bad input.

A command imports what it works with when it is called, here and in the modules of other commands:
help and mistyped names are answered before any solver, table or picture is loaded, which takes
seconds.
"""

from collections import Counter
from functools import partial
from pathlib import Path
from typing import Any

import click

import lacore as la
from lacore.coupling_names import COUPLINGS
from lacore.errors import require_positive
from verification.bracketing import BRACKET
from verification.case import KINDS
from verification.catalogue import Catalogue, tagged
from verification.defaults import ON_DEMAND, RAW
from verification.fuzz.fuzz_command import fuzz
from verification.options import (
    cases_option,
    fresh_option,
    json_option,
    name_list,
    named_cases,
    names_option,
    out_option,
    print_json,
    resumable,
    time_limit_option,
)
from verification.report_command import manual, report
from verification.sweep_command import sweep
from verification.verify_command import verify


class _BadInput(click.ClickException):
    exit_code = 2


class _Commands(click.Group):
    """Bad input is one sentence and exit code 2, never a traceback."""

    def invoke(self, ctx: click.Context) -> Any:
        try:
            return super().invoke(ctx)
        except (la.InputError, la.CapabilityError) as error:
            raise _BadInput(str(error)) from error


@click.group(cls=_Commands, context_settings={"help_option_names": ["-h", "--help"]})
@click.version_option(package_name="lacore")
def main() -> None:
    """Plastic collapse loads of bodies in frictional contact, verified.

    Exit codes: 0 good, 1 a result is wrong or failed, 2 bad input.
    """


@main.command()
@named_cases("[CASE]...")
@names_option(
    "--backends",
    f"Backends, or 'all'; default: all but {', '.join(ON_DEMAND)}.",
)
@names_option(
    "--meshes",
    "Mesh levels: coarse, medium, fine; default: those of each variant. Rigid bodies have none.",
)
@names_option(
    "--couplings",
    f"Coupling loops: {', '.join(COUPLINGS)}; without damping and acceleration"
    f" {', '.join(RAW)}; {BRACKET!r} for a lower and an upper bound; default: that of each backend."
    " Where they are named, a table says how many runs each certified.",
)
@out_option("reports/compare", "Folder for the results, and the pages: open index.html.")
@time_limit_option
@cases_option
@click.option(
    "--jobs",
    type=click.IntRange(min=1),
    default=1,
    show_default=True,
    help="Runs at a time, each on one thread; more than one blurs the times.",
)
@fresh_option
@json_option
@click.pass_context
def compare(
    ctx: click.Context,
    cases: tuple[str, ...],
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

    CASE is the id of a case (see `lacore cases`) or id:variant; without any, all cases are run, on
    coarse and medium meshes, in a minute or two. Each result is kept in the folder as soon as it is
    there, and not run again by the same code; at the end come a table, results.csv and the page
    index.html, with a page beside it that explains each case.

    \b
    Examples:
      lacore compare
      lacore compare prandtl-punch deformable-block:sliding --backends clarabel
      lacore compare prandtl-punch --meshes coarse,medium,fine --out /tmp/punch
      lacore compare wall-1 wall-3 --backends clarabel --couplings certified,reaction,shift,kappa
    """  # noqa: D301  # click reads the backspace
    from verification import terminal
    from verification.compare import efforts, plan, run_all, tally
    from verification.execution import execute
    from verification.provenance import describe
    from verification.reporting import write_report
    from verification.results import as_table, export
    from verification.store import NAME

    require_positive("--time-limit", time_limit)
    runs = plan(cases, backends, meshes, couplings, known)
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
    export(as_table(outcome.record() for outcome in outcomes), out / "results.csv")
    about = describe()
    page = write_report(outcomes, about, out)
    count = tally(outcomes)
    if as_json:
        rows = [outcome.row.record() for outcome in outcomes]
        document = {
            "summary": vars(count),
            "couplings": [vars(effort) for effort in efforts(outcomes)],
            "report": str(page),
            "machine": about,
            "rows": rows,
        }
        print_json(document)
    else:
        console = terminal.table_console()
        terminal.show_results(console, outcomes)
        if couplings:
            terminal.show_efforts(console, outcomes)
        click.echo(f"\n{count.text}\nResults: {out / 'results.csv'}\nReport:  {page}")
    if not count.passed:
        click.echo("nothing was verified: no run passed", err=True)
    ctx.exit(0 if count.passed and not count.failed else 1)


@main.command("cases")
@click.option(
    "--tag",
    "tags",
    callback=name_list,
    metavar="A,B",
    help=f"Only cases that have all of these tags: {', '.join(KINDS)}, and those listed.",
)
@cases_option
@json_option
def list_cases(tags: list[str], known: Catalogue, as_json: bool) -> None:
    """List the verification cases."""
    from verification import terminal

    records = [
        {
            "id": case.id,
            "title": case.title,
            "variants": [variant.name for variant in case.variants],
            "meshes": list(case.meshes),
            "tags": list(case.tags),
            "source": known.sources[case.id],
            "run": "by name" if case.on_demand else "by default",
            "without": [
                f"{name} in {variant.name}: {why}"
                for variant in case.variants
                for name, why in variant.unfit.items()
            ],
        }
        for case in tagged(known, tags)
    ]
    if as_json:
        print_json(records)
    else:
        terminal.show_cases(terminal.table_console(), records)


@main.command("backends")
@json_option
def list_backends(as_json: bool) -> None:
    """List the backends: what they solve, their limits, and why one cannot run here.

    Solvers that a family of backends offers are asked for as NAME:SOLVER.
    """
    from verification import doctor, terminal

    records = [doctor.backend_record(*entry) for entry in doctor.all_backends()]
    if as_json:
        print_json(records)
    else:
        terminal.show_backends(terminal.table_console(), records)


@main.command("conformance")
@click.argument("backends", nargs=-1, metavar="[BACKEND]...")
@json_option
@click.pass_context
def run_conformance(ctx: click.Context, backends: tuple[str, ...], as_json: bool) -> None:
    """Check backends on small programs that were solved by hand.

    BACKEND is a name from `lacore backends`; without any, all that can run here are checked. Each
    must find the known load factor, velocity, stresses and reactions, tell what has no answer,
    keep its limits and refuse bad numbers.

    \b
    Examples:
      lacore conformance
      lacore conformance clarabel cvxpy:SCS
    """  # noqa: D301  # click reads the backspace
    from verification import conformance, doctor, terminal

    ready = [name for name, _, missing in doctor.all_backends() if not missing]
    names = list(dict.fromkeys(backends or ready))
    for name in names:  # a wrong name is to be known before the first one has run
        la.find_backend(name)
    rows: list[dict[str, Any]] = []
    for name in names:
        findings = conformance.run(name)
        rows += [{"backend": name} | row for row in conformance.records(findings)]
        if not as_json:
            terminal.show_conformance(
                terminal.table_console(),
                name,
                conformance.by_program(findings),
                conformance.failures(findings),
            )
    failed = [row for row in rows if row["verdict"] == conformance.FAIL]
    if as_json:
        counted = Counter(row["verdict"] for row in rows)
        summary = {
            "passed": counted[conformance.PASS],
            "failed": counted[conformance.FAIL],
            "skipped": counted[conformance.SKIPPED],
        }
        print_json({"summary": summary, "rows": rows})
    ctx.exit(1 if failed else 0)


@main.command("doctor")
@json_option
@click.pass_context
def run_doctor(ctx: click.Context, as_json: bool) -> None:
    """Check the installation: packages, BLAS threads, a self-test of every backend.

    Says what is missing and how to get it. Exit code 1 when something has to be mended.
    """
    from verification import doctor, terminal

    entries = sum(1 for _ in doctor.all_backends())
    with terminal.patiently("self-test", entries) as on_start:
        found = doctor.examine(on_start)
    if as_json:
        print_json(found)
    else:
        terminal.show_health(terminal.table_console(), found)
    ctx.exit(0 if found["healthy"] else 1)


main.add_command(fuzz)
main.add_command(manual)
main.add_command(report)
main.add_command(sweep)
main.add_command(verify)
