"""The command line: ``lacore``, also ``python -m lacore_verification``.

Exit codes: 0 success, 1 a result is wrong or missing, 2 invalid input.

The module of a command is imported when the command is named, and solvers, tables and pictures when
it is called. Help texts and messages about mistyped names therefore appear without delay.
"""

from collections import Counter
from typing import Any

import click

import lacore as la
from lacore_verification.case import KINDS
from lacore_verification.catalogue.catalogue import Catalogue, tagged
from lacore_verification.commands.options import cases_option, json_option, name_list, print_json
from lacore_verification.usage import Commands, Imported

START = """\
lacore computes the load at which a structure collapses, and proves the result.

  lacore new footing > footing.toml   write a starter file that describes a problem
  lacore solve footing.toml           compute its collapse load, and write a report
  lacore compare                      compare all solvers on the verification cases

`lacore new` lists the other starter files, and `lacore --help` lists all commands."""
"""Text of `lacore` without arguments."""


@click.group(
    cls=Commands,
    commands=Imported(
        {
            "new": "lacore_verification.commands.new:new",
            "solve": "lacore_verification.commands.solve:solve",
            "compare": "lacore_verification.commands.compare:compare",
            "verify": "lacore_verification.commands.verify:verify",
            "report": "lacore_verification.commands.report:report",
            "manual": "lacore_verification.commands.report:manual",
            "history": "lacore_verification.commands.report:history",
            "cases": "lacore_verification.commands.cli:list_cases",
            "backends": "lacore_verification.commands.cli:list_backends",
            "sweep": "lacore_verification.commands.sweep:sweep",
            "fuzz": "lacore_verification.commands.fuzz:fuzz",
            "programs": "lacore_verification.commands.programs:programs",
            "conformance": "lacore_verification.commands.cli:run_conformance",
            "export": "lacore_verification.commands.export:export",
            "doctor": "lacore_verification.commands.cli:run_doctor",
        }
    ),
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"]},
)
@click.version_option(la.__version__, prog_name="lacore")
@click.pass_context
def main(ctx: click.Context) -> None:
    """Compute the loads at which structures collapse, and verify solvers that compute them.

    To solve a problem of your own, use `new` and `solve`. To test solvers, use `compare` and
    `verify`. Every command has its own help, such as `lacore solve --help`.

    Exit codes: 0 success, 1 a result is wrong or missing, 2 invalid input, 130 stopped by Ctrl-C.
    """
    if ctx.invoked_subcommand is None:
        click.echo(START)


@click.command("cases", short_help="List the verification cases.")
@click.option(
    "--tag",
    "tags",
    callback=name_list,
    metavar="A,B",
    help=f"List only the cases that have all of these tags, such as {', '.join(KINDS)}.",
)
@cases_option
@json_option
def list_cases(tags: list[str], known: Catalogue, as_json: bool) -> None:
    """List the verification cases, with their variants, mesh levels and tags."""
    from lacore_verification.commands import screen, tables

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
        tables.show_cases(screen.table_console(), records)


@click.command("backends", short_help="List the backends (solvers) and what they solve.")
@json_option
def list_backends(as_json: bool) -> None:
    """List the backends, which are the solvers that lacore can use.

    The list shows what each backend solves, its limits, when comparisons run it, and what is
    missing where it cannot run. Some backends offer several solvers, selected as NAME:SOLVER.
    """
    from lacore_verification.commands import doctor, screen, tables

    records = [doctor.backend_record(*entry) for entry in doctor.all_backends()]
    if as_json:
        print_json(records)
    else:
        tables.show_backends(screen.table_console(), records)


@click.command("conformance", short_help="Check backends on small programs.")
@click.argument("backends", nargs=-1, metavar="[BACKEND]...")
@json_option
@click.pass_context
def run_conformance(ctx: click.Context, backends: tuple[str, ...], as_json: bool) -> None:
    """Check backends on small programs with known solutions.

    BACKEND is a name from `lacore backends`. Without it, all backends that are installed are
    checked. A backend must find the known load factor, velocities, stresses and reactions, detect
    programs without a solution, observe its limits and reject invalid numbers.

    Exit code: 0 if no check failed, 1 otherwise, 2 for invalid input.

    \b
    Examples:
      lacore conformance
      lacore conformance clarabel cvxpy:SCS
    """  # noqa: D301  # click reads the backspace
    from lacore_verification import conformance
    from lacore_verification.commands import doctor, screen, tables

    named = backends or (name for name, _, missing in doctor.all_backends() if not missing)
    names = list(dict.fromkeys(named))
    for name in names:  # Report a mistyped name before any backend runs.
        la.find_backend(name)
    rows: list[dict[str, Any]] = []
    for name in names:
        findings = conformance.run(name)
        rows += [{"backend": name} | row for row in conformance.records(findings)]
        if not as_json:
            tables.show_conformance(
                screen.table_console(),
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


@click.command("doctor", short_help="Check the installation.")
@json_option
@click.pass_context
def run_doctor(ctx: click.Context, as_json: bool) -> None:
    """Check the installation: packages, BLAS threads, and a self-test of every backend.

    Missing packages are listed with the command that installs them. Exit code: 0 if everything
    that lacore needs works, 1 otherwise.
    """
    from lacore_verification.commands import doctor, screen, tables
    from lacore_verification.harness import progress

    entries = sum(1 for _ in doctor.all_backends())
    with progress.patiently("self-test", entries) as on_start:
        found = doctor.examine(on_start)
    if as_json:
        print_json(found)
    else:
        tables.show_health(screen.table_console(), found)
    ctx.exit(0 if found["healthy"] else 1)
