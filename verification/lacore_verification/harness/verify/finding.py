"""The finding on a question, with its numbers."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from math import nan
from pathlib import Path

import pandas as pd

from lacore_verification.harness.store.spreadsheets import unquoted
from lacore_verification.harness.verdicts.words import FAIL, NO_REFERENCE, NO_RESULT, PASS, SKIPPED

FILE = "checks.csv"
"""File of findings, in the folder of their results."""


@dataclass(frozen=True)
class CheckResult:
    """Result of a check.

    Attributes:
        verdict: ``pass``, ``FAIL``, ``skipped``, ``no reference``: nothing to compare with, or
            ``no result`` of a regularised backend that reports none.
        why: one line with the numbers.
        measured: the decisive number; NaN if it was a status, or there is none.
        allowed: limit as text.
    """

    verdict: str
    why: str
    measured: float = nan
    allowed: str = ""


@dataclass(frozen=True)
class Finding:
    """A question and its finding; a field is a column.

    Attributes:
        case, variant, backend, coupling, check: of the question; no coupling is the default one.
        meshes: mesh levels, or the numbers of elements of a ladder, or of the meshes of a lower and
            an upper bound.
        measured, allowed: of the finding: ``value`` relative error and band, ``side`` relative
            distance from the bound, ``residuals`` the largest and its bar, ``order`` p of
            ``error ~ elements**-p`` and its expected value, ``bracket`` width and target, ``gap``
            difference from the sum of shares, per gap, and its bar, ``range`` its width.
        verdict, why: of the finding.
    """

    case: str
    variant: str
    backend: str
    coupling: str
    meshes: str
    check: str
    verdict: str
    measured: float
    allowed: str
    why: str


def tally(findings: Sequence[Finding]) -> dict[str, int]:
    """Return the number of findings by verdict."""
    count = Counter(finding.verdict for finding in findings)
    kinds = {
        "passed": PASS,
        "failed": FAIL,
        "skipped": SKIPPED,
        "no_result": NO_RESULT,
        "no_reference": NO_REFERENCE,
    }
    return {name: count[kind] for name, kind in kinds.items()}


def load_checks(folder: Path) -> pd.DataFrame:
    """Return the findings that `lacore verify` wrote into a folder; no rows if there are none."""
    path = folder / FILE
    return unquoted(pd.read_csv(path)) if path.is_file() else as_table([])


def as_table(findings: Sequence[Finding]) -> pd.DataFrame:
    """Return one row for each finding."""
    columns = [entry.name for entry in fields(Finding)]
    return pd.DataFrame([asdict(finding) for finding in findings], columns=columns)
