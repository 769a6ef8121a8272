"""A run with its row and its evidence."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from lacore_verification.runs.row import Row
from lacore_verification.runs.run import Run


@dataclass(frozen=True)
class Evidence:
    """Evidence of a row.

    Attributes:
        residuals: residuals of the certificate, by name; may be empty.
        history: one record per inner solve, as in `la.LimitState.history`.
        arrays: velocity, stresses and reactions, see
            `lacore_verification.harness.evidence.limit_state`; may be empty.
    """

    residuals: Mapping[str, float]
    history: tuple[Mapping[str, Any], ...]
    arrays: bytes


NO_EVIDENCE = Evidence({}, (), b"")


@dataclass(frozen=True)
class Outcome:
    """A run with its row, its evidence, and its printed output."""

    run: Run
    row: Row
    evidence: Evidence = NO_EVIDENCE
    log: str = ""

    def record(self) -> dict[str, Any]:
        """Return all columns."""
        return columns(self.row, self.evidence.residuals, self.run.identity)


def columns(
    row: Row, residuals: Mapping[str, float], identity: Mapping[str, Any]
) -> dict[str, Any]:
    """Return the columns of a finished run: its row, its residuals, and all settings."""
    groups = {
        "residual": residuals,
        "param": identity["parameters"],
        "size": identity["size"],
        "setting": identity["settings"],
        "option": identity["options"],
    }
    return row.record() | {
        f"{kind}_{name}": value for kind, values in groups.items() for name, value in values.items()
    }
