"""`lacore report` and `lacore manual`: pages and tables of what a store holds."""

import csv
import re
import sqlite3
from pathlib import Path

import pytest

from lacore_verification.harness.campaigns import sweep
from lacore_verification.harness.campaigns.comparison import plan
from lacore_verification.harness.campaigns.run_all import run_all
from lacore_verification.harness.store.store import NAME
from tests.verification.command_line import lacore as run
from tests.verification.command_line import run_in_order

CASES = ["shear-patch", "deformable-block:crushing", "wedge-extraction:rough"]
LINK = re.compile(r"""(?:src|href)\s*=\s*["']([^"']*)""")


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Some cases with two backends, and r varied, as `compare` and `sweep` leave them."""
    folder = tmp_path_factory.mktemp("results")
    backends, meshes = ["clarabel", "newton"], ["coarse"]
    compared = plan(CASES, backends, meshes)
    swept = sweep.plan(["deformable-block:crushing"], ["r=1e-1:1e-3:5:log"], backends, meshes)
    for runs in (compared, swept):
        run_all(runs, folder / NAME, executor=run_in_order)
    return folder


@pytest.fixture(scope="module")
def reported(results, tmp_path_factory):
    out = tmp_path_factory.mktemp("report")
    result = run("report", results, "--out", out, "--pictures", 1)
    assert result.exit_code == 0, result.output
    return out


def test_report_has_every_run_and_its_certificate(reported):
    pages = {path: path.read_text(encoding="utf-8") for path in reported.rglob("*.html")}
    ids = {path.resolve(): set(re.findall(r'id="([^"]*)"', text)) for path, text in pages.items()}
    seen = 0
    for path, text in pages.items():
        for link in LINK.findall(text):
            file, _, name = link.partition("#")
            target = (path.parent / file if file else path).resolve()
            assert target.is_file(), link
            assert not name or name in ids[target], link
            seen += "certificate-" in name
    assert seen >= 14
    every = [name for names in ids.values() for name in names if name.startswith("run-")]
    assert len(every) == 14  # 10 compared, 5 swept, 1 is both
    assert "Error against regularisation r" in pages[reported / "index.html"]


def test_index_has_the_answer_of_each_variant(reported):
    """What is proven, the error beside the one allowed, who agrees; each with its proof."""
    with (reported / "tables" / "cases-all-cases-in-one-table.csv").open(newline="") as file:
        rows = {row["variant"]: row for row in csv.DictReader(file)}
    crushing = rows["crushing"]
    assert crushing["reference"] == "3"
    # The exact value is 3, and the certificate lets through 1e-6 of it.
    shown = crushing["proven bounds or value"].lstrip("\N{LESS-THAN OR EQUAL TO} ")
    assert float(shown) == pytest.approx(3, abs=1e-5)
    assert abs(float(crushing["error %"])) <= abs(float(crushing["tolerance %"]))
    assert crushing["backends agreeing"] == "2 of 2"
    # The associated load factor is a proven bound, 1.4757, and tells less than the value.
    assert float(rows["rough"]["proven bounds or value"]) == pytest.approx(1, abs=1e-5)
    index = (reported / "index.html").read_text(encoding="utf-8")
    assert re.search(r'href="cases/deformable-block.html#certificate-\w+"', index)
    assert "pictures/deformable-block-crushing-thumbnail.png" in index


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
    result = run("manual", "--results", results, "--out", tmp_path, "--pictures", 0)
    assert result.exit_code == 0, result.output
    assert "Next:" in result.stdout
    pages = {str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*.html")}
    names = ("shear-patch", "deformable-block", "wedge-extraction")
    assert pages == {"index.html", *(f"cases/{name}.html" for name in names)}
    index = (tmp_path / "index.html").read_text(encoding="utf-8")
    for name in names:
        assert f'src="pictures/{name}-sketch-thumbnail.png"' in index
    page = (tmp_path / "cases" / "deformable-block.html").read_text(encoding="utf-8")
    for text in (
        "alpha = min(4 mu, 3)",
        "supports, contact, loads",
        "lacore sweep",
        "../index.html",
    ):
        assert text in page


@pytest.mark.slow
def test_manual_of_one_case(results, tmp_path):
    assert run("manual", "shear-patch", "--results", results, "--out", tmp_path).exit_code == 0
    assert [path.name for path in (tmp_path / "cases").iterdir()] == ["shear-patch.html"]


@pytest.mark.slow
def test_how_many_pictures_are_drawn_can_be_said(results, tmp_path):
    """What is not drawn is named, with the command that draws it."""
    result = run("report", results, "--out", tmp_path, "--pictures", "0")
    assert result.exit_code == 0, result.output
    assert {path.stem for path in (tmp_path / "pictures").iterdir()} == {
        f"{name}-sketch-thumbnail"
        for name in ("shear-patch", "deformable-block", "wedge-extraction")
    }
    page = (tmp_path / "cases" / "deformable-block.html").read_text(encoding="utf-8")
    assert "Not drawn yet: Collapse mechanism of crushing" in page


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


@pytest.mark.parametrize("command", [["report"], ["manual", "wall-1", "--results"]])
def test_without_results(command, tmp_path):
    """It names what to run first."""
    result = run(*command, tmp_path)
    assert result.exit_code == 2
    assert "contains no results" in result.stderr
    assert "`lacore verify`" in result.stderr
    assert len(result.stderr.strip().splitlines()) == 1


def test_a_manual_of_a_first_look_is_offered(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert "there are no results yet; run `lacore verify` first" in run("manual").stderr
    store = Path("reports/compare") / NAME
    store.parent.mkdir(parents=True)
    store.touch()
    assert "did you mean 'reports/compare'?" in run("manual").stderr


@pytest.mark.slow
def test_a_page_that_cannot_be_written(results, tmp_path):
    (tmp_path / "file").write_text("")
    for command, place in (("report", [results]), ("manual", ["--results", results])):
        result = run(command, *place, "--out", tmp_path / "file" / "below")
        assert result.exit_code == 2
        assert "is a file; give a folder" in result.stderr
