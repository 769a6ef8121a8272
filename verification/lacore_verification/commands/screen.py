"""Summary on the terminal: a line for each case, failures with reasons, and the report folder."""

# Annotations are not evaluated, so their modules are not loaded.
from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite, isnan
from textwrap import wrap
from typing import TYPE_CHECKING

import pandas as pd
from rich.console import Console

from lacore_verification.case import SOLVER
from lacore_verification.harness.analysis.summary import DISCRETE, Shortfall, VariantSummary
from lacore_verification.harness.verdicts.words import FAIL, NO_RESULT, PASS, SKIPPED
from lacore_verification.report.columns import Column, column, heads, line

if TYPE_CHECKING:
    from lacore_verification.harness.analysis.history import History
    from lacore_verification.harness.store.versions import Version

LINES = 60
"""Largest number of lines of a summary."""
WIDTH = 120
"""Characters of a line."""
_VARIANTS = 42  # lines for cases; with more variants each case gets one
_NAMES = 9  # lines for names alone, if there are still more cases
_RATES = 4  # lines for the rates of backends
_CHANGES = 20  # lines for runs that changed from one version to the next
_REASONS = 7  # lines for failures
_NAME = 30
_STYLES = {PASS: "", FAIL: "bold red"}
_CASES = (
    Column("name", width=_NAME),
    Column("expected", "reference", width=20),
    Column("proven", "or value", width=20),
    Column("error", form="g", width=10),
    Column("tolerance", form="g", width=10),
    Column("agree", "agreeing", width=8),
    Column("seconds", "time", "g", width=8),
    column("verdict"),
)
_ABOVE = ("", "", "proven bounds", "", "", "backends", "solve", "")
_VERSIONS = (
    Column("backend", width=30),
    Column("version", "results", width=24),
    column("runs", width=9),
    column("success_rate", width=9),
    column("certified_rate", title="certified", width=9),
    column("correctness_rate", title="correct", width=9),
    column("mean_time", title="mean s", width=10),
    column("worst_error", title="max error %", width=10),
)


def table_console() -> Console:
    """Return stdout, at least as wide as the table of results, so that pipes do not cut it."""
    console = Console()
    console.width = max(console.width, WIDTH)
    return console


def print_line(console: Console, text: str, style: str = "") -> None:
    """Print one line, neither cut nor wrapped."""
    console.print(text, style=style, highlight=False, markup=False, soft_wrap=True)


def show_overview(console: Console, found: Sequence[VariantSummary]) -> None:
    """Print a line for each variant, or for the worst of each case, and then failures.

    Failures come first, then the largest errors. If there are many cases, the last ones are only
    named.
    """
    folded = len(found) > _VARIANTS
    cases = _by_case(found) if folded else [[own] for own in found]
    cases.sort(key=lambda own: min(one.rank for one in own))
    shown = len(cases) if len(cases) <= _VARIANTS else _VARIANTS - _NAMES
    name = "case and its worst variant" if folded else "case and variant"
    print_line(console, line(_CASES, _ABOVE), "bold")
    print_line(console, heads((_CASES[0].but(title=name), *_CASES[1:])), "bold")
    for own in cases[:shown]:
        worst = min(own, key=lambda one: one.rank)
        more = f" +{len(own) - 1}" if len(own) > 1 else ""
        cells = (
            _cut(worst.name, _NAME - len(more)) + more,
            _cut(worst.expected, 20),
            proven(worst),
            worst.error_text,
            worst.tolerance_text,
            f"{worst.agreeing} of {worst.asked}",
            f"{sum(one.seconds for one in own):.1f} s",
            worst.verdict,
        )
        print_line(console, line(_CASES, cells), _STYLES.get(worst.verdict, "dim"))
    rest = [own[0].case for own in cases[shown:]]
    for text in wrap(
        f"with smaller errors, or without any: {', '.join(rest)}" if rest else "",
        WIDTH,
        subsequent_indent="  ",
        max_lines=_NAMES,
        placeholder=" ... (--full)",
        break_on_hyphens=False,
    ):
        print_line(console, text, "dim")
    show_shortfalls(console, [short for own in found for short in own.shortfalls])


def proven(summary: VariantSummary) -> str:
    """Return the proven bracket, or the bound, or else the value."""
    lower, upper, value = summary.lower, summary.upper, summary.value
    straight = "~" if summary.bounded == DISCRETE else ""
    if isfinite(lower) and isfinite(upper):
        return f"{straight}[{lower:.6g}, {upper:.6g}]"
    if isfinite(upper) and not (isfinite(value) and upper > value * (1 + SOLVER)):
        return f"<= {upper:.7g}"
    if isnan(value):
        return summary.expected if summary.verdict == PASS else ""
    return f"{value + 0.0:.7g}"


def _by_case(found: Sequence[VariantSummary]) -> list[list[VariantSummary]]:
    cases: dict[str, list[VariantSummary]] = {}
    for own in found:
        cases.setdefault(own.case, []).append(own)
    return [*cases.values()]


def show_shortfalls(console: Console, shortfalls: Sequence[Shortfall]) -> None:
    """Print failed, missing and skipped results with reasons: each reason once, in a few lines."""
    grouped: dict[tuple[str, str, str], list[Shortfall]] = {}
    for verdict in (FAIL, NO_RESULT, SKIPPED):
        for short in (one for one in shortfalls if one.verdict == verdict):
            grouped.setdefault((verdict, short.backend, short.why), []).append(short)
    lines = []
    for (verdict, backend, why), shorts in grouped.items():
        what = shorts[0].label if len(shorts) == 1 else f"{backend}, {len(shorts)} times"
        most = 1 if verdict == NO_RESULT else 2
        text = " ".join(f"{verdict}: {what}: {why}".split())
        lines += [
            (part, "red" if verdict == FAIL else "dim")
            for part in wrap(text, WIDTH, subsequent_indent="  ", max_lines=most, placeholder="...")
        ]
    for text, style in lines[:_REASONS]:
        print_line(console, text, style)
    if len(lines) > _REASONS:
        print_line(console, f"... and {len(lines) - _REASONS} more lines: see --full", "dim")


def show_rates(console: Console, rates: pd.DataFrame) -> None:
    """Print how many runs of each backend are claimed, certified and correct, in a few lines.

    Args:
        console: To print to.
        rates: From `lacore_verification.harness.analysis.rates`, one row for each backend.
    """
    counts = [
        f"{own['backend']} {own['claimed']}, {own['certified']}, {own['correct']} of {own['runs']}"
        for own in rates.to_dict("records")
    ]
    text = f"claimed, certified and correct runs: {'; '.join(counts)}" if counts else ""
    lines = wrap(text, WIDTH, subsequent_indent="  ", max_lines=_RATES, placeholder=" ...")
    for part in lines:
        print_line(console, part, "dim")


def show_history(console: Console, versions: Sequence[Version], found: History) -> None:
    """Print the versions, the rates of each backend in each of them, and the runs that changed."""
    for own in versions:
        about = f"lacore {own.lacore or 'unknown'}, {own.date or 'unknown date'}"
        print_line(console, f"{own.name}: {about}, {len(own.results)} runs, {own.place}")
    print_line(console, f"\n{heads(_VERSIONS)}", "bold")
    for row in found.backends.to_dict("records"):
        names = _cut(row["backend"], 30), _cut(row["version"], 24)
        numbers = (own.text(row[own.name]) or "-" for own in _VERSIONS[2:])
        print_line(console, line(_VERSIONS, (*names, *numbers)))
    print_line(console, f"\n{len(found.changes)} runs changed, {found.worse} pass and now FAIL", "")
    for row in found.changes.head(_CHANGES).to_dict("records"):
        run = f"{row['case']}:{row['variant']} {row['mesh']} {row['backend']} {row['coupling']}"
        values = (_shown(row[f"load_factor_{when}"], ".7g") for when in ("before", "after"))
        verdicts = f"{row['verdict_before']} -> {row['verdict_after']}"
        text = f"  {run}: {verdicts}, {' -> '.join(values)} ({row['before']} -> {row['after']})"
        print_line(console, text, _STYLES.get(row["verdict_after"], "dim"))
    if len(found.changes) > _CHANGES:
        print_line(
            console, f"  ... and {len(found.changes) - _CHANGES} more: see the report", "dim"
        )


def _shown(value: float, form: str) -> str:
    return format(value, form) if isfinite(value) else "-"


def show_end(console: Console, count: str, places: Mapping[str, object], after: str) -> None:
    """Print the counts of verdicts, the places of files, and the next command."""
    print_line(console, count)
    for name, place in places.items():
        print_line(console, f"{name + ':':9}{place}")
    print_line(console, f"{'Next:':9}{after}")


def _cut(text: str, width: int) -> str:
    return text if len(text) <= width else f"{text[: width - 3]}..."
