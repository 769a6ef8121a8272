"""What is kept of the benchmarks: docs/benchmarks.json, with its checksum beside it."""

import hashlib
import json
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[2]
KEPT = ROOT / "docs" / "benchmarks.json"


def load() -> dict[str, Any]:
    """What is kept, whose checksum must be right.

    Raises:
        ValueError: it is not.
    """
    data = KEPT.read_bytes()
    if digest(data) != seal_of(KEPT).read_text(encoding="ascii").strip():
        raise ValueError(f"{KEPT.name} does not match its checksum; write it by make bench-page")
    kept: dict[str, Any] = json.loads(data)
    return kept


def keep(now: dict[str, Any]) -> dict[str, Any]:
    """Write what was measured beside what is kept already, and say what is kept then."""
    kept = joined(load(), now) if KEPT.exists() else now
    lines = ",\n".join(json.dumps(record) for record in kept["records"])
    measured = json.dumps(kept["measured"], indent=1)
    text = f'{{"measured": {measured},\n"records": [\n{lines}\n]}}\n'
    KEPT.write_text(text, "utf-8")
    seal_of(KEPT).write_text(f"{digest(text.encode())}\n", "ascii")
    return kept


def seal_of(file: Path) -> Path:
    """Where the checksum of a file is."""
    return Path(f"{file}.sha256")


def digest(data: bytes) -> str:
    """SHA-256."""
    return hashlib.sha256(data).hexdigest()


def found(text: str) -> dict[str, Any]:
    """What `make bench` found, from its lines: of each benchmark the last.

    Raises:
        ValueError: there are none.
    """
    lines = [json.loads(line) for line in text.splitlines()]
    if not lines:
        raise ValueError("no benchmark has written a record")
    records = {_identity(line["record"]): line["record"] for line in lines}
    return {"measured": lines[-1]["measured"], "records": [*records.values()]}


def joined(before: dict[str, Any], now: dict[str, Any]) -> dict[str, Any]:
    """Benchmarks that were not run again stay, if they were measured with the same."""
    then, measured = before["measured"], now["measured"]
    names = ("machine", "python", "direct_solver")
    old_ones, new_ones = _versions(then["packages"]), _versions(measured["packages"])
    if any(then[name] != measured[name] for name in names) or any(
        old_ones[name] != new_ones[name] for name in old_ones.keys() & new_ones.keys()
    ):
        return now
    anew = {_identity(record) for record in now["records"]}
    old = [record for record in before["records"] if _identity(record) not in anew]
    first = then["date"].partition(" to ")[0]
    date = f"{first} to {measured['date']}" if old else measured["date"]
    return {"measured": measured | {"date": date}, "records": [*old, *now["records"]]}


def _identity(record: dict[str, Any]) -> tuple[Any, ...]:
    return record["kind"], record["what"], record.get("triangles"), str(record.get("options") or "")


def _versions(packages: str) -> dict[str, str]:
    """By name, from ``name version, name version``."""
    return dict(package.rsplit(" ", 1) for package in packages.split(", "))
