"""What a line of a chart is called: the backend, and whatever else tells the lines apart."""

from collections.abc import Sequence

import pandas as pd

LINE = "line"
"""Column that `with_lines` adds."""
_PLAIN = ("backend", "coupling", "mesh")
_PREFIXES = ("option_", "setting_", "size_", "param_")


def with_lines(frame: pd.DataFrame, columns: Sequence[str], among: pd.DataFrame) -> pd.DataFrame:
    """A frame with a column ``line``: names made of `columns`, as short as tells them apart.

    Args:
        frame: has these columns.
        columns: what a line is one value of each of; the first is always named.
        among: the rows to tell apart; columns with one value in all of them are not named.
    """
    first, *others = columns
    varied = [name for name in others if among[name].nunique(dropna=False) > 1]
    names = [
        ", ".join([str(row[first]), *(word for name in varied if (word := _word(name, row[name])))])
        for row in frame.to_dict("records")
    ]
    return frame.assign(**{LINE: names})


def _word(column: str, value: object) -> str:
    """``certified``, ``r=0.001``; empty where there is no value."""
    if pd.isna(value):  # type: ignore[call-overload]
        return ""
    shown = f"{value:.3g}" if isinstance(value, float) else str(value)
    if column in _PLAIN:
        return shown
    for prefix in _PREFIXES:
        column = column.removeprefix(prefix)
    return f"{column}={shown}"
