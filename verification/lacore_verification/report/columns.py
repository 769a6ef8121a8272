"""Columns of tables: what their cells show, link to and are ordered by."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from math import isfinite, isnan
from typing import Any, SupportsFloat, TypeGuard

import pandas as pd


def slug(name: object) -> str:
    """A name as part of an id: letters, digits and ``-``, others by their code."""
    return re.sub(r"[^A-Za-z0-9-]", lambda m: f"-{ord(m[0]):x}-", str(name))


@dataclass(frozen=True)
class Anchor:
    """A place to link to: one for each value of a column.

    Attributes:
        prefix: what is there, such as ``certificate``; on one page one table has it.
        column: whose values are unique in that table, such as ``run``.
    """

    prefix: str
    column: str

    def of(self, record: Mapping[str, Any]) -> str:
        """The id for a row; empty where it has no value to make one of."""
        value = record[self.column]
        return "" if is_missing(value) else f"{self.prefix}-{slug(value)}"


@dataclass(frozen=True)
class Column:
    """A column of a table.

    Attributes:
        name: of the DataFrame.
        title: head of the column; empty: the name.
        form: format of numbers, such as ``.4f``; empty: a column of text.
        scale: factor on numbers, 100 for per cent.
        link: where its cells link to.
        long: whether lines break in it.
        moods: ``good``, ``bad`` or ``mild`` for values that have a colour.
        hover: another column whose text is seen under the pointer.
        order: another column to sort by, such as the number of elements for the name of a mesh.
        file: whether its cells are paths of files in the folder of the report, and link to them.
    """

    name: str
    title: str = ""
    form: str = ""
    scale: float = 1.0
    link: Anchor | None = None
    long: bool = False
    moods: Mapping[str, str] = field(default_factory=dict)
    hover: str = ""
    order: str = ""
    file: bool = False

    @property
    def head(self) -> str:
        """What stands above the column."""
        return self.title or self.name.replace("_", " ")

    @property
    def numeric(self) -> bool:
        """Whether cells are numbers, to the right."""
        return bool(self.form)

    @property
    def sorts_by_number(self) -> bool:
        """Whether rows are ordered by number."""
        return self.numeric or bool(self.order)

    def shown(self, record: Mapping[str, Any]) -> str:
        """The text of a cell; empty where there is no value."""
        value = record[self.name]
        if is_missing(value):
            return ""
        if not self.numeric or isinstance(value, str):
            return str(value)
        number = float(value)
        return format(self.scale * number, self.form) if isfinite(number) else str(number)

    def key(self, record: Mapping[str, Any]) -> str:
        """What a cell is ordered by; empty ones are always last."""
        value = record[self.order or self.name]
        if is_missing(value):
            return ""
        return repr(float(value)) if _is_number(value) and self.sorts_by_number else str(value)


def _is_number(value: object) -> TypeGuard[SupportsFloat]:
    return hasattr(value, "__float__")  # as of `SupportsFloat`, which takes ten times as long


def is_missing(value: object) -> bool:
    """Whether there is no value."""
    return (
        value is None or value is pd.NA or value is pd.NaT or (_is_number(value) and isnan(value))
    )
