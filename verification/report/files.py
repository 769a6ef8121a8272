"""A page and its tables as files: HTML, Markdown, CSV, and its pictures."""

import re
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain, count
from pathlib import Path

import pandas as pd

from lacore.errors import InputError
from verification.report import document
from verification.report.blocks import (
    Block,
    Columns,
    Details,
    Document,
    Drawing,
    Gallery,
    Heading,
    Picture,
    Table,
)
from verification.report.figures import png
from verification.spreadsheets import as_text, quoted

_SPECIAL = re.compile(r"([\\`*_\[\]<>|~$])")  # what Markdown makes something of inside a line
_LONGEST = 80  # letters of the name of a file


def write(page: Document, folder: Path) -> Path:
    """Write ``index.html``, ``pictures/*.png``, ``tables/*.csv`` and ``tables/*.md``.

    Returns:
        the path of the page.

    Raises:
        InputError: the folder cannot be written.
    """
    try:
        for place in ("pictures", "tables"):
            (folder / place).mkdir(parents=True, exist_ok=True)
        for name, data in pictures(page):
            (folder / "pictures" / f"{name}.png").write_bytes(data)
        for name, table in tables(page):
            quoted(values(table)).to_csv(folder / "tables" / f"{name}.csv", index=False)
            (folder / "tables" / f"{name}.md").write_text(markdown(table), encoding="utf-8")
    except OSError as error:
        raise InputError(
            "--out", str(folder), f"cannot write there ({error.strerror})", "name a folder"
        ) from error
    return document.write(page, folder / "index.html")


def pictures(page: Document) -> Iterator[tuple[str, bytes]]:
    """Names and bytes of all charts and pictures on a page."""
    items = [
        item
        for _, block in _blocks(page)
        for item in (block.items if isinstance(block, Gallery) else [block])
        if isinstance(item, Drawing | Picture)
    ]
    for name, item in zip(_file_names(item.name for item in items), items, strict=True):
        yield name, item.data if isinstance(item, Picture) else png(item.chart.figure)


def tables(page: Document) -> Iterator[tuple[str, Table]]:
    """Tables of a page that have rows, named by section and what stands above them."""
    found = [(t, b) for t, b in _blocks(page) if isinstance(b, Table) and len(b.data)]
    names = _file_names(f"{title} {table.caption}" for title, table in found)
    yield from zip(names, (table for _, table in found), strict=True)


def _file_names(texts: Iterable[str]) -> Iterator[str]:
    """Words in lower case, joined by ``-``; those that would be alike are numbered."""
    taken: set[str] = set()
    for text in texts:
        name = "-".join(re.findall("[a-z0-9]+", text.lower()))[:_LONGEST].strip("-") or "unnamed"
        numbered = chain([name], (f"{name}-{number}" for number in count(2)))
        free = next(one for one in numbered if one not in taken)
        taken.add(free)
        yield free


def values(table: Table) -> pd.DataFrame:
    """Its columns, numbers in full."""
    shown = [column.name for column in table.columns]
    return table.data[shown].rename(columns={c.name: c.head for c in table.columns})


def markdown(table: Table) -> str:
    """As a table of Markdown, numbers as on the page."""
    plain = table.plain
    head, *rows = (
        "| " + " | ".join(map(_cell, line)) + " |\n"
        for line in (list(plain.columns), *plain.to_numpy().tolist())
    )
    marks = ["--:" if column.numeric else "---" for column in table.columns]
    return "".join([head, "| " + " | ".join(marks) + " |\n", *rows])


def _cell(text: object) -> str:
    """Text that neither ends a cell nor is taken for markup, nor for a formula when pasted."""
    line = " ".join(str(as_text(text)).replace("&", "&amp;").split())
    return _SPECIAL.sub(r"\\\1", line)


def _blocks(page: Document) -> Iterator[tuple[str, Block]]:
    for section in page.sections:
        yield from _inside(section.id, section.blocks)


def _inside(section: str, blocks: Sequence[Block]) -> Iterator[tuple[str, Block]]:
    """All blocks with the id of their section and the heading before them."""
    heading = ""
    for block in blocks:
        if isinstance(block, Heading):
            heading = block.text
        if isinstance(block, Details):
            yield from _inside(f"{section}-{block.title.split(':')[0]}", block.blocks)
        elif isinstance(block, Columns):
            yield from _inside(section, [*block.left, *block.right])
        else:
            yield f"{section}-{heading}".rstrip("-"), block
