"""Stored results of several versions of lacore or of solvers, each with its provenance."""

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import nan
from pathlib import Path

import pandas as pd

from lacore.reporting.errors import InputError
from lacore_verification.harness.store.provenance import PROVENANCE
from lacore_verification.harness.store.results import RESULTS, as_table, load_results
from lacore_verification.harness.store.spreadsheets import unquoted
from lacore_verification.harness.store.store import NAME, file_of, sessions
from lacore_verification.runs.row import TYPES

FIELD = "RESULTS"
"""Argument of the command, for messages."""
_FIX = "give folders of `lacore compare`, `lacore verify` or `lacore sweep`, or their results.csv"
_ENDINGS = (Path(NAME).suffix, Path(RESULTS).suffix)
_NEEDED = ("case", "variant", "mesh", "backend", "coupling", "verdict", "load_factor", "solve_time")


@dataclass(frozen=True)
class Version:
    """Stored results of one version.

    Attributes:
        name: Shortest name that distinguishes it from the others.
        place: Folder or file, as given.
        results: One row for each run, with the columns of `load_results`, and ``lacore``, the
            version of lacore that computed it; empty if unknown.
        sessions: Machine, date and versions, as text by name, of each session that computed a row;
            none if unknown. A comparison that was resumed has several.
    """

    name: str
    place: str
    results: pd.DataFrame
    sessions: tuple[Mapping[str, str], ...]

    @property
    def provenance(self) -> dict[str, str]:
        """Return the different texts of all sessions by name."""
        names = dict.fromkeys(name for own in self.sessions for name in own)
        return {name: _different(own.get(name, "") for own in self.sessions) for name in names}

    @property
    def packages(self) -> dict[str, str]:
        """Return the versions of lacore, of its dependencies and of the solvers, by package.

        If the sessions had different versions of a package, all of them are listed.
        """
        each = [packages_of(own) for own in self.sessions]
        names = dict.fromkeys(name for own in each for name in own)
        return {name: _different(own.get(name, "") for own in each) for name in names}

    @property
    def lacore(self) -> str:
        """Return the version of lacore, or all of them; empty if unknown."""
        return self.packages.get("lacore", "")

    @property
    def date(self) -> str:
        """Return when the sessions began, the first and the last of them; empty if unknown."""
        dates = sorted({own["date"] for own in self.sessions if own.get("date")})
        return " to ".join(dict.fromkeys([*dates[:1], *dates[-1:]]))


def packages_of(provenance: Mapping[str, str]) -> dict[str, str]:
    """Return the versions of packages in the provenance of a session, by package."""
    parts = provenance.get("packages", "").split(", ")
    pairs = (part.rpartition(" ") for part in parts if " " in part)
    return {name: version for name, _, version in pairs}


def _different(texts: Iterable[str]) -> str:
    return ", ".join(dict.fromkeys(filter(None, texts)))


def load_versions(places: Sequence[Path]) -> list[Version]:
    """Read the results of several versions, in the given order.

    Args:
        places: Folders with results, stores, or files ``results.csv``. The provenance of such a
            file is read from ``provenance.json`` next to it.

    Raises:
        InputError: There are fewer than two, two are the same, or one cannot be read.
    """
    if len(places) < 2:
        given = ", ".join(map(str, places)) or None
        raise InputError(FIELD, given, "a history needs the results of two versions", _FIX)
    files = [_file_of(place) for place in places]
    for number, file in enumerate(files):
        if any(file.samefile(other) for other in files[:number]):
            raise InputError(FIELD, str(places[number]), "is given twice", "omit one of them")
    read = [_read(file) for file in files]
    names = _names(places, files)
    return [
        Version(name, str(place), results, of_rows)
        for name, place, (results, of_rows) in zip(names, places, read, strict=True)
    ]


def _file_of(place: Path) -> Path:
    """Return the file with the results: the store of a folder, or else its table."""
    if not place.exists():
        raise InputError(FIELD, str(place), "there is no such folder or file", _FIX)
    if place.is_file():
        if place.suffix not in _ENDINGS:
            raise InputError(FIELD, str(place), "is not a file with results", _FIX)
        return place
    for file in (file_of(place), place / RESULTS):
        if file.is_file():
            return file
    raise InputError(FIELD, str(place), f"contains no results ({NAME} or {RESULTS})", _FIX)


def _read(file: Path) -> tuple[pd.DataFrame, tuple[Mapping[str, str], ...]]:
    """Return the rows with the version of lacore of each, and the sessions that computed them."""
    if file.suffix == ".csv":
        results, read = _read_table(file), _read_provenance(file.parent / PROVENANCE)
        numbers = pd.Series(0, index=results.index)
        by_number: Mapping[int, Mapping[str, str]] = {0: read} if read else {}
    else:
        results, by_number = load_results(file), sessions(file)
        numbers = results["session"].astype(int) if len(results) else pd.Series(dtype=int)
    if not len(results):
        raise InputError(FIELD, str(file), "contains no finished run", _FIX)
    known = {number: packages_of(own).get("lacore", "") for number, own in by_number.items()}
    named = [known.get(int(number), "") for number in numbers]
    results = results.assign(lacore=pd.Series(named, index=results.index, dtype="string"))
    there = set(numbers)
    return results, tuple(own for number, own in by_number.items() if number in there)


def _read_table(file: Path) -> pd.DataFrame:
    """Read a table as `load_results` returns it."""
    texts = [name for name, kind in TYPES.items() if kind == "string"]
    try:
        found = unquoted(pd.read_csv(file, dtype=dict.fromkeys(texts, "str")))
    except (OSError, ValueError) as error:  # Text that is not UTF-8, and errors of the parser.
        raise InputError(FIELD, str(file), "is not a table in CSV format", _FIX) from error
    missing = [name for name in _NEEDED if name not in found]
    if missing:
        raise InputError(FIELD, str(file), f"has no column {missing[0]!r}", _FIX)
    filled = found.assign(**{name: found[name].fillna("") for name in texts if name in found})
    absent = {name: _nothing(kind) for name, kind in TYPES.items() if name not in found}
    try:
        return as_table(
            {str(name): own for name, own in record.items() if name in TYPES or not pd.isna(own)}
            | absent
            for record in filled.to_dict("records")
        )
    except (ValueError, TypeError) as error:
        text = " ".join(str(error).split())
        raise InputError(FIELD, str(file), f"has an invalid value ({text})", _FIX) from error


def _nothing(kind: str) -> str | float | None:
    """Return the value of a column that older tables do not have."""
    if kind == "string":
        return ""
    return nan if kind == "float64" else None


def _read_provenance(file: Path) -> dict[str, str]:
    """Read the file next to a table; without it, nothing is known."""
    if not file.is_file():
        return {}
    try:
        found = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(FIELD, str(file), "is not a JSON file", "delete or restore it") from error
    if not isinstance(found, dict):
        raise InputError(FIELD, str(file), "is not a JSON object", "delete or restore it")
    return {str(name): str(value) for name, value in found.items()}


def _names(places: Sequence[Path], files: Sequence[Path]) -> list[str]:
    """Return the name of the folder, with as many folders above as distinguish them."""
    parts = [
        (file.parent if file.name in (NAME, RESULTS) else file).resolve().parts for file in files
    ]
    for count in range(1, max(map(len, parts)) + 1):
        names = ["/".join(own[-count:]) for own in parts]
        if len(set(names)) == len(names):
            return names
    return list(map(str, places))  # The store and the table of one folder.
