"""Tables of `lacore verify`: a line for each case, or for each variant and backend."""

from collections.abc import Mapping, Sequence
from math import isfinite

from rich.console import Console

from lacore_verification.commands.screen import print_line, show_shortfalls
from lacore_verification.harness.analysis.summary import Shortfall
from lacore_verification.harness.campaigns.comparison import is_regularised
from lacore_verification.harness.verdicts.words import FAIL, NO_REFERENCE, NO_RESULT, PASS, SKIPPED
from lacore_verification.harness.verify.finding import Finding

_VALUES = ("value", "path")
_ORDERS = ("order", "steps")


def show_cases(console: Console, findings: Sequence[Finding]) -> None:
    """Print a line for each case with the largest error of exact backends; then the failures.

    For loading paths, the error is the largest along the path, and the order that of the steps.
    """
    line = "{:24} {:>8} {:>9} {:>9} {:22} {:>9} {:>5} {:>7} {:>6} {}".format
    head = (
        *("case", "variants", "pass", "error", "tolerance", "residuals", "order"),
        *("width %", "gap", "verdict"),
    )
    print_line(console, line(*head), "bold")
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
            _measured(_worst(own, ("residuals",)), ".0e"),
            _measured(_worst(own, _ORDERS), ".2f"),
            _measured(_worst(own, ("bracket",)), ".2f", 100),
            _measured(_worst(own, ("gap",)), ".0e"),
        )
        style = {PASS: "", FAIL: "bold red"}.get(verdict, "dim")
        print_line(console, line(*cells, verdict), style)
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
    """Of these checks the one that measured most; None where none measured anything."""
    found = [one for one in findings if one.check in checks and isfinite(one.measured)]
    return max(found, key=lambda one: abs(one.measured), default=None)


def _measured(found: Finding | None, how: str, scale: float = 1.0) -> str:
    return "" if found is None else format(scale * found.measured, how)


def show_findings(console: Console, findings: Sequence[Finding]) -> None:
    """Print a line for each variant, backend and coupling; then the failed checks, and why.

    For a loading path, the value is its largest error, and the order that of the steps.
    """
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
    """What has failed, or has no result or no reference, has not passed."""
    verdicts = {found.verdict for found in checks.values()}
    return next(kind for kind in (FAIL, NO_RESULT, NO_REFERENCE, PASS, SKIPPED) if kind in verdicts)


def _cell(checks: Mapping[str, Finding], check: str, how: str, scale: float = 1.0) -> str:
    """What a check measured, or the status that was expected and found."""
    found = checks.get(check)
    if found is None or found.verdict == SKIPPED:
        return ""
    if isfinite(found.measured):
        return format(scale * found.measured, how)
    return found.verdict if found.verdict == FAIL or how else found.allowed
