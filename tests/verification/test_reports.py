"""`lacore report` and `lacore manual`: pages and tables of what a store holds."""

import csv
import re
import sqlite3

import pytest
from click.testing import CliRunner

from verification import cli
from verification.store import NAME

CASES = ["shear-patch", "deformable-block:crushing", "wedge-extraction:rough"]
LINK = re.compile(r"""(?:src|href)\s*=\s*["']([^"']*)""")


def run(*arguments):
    return CliRunner().invoke(cli.main, list(map(str, arguments)))


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Some cases with two backends, and r varied."""
    folder = tmp_path_factory.mktemp("results")
    options = ("--backends", "clarabel,newton", "--meshes", "coarse", "--out", folder)
    assert run("compare", *CASES, *options).exit_code == 0
    vary = ("--vary", "r=1e-1:1e-3:5:log")
    assert run("sweep", "deformable-block:crushing", *vary, *options).exit_code == 0
    return folder


@pytest.fixture(scope="module")
def reported(results, tmp_path_factory):
    out = tmp_path_factory.mktemp("report")
    result = run("report", results, "--out", out)
    assert result.exit_code == 0, result.output
    return out


def test_report_has_every_run_and_its_certificate(reported):
    page = (reported / "index.html").read_text(encoding="utf-8")
    ids = set(re.findall(r'id="([^"]*)"', page))
    links = [link for link in LINK.findall(page) if link.startswith("#")]
    assert links
    assert {link[1:] for link in links} <= ids
    assert sum(name.startswith("run-") for name in ids) == 14  # 10 compared, 5 swept, 1 is both
    assert "Error against regularisation r" in page
    assert all(link.startswith(("#", "data:")) for link in LINK.findall(page))


def test_tables_are_the_same_as_csv_and_markdown(reported):
    tables = {path.stem for path in (reported / "tables").glob("*.csv")}
    assert tables == {path.stem for path in (reported / "tables").glob("*.md")}
    assert "case-deformable-block-results" in tables
    for stem in tables:
        with (reported / "tables" / f"{stem}.csv").open(newline="") as file:
            rows = list(csv.reader(file))
        lines = (reported / "tables" / f"{stem}.md").read_text(encoding="utf-8").splitlines()
        assert len(lines) == len(rows) + 1
        assert lines[0] == "| " + " | ".join(rows[0]) + " |"


def test_manual_has_a_page_a_case(results, tmp_path):
    result = run("manual", "--results", results, "--out", tmp_path)
    assert result.exit_code == 0, result.output
    pages = {path.name for path in tmp_path.iterdir()}
    names = ("shear-patch", "deformable-block", "wedge-extraction")
    assert pages == {"index.html", *(f"case-{name}.html" for name in names)}
    for name in pages:
        page = (tmp_path / name).read_text(encoding="utf-8")
        others = {link for link in LINK.findall(page) if not link.startswith(("#", "data:"))}
        assert others <= pages
    page = (tmp_path / "case-deformable-block.html").read_text(encoding="utf-8")
    for text in ("alpha = min(4 mu, 3)", "drawn from the model", "lacore sweep", "2.9999"):
        assert text in page


def test_manual_of_one_case(results, tmp_path):
    assert run("manual", "shear-patch", "--results", results, "--out", tmp_path).exit_code == 0
    assert {path.name for path in tmp_path.iterdir()} == {"index.html", "case-shear-patch.html"}


def test_cases_that_are_not_known_here_are_named(results, tmp_path):
    (tmp_path / NAME).write_bytes((results / NAME).read_bytes())
    with sqlite3.connect(tmp_path / NAME) as database:
        (first,) = database.execute("SELECT identity FROM runs LIMIT 1").fetchone()
    # An identity is part of the checksum: a row that was changed by hand is refused.
    with sqlite3.connect(tmp_path / NAME) as database:
        changed = first.replace("shear-patch", "never-heard-of")
        database.execute("UPDATE runs SET identity = ? WHERE identity = ?", (changed, first))
    database.close()
    result = run("report", tmp_path)
    assert result.exit_code == 2
    assert "is damaged (checksum of run" in result.stderr


@pytest.mark.parametrize("command", ["report", "manual"])
def test_without_results(command, tmp_path):
    place = [tmp_path] if command == "report" else ["--results", tmp_path]
    result = run(command, *place)
    assert result.exit_code == 2
    assert "there is no store" in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1


def test_a_page_that_cannot_be_written(results, tmp_path):
    (tmp_path / "file").write_text("")
    for command, place in (("report", [results]), ("manual", ["--results", results])):
        result = run(command, *place, "--out", tmp_path / "file" / "below")
        assert result.exit_code == 2
        assert "cannot write there" in result.stderr
