"""Columns of results that identify a run or contain numbers."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np
import pandas as pd

import lacore as la
from lacore.numerics.arrays import Bools, Floats
from lacore.reporting.errors import InputError, suggest

PROBLEM = ("case", "variant", "mesh")
"""Columns that identify a problem, with all of ``param_*`` and ``size_*``."""
SOLVER = ("backend", "coupling")
"""Columns that identify a solver, with all of ``setting_*`` and ``option_*``."""
SOLVED = la.Status.SOLVED.label


def require_columns(frame: pd.DataFrame, names: Iterable[str]) -> None:
    """Raise `InputError` unless all these columns are there."""
    for name in names:
        if name not in frame.columns:
            raise InputError("column", name, "not in the results", suggest(name, frame.columns))


def with_prefix(frame: pd.DataFrame, *prefixes: str) -> list[str]:
    """Return the columns with these prefixes, in their order."""
    return [str(name) for name in frame.columns if str(name).startswith(prefixes)]


def problem_columns(frame: pd.DataFrame) -> list[str]:
    """Return all columns that distinguish problems."""
    return [*PROBLEM, *with_prefix(frame, "param_", "size_")]


def solver_columns(frame: pd.DataFrame) -> list[str]:
    """Return all columns that distinguish solvers."""
    return [*SOLVER, *with_prefix(frame, "setting_", "option_")]


def numbers(frame: pd.DataFrame, name: str) -> Floats:
    """Return a column as floats, with NaN for missing values.

    Raises:
        InputError: there is no such column, or it has no numbers.
    """
    require_columns(frame, [name])
    try:
        values = pd.to_numeric(frame[name])
    except (ValueError, TypeError):
        raise InputError("column", name, "does not hold numbers", "name one that does") from None
    return np.array(values.to_numpy(dtype=float, na_value=np.nan))


def truths(frame: pd.DataFrame, name: str) -> Bools:
    """Return where a column is true; all other values count as false.

    Raises:
        InputError: there is no such column.
    """
    require_columns(frame, [name])
    told = [isinstance(v, bool | np.bool_ | int | float) and v == 1 for v in frame[name]]
    return np.array(told, dtype=bool)


def says(frame: pd.DataFrame, name: str, *words: str) -> Bools:
    """Return where a column has one of the given values.

    Raises:
        InputError: there is no such column.
    """
    require_columns(frame, [name])
    return np.array(frame[name].isin(words), dtype=bool)


def answered_itself(frame: pd.DataFrame) -> Bools:
    """Return where the result is from the backend alone, as are all older results.

    Raises:
        InputError: There is no column `backend`.
    """
    require_columns(frame, ["backend"])
    if "answered_by" not in frame.columns:
        return np.ones(len(frame), dtype=bool)
    answered, backend = frame["answered_by"].fillna(""), frame["backend"]
    return np.array((answered == "") | (answered == backend), dtype=bool)


def groups(frame: pd.DataFrame, by: Sequence[str]) -> Iterator[tuple[dict[str, Any], pd.DataFrame]]:
    """Yield parts with equal values in some columns, in order of appearance.

    Missing ones are equal.

    Raises:
        InputError: there is no such column.
    """
    require_columns(frame, by)
    if not by:
        yield {}, frame
        return
    for key, part in frame.groupby(list(by), sort=False, dropna=False):
        yield dict(zip(by, key, strict=True)), part


def table(rows: Sequence[dict[str, Any]], columns: Sequence[str]) -> pd.DataFrame:
    """Return rows as a frame that has all its columns even without a row."""
    return pd.DataFrame(rows, columns=list(dict.fromkeys(columns)))
