"""A page as files: pictures, tables as CSV and Markdown, in the folder and nowhere else."""

from dataclasses import replace
from hashlib import sha256
from html import unescape

import pandas as pd
import pytest
from markdown_it import MarkdownIt  # comes with rich
from matplotlib.figure import Figure

from lacore_verification.harness.store.manifest import MANIFEST
from lacore_verification.report import files
from lacore_verification.report.blocks import (
    Drawing,
    Gallery,
    Page,
    Picture,
    Report,
    Section,
    Table,
)
from lacore_verification.report.charts.figures import png
from lacore_verification.report.columns import Column
from lacore_verification.report.files import case_files, markdown, pictures
from tests.verification.report.test_page import HOSTILE, TABLE, fitted


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
    picture = Picture(name, name, png(Figure((1, 1))))
    sections.append(Section("two", name, [picture]))
    pages = {"index.html": Page(name, name, sections)}
    (file,) = case_files([name]).values()
    files.write(Report(pages | {file: Page(name, name, sections)}), tmp_path / "out")
    written = sorted(path.relative_to(tmp_path) for path in tmp_path.rglob("*") if path.is_file())
    assert [path.parts[1] for path in written] == [
        "cases",
        "index.html",
        "pictures",
        MANIFEST,
        *4 * ["tables"],
    ]
    assert all(path.parts[0] == "out" for path in written)
    assert not any(path.name.startswith(".") for path in written)


def test_pages_share_their_pictures(tmp_path):
    """One file, whatever page it is on."""
    picture = Picture("shown", "", png(Figure((1, 1))))
    page = Page("", "", [Section("one", "", [Gallery([picture]), picture])])
    files.write(Report({"index.html": page, "cases/a.html": page}), tmp_path)
    assert [path.name for path in (tmp_path / "pictures").iterdir()] == ["shown.png"]
    assert 'src="pictures/shown.png"' in (tmp_path / "index.html").read_text()
    assert 'src="../pictures/shown.png"' in (tmp_path / "cases" / "a.html").read_text()


def pages_of(*names):
    picture = Picture("p " + names[-1], "", png(Figure((1, 1))))
    own = Page("", "", [Section("one", "", [picture, TABLE])])
    return Report({"index.html": own} | {f"cases/{name}.html": own for name in names})


def test_a_smaller_report_leaves_none_of_the_pages_of_a_larger_one(tmp_path):
    """Nor its pictures and tables; what others put there, or changed, stays."""
    files.write(pages_of("a", "b", "c"), tmp_path)
    kept = {"cases/c.html": "mine now", "cases/notes.txt": "mine", "results.csv": "of a store"}
    for name, text in kept.items():
        (tmp_path / name).write_text(text)
    files.write(pages_of("a"), tmp_path)
    fresh = tmp_path / "fresh"
    files.write(pages_of("a"), fresh)
    left = {file.relative_to(tmp_path).as_posix() for file in tmp_path.rglob("*") if file.is_file()}
    own = {file.relative_to(fresh).as_posix() for file in fresh.rglob("*") if file.is_file()}
    assert left == own | set(kept) | {f"fresh/{name}" for name in own}
    assert {name: (tmp_path / name).read_text() for name in kept} == kept


def test_folders_that_a_report_leaves_empty_go(tmp_path):
    files.write(pages_of("a"), tmp_path)
    files.write(Report({"index.html": Page("", "", [])}), tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["index.html", MANIFEST]


@pytest.mark.parametrize("name", ["../outside", "{root}/outside", "link", "\0", "no/such", ""])
def test_a_list_of_files_removes_nothing_elsewhere(name, tmp_path):
    """Whoever wrote the list."""
    outside, folder = tmp_path / "outside", tmp_path / "report"
    outside.write_text("x")
    folder.mkdir()
    (folder / "link").symlink_to(outside)
    listed = name.format(root=tmp_path)
    (folder / MANIFEST).write_text(f"{sha256(b'x').hexdigest()}  {listed}\nno line of a list\n")
    files.write(pages_of("a"), folder)
    assert outside.read_text() == "x"


def test_a_picture_says_its_size():
    assert Picture("a", "", png(Figure((2, 1)), dpi=50)).size == (100, 50)


def test_each_picture_has_a_file_of_its_own():
    names = ["a b", "a/b", "a-b-2", "漢", "字", "W" * 400, "W" * 401]
    shown = [Picture(name, "", b"") for name in names]
    page = Page("", "", [Section("one", "", [Gallery(shown)])])
    written = pictures(Report({"index.html": page}))
    assert [picture.name for picture in written.values()] == names
    assert [*written][:3] == ["a-b", "a-b-2", "a-b-2-2"]
