"""Tables that the commands show on stdout."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from math import isfinite, isnan
from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.table import Table

import lacore as la
from lacore_verification.commands.screen import print_line
from lacore_verification.harness.verdicts.words import FAIL, PASS, SKIPPED
from lacore_verification.runs.outcome import Outcome
from lacore_verification.runs.row import Row

if TYPE_CHECKING:
    import pandas as pd

_STYLES = {PASS: "", FAIL: "bold red"}
_MOST_REASONS = 10


def show_results(console: Console, outcomes: Sequence[Outcome]) -> None:
    """Table of all rows, a heading for each case and variant; then what did not pass, and why.

    A heading names the reference interval, where there is one.
    """
    console.print(_line(*_HEAD), style="bold", highlight=False, markup=False)
    before = ""
    for row in (outcome.row for outcome in outcomes):
        name = f"{row.case}:{row.variant}"
        if name != before:
            within = f"   any of {row.expected}" if row.expected.startswith("[") else ""
            console.print(name + within, style="cyan", highlight=False, markup=False)
        before = name
        line = _line(
            row.mesh,
            row.backend,
            row.coupling,
            _number(row.load_factor, ".6f"),
            _expected(row),
            _number(100 * row.error, "+.4f"),
            row.rigor if row.status == la.Status.SOLVED.label else row.status,
            _number(row.outer_iterations, ".0f"),
            _number(row.build_time, ".2f"),
            _number(row.solve_time, ".2f"),
            f"{row.verdict} (model: {row.model})" if row.model else row.verdict,
        )
        console.print(line, style=_STYLES.get(row.verdict, "dim"), highlight=False, markup=False)
        for note in _notes(row):
            print_line(console, f"         {note}", "dim")
    _show_reasons(console, outcomes)


def _notes(row: Row) -> Iterator[str]:
    """Yield what else is known of a row."""
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
    """What is proven of a structure that is not proven to stand."""
    text = f"dead loads alone: {row.standing}"
    if isnan(row.carried_low):
        return text
    ends = f"from {row.carried_low:.6f} to {row.carried_high:.6f}"
    return f"{text}; load factors {ends} are carried"


def _expected(row: Row) -> str:
    """The reference, as far as it fits: of an interval the end that a value in it is nearest to."""
    if row.expected.startswith("["):
        return "interval"
    return _number(row.reference, ".6f") if isfinite(row.reference) else row.expected


def show_sweep(console: Console, outcomes: Sequence[Outcome]) -> None:
    """How many runs of each case and backend ended how; then what did not pass, and why."""
    counts: dict[tuple[str, str, str], Counter[str]] = {}
    for row in (outcome.row for outcome in outcomes):
        counts.setdefault((row.case, row.backend, row.coupling), Counter())[row.status] += 1
    line = "{:25} {:21} {:12} {:>5}  {}".format
    print_line(console, line("case", "backend", "coupling", "runs", "statuses"), "bold")
    for names, statuses in counts.items():
        parts = ", ".join(f"{count} {status}" for status, count in statuses.most_common())
        print_line(console, line(*names, statuses.total(), parts))
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
    """Fitted slopes, a line each; where there is none, why."""
    line = "{:35} {:8} {:21} {:17} {:>7} {:>6}  {:24} {}".format
    head = ("case", "mesh", "backend", "error", "slope", "T19", "where it holds", "floor")
    print_line(console, "\n" + line(*head), "bold")
    for record in records:
        name = record["parameter"].partition("_")[2]
        within = f"{name} {record['start']:.3g} to {record['stop']:.3g}"
        cells = (
            f"{record['case']}:{record['variant']}",
            *(record[key] for key in ("mesh", "backend", "error")),
            _number(record["slope"], ".3f"),
            _number(record["expected"], "g"),
            record["reason"] or within,
            _number(record["floor"], ".2g"),
        )
        print_line(console, line(*cells), "dim" if record["reason"] else "")


def show_step_orders(console: Console, records: Sequence[Mapping[str, Any]]) -> None:
    """Orders of paths in their steps, a line each; where there is none, why."""
    line = "{:22} {:34} {:9} {:12} {:>7} {:>6}  {:24} {}".format
    head = ("case", "path", "mesh", "backend", "order", "T30", "where it holds", "floor")
    print_line(console, "\n" + line(*head), "bold")
    for record in records:
        names = [key for key in record if key.startswith(("param_", "size_"))]
        within = f"{record['start']:.0f} to {record['stop']:.0f} steps"
        cells = (
            record["case"],
            ", ".join(str(record[name]) for name in names if record[name] == record[name]),
            *(record[key] for key in ("mesh", "backend")),
            _number(record["order"], ".3f"),
            _number(record["expected"], "g"),
            record["reason"] or within,
            _number(record["floor"], ".2g"),
        )
        print_line(console, line(*cells), "dim" if record["reason"] else "")


def show_couplings(console: Console, couplings: "pd.DataFrame") -> None:
    """How each coupling fared: how many runs it certified, and with how many inner solves."""
    line = "  {:12} {:20} {:>9} {:>7} {:>7} {:>5}".format
    print_line(console, "\ncouplings, for problems that have a load factor", "cyan")
    print_line(console, line("coupling", "backend", "certified", "median", "most", "FAIL"), "bold")
    for own in couplings.to_dict("records"):
        shares = f"{own['solved']}/{own['cases']}"
        solves = (_number(own["median"], "g"), _number(own["most"], "g"))
        print_line(console, line(own["coupling"], own["backend"], shares, *solves, own["failed"]))


_HEAD = (
    "mesh",
    "backend",
    "coupling",
    "value",
    "reference",
    "error %",
    "rigor/status",
    "iter",
    "build s",
    "solve s",
    "verdict",
)


def _line(*cells: str) -> str:
    formats = (
        "  {:6}",
        "{:20}",  # clarabel-regularised
        "{:12}",
        "{:>9}",
        "{:>9}",
        "{:>8}",
        "{:15}",
        "{:>4}",
        "{:>7}",
        "{:>7}",
        "{}",
    )
    return " ".join(how.format(cell) for how, cell in zip(formats, cells, strict=True))


def _number(value: float, how: str) -> str:
    return format(value, how) if isfinite(value) else ("" if value != value else str(value))


def show_records(console: Console, records: Sequence[dict[str, Any]]) -> None:
    """A plain table of records of one shape."""
    table = Table(box=None, pad_edge=False, header_style="bold", padding=(0, 2, 0, 0))
    for name in records[0] if records else ():
        table.add_column(name)
    for record in records:
        table.add_row(*(_text(value) for value in record.values()))
    console.print(table, markup=False)


def show_cases(console: Console, records: Sequence[dict[str, Any]]) -> None:
    """Print for each case a line, its variants and tags, and the backends that cannot solve it."""
    line = "{:25} {:10} {}".format
    print_line(console, line("name", "runs", "title"), "bold")
    for record in records:
        print_line(console, line(record["id"], record["run"], record["title"]))
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

    line = "{:21} {:28} {:12} {:27} {:10} {:11} {:16} {}".format
    say(
        line("name", "version", "solution", "programs", "hardening", "warm start", "runs", "state"),
        "bold",
    )
    for record in records:
        keys = ("name", "version", "solves", "takes", "hardening", "warm_start", "run")
        ready = record["state"] == "ready"
        say(line(*(record[key] for key in keys), "ready" if ready else "missing"))
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

    line = "  {:31} {:8} {:>7} {:24} {:>9} {:>9}".format
    say(name, "cyan")
    say(line("program", "verdict", "checks", "check nearest its limit", "error", "allowed"), "bold")
    for record in records:
        cells = (
            *(record[key] for key in ("program", "verdict", "checks", "closest")),
            *(_number(record[key], ".1e") for key in ("value", "allowed")),
        )
        say(line(*cells), _STYLES.get(record["verdict"], "dim"))
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
