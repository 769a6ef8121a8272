"""Columns of the results that the analysis stands on: which name a run, which hold numbers."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np
import pandas as pd

import lacore as la
from lacore.numerics.arrays import Bools, Floats
from lacore.reporting.errors import InputError, suggest

PROBLEM = ("case", "variant", "mesh")
"""Columns that name what is solved, with all of ``param_*`` and ``size_*``."""
SOLVER = ("backend", "coupling")
"""Columns that name what solves it, with all of ``setting_*`` and ``option_*``."""
SOLVED = la.Status.SOLVED.label


def require_columns(frame: pd.DataFrame, names: Iterable[str]) -> None:
    """Raise `InputError` unless all these columns are there."""
    for name in names:
        if name not in frame.columns:
            raise InputError("column", name, "not in the results", suggest(name, frame.columns))


def with_prefix(frame: pd.DataFrame, *prefixes: str) -> list[str]:
    """Columns whose names begin so, in their order."""
    return [str(name) for name in frame.columns if str(name).startswith(prefixes)]


def problem_columns(frame: pd.DataFrame) -> list[str]:
    """All columns that tell one problem from another."""
    return [*PROBLEM, *with_prefix(frame, "param_", "size_")]


def solver_columns(frame: pd.DataFrame) -> list[str]:
    """All columns that tell one way of solving from another."""
    return [*SOLVER, *with_prefix(frame, "setting_", "option_")]


def numbers(frame: pd.DataFrame, name: str) -> Floats:
    """A column as floats, NaN where there is none.

    Raises:
        InputError: no such column, or no numbers in it.
    """
    require_columns(frame, [name])
    try:
        values = pd.to_numeric(frame[name])
    except (ValueError, TypeError):
        raise InputError("column", name, "does not hold numbers", "name one that does") from None
    return np.array(values.to_numpy(dtype=float, na_value=np.nan))


def truths(frame: pd.DataFrame, name: str) -> Bools:
    """Where a column says True; nowhere else, whatever stands there.

    Raises:
        InputError: no such column.
    """
    require_columns(frame, [name])
    told = [isinstance(v, bool | np.bool_ | int | float) and v == 1 for v in frame[name]]
    return np.array(told, dtype=bool)


def says(frame: pd.DataFrame, name: str, *words: str) -> Bools:
    """Where a column holds one of some words.

    Raises:
        InputError: no such column.
    """
    require_columns(frame, [name])
    return np.array(frame[name].isin(words), dtype=bool)


def answered_itself(frame: pd.DataFrame) -> Bools:
    """Where the answer is that of the backend alone; so are all answers of older results.

    Raises:
        InputError: There is no column `backend`.
    """
    require_columns(frame, ["backend"])
    if "answered_by" not in frame.columns:
        return np.ones(len(frame), dtype=bool)
    answered, backend = frame["answered_by"].fillna(""), frame["backend"]
    return np.array((answered == "") | (answered == backend), dtype=bool)


def groups(frame: pd.DataFrame, by: Sequence[str]) -> Iterator[tuple[dict[str, Any], pd.DataFrame]]:
    """Parts of equal values in some columns, missing ones count as equal; in order of appearance.

    Raises:
        InputError: no such column.
    """
    require_columns(frame, by)
    if not by:
        yield {}, frame
        return
    for key, part in frame.groupby(list(by), sort=False, dropna=False):
        yield dict(zip(by, key, strict=True)), part


def table(rows: Sequence[dict[str, Any]], columns: Sequence[str]) -> pd.DataFrame:
    """Rows as a frame that has all its columns even without a row."""
    return pd.DataFrame(rows, columns=list(dict.fromkeys(columns)))
