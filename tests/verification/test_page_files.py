"""A page as files: pictures, tables as CSV and Markdown, in the folder and nowhere else."""

from dataclasses import replace
from html import unescape

import pandas as pd
import pytest
from markdown_it import MarkdownIt  # comes with rich

from tests.verification.test_page import HOSTILE, TABLE, fitted
from verification.report import files
from verification.report.blocks import Column, Document, Drawing, Gallery, Section, Table
from verification.report.files import markdown, pictures


def test_table_as_markdown():
    assert markdown(TABLE) == (
        "| name | value % | verdict |\n| --- | --: | --- |\n"
        "| b | 200.0 | pass |\n| a10 |  | FAIL |\n| a9 | inf | skipped |\n"
    )


@pytest.mark.parametrize("name", [*HOSTILE, "**bold** `code` ~x~ [a](b) <b> | end"])
def test_any_name_is_text_in_a_table(name):
    """Read again by a parser of Markdown, the cell says the name."""
    table = Table([Column("name")], pd.DataFrame({"name": [name]}))
    read = MarkdownIt().enable("table").render(markdown(table))
    (cell,) = [line for line in read.splitlines() if line.startswith("<td>")]
    shown = unescape(cell.removeprefix("<td>").removesuffix("</td>"))
    assert shown == " ".join(name.split()).replace("\x00", "\ufffd")


@pytest.mark.parametrize("name", ["../../etc/x", ".hidden", "a/b", "a\\b", "W" * 400, "ü:*?"])
def test_files_stay_in_their_folder(name, tmp_path):
    drawing = Drawing(name, name, fitted())
    sections = [Section("one", name, [Gallery([drawing]), replace(TABLE, caption=name)])]
    files.write(Document(name, name, sections), tmp_path / "out")
    written = sorted(path.relative_to(tmp_path) for path in tmp_path.rglob("*") if path.is_file())
    assert [path.parts[:2] for path in written] == [
        ("out", "index.html"),
        ("out", "pictures"),
        ("out", "tables"),
        ("out", "tables"),
    ]
    assert not any(path.name.startswith(".") for path in written)


def test_a_chart_that_stands_alone_is_a_file_too(tmp_path):
    page = Document("", "", [Section("one", "", [Drawing("alone", "", fitted())])])
    files.write(page, tmp_path)
    assert (tmp_path / "pictures" / "alone.png").read_bytes().startswith(b"\x89PNG")


def test_each_picture_has_a_file_of_its_own():
    names = ["a b", "a/b", "a-b-2", "a b", "漢", "字", "W" * 400, "W" * 401]
    section = Section("one", "", [Gallery([Drawing(name, "", fitted()) for name in names])])
    written = [name for name, _ in pictures(Document("", "", [section]))]
    assert len(set(written)) == len(names)
    assert written[:4] == ["a-b", "a-b-2", "a-b-2-2", "a-b-3"]
