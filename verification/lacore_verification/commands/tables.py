"""Tables of commands on stdout."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from math import isfinite, isnan
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.table import Table

import lacore as la
from lacore_verification.commands.screen import print_line
from lacore_verification.harness.verdicts.words import FAIL, PASS, SKIPPED
from lacore_verification.report.columns import Column, column, heads, line
from lacore_verification.runs.outcome import Outcome
from lacore_verification.runs.row import Row

if TYPE_CHECKING:
    import pandas as pd

_STYLES = {PASS: "", FAIL: "bold red"}
_MOST_REASONS = 10
_RUNS = (
    Column("mesh", "  mesh", width=8),
    Column("backend", width=20),  # clarabel-regularised
    Column("coupling", width=12),
    column("load_factor", title="value", form=".6f", width=9),
    column("expected", form=".6f", width=9),
    column("error", width=8),
    Column("outcome", "rigor/status", width=15),
    column("outer_iterations", title="iter", width=4),
    column("build_time", title="build s", width=7),
    column("solve_time", title="solve s", width=7),
    column("verdict"),
)
_FITTED = (
    Column("range", "where it holds", width=24),
    column("floor", form=".2g"),
)


def show_results(console: Console, outcomes: Sequence[Outcome]) -> None:
    """Print a table of all rows with a heading for each case and variant, then failures.

    A heading names the reference interval, if there is one.
    """
    console.print(heads(_RUNS), style="bold", highlight=False, markup=False)
    before = ""
    for row in (outcome.row for outcome in outcomes):
        name = f"{row.case}:{row.variant}"
        if name != before:
            within = f"   any of {row.expected}" if row.expected.startswith("[") else ""
            console.print(name + within, style="cyan", highlight=False, markup=False)
        before = name
        cells = (
            *(f"  {row.mesh}", row.backend, row.coupling, row.load_factor, _expected(row)),
            row.error,
            row.rigor if row.status == la.Status.SOLVED.label else row.status,
            *(row.outer_iterations, row.build_time, row.solve_time),
            f"{row.verdict} (model: {row.model})" if row.model else row.verdict,
        )
        console.print(
            line(_RUNS, cells), style=_STYLES.get(row.verdict, "dim"), highlight=False, markup=False
        )
        for note in _notes(row):
            print_line(console, f"         {note}", "dim")
    _show_reasons(console, outcomes)


def _notes(row: Row) -> Iterator[str]:
    """Yield further results of a row."""
    if row.options:
        yield f"options: {row.options}"
    if row.answered_by not in ("", row.backend):
        yield f"answered by {row.answered_by}"
    if isfinite(row.width):
        between = f"{row.lower:.6f} <= load factor <= {row.upper:.6f}"
        yield f"{between}, {100 * row.width:.2g} % wide"
    if row.standing and row.standing != la.Standing.STANDS.label:
        yield _standing(row)
    if row.ending:
        worst = f", error {100 * row.path_error:.2g} % at most" if isfinite(row.path_error) else ""
        yield f"path: {row.ending}{worst}"


def _show_reasons(console: Console, outcomes: Sequence[Outcome]) -> None:
    """Print why runs were skipped, and why others failed."""
    skipped: dict[tuple[str, str, str], list[str]] = {}
    for row in (outcome.row for outcome in outcomes):
        if row.verdict == SKIPPED:
            skipped.setdefault((row.backend, row.mesh, row.why), []).append(row.why)
    for (backend, mesh, why), rows in skipped.items():
        text = f"\nskipped: {backend} on {mesh}, {len(rows)} runs: {why}"
        console.print(text, style="dim", markup=False, highlight=False)
    for outcome in outcomes:
        if outcome.row.verdict == FAIL:
            text = f"\nFAIL {outcome.run.label}: {outcome.row.why}"
            console.print(text, style="red", markup=False, highlight=False)


def _standing(row: Row) -> str:
    """Return the proven status of a structure that is not proven to stand."""
    text = f"dead loads alone: {row.standing}"
    if isnan(row.carried_low):
        return text
    ends = f"from {row.carried_low:.6f} to {row.carried_high:.6f}"
    return f"{text}; load factors {ends} are carried"


def _expected(row: Row) -> float | str:
    """The reference, as far as it fits: of an interval the end that a value in it is nearest to."""
    if row.expected.startswith("["):
        return "interval"
    return row.reference if isfinite(row.reference) else row.expected


def show_sweep(console: Console, outcomes: Sequence[Outcome]) -> None:
    """Print the number of runs by verdict for each case and backend, then failures."""
    counts: dict[tuple[str, str, str], Counter[str]] = {}
    for row in (outcome.row for outcome in outcomes):
        counts.setdefault((row.case, row.backend, row.coupling), Counter())[row.status] += 1
    shown = (
        Column("case", width=25),
        Column("backend", width=21),
        Column("coupling", width=12),
        column("runs", width=5),
        Column("statuses"),
    )
    print_line(console, heads(shown), "bold")
    for names, statuses in counts.items():
        parts = ", ".join(f"{count} {status}" for status, count in statuses.most_common())
        print_line(console, line(shown, (*names, statuses.total(), parts)))
    reasons: dict[tuple[str, str], list[str]] = {}
    for outcome in outcomes:
        if outcome.row.verdict != PASS:
            reasons.setdefault((outcome.row.verdict, outcome.row.why), []).append(outcome.run.label)
    for (verdict, why), labels in list(reasons.items())[:_MOST_REASONS]:
        more = f" and {len(labels) - 1} more" if len(labels) > 1 else ""
        print_line(
            console, f"{verdict}: {labels[0]}{more}: {why}", "red" if verdict == FAIL else "dim"
        )
    if len(reasons) > _MOST_REASONS:
        print_line(
            console,
            f"{len(reasons) - _MOST_REASONS} other reasons are listed in the results",
            "dim",
        )


def show_slopes(console: Console, records: Sequence[Mapping[str, Any]]) -> None:
    """Print fitted slopes, one line each, or why there is none."""
    shown = (
        Column("case", width=35),
        Column("mesh", width=8),
        Column("backend", width=21),
        Column("error", width=17),
        column("slope", form=".3f", width=7),
        column("expected", title="T19", width=6),
        *_FITTED,
    )
    print_line(console, "\n" + heads(shown), "bold")
    for record in records:
        name = record["parameter"].partition("_")[2]
        within = f"{name} {record['start']:.3g} to {record['stop']:.3g}"
        cells = (
            f"{record['case']}:{record['variant']}",
            *(record[key] for key in ("mesh", "backend", "error", "slope", "expected")),
            record["reason"] or within,
            record["floor"],
        )
        print_line(console, line(shown, cells), "dim" if record["reason"] else "")


def show_step_orders(console: Console, records: Sequence[Mapping[str, Any]]) -> None:
    """Print orders of paths in their steps, one line each, or why there is none."""
    shown = (
        Column("case", width=22),
        Column("path", width=34),
        Column("mesh", width=9),
        Column("backend", width=12),
        column("order", form=".3f", width=7),
        column("expected", title="T30", width=6),
        *_FITTED,
    )
    print_line(console, "\n" + heads(shown), "bold")
    for record in records:
        names = [key for key in record if key.startswith(("param_", "size_"))]
        within = f"{record['start']:.0f} to {record['stop']:.0f} steps"
        cells = (
            record["case"],
            ", ".join(str(record[name]) for name in names if record[name] == record[name]),
            *(record[key] for key in ("mesh", "backend", "order", "expected")),
            record["reason"] or within,
            record["floor"],
        )
        print_line(console, line(shown, cells), "dim" if record["reason"] else "")


def show_couplings(console: Console, couplings: "pd.DataFrame") -> None:
    """Print how many runs each coupling certified, and with how many inner solves."""
    shown = (
        Column("coupling", width=12),
        Column("backend", width=20),
        column("solved", width=9),
        column("median", title="median", width=7),
        column("most", title="most", width=7),
        column("failed", width=5),
    )
    print_line(console, "\ncouplings, for problems that have a load factor", "cyan")
    print_line(console, f"  {heads(shown)}", "bold")
    for own in couplings.to_dict("records"):
        own["solved"] = f"{own['solved']}/{own['cases']}"
        print_line(console, f"  {line(shown, [own[one.name] for one in shown])}")


def show_records(console: Console, records: Sequence[dict[str, Any]]) -> None:
    """Print a plain table of records of one shape."""
    table = Table(box=None, pad_edge=False, header_style="bold", padding=(0, 2, 0, 0))
    for name in records[0] if records else ():
        table.add_column(name)
    for record in records:
        table.add_row(*(_text(value) for value in record.values()))
    console.print(table, markup=False)


def show_cases(console: Console, records: Sequence[dict[str, Any]]) -> None:
    """Print for each case a line, its variants and tags, and the backends that cannot solve it."""
    own = (Column("name", width=25), Column("runs", width=10), Column("title"))
    print_line(console, heads(own), "bold")
    for record in records:
        print_line(console, line(own, (record["id"], record["run"], record["title"])))
        variants = record["variants"]
        shown = ", ".join(variants[:8]) + (f", ... {len(variants)}" if len(variants) > 8 else "")
        print_line(console, f"  variants: {shown}; meshes: {', '.join(record['meshes'])}", "dim")
        print_line(console, f"  tags: {', '.join(record['tags'])}", "dim")
        for text in record["without"]:
            print_line(console, f"  not solved by {text}", "dim")


def _text(value: Any) -> str:
    return ", ".join(map(str, value)) if isinstance(value, (list, tuple)) else str(value)


def show_backends(console: Console, records: Sequence[dict[str, str]]) -> None:
    """Print a line for each backend, with its title, or with the reason why it cannot run."""

    def say(text: str, style: str = "") -> None:
        print_line(console, text, style)

    shown = (
        Column("name", width=21),
        Column("version", width=28),
        Column("solves", "solution", width=12),
        Column("takes", "programs", width=27),
        Column("hardening", width=10),
        Column("warm_start", width=11),
        Column("run", "runs", width=16),
    )
    say(f"{heads(shown)} state", "bold")
    for record in records:
        ready = record["state"] == "ready"
        state = "ready" if ready else "missing"
        say(f"{line(shown, [record[own.name] for own in shown])} {state}")
        if ":" not in record["name"]:
            say(f"  {record['title']}", "dim")
        if not ready:
            say(f"  {record['state']}", "yellow")


def show_conformance(
    console: Console, name: str, records: Sequence[dict[str, Any]], failures: Sequence[str]
) -> None:
    """Print a line for each program with the error nearest to its limit; then the failures."""

    def say(text: str, style: str = "") -> None:
        print_line(console, text, style)

    shown = (
        Column("program", width=31),
        column("verdict", width=8),
        Column("checks", form=".0f", width=7),
        Column("closest", "check nearest its limit", width=24),
        Column("value", "error", ".1e", width=9),
        Column("allowed", form=".1e", width=9),
    )
    say(name, "cyan")
    say(f"  {heads(shown)}", "bold")
    for record in records:
        cells = line(shown, [record[own.name] for own in shown])
        say(f"  {cells}", _STYLES.get(record["verdict"], "dim"))
    for reason in dict.fromkeys(r["message"] for r in records if r["verdict"] == SKIPPED):
        say(f"skipped: {reason}", "dim")
    for text in failures:
        say(f"FAIL {text}", "red")
    count = [sum(record["verdict"] == kind for record in records) for kind in (PASS, FAIL, SKIPPED)]
    say("{} programs pass, {} FAIL, {} skipped\n".format(*count))


def show_health(console: Console, found: dict[str, Any]) -> None:
    """Print the findings of `lacore_verification.commands.doctor` in sections."""
    for key, text in found["environment"].items():
        console.print(f"{key:9} {text}", highlight=False, markup=False)
    for section in ("packages", "libraries", "backends"):
        console.print()
        show_records(console, found[section])
    verdict = "the installation works"
    if not found["healthy"]:
        verdict = "the installation has problems: see the column remedy"
    console.print(f"\n{verdict}", style="" if found["healthy"] else "bold red", highlight=False)
