"""Tables of `lacore verify`: a line for each case, or for each variant and backend."""

from collections.abc import Mapping, Sequence
from math import isfinite

from rich.console import Console

from lacore_verification.commands.screen import print_line, show_shortfalls
from lacore_verification.harness.analysis.summary import Shortfall
from lacore_verification.harness.campaigns.comparison import is_regularised
from lacore_verification.harness.verdicts.words import FAIL, NO_REFERENCE, NO_RESULT, PASS, SKIPPED
from lacore_verification.harness.verify.finding import Finding
from lacore_verification.report.columns import Column, column, heads, line

_VALUES = ("value", "path")
_ORDERS = ("order", "steps")
_SHOWN = (("residuals",), _ORDERS, ("bracket",), ("gap",))
_OF_CASES = (
    Column("case", width=24),
    Column("variants", form="g", width=8),
    Column("pass", form="g", width=9),
    column("error", title="error", width=9),
    Column("tolerance", width=22),
    Column("residuals", form=".0e", width=9),
    column("order", form=".2f", width=5),
    column("width", width=7),
    column("gap", form=".0e", width=6),
    column("verdict"),
)
_OF_RUNS = (
    Column("backend", "  backend", width=22),
    Column("coupling", width=12),
    Column("meshes", width=22),
    Column("value", "value %", "+.4f", scale=100, width=12),
    Column("side", form="+.1e", width=9),
    Column("residuals", form=".1e", width=9),
    column("order", form=".2f", width=6),
    column("width", width=7),
    column("gap", form=".0e", width=7),
    Column("verdict", " verdict"),
)


def show_cases(console: Console, findings: Sequence[Finding]) -> None:
    """Print a line for each case with the largest error of exact backends; then the failures.

    For loading paths, the error is the largest along the path, and the order that of the steps.
    """
    print_line(console, heads(_OF_CASES), "bold")
    cases: dict[str, list[Finding]] = {}
    for found in findings:
        cases.setdefault(found.case, []).append(found)
    for name, own in cases.items():
        exact = [one for one in own if one.check in _VALUES and not is_regularised(one.backend)]
        value = _worst(exact, _VALUES)
        passed = sum(one.verdict == PASS for one in own)
        verdict = _verdict({str(number): one for number, one in enumerate(own)})
        cells = (
            name[:24],
            len({one.variant for one in own}),
            f"{passed} of {len(own)}",
            "" if value is None else f"{100 * value.measured:+.2g} %",
            "" if value is None else value.allowed[:22],
            *map(_measured, (_worst(own, checks) for checks in _SHOWN)),
            verdict,
        )
        style = {PASS: "", FAIL: "bold red"}.get(verdict, "dim")
        print_line(console, line(_OF_CASES, cells), style)
    show_shortfalls(
        console,
        [
            Shortfall(
                _label(one),
                *(one.backend, one.coupling, one.meshes, one.verdict, one.check, one.why),
            )
            for one in findings
            if one.verdict in (FAIL, NO_RESULT, SKIPPED)
        ],
    )


def _label(found: Finding) -> str:
    return f"{found.case}:{found.variant} {found.backend} {found.check}"


def _worst(findings: Sequence[Finding], checks: Sequence[str]) -> Finding | None:
    """Return the finding with the largest measure of these checks; None without one."""
    found = [one for one in findings if one.check in checks and isfinite(one.measured)]
    return max(found, key=lambda one: abs(one.measured), default=None)


def _measured(found: Finding | None) -> float | None:
    return None if found is None else found.measured


def show_findings(console: Console, findings: Sequence[Finding]) -> None:
    """Print a line for each variant, backend and coupling; then the failed checks, and why.

    For a loading path, the value is its largest error, and the order that of the steps.
    """
    print_line(console, heads(_OF_RUNS), "bold")
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
        verdict = f"FAIL: {', '.join(failed)}" if failed else _verdict(checks)
        cells = (
            *(f"  {backend}", coupling, meshes, _value(checks)),
            *(_cell(checks, *names) for names in (("side",), *_SHOWN)),
            f" {verdict}",
        )
        style = "bold red" if failed else "" if verdict == PASS else "dim"
        print_line(console, line(_OF_RUNS, cells), style)
    for found in findings:
        if found.verdict == FAIL:
            print_line(console, f"\nFAIL {found.check}: {found.why}", "red")
    reasons = [found.why for found in findings if found.verdict == SKIPPED]
    for why in dict.fromkeys(reasons):
        print_line(console, f"\nskipped, {reasons.count(why)} checks: {why}", "dim")


def _verdict(checks: Mapping[str, Finding]) -> str:
    """Return the overall verdict: without result or reference, a check has not passed."""
    verdicts = {found.verdict for found in checks.values()}
    return next(kind for kind in (FAIL, NO_RESULT, NO_REFERENCE, PASS, SKIPPED) if kind in verdicts)


def _value(checks: Mapping[str, Finding]) -> float | str:
    """Return the error, of a path the largest one, or the status that was expected and found."""
    for name in ("status", "path"):
        found = checks.get(name)
        if found is not None and found.verdict != SKIPPED:
            if isfinite(found.measured):
                return f"{100 * found.measured:.4f}"
            return found.verdict if found.verdict == FAIL or name == "path" else found.allowed
    return _cell(checks, "value")


def _cell(checks: Mapping[str, Finding], *names: str) -> float | str:
    """Return what the first of some checks measured, or its verdict."""
    for name in names:
        found = checks.get(name)
        if found is not None and found.verdict != SKIPPED:
            return found.measured if isfinite(found.measured) else found.verdict
    return ""
