"""Accuracy within one solve: the runs of a program with several values of an option."""

from collections.abc import Iterator

import numpy as np
import pandas as pd

from verification.analysis.columns import (
    answered_itself,
    groups,
    numbers,
    problem_columns,
    says,
    solver_columns,
    with_prefix,
)
from verification.analysis.sizes import largest_residuals
from verification.verdicts.words import SKIPPED

LEAST = 3
"""Values of an option that make a curve, at least."""
OPTION, VALUE, RESIDUAL = "ladder", "value", "residual"
"""Columns that `ladders` adds."""
_OPTION = "option_"
_MODEL = ("r", "eta", "bulk", "normal", "tangential")
"""Options of penalised backends that change the program, and not the accuracy of its solution."""


def ladders(results: pd.DataFrame) -> pd.DataFrame:
    """Return the runs in which a backend solved a program once, with `LEAST` values of an option.

    Runs whose residuals prove no load factor are included, because the residuals state how
    accurate they are. If several options of a backend vary, the curve follows the one with the
    most values, and the others distinguish curves.

    Args:
        results: One row for each run.

    Returns:
        The rows, with ``ladder``, the name of the option that varies; ``value``, its value as
        text, or ``default``; ``residual``, the largest residual. In the column of that option they
        have no value, so that `solver_columns` distinguish the curves.

    Raises:
        InputError: A column is missing.
    """
    names = [name for name in with_prefix(results, _OPTION) if name[len(_OPTION) :] not in _MODEL]
    found = results.assign(**{RESIDUAL: largest_residuals(results)})
    if not names:
        return _none(found)
    seen = (
        (numbers(found, "outer_iterations") == 1)
        & np.isfinite(numbers(found, RESIDUAL))
        & (numbers(found, "solve_time") > 0)
        & answered_itself(found)
        & ~says(found, "verdict", SKIPPED)
    )
    fixed = [name for name in solver_columns(found) if name not in names]
    by = [*problem_columns(found), *fixed]
    curves = [own for _, part in groups(found[seen], by) for own in _curves(part, names)]
    return pd.concat(curves) if curves else _none(found)


def _none(found: pd.DataFrame) -> pd.DataFrame:
    return found.iloc[:0].assign(**{OPTION: "", VALUE: ""})


def _curves(part: pd.DataFrame, names: list[str]) -> Iterator[pd.DataFrame]:
    """Yield the curves of the runs of one backend on one program."""
    counts = {name: part[name].nunique(dropna=False) for name in names}
    varied = max(names, key=lambda name: counts[name])
    others = [name for name in names if name != varied]
    for _, own in groups(part, others):
        if own[varied].nunique(dropna=False) >= LEAST:
            values = [_text(value) for value in own[varied]]
            option = varied.removeprefix(_OPTION)
            made = own.assign(**{OPTION: option, VALUE: values})
            made[varied] = pd.NA
            yield made


def _text(value: object) -> str:
    if pd.isna(value):  # type: ignore[call-overload]
        return "default"
    return f"{value:g}" if isinstance(value, float) else str(value)
