"""The commands ``lacore report`` and ``lacore manual``."""

from collections.abc import Sequence
from pathlib import Path

import click

import lacore as la
from verification.catalogue.catalogue import Catalogue, find
from verification.commands.options import cases_option, named_cases, out_option

VERIFIED = Path("reports/verify")
"""Where `lacore verify` writes by default."""
COMPARED = Path("reports/compare")
"""Where `lacore compare` does."""

pictures_option = click.option(
    "--pictures",
    "most",
    type=click.IntRange(min=0),
    metavar="N",
    help="Mechanisms, and brackets, that are drawn of each case, a second or so each; default:"
    " 4 of a few cases, 1 of many.",
)


@click.command()
@click.argument("folder", type=click.Path(path_type=Path), metavar="DIR")
@click.option(
    "--out",
    type=click.Path(path_type=Path),
    help="Folder for the pages, tables and pictures; default: DIR itself.",
)
@pictures_option
@cases_option
def report(folder: Path, out: Path | None, most: int | None, known: Catalogue) -> None:
    """Write the report of the results in DIR, from `compare`, `verify` or `sweep`.

    index.html has a card a case: its picture, references, what is proven, the worst error beside
    the one allowed, and backends side by side. A page for each case, in cases/, has every run with
    its certificate, and says why it passes. They load nothing but the pictures beside them. The
    same tables are in tables/ as CSV and Markdown.
    """
    from verification.commands import screen, tables
    from verification.report.reporting import write_report
    from verification.store.results import load_outcomes
    from verification.store.store import file_of, sessions
    from verification.verdicts.tally import tally

    outcomes, strange = load_outcomes(folder, known)
    for entry in strange:
        name = f"{entry.row.case}:{entry.row.variant}"
        click.echo(f"warning: left out: {name}: no such case here (--cases?)", err=True)
    if not outcomes:
        raise la.InputError("DIR", str(folder), "holds no finished run", "run something into it")
    about = list(sessions(file_of(folder)).values())[-1]
    page = write_report(outcomes, about, out or folder, most)
    after = "open it in a browser; `lacore verify` checks every case"
    screen.show_end(tables.table_console(), tally(outcomes).text, {"Report": page}, after)


@click.command()
@named_cases("[CASE]...")
@click.option(
    "--results",
    type=click.Path(path_type=Path),
    default=VERIFIED,
    show_default=True,
    help="Folder whose results are shown: that of `lacore verify`.",
)
@out_option("reports/manual", "Folder for the pages.")
@pictures_option
@cases_option
def manual(
    cases: tuple[str, ...], results: Path, out: Path, most: int | None, known: Catalogue
) -> None:
    """Write the verification manual: a page for each case.

    Each shows the problem drawn from its model, the reference and how it is found by hand, what
    error is allowed and why, and what lacore found, with its certificates. CASE is the id of a
    case; without any, all that have results are shown. It shows what `lacore verify` has found.
    """
    from verification.commands import screen, tables
    from verification.report.reporting import write_manual
    from verification.store.results import load_outcomes
    from verification.store.store import NAME
    from verification.verdicts.tally import tally

    if not results.is_file() and not (results / NAME).is_file():
        raise _nothing_yet(cases, results)
    outcomes, _ = load_outcomes(results, known)
    seen = {outcome.run.case.id for outcome in outcomes}
    named = dict.fromkeys(find(name, known)[0].id for name in cases)
    chosen = [known[name] for name in named or known if named or name in seen]
    if not chosen:
        raise _nothing_yet(cases, results)
    page = write_manual(chosen, outcomes, results, out, most)
    after = "open it in a browser; its pages say how to run each case"
    screen.show_end(tables.table_console(), tally(outcomes).text, {"Manual": page}, after)


def _nothing_yet(names: Sequence[str], results: Path) -> la.InputError:
    """What to run first, or what a first look has left."""
    from verification.store.store import NAME

    words = ["lacore", "verify", *names, *([] if results == VERIFIED else ["--out", str(results)])]
    there = results != COMPARED and (COMPARED / NAME).is_file()
    other = f"give --results {COMPARED}" if there else "name the folder of results that are there"
    return la.InputError(
        "--results",
        str(results),
        "there are no results yet",
        f"run `{' '.join(words)}` first, or {other}",
    )
