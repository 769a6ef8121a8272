"""A run with its row, and what proves it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from lacore_verification.runs.row import Row
from lacore_verification.runs.run import Run


@dataclass(frozen=True)
class Evidence:
    """What proves a row.

    Attributes:
        residuals: of the certificate, by name; empty without one.
        history: one record an inner solve, as in `la.LimitState.history`.
        arrays: velocity, stresses and reactions, see
            `lacore_verification.harness.evidence.limit_state`; empty without any.
    """

    residuals: Mapping[str, float]
    history: tuple[Mapping[str, Any], ...]
    arrays: bytes


NO_EVIDENCE = Evidence({}, (), b"")


@dataclass(frozen=True)
class Outcome:
    """A run with its row, what proves it, and what was printed meanwhile."""

    run: Run
    row: Row
    evidence: Evidence = NO_EVIDENCE
    log: str = ""

    def record(self) -> dict[str, Any]:
        """All columns."""
        return columns(self.row, self.evidence.residuals, self.run.identity)


def columns(
    row: Row, residuals: Mapping[str, float], identity: Mapping[str, Any]
) -> dict[str, Any]:
    """Columns of a finished run: its row, its residuals, and everything that was set."""
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
