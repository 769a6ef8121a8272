"""Results as a typed table, one row for each finished run, and its exports."""

from collections.abc import Iterable, Mapping
from math import inf
from pathlib import Path
from typing import Any

import pandas as pd

from lacore.reporting.errors import InputError, require_known
from lacore_verification.case import Variant
from lacore_verification.catalogue.catalogue import Catalogue
from lacore_verification.harness.store.manifest import whole_file
from lacore_verification.harness.store.spreadsheets import quoted
from lacore_verification.harness.store.store import Entry, entries, file_of
from lacore_verification.runs.outcome import Outcome
from lacore_verification.runs.row import TYPES
from lacore_verification.runs.run import Run, canonical

FORMATS = ("csv", "parquet")
RESULTS = "results.csv"
"""Table of all runs in the folder of a comparison."""


def load_results(place: Path | str) -> pd.DataFrame:
    """Return the finished runs of a store, the newest of each, in the order in which they ended.

    Columns: those of `lacore_verification.runs.row.Row` (lambda of T19 as ``lambda``);
    ``residual_*`` of the certificate; ``param_*`` of the case, ``size_*`` of the mesh,
    ``setting_*`` of the loop, ``option_*`` of the backend, as far as a run sets them; ``run``, its
    key; ``session``, the number of its provenance; ``finished``, UTC. Missing numbers are NaN;
    missing counts and other missing values are NA.

    Args:
        place: folder of a comparison, verification or sweep, or the file of its store.

    Raises:
        InputError: there is no store, it is damaged, or of a newer lacore.
    """
    return as_table(entry.record() for entry in entries(file_of(Path(place))))


def load_outcomes(place: Path | str, known: Catalogue) -> tuple[list[Outcome], list[Entry]]:
    """Return the finished runs of a store with their cases; and those of unknown cases.

    The first are in the order of the catalogue, its variants and meshes, then by their settings.

    Raises:
        InputError: as `load_results`.
    """
    found, strange = [], []
    for entry in entries(file_of(Path(place))):
        if _fits(entry, known):
            found.append(entry.outcome(_run(entry, known)))
        else:
            strange.append(entry)
    order = {case_id: number for number, case_id in enumerate(known)}
    return sorted(found, key=lambda outcome: _place(outcome.run, order)), strange


def _place(run: Run, order: Mapping[str, int]) -> tuple[Any, ...]:
    """Return the sort key of a run.

    Names have the order of the case, numbers that of their size.
    """
    meshes = [*run.case.meshes]
    variants = [variant.name for variant in run.case.variants]
    own = variants.index(run.variant.name) if run.variant.name in variants else len(variants)
    settings = (run.parameters, run.size, run.settings, run.options)
    place = (order[run.case.id], own, meshes.index(run.mesh), run.backend, run.coupling or "")
    return (*place, *([_sortable(item) for item in each.items()] for each in settings))


def _sortable(item: tuple[str, Any]) -> tuple[str, float, str]:
    """Return a name and its value, so that any two can be compared."""
    name, value = item
    number = isinstance(value, int | float)
    return (name, float(value) if number else inf, "" if number else str(value))


def _fits(entry: Entry, known: Catalogue) -> bool:
    identity = entry.identity
    return identity["case"] in known and identity["mesh"] in known[identity["case"]].meshes


def _run(entry: Entry, known: Catalogue) -> Run:
    identity = entry.identity
    case = known[identity["case"]]
    asked = Variant(identity["variant"], identity["parameters"])
    own = (one for one in case.variants if _equal(one, asked))
    return Run(
        case=case,
        variant=next(own, asked),
        mesh=identity["mesh"],
        backend=identity["backend"],
        coupling=identity["coupling"],
        size=identity["size"],
        settings=identity["settings"],
        options=identity["options"],
    )


def _equal(one: Variant, other: Variant) -> bool:
    parameters = canonical(dict(one.parameters)), canonical(dict(other.parameters))
    return one.name == other.name and parameters[0] == parameters[1]


def as_table(records: Iterable[Mapping[str, Any]]) -> pd.DataFrame:
    """Return typed columns of records from `Outcome.record` or a store."""
    rows = list(records)
    frame = pd.DataFrame(rows, columns=None if rows else list(TYPES)).astype(TYPES)
    if "finished" in frame:
        frame["finished"] = pd.to_datetime(frame["finished"], format="ISO8601", utc=True)
    mixed = [str(name) for name in frame if frame[name].dtype == object]
    return frame.assign(**{name: frame[name].convert_dtypes() for name in mixed})


def export(frame: pd.DataFrame, path: Path) -> None:
    """Write a table as CSV, with text as text for spreadsheets, or as Parquet, by the suffix.

    A process that is killed meanwhile leaves the file unchanged.

    Raises:
        InputError: another suffix, a missing package, or the file cannot be written.
    """
    kind = path.suffix.removeprefix(".")
    require_known("ending of the file", kind, FORMATS)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with whole_file(path) as unfinished:
            if kind == "csv":
                quoted(frame).to_csv(unfinished, index=False)
            else:
                frame.to_parquet(unfinished, index=False)
    except ImportError as error:
        raise InputError(
            "export", str(path), "Parquet needs pyarrow", "pip install pyarrow"
        ) from error
    except OSError as error:
        raise InputError(
            "export", str(path), f"cannot be written ({error.strerror})", "name another file"
        ) from error
