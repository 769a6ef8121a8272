"""Columns of tables on pages and on the terminal: heads, formats, links, order and widths."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import isfinite, isnan
from typing import Any, SupportsFloat, TypeGuard

import pandas as pd


def slug(name: object) -> str:
    """Return a name as part of an id: letters, digits and ``-``, others by their code."""
    return re.sub(r"[^A-Za-z0-9-]", lambda m: f"-{ord(m[0]):x}-", str(name))


@dataclass(frozen=True)
class Anchor:
    """Target of links: one for each value of a column.

    Attributes:
        prefix: its kind, such as ``certificate``; one table of a page has it.
        column: column with unique values in that table, such as ``run``.
    """

    prefix: str
    column: str

    def of(self, record: Mapping[str, Any]) -> str:
        """Return the id for a row; empty without a value."""
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
        width: Characters of a cell on the terminal.
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
    width: int = 0

    def but(self, **changes: Any) -> "Column":
        """Return the same column with other attributes."""
        return replace(self, **changes)

    @property
    def head(self) -> str:
        """Heading of the column."""
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
        """Return the text of a cell; empty without a value."""
        return self.text(record[self.name])

    def text(self, value: Any) -> str:
        """The text of a value; empty where there is none."""
        if is_missing(value):
            return ""
        if not self.numeric or isinstance(value, str):
            return str(value)
        number = float(value)
        return format(self.scale * number, self.form) if isfinite(number) else str(number)

    def key(self, record: Mapping[str, Any]) -> str:
        """Return the sort key of a cell; empty ones are always last."""
        value = record[self.order or self.name]
        if is_missing(value):
            return ""
        return repr(float(value)) if _is_number(value) and self.sorts_by_number else str(value)


def _is_number(value: object) -> TypeGuard[SupportsFloat]:
    return hasattr(value, "__float__")  # as `SupportsFloat`, which takes ten times as long


def is_missing(value: object) -> bool:
    """Return whether a value is missing."""
    return (
        value is None or value is pd.NA or value is pd.NaT or (_is_number(value) and isnan(value))
    )


RUN = Anchor("run", "run")
"""Row of a run."""
CERTIFICATE = Anchor("certificate", "certificate")
"""Certificate of a run."""
VERDICTS: Mapping[str, str] = {"pass": "good", "FAIL": "bad"}
"""Colours of verdicts; all others are mild."""
_SHARED = (
    Column("verdict", moods=VERDICTS),
    Column("why", "reason", long=True),
    Column("load_factor", "load factor", ".7f"),
    Column("expected", "reference", "g", order="reference"),
    Column("error", "error %", "+.4f", scale=100),
    Column("path_error", "largest error %", ".4f", scale=100),
    Column("width", "width %", ".2f", scale=100),
    Column("gap", form=".1e"),
    Column("n_elements", "elements", ".0f"),
    Column("outer_iterations", "inner solves", ".0f"),
    Column("iterations", form=".0f"),
    Column("build_time", "build time, s", ".2f"),
    Column("solve_time", "solve time, s", ".2f"),
    Column("runs", form=".0f"),
    Column("success_rate", "claimed %", ".1f", scale=100),
    Column("certified_rate", "certified %", ".1f", scale=100),
    Column("correctness_rate", "correct %", ".1f", scale=100),
    Column("wrong_claims", "wrong claims", ".0f"),
    Column("mean_time", "mean time, s", ".3g"),
    Column("worst_error", "largest error %", ".3g", scale=100),
    Column("order", form="+.2f"),
    Column("order_low", "from", "+.2f"),
    Column("order_high", "to", "+.2f"),
    Column("slope", form="+.3f"),
    Column("start", "valid from", ".2g"),
    Column("stop", "to", ".2g"),
    Column("floor", form=".1e"),
    Column("reason", long=True),
    Column("solved", "certified", ".0f"),
    Column("median", "inner solves, median", "g"),
    Column("most", "inner solves, maximum", "g"),
    Column("failed", "FAIL", ".0f"),
)
_BY_NAME: Mapping[str, Column] = {column.name: column for column in _SHARED}


def column(name: str, **changes: Any) -> Column:
    """Return the column that several tables share, or one of text, with other attributes."""
    return _BY_NAME.get(name, Column(name)).but(**changes)


def columns(*names: str | Column) -> tuple[Column, ...]:
    """Return columns, those that are given by name as of `column`."""
    return tuple(column(own) if isinstance(own, str) else own for own in names)


def line(shown: Sequence[Column], cells: Iterable[Any]) -> str:
    """Return a row of a table on the terminal: numbers are aligned to the right."""
    texts = zip(shown, cells, strict=True)
    return " ".join(
        f"{own.text(cell):{'>' if own.numeric else '<'}{own.width}}" for own, cell in texts
    )


def heads(shown: Sequence[Column]) -> str:
    """Return the heads of a table on the terminal."""
    return line(shown, [own.head for own in shown])
