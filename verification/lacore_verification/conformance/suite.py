"""Run the suite for a backend: `run` for a table, `require` for a test of one line."""

from collections.abc import Callable, Mapping
from contextlib import ExitStack, suppress
from dataclasses import astuple, fields, replace
from typing import Any

import pandas as pd

import lacore as la
from lacore.reporting.errors import require_known
from lacore.solvers.backend import Backend
from lacore.solvers.isolation import IsolatedBackend
from lacore_verification.conformance.contract import EXERCISES, Bench, examine
from lacore_verification.conformance.judge import FAIL, PASS, SKIPPED, Finding, Subject
from lacore_verification.harness import progress

COLUMNS = [field.name for field in fields(Finding)]


def run(
    backend: str | Backend,
    options: Mapping[str, Any] | None = None,
    *,
    programs: list[str] | None = None,
    on_start: Callable[[str], None] | None = None,
    process: la.SolverProcess | None = None,
) -> pd.DataFrame:
    """Run the suite for a backend, and return one row per check.

    Columns: `program`, `check`, `value` (the error), `allowed` (the largest that passes), `verdict`
    (``pass``, ``FAIL`` or ``skipped``) and `message` (expected and actual result).

    Args:
        backend: a registered name, a variant of a family (``cvxpy:SCS``), or a backend itself.
        options: options of the backend, except those set by a program (limits, `r`).
        programs: some of `EXERCISES`; default: all.
        on_start: called with the name of each program, for progress; without it a bar appears on
            stderr when the suite takes longer than two seconds.
        process: Let a registered backend work in this process.

    Raises:
        InputError: no such backend, option or program.
        CapabilityError: the backend cannot run here.
    """
    names = list(EXERCISES) if programs is None else programs
    for name in names:
        require_known("program of the conformance suite", name, EXERCISES)
    tested = la.find_backend(backend, process) if isinstance(backend, str) else backend
    shown = backend if isinstance(backend, str) else tested.name
    if isinstance(tested, IsolatedBackend):
        with suppress(la.CapabilityError):  # The program "warm-up" reports it.
            tested.start()  # Compilation does not count to the time limits of the programs.
    findings: list[Finding] = []
    with ExitStack() as stack:
        if on_start is None:
            on_start = stack.enter_context(
                progress.patiently(f"conformance of {shown}", len(names))
            )
        bench = Bench(Subject(tested, dict(options or {})))
        for name in names:
            on_start(name)
            findings += [_sentence(shown, finding) for finding in examine(bench, name)]
    return pd.DataFrame([astuple(finding) for finding in findings], columns=COLUMNS)


def _sentence(backend: str, finding: Finding) -> Finding:
    if finding.verdict != FAIL:
        return finding
    text = f"{backend} on {finding.program!r}, {finding.check}: {finding.message}"
    return replace(finding, message=text)


def require(backend: str | Backend, options: Mapping[str, Any] | None = None) -> None:
    """Raise `AssertionError` with all failures of a backend; arguments as those of `run`."""
    wrong = failures(run(backend, options))
    if wrong:
        raise AssertionError("\n".join(wrong))


def failures(findings: pd.DataFrame) -> list[str]:
    """Return the messages of failed checks."""
    return [str(row["message"]) for row in records(findings) if row["verdict"] == FAIL]


def by_program(findings: pd.DataFrame) -> list[dict[str, Any]]:
    """Return one record per program: its verdict, and the check closest to its allowed error."""
    programs: dict[str, list[dict[str, Any]]] = {}
    for row in records(findings):
        programs.setdefault(row["program"], []).append(row)
    return [_summary(name, rows) for name, rows in programs.items()]


def _summary(name: str, rows: list[dict[str, Any]]) -> dict[str, Any]:
    verdicts = {row["verdict"] for row in rows}
    measured = [row for row in rows if row["value"] == row["value"]]
    closest: dict[str, Any] = max(
        measured,
        key=lambda row: row["value"] / row["allowed"],
        default={"check": "", "value": float("nan"), "allowed": float("nan")},
    )
    return {
        "program": name,
        "verdict": next(kind for kind in (FAIL, PASS, SKIPPED) if kind in verdicts),
        "checks": len(rows),
        "closest": closest["check"],
        "value": closest["value"],
        "allowed": closest["allowed"],
        "message": next((row["message"] for row in rows if row["message"]), ""),
    }


def records(findings: pd.DataFrame) -> list[dict[str, Any]]:
    """Return the rows as dictionaries."""
    return [{str(key): value for key, value in row.items()} for row in findings.to_dict("records")]
