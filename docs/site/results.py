"""The committed results that the verification manual is built of, and how they are made.

``python docs/site/results.py DIR`` keeps those of `lacore verify` in DIR: every run, its residuals
and the history of brackets and paths, without states; those of cases that DIR does not have stay,
and so do those of backends that it did not ask about a case.
``results.jsonl.gz.sha256`` is of the whole file; of one that was changed by hand nothing is shown.
"""

import gzip
import hashlib
import json
import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, fields
from math import isnan
from pathlib import Path
from typing import Any

import pandas as pd

from lacore_verification.case.band import BRACKET
from lacore_verification.catalogue.catalogue import catalogue
from lacore_verification.harness.store.results import load_outcomes
from lacore_verification.harness.store.store import file_of, sessions
from lacore_verification.harness.verify.finding import load_checks
from lacore_verification.runs.outcome import Evidence, Outcome
from lacore_verification.runs.row import Row
from lacore_verification.runs.run import Run, canonical

FILE = Path(__file__).parent / "results.jsonl.gz"
SEAL = Path(f"{FILE}.sha256")
_DEFAULTS = {entry.name: entry.default for entry in fields(Row)}


@dataclass(frozen=True)
class Results:
    """What the manual shows.

    Attributes:
        provenances: of the runs, machine, versions, date, by what they are of.
        outcomes: without states; of cases and variants that are in the catalogue.
        checks: as `lacore verify` writes them.
        left: lines of cases and variants that are not there any more, or changed since.
        digest: SHA-256 of the file.
    """

    provenances: Mapping[str, Mapping[str, str]]
    outcomes: list[Outcome]
    checks: pd.DataFrame
    left: int
    digest: str


def load() -> Results:
    """The committed results, whose checksum must be right.

    Raises:
        ValueError: it is not.
    """
    kept = _read()
    found = [_outcome(line) for line in kept.lines]
    known = [outcome for outcome in found if outcome is not None]
    counts = Counter(line["date"] for line in kept.lines)
    provenances = {f"{own['date']}: {counts[own['date']]} runs": own for own in kept.sessions}
    seal = SEAL.read_text(encoding="ascii").strip()
    return Results(provenances, known, pd.DataFrame(kept.checks), len(found) - len(known), seal)


@dataclass(frozen=True)
class _Kept:
    """What the file has: provenances, checks, and a line a run with the date of its provenance."""

    sessions: Sequence[dict[str, str]] = ()
    checks: Sequence[dict[str, Any]] = ()
    lines: Sequence[dict[str, Any]] = ()

    def without(self, asked: Set[tuple[str, str]]) -> "_Kept":
        """What is kept of others than these cases with these backends."""
        lines = [line for line in self.lines if _asked(line["identity"]) not in asked]
        dates = {line["date"] for line in lines}
        return _Kept(
            [own for own in self.sessions if own["date"] in dates],
            [own for own in self.checks if _asked(own) not in asked],
            lines,
        )


def _asked(told: Mapping[str, Any]) -> tuple[str, str]:
    """Which case of which backend."""
    return told["case"], told["backend"]


def _read() -> _Kept:
    data = FILE.read_bytes()
    if hashlib.sha256(data).hexdigest() != SEAL.read_text(encoding="ascii").strip():
        raise ValueError(f"{FILE.name} does not match its checksum; write it by make results")
    sessions, checks, *lines = map(json.loads, gzip.decompress(data).decode().splitlines())
    return _Kept(sessions, checks, lines)


def _outcome(line: Mapping[str, Any]) -> Outcome | None:
    """A line as an outcome; None if its case is another one today."""
    identity, row = line["identity"], line["row"]
    case = catalogue().get(identity["case"])
    variants = {one.name: one for one in case.variants} if case else {}
    variant = variants.get(identity["variant"])
    if case is None or variant is None or identity["mesh"] not in case.meshes:
        return None
    if canonical(dict(variant.parameters)) != canonical(identity["parameters"]):
        return None
    settings = {name: identity[name] for name in ("size", "settings", "options")}
    run = Run(
        case, variant, identity["mesh"], identity["backend"], identity["coupling"], **settings
    )
    evidence = Evidence(line.get("residuals", {}), tuple(line.get("history", ())), b"")
    return Outcome(run, Row(**row), evidence)


def _line(outcome: Outcome, date: str) -> dict[str, Any]:
    """What is kept of an outcome: without what is not there, measured with few digits."""
    row = {name: value for name, value in vars(outcome.row).items() if not _same(name, value)}
    row |= {name: _short(row[name]) for name in _MEASURED & row.keys()}
    residuals = {name: _short(value) for name, value in outcome.evidence.residuals.items()}
    kept = {"residuals": residuals, "history": list(_history(outcome))}
    told = {name: value for name, value in kept.items() if value}
    return {"identity": outcome.run.identity, "date": date, "row": row, **told}


_MEASURED = {"build_time", "solve_time", "peak_memory_mb", "contraction", "gap", "energy"}


def _short(value: float) -> float:
    return float(f"{value:.3g}")


def _history(outcome: Outcome) -> Iterator[dict[str, Any]]:
    """Of brackets and paths what charts show."""
    names = ["bound", "elements", "width"] if outcome.row.coupling == BRACKET else []
    if outcome.row.ending:
        names = ["travel", outcome.run.case.following_of(outcome.run.variant).load, "exact"]
    for step in outcome.evidence.history if names else ():
        yield {name: step[name] for name in names}


def _same(name: str, value: Any) -> bool:
    default = _DEFAULTS[name]
    nothing = isinstance(value, float) and isnan(value)
    return bool(nothing if isinstance(default, float) else value == default)


def _found(folder: Path) -> _Kept:
    outcomes, _ = load_outcomes(folder, catalogue())
    newest = list(sessions(file_of(folder)).values())[-1]
    checks = json.loads(load_checks(folder).to_json(orient="records"))
    return _Kept([newest], checks, [_line(outcome, newest["date"]) for outcome in outcomes])


def main(folder: Path) -> None:
    """Keep the results of a folder, in place of older ones of the same cases and backends."""
    new = _found(folder)
    old = _read().without({_asked(line["identity"]) for line in new.lines})
    parts = [[*old.sessions, *new.sessions], [*old.checks, *new.checks], *old.lines, *new.lines]
    data = "".join(f"{canonical(part)}\n" for part in parts).encode()
    packed = gzip.compress(data, mtime=0)
    FILE.write_bytes(packed)
    SEAL.write_text(hashlib.sha256(packed).hexdigest() + "\n", encoding="ascii")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
