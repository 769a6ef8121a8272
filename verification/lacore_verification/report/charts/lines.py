"""Names of lines in a chart: the backend, and other properties that distinguish them."""

from collections.abc import Sequence

import pandas as pd

LINE = "line"
"""Column that `with_lines` adds."""
_PLAIN = ("backend", "coupling", "mesh")
_PREFIXES = ("option_", "setting_", "size_", "param_")


def with_lines(frame: pd.DataFrame, columns: Sequence[str], among: pd.DataFrame) -> pd.DataFrame:
    """Return a frame with a column ``line``: the shortest distinct names made of `columns`.

    Args:
        frame: table with these columns.
        columns: columns with one value per line; the first is always part of the name.
        among: rows to distinguish; columns with a single value are not part of the name.
    """
    first, *others = columns
    varied = [name for name in others if among[name].nunique(dropna=False) > 1]
    names = [
        ", ".join([str(row[first]), *(word for name in varied if (word := _word(name, row[name])))])
        for row in frame.to_dict("records")
    ]
    return frame.assign(**{LINE: names})


def _word(column: str, value: object) -> str:
    """Return a part of a name: ``certified``, ``r=0.001``; empty without a value."""
    if pd.isna(value):  # type: ignore[call-overload]
        return ""
    shown = f"{value:.3g}" if isinstance(value, float) else str(value)
    if column in _PLAIN:
        return shown
    for prefix in _PREFIXES:
        column = column.removeprefix(prefix)
    return f"{column}={shown}"
