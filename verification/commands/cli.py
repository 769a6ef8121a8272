"""The command line: ``lacore``, also ``python -m verification``.

Exit codes: 0 good, 1 a result is wrong or failed, 2 bad input.

A command imports what it works with when it is called, here and in the modules of other commands:
help and mistyped names are answered before any solver, table or picture is loaded, which takes
seconds.
"""

from collections import Counter
from typing import Any

import click

import lacore as la
from verification.case import KINDS
from verification.catalogue.catalogue import Catalogue, tagged
from verification.commands.compare import compare
from verification.commands.export import export
from verification.commands.fuzz import fuzz
from verification.commands.new import new
from verification.commands.options import cases_option, json_option, name_list, print_json
from verification.commands.programs import programs
from verification.commands.report import manual, report
from verification.commands.solve import solve
from verification.commands.sweep import sweep
from verification.commands.verify import verify


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
    from verification.commands import tables

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
        tables.show_cases(tables.table_console(), records)


@main.command("backends")
@json_option
def list_backends(as_json: bool) -> None:
    """List the backends: what they solve, their limits, when comparisons run them, what is missing.

    Solvers that a family of backends offers are asked for as NAME:SOLVER.
    """
    from verification.commands import doctor, tables

    records = [doctor.backend_record(*entry) for entry in doctor.all_backends()]
    if as_json:
        print_json(records)
    else:
        tables.show_backends(tables.table_console(), records)


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
    from verification import conformance
    from verification.commands import doctor, tables

    ready = [name for name, _, missing in doctor.all_backends() if not missing]
    names = list(dict.fromkeys(backends or ready))
    for name in names:  # a wrong name is to be known before the first one has run
        la.find_backend(name)
    rows: list[dict[str, Any]] = []
    for name in names:
        findings = conformance.run(name)
        rows += [{"backend": name} | row for row in conformance.records(findings)]
        if not as_json:
            tables.show_conformance(
                tables.table_console(),
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
    from verification import progress
    from verification.commands import doctor, tables

    entries = sum(1 for _ in doctor.all_backends())
    with progress.patiently("self-test", entries) as on_start:
        found = doctor.examine(on_start)
    if as_json:
        print_json(found)
    else:
        tables.show_health(tables.table_console(), found)
    ctx.exit(0 if found["healthy"] else 1)


main.add_command(compare)
main.add_command(export)
main.add_command(fuzz)
main.add_command(manual)
main.add_command(new)
main.add_command(programs)
main.add_command(report)
main.add_command(solve)
main.add_command(sweep)
main.add_command(verify)
