"""Blocks of reports as MyST, the text of the sources of the site."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import singledispatchmethod
from itertools import count

from lacore_verification.report.blocks import (
    Block,
    Columns,
    Details,
    Drawing,
    Facts,
    Gallery,
    Heading,
    Picture,
    Preformatted,
    Table,
    Text,
)
from lacore_verification.report.charts.svg import inline
from lacore_verification.report.columns import Column
from lacore_verification.report.files import markdown

_SPECIAL = re.compile(r"([\\*_\[\]<>|~$#{}])")


def escaped(text: str) -> str:
    """Plain text; what stands between backticks is code."""
    parts = text.split("`")
    if len(parts) % 2 == 0:
        return _SPECIAL.sub(r"\\\1", text.replace("`", "\\`"))
    return "`".join(p if n % 2 else _SPECIAL.sub(r"\\\1", p) for n, p in enumerate(parts))


@dataclass(frozen=True)
class Writer:
    """Writes the blocks of one page.

    Attributes:
        pictures: where their files are, seen from the page, by their names.
    """

    pictures: Mapping[str, str]
    _numbers: "count[int]" = field(default_factory=lambda: count(1))

    def page(self, blocks: Iterable[Block]) -> str:
        """Blocks, one below the other."""
        return "\n\n".join(self.block(one) for one in blocks)

    @singledispatchmethod
    def block(self, block: object) -> str:
        """One block."""
        raise TypeError(f"pages have no {type(block).__name__}")

    @block.register
    def _(self, block: Text) -> str:
        lead = f"**{escaped(block.lead)}**\\\n" if block.lead else ""
        return lead + escaped(block.text)

    @block.register
    def _(self, block: Heading) -> str:
        return f"### {escaped(block.text)}"

    @block.register
    def _(self, block: Preformatted) -> str:
        return f"```text\n{block.text.rstrip()}\n```"

    @block.register
    def _(self, block: Table) -> str:
        caption = f"**{escaped(block.caption)}**\n\n" if block.caption else ""
        if not len(block.data):
            return f"{caption}None."
        short = replace(block, columns=[own for own in block.columns if not own.long])
        folds = [_below(block, own) for own in block.columns if own.long]
        return "\n\n".join([caption + markdown(short).rstrip(), *folds])

    @block.register
    def _(self, block: Facts) -> str:
        return "\n".join(f"{escaped(n)}\n: {escaped(t)}\n" for n, t in block.items.items())

    @block.register
    def _(self, block: Picture) -> str:
        text = escaped(block.caption)
        return f":::{{figure}} {self.pictures[block.name]}\n:alt: {text}\n\n{text}\n:::"

    @block.register
    def _(self, block: Drawing) -> str:
        chart = inline(block.chart, f"chart-{next(self._numbers)}")
        note = f"\n\n{escaped(block.note)}" if block.note else ""
        title = f"<figcaption>{_plain(block.caption)}</figcaption>"
        return f'```{{raw}} html\n<figure class="chart">{title}{chart}</figure>\n```{note}'

    @block.register
    def _(self, block: Gallery) -> str:
        return self.page(block.items)

    @block.register
    def _(self, block: Columns) -> str:
        return self.page([*block.left, *block.right])

    @block.register
    def _(self, block: Details) -> str:
        return f"::::::{{dropdown}} {block.title}\n{self.page(block.blocks)}\n::::::"


_NAMING = 2
"""Columns, the first of a table, that tell its rows apart in the fold below it."""


def _below(table: Table, column: Column) -> str:
    """A column of sentences, folded: a line a row, after what the row is called by."""
    rows = table.plain
    named = [own.head for own in table.columns if not own.long][:_NAMING]
    lines = [
        f"- {escaped(', '.join(row[named]))}: {escaped(row[column.head])}"
        for _, row in rows.iterrows()
        if row[column.head]
    ]
    return "\n".join([f":::::{{dropdown}} {column.head}", *lines, ":::::"])


def _plain(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;")
