"""The commands ``lacore report``, ``lacore manual`` and ``lacore history``."""

from collections.abc import Sequence
from difflib import get_close_matches
from pathlib import Path

import click

import lacore as la
from lacore_verification.catalogue.catalogue import Catalogue, find
from lacore_verification.commands.options import (
    cases_option,
    json_option,
    named_cases,
    out_option,
    print_json,
)
from lacore_verification.usage import folder, whole

VERIFIED = Path("reports/verify")
"""Default folder of `lacore verify`."""
COMPARED = Path("reports/compare")
"""Default folder of `lacore compare`."""

pictures_option = click.option(
    "--pictures",
    "most",
    type=whole(0),
    metavar="N",
    help="Number of collapse mechanisms and bounds drawn for each case, at about a second each."
    " Default: 4 if there are few cases, 1 if there are many.",
)


@click.command(short_help="Write the report of stored results.")
@click.argument("results", type=click.Path(path_type=Path), metavar="DIR")
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    metavar="FOLDER",
    callback=folder,
    help="Folder for the pages, tables and pictures. Default: DIR itself.",
)
@pictures_option
@cases_option
@json_option
def report(
    results: Path, out: Path | None, most: int | None, known: Catalogue, as_json: bool
) -> None:
    """Write the report of results that `compare`, `verify` or `sweep` stored in the folder DIR.

    index.html shows for each case a picture, the reference value, the proven bounds, the largest
    error next to the allowed error, and a comparison of the backends. The page of a case, in
    cases/, lists every run with its certificate and explains why it passes. The pages load
    nothing from the internet. The folder tables/ contains the tables as CSV and Markdown, and
    results.csv contains all runs.
    """
    from lacore_verification.commands import screen
    from lacore_verification.harness.campaigns.compared_programs import copy_programs
    from lacore_verification.harness.store.logs import copy_logs
    from lacore_verification.harness.store.results import load_outcomes
    from lacore_verification.harness.store.store import file_of, sessions
    from lacore_verification.harness.verdicts.words import tally
    from lacore_verification.report.reporting import write_report

    require_results("DIR", results)
    outcomes, strange = load_outcomes(results, known)
    for entry in strange:
        name = f"{entry.row.case}:{entry.row.variant}"
        click.echo(f"warning: {name} omitted: unknown case (use --cases?)", err=True)
    if not outcomes:
        why = "contains no finished run"
        raise la.InputError("DIR", str(results), why, "run `lacore compare` or `lacore verify`")
    about = list(sessions(file_of(results)).values())[-1]
    folder = out or (results.parent if results.is_file() else results)
    copy_logs(outcomes, file_of(results).parent, folder)
    copy_programs(file_of(results).parent, folder)
    page = write_report(outcomes, about, folder, most)
    if as_json:
        print_json({"summary": vars(tally(outcomes)), "report": str(page)})
        return
    after = "open the report in a browser; `lacore verify` checks every case"
    screen.show_end(screen.table_console(), tally(outcomes).text, {"Report": page}, after)


@click.command(short_help="Write the verification manual.")
@named_cases("[CASE]...")
@click.option(
    "--results",
    type=click.Path(path_type=Path),
    default=VERIFIED,
    show_default=True,
    metavar="FOLDER",
    help="Folder with the results to show, as written by `lacore verify`.",
)
@out_option("reports/manual", "Folder for the pages.")
@pictures_option
@cases_option
@json_option
def manual(
    cases: tuple[str, ...],
    results: Path,
    out: Path,
    most: int | None,
    known: Catalogue,
    as_json: bool,
) -> None:
    """Write the verification manual, which has a page for each case.

    A page shows the problem drawn from its model, the reference value with its derivation, the
    allowed error with its reason, and the results of `lacore verify` with their certificates. CASE
    is the name of a case. Without CASE, all cases that have results are shown.
    """
    from lacore_verification.commands import screen
    from lacore_verification.harness.store.results import load_outcomes
    from lacore_verification.harness.verdicts.words import tally
    from lacore_verification.report.manual import write_manual

    if not results.exists() and not _similar(results):
        raise _no_results(cases, results)
    require_results("--results", results)
    outcomes, _ = load_outcomes(results, known)
    seen = {outcome.run.case.id for outcome in outcomes}
    named = dict.fromkeys(find(name, known)[0].id for name in cases)
    chosen = [known[name] for name in named or known if named or name in seen]
    if not chosen:
        raise _no_results(cases, results)
    page = write_manual(chosen, outcomes, results, out, most)
    if as_json:
        print_json({"summary": vars(tally(outcomes)), "manual": str(page)})
        return
    after = "open the manual in a browser; each page shows how to run its case"
    screen.show_end(screen.table_console(), tally(outcomes).text, {"Manual": page}, after)


@click.command(short_help="Compare stored results of several versions.")
@click.argument("results", type=click.Path(path_type=Path), nargs=-1, required=True)
@out_option("reports/history", "Folder for the page.")
@json_option
@click.pass_context
def history(ctx: click.Context, results: tuple[Path, ...], out: Path, as_json: bool) -> None:
    """Compare stored results of several versions of lacore or of solvers.

    RESULTS are two or more folders of `compare`, `verify` or `sweep`, or files results.csv, from
    the oldest to the newest. The versions and the date of results.csv are read from
    provenance.json in the same folder.

    For each backend and version, the command prints how many runs are claimed, certified and
    correct, the geometric mean of the solve times and the largest error. It lists the runs whose
    verdict or load factor changed, and writes a page with tables and charts.

    Exit code: 0, or 1 if a run passes in one version and fails in the next, 2 for invalid input.

    \b
    Examples:
      lacore history reports/0.3 reports/0.4
      lacore history old/results.csv reports/compare --out /tmp/history
    """  # noqa: D301  # click reads the backspace
    from lacore_verification.commands import screen
    from lacore_verification.harness.analysis.history import history as compare_versions
    from lacore_verification.harness.store.versions import load_versions
    from lacore_verification.report.files import write
    from lacore_verification.report.studies.history import history_report

    versions = load_versions(results)
    found = compare_versions({own.name: own.results for own in versions})
    page = write(history_report(versions, found), out)
    if as_json:
        document = {
            "versions": [
                {"name": own.name, "runs": len(own.results), "only": found.only[own.name]}
                | {"provenance": own.provenance, "sessions": [*map(dict, own.sessions)]}
                for own in versions
            ],
            "backends": found.backends.to_dict("records"),
            "changes": found.changes.to_dict("records"),
            "worse": found.worse,
            "report": str(page),
        }
        print_json(document)
    else:
        screen.show_history(screen.table_console(), versions, found)
        click.echo(f"Report:  {page}")
    ctx.exit(1 if found.worse else 0)


def _similar(results: Path) -> list[str]:
    """Return names of folders with results that a mistyped name may mean."""
    from lacore_verification.harness.store.store import NAME

    try:
        there = [str(own) for own in results.parent.iterdir() if (own / NAME).is_file()]
    except OSError:
        return []
    return get_close_matches(str(results), there, n=1)


def require_results(field: str, results: Path) -> None:
    """Raise `InputError` unless a path is a folder with results, or the file of these.

    Args:
        field: Name of the argument or option, for the message.
        results: Its value.
    """
    from lacore_verification.harness.store.store import NAME, file_of

    if file_of(results).is_file():
        return
    fix = "give the folder of `lacore compare`, `lacore verify` or `lacore sweep`"
    if results.is_dir():
        raise la.InputError(field, str(results), f"contains no results ({NAME})", fix)
    if results.exists():
        raise la.InputError(field, str(results), "is a file without results", fix)
    close = _similar(results)
    fix = f"did you mean {close[0]!r}?" if close else fix
    raise la.InputError(field, str(results), "there is no such folder", fix)


def _no_results(names: Sequence[str], results: Path) -> la.InputError:
    """Return the error that names the command for the missing results."""
    from lacore_verification.harness.store.store import NAME

    words = ["lacore", "verify", *names, *([] if results == VERIFIED else ["--out", str(results)])]
    there = results != COMPARED and (COMPARED / NAME).is_file()
    other = f"give --results {COMPARED}" if there else "give a folder with results"
    return la.InputError(
        "--results",
        str(results),
        "there are no results yet",
        f"run `{' '.join(words)}` first, or {other}",
    )
