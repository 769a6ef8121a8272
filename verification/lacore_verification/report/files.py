"""Report as files: pages, shared pictures, tables as Markdown and CSV."""

import csv
import io
import re
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain, count
from pathlib import Path, PurePosixPath

from lacore.reporting.errors import InputError
from lacore_verification.harness.store.manifest import replace_files
from lacore_verification.harness.store.spreadsheets import as_text
from lacore_verification.report.blocks import (
    Block,
    Cards,
    Columns,
    Details,
    Gallery,
    Heading,
    Page,
    Picture,
    Report,
    Table,
)
from lacore_verification.report.document import Place, render

INDEX = "index.html"
"""Page that is opened first."""
_CASES = "cases"
_SPECIAL = re.compile(r"([\\`*_\[\]<>|~$])")  # characters with a meaning in Markdown inside a line
_LONGEST = 80  # letters of the name of a file


def write(report: Report, folder: Path) -> Path:
    """Write the pages, ``pictures/*.png``, ``tables/*.csv``, ``tables/*.md`` and other files.

    Other files of an earlier report are removed.

    Returns:
        the path of the page that is opened first.

    Raises:
        InputError: the folder cannot be written.
    """
    try:
        replace_files(folder, contents(report))
    except OSError as error:
        raise InputError(
            "--out", str(folder), f"cannot write there ({error.strerror})", "name a folder"
        ) from error
    return folder / INDEX


def contents(report: Report) -> dict[str, bytes]:
    """Return the contents of the files of a report, by their paths in its folder."""
    found = {_picture_file(name): picture.data for name, picture in pictures(report).items()}
    texts = dict(report.data)
    for name, table in tables(report):
        texts[_table_file(name)] = spreadsheet(table)
        texts[f"tables/{name}.md"] = markdown(table)
    texts |= rendered(report)
    # A path may have bytes that are not valid text.
    return found | {file: text.encode(errors="replace") for file, text in texts.items()}


def rendered(report: Report) -> dict[str, str]:
    """Return the pages as text, by file."""
    ids = {file: list(_ids(page)) for file, page in report.pages.items()}
    shared = {name: file for file, names in reversed(ids.items()) for name in names}
    files = {picture.name: _picture_file(name) for name, picture in pictures(report).items()}
    sheets = {id(table): _table_file(name) for name, table in tables(report)}
    return {
        file: render(page, Place(file, shared | dict.fromkeys(ids[file], file), files, sheets))
        for file, page in report.pages.items()
    }


def _ids(page: Page) -> Iterator[str]:
    """Yield the ids of a page for links."""
    yield from (section.id for section in page.sections)
    for _, block in _blocks(page):
        if isinstance(block, Table) and block.anchor:
            yield from filter(None, map(block.anchor.of, block.records))


def pictures(report: Report) -> dict[str, Picture]:
    """Return all pictures, each once, by the name of their file."""
    found: dict[str, Picture] = {}
    for page in report.pages.values():
        for _, block in _blocks(page):
            for item in _pictures_in(block):
                found.setdefault(item.name, item)
    return dict(zip(file_names(found), found.values(), strict=True))


def _pictures_in(block: Block) -> Iterator[Picture]:
    if isinstance(block, Picture):
        yield block
    elif isinstance(block, Gallery):
        yield from (item for item in block.items if isinstance(item, Picture))
    elif isinstance(block, Cards):
        yield from (card.picture for card in block.items if card.picture is not None)


def _picture_file(name: str) -> str:
    return f"pictures/{name}.png"


def _table_file(name: str) -> str:
    return f"tables/{name}.csv"


def tables(report: Report) -> Iterator[tuple[str, Table]]:
    """Yield the tables with rows, named by the page of their case, section and heading."""
    found = [
        (f"{_prefix(file)}{title} {block.caption}", block)
        for file, page in report.pages.items()
        for title, block in _blocks(page)
        if isinstance(block, Table) and len(block.data)
    ]
    yield from zip(file_names(title for title, _ in found), (t for _, t in found), strict=True)


def _prefix(file: str) -> str:
    path = PurePosixPath(file)
    return f"case-{path.stem}-" if path.parent.name == _CASES else ""


def case_files(names: Iterable[str]) -> dict[str, str]:
    """Return the files of the pages of cases, by their ids."""
    ids = list(names)
    return {own: f"{_CASES}/{file}.html" for own, file in zip(ids, file_names(ids), strict=True)}


def file_names(texts: Iterable[str]) -> Iterator[str]:
    """Yield texts in lower case, joined by ``-``; equal ones are numbered."""
    taken: set[str] = set()
    for text in texts:
        name = "-".join(re.findall("[a-z0-9]+", text.lower()))[:_LONGEST].strip("-") or "unnamed"
        numbered = chain([name], (f"{name}-{number}" for number in count(2)))
        free = next(one for one in numbered if one not in taken)
        taken.add(free)
        yield free


def spreadsheet(table: Table) -> str:
    """Return a table as CSV, with all digits."""
    # `DataFrame.to_csv` takes ten times as long for the many small tables of a report.
    buffer = io.StringIO()
    rows = [[column.head for column in table.columns], *table.values]
    csv.writer(buffer, lineterminator="\n").writerows([*map(as_text, row)] for row in rows)
    return buffer.getvalue()


def markdown(table: Table) -> str:
    """Return a table as Markdown, with numbers as on the page."""
    head, *rows = (
        "| " + " | ".join(map(_cell, line)) + " |\n"
        for line in ([column.head for column in table.columns], *table.texts)
    )
    marks = ["--:" if column.numeric else "---" for column in table.columns]
    return "".join([head, "| " + " | ".join(marks) + " |\n", *rows])


def _cell(text: object) -> str:
    """Return text that neither ends a cell nor contains markup."""
    line = " ".join(str(text).replace("&", "&amp;").split())
    return _SPECIAL.sub(r"\\\1", line)


def _blocks(page: Page) -> Iterator[tuple[str, Block]]:
    yield from _inside("summary", page.summary)
    for section in page.sections:
        yield from _inside(section.id, section.blocks)


def _inside(section: str, blocks: Sequence[Block]) -> Iterator[tuple[str, Block]]:
    """Yield all blocks with the id of their section and the last heading."""
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
