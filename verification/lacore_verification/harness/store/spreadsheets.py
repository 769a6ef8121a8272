"""Tables for spreadsheets: text stays text, whatever its first character.

A cell ``=HYPERLINK(1)`` is a formula to a spreadsheet, and runs when the file is opened. Such text
gets a leading apostrophe, which marks it as text; numbers stay numbers.
"""

from typing import Any

import pandas as pd

_MARK = "'"
_FORMULA = ("=", "@", "\t", "\r", "\n", "＝", "＠", "＋", "－")  # noqa: RUF001  # wide ones count
_SIGNS = ("+", "-")


def is_formula(text: str) -> bool:
    """Return whether a spreadsheet would treat text as a formula; False for signed numbers."""
    if text.startswith(_FORMULA):
        return True
    if not text.startswith(_SIGNS) or len(text) == 1:
        return False
    try:
        float(text)
    except ValueError:
        return True
    return False


def as_text(cell: Any) -> Any:
    """Return a cell that no spreadsheet executes; only text is changed.

    Carriage returns become line feeds: writers of CSV quote only those, and a row would end there.
    """
    if not isinstance(cell, str):
        return cell
    text = cell.replace("\r\n", "\n").replace("\r", "\n") if "\r" in cell else cell
    return _MARK + text if is_formula(text.lstrip(_MARK)) else text


def as_written(cell: Any) -> Any:
    """Return the inverse of `as_text`, except for carriage returns."""
    if isinstance(cell, str) and cell.startswith(_MARK) and is_formula(cell.lstrip(_MARK)):
        return cell[len(_MARK) :]
    return cell


def quoted(frame: pd.DataFrame) -> pd.DataFrame:
    """Return a table whose texts, including column names, are text to spreadsheets."""
    return _each(frame, as_text)


def unquoted(frame: pd.DataFrame) -> pd.DataFrame:
    """Return the inverse of `quoted`."""
    return _each(frame, as_written)


def _each(frame: pd.DataFrame, change: Any) -> pd.DataFrame:
    plain = (pd.api.types.is_numeric_dtype, pd.api.types.is_datetime64_any_dtype)
    texts = [n for n, kind in enumerate(frame.dtypes) if not any(own(kind) for own in plain)]
    changed = frame.copy()
    for number in texts:
        own = frame.iloc[:, number]
        before = own.tolist()
        after = [change(cell) for cell in before]
        if any(new is not old for new, old in zip(after, before, strict=True)):
            changed.isetitem(number, pd.Series(after).astype(own.dtype).array)
    changed.columns = [change(name) for name in frame.columns]
    return changed
