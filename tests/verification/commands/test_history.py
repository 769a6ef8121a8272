"""The command ``lacore history``: stored results of several versions."""

import json
import shutil
from dataclasses import replace

import pandas as pd
import pytest

import lacore as la
from lacore_verification.catalogue.catalogue import find
from lacore_verification.harness.store.results import load_outcomes
from lacore_verification.harness.store.store import NAME, Store
from tests.verification.command_line import lacore

RUN = ("wall-1:mu-0.65", "--backends", "clarabel,highs")


@pytest.fixture(scope="module")
def stored(tmp_path_factory):
    """Results of a comparison, and the table of an older one in which one run had another value."""
    place = tmp_path_factory.mktemp("history")
    new, old = place / "new", place / "old"
    assert lacore("compare", *RUN, "--out", new).exit_code == 0
    old.mkdir()
    table = pd.read_csv(new / "results.csv")
    table.loc[table["backend"] == "highs", ["load_factor", "verdict"]] = [9.0, "FAIL"]
    table.to_csv(old / "results.csv", index=False)
    about = json.loads((new / "provenance.json").read_text())
    about |= {"packages": "lacore 0.1.0, highspy 1.0", "date": "2020-01-01 00:00 UTC"}
    (old / "provenance.json").write_text(json.dumps(about))
    return old, new


def test_a_table_and_a_page_compare_versions(stored, tmp_path):
    result = lacore("history", *stored, "--out", tmp_path)
    assert result.exit_code == 0, result.output
    assert "old: lacore 0.1.0, 2020-01-01 00:00 UTC" in result.stdout
    assert "FAIL -> pass, 9 -> " in result.stdout
    assert max(map(len, result.stdout.splitlines())) <= 160
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert "Packages that changed" in page
    assert (tmp_path / "tables" / "changes.csv").is_file()


def test_one_document_has_the_same(stored, tmp_path):
    document = json.loads(lacore("history", *stored, "--out", tmp_path, "--json").stdout)
    assert [own["name"] for own in document["versions"]] == ["old", "new"]
    assert {own["backend"] for own in document["changes"]} == {"highs"}
    assert {own["backend"] for own in document["backends"]} == {"clarabel", "highs"}
    assert document["worse"] == 0


def test_a_run_that_fails_now_is_exit_code_1(stored, tmp_path):
    old, new = stored
    result = lacore("history", new, old, "--out", tmp_path)
    assert result.exit_code == 1
    assert "2 pass and now FAIL" in result.stdout


def test_a_store_and_its_table_are_the_same_results(stored, tmp_path):
    _, new = stored
    document = json.loads(
        lacore("history", new, new / "results.csv", "--out", tmp_path, "--json").stdout
    )
    assert document["changes"] == []
    assert [own["only"] for own in document["versions"]] == [0, 0]


@pytest.fixture
def resumed(stored, tmp_path):
    """A store whose last run is from a later session, and a session after it without any run."""
    shutil.copytree(stored[1], place := tmp_path / "resumed")
    known = {case.id: case for case in (find("wall-1")[0],)}
    outcomes, _ = load_outcomes(place, known)
    last = next(one for one in outcomes if one.run.backend == "highs")
    later = {"packages": "lacore 9.0.0, highspy 2.0", "date": "2030-01-01 00:00 UTC"}
    with Store(place / NAME, later) as store:
        store.append(replace(last, row=replace(last.row, load_factor=9.0)), "later")
    with Store(place / NAME, {"packages": "lacore 99.0.0", "date": "2031-01-01 00:00 UTC"}):
        pass
    return place


def test_each_run_has_the_version_of_its_own_session(stored, resumed, tmp_path):
    words = ("history", stored[1], resumed, "--out", tmp_path / "page")
    first = la.__version__
    document = json.loads(lacore(*words, "--json").stdout)
    (change,) = document["changes"]
    assert (change["backend"], change["load_factor_after"]) == ("highs", 9.0)
    assert (change["lacore_before"], change["lacore_after"]) == (first, "9.0.0")
    new, mixed = document["versions"]
    assert [own["packages"].split(", ")[0] for own in new["sessions"]] == [f"lacore {first}"]
    assert len(mixed["sessions"]) == 2  # the one without a run computed nothing
    shown = lacore(*words).stdout
    assert f"resumed: lacore {first}, 9.0.0, " in shown
    assert " to 2030-01-01 00:00 UTC" in shown
    assert "99.0.0" not in shown
    page = (tmp_path / "page" / "index.html").read_text(encoding="utf-8")
    assert f"{first}, 9.0.0" in page


def test_a_table_without_provenance_is_accepted(stored, tmp_path):
    alone = tmp_path / "alone"
    alone.mkdir()
    shutil.copy(stored[0] / "results.csv", alone)
    result = lacore("history", alone, stored[1], "--out", tmp_path / "page")
    assert "alone: lacore unknown, unknown date" in result.stdout


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["{new}"], "two versions"),
        (["{new}", "{new}"], "is given twice"),
        (["{new}", "{new}/results.sqlite"], "is given twice"),
        (["{new}", "no-such-folder"], "there is no such folder or file"),
        (["{new}", "{empty}"], "contains no results (results.sqlite or results.csv)"),
        (["{new}", "{empty}/text.csv"], "has no column 'case'"),
        (["{new}", "{empty}/nothing.csv"], "is not a table"),
        (["{new}", "{empty}/provenance.json"], "is not a file with results"),
    ],
)
def test_invalid_input_is_one_sentence(stored, tmp_path, words, said):
    empty = tmp_path / "empty"
    empty.mkdir()
    if "empty}/" in words[-1]:
        (empty / "text.csv").write_text("a,b\n1,2\n")
        (empty / "nothing.csv").write_text("")
        (empty / "provenance.json").write_text("{}")
    given = [word.format(new=stored[1], empty=empty) for word in words]
    result = lacore("history", *given, "--out", tmp_path / "page")
    assert result.exit_code == 2
    assert said in result.stderr
    assert len(result.stderr.splitlines()) == 1
    assert not (tmp_path / "page").exists()


def test_damaged_provenance_is_named(stored, tmp_path):
    shutil.copy(stored[0] / "results.csv", tmp_path)
    (tmp_path / "provenance.json").write_text("{")
    result = lacore("history", tmp_path, stored[1], "--out", tmp_path / "page")
    assert result.exit_code == 2
    assert "is not a JSON file" in result.stderr
