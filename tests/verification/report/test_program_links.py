"""The programs of a comparison are files next to its pages, with the minima that its rows state."""

import csv
import hashlib
import re
import shutil
from dataclasses import replace
from math import isnan, nan

import pandas as pd
import pytest

import lacore as la
from lacore_verification.catalogue.catalogue import catalogue
from lacore_verification.harness.campaigns import compared_programs, comparison, instances
from lacore_verification.harness.campaigns.compared_programs import (
    copy_programs,
    program_files,
    sources_of,
    write_programs,
)
from lacore_verification.harness.perform.one_run import run_here
from lacore_verification.harness.store.results import load_outcomes
from tests.program_files import solve_file
from tests.verification.command_line import lacore


@pytest.fixture(scope="module")
def outcomes(compared):
    found, _ = load_outcomes(compared.parent, catalogue())
    return found


@pytest.fixture
def written(compared, tmp_path):
    """A copy of the programs of a comparison, to be changed."""
    shutil.copytree(compared.parent / "instances", tmp_path / "instances")
    return tmp_path


@pytest.fixture
def requested(monkeypatch):
    """Files of the programs that are written again."""
    found = []
    answers = compared_programs.answers

    def noted(worker, method, items, *rest):
        found.extend(
            compared_programs.commands_of(one.outcome.run)["instance_file"] for one in items
        )
        return answers(worker, method, items, *rest)

    monkeypatch.setattr(compared_programs, "answers", noted)
    return found


@pytest.fixture(autouse=True)
def one_process(monkeypatch):
    monkeypatch.setattr("lacore_verification.harness.perform.pool.TOGETHER", 1000)


def index_of(folder):
    return pd.read_csv(folder / "instances" / "index.csv")


def test_each_run_links_the_file_of_its_program(page_of_case):
    page = page_of_case.read_text(encoding="utf-8")
    links = re.findall(r'<a href="(\.\./instances/[^"]+)">', page)
    runs = set(re.findall(r'<tr id="(run-\w+)"', page))
    assert len(links) >= len(runs)
    for link in links:
        assert (page_of_case.parent / link).is_file()


def test_the_index_states_the_checksum_and_the_minimum_of_each_file(compared):
    index = index_of(compared.parent)
    assert set(index.file) == program_files(compared.parent)
    assert len(index) == 4
    for row in index.itertuples():
        path = compared.parent / "instances" / row.file
        assert hashlib.sha256(path.read_bytes()).hexdigest() == row.sha256
        assert row.status == "SOLVED"
        assert solve_file(path).value == pytest.approx(row.value, rel=1e-6)


def test_the_minimum_is_the_load_factor_of_the_row_that_proves_it(compared):
    index = index_of(compared.parent).set_index("file")
    rows = pd.read_csv(compared.parent / "results.csv")
    proven = rows[rows.coupling == "associated"]
    assert len(proven)
    for row in proven.itertuples():
        stated = index.loc[row.instance_file]
        assert stated.load_factor == row.load_factor
        assert stated.value * stated.load_factor_unit == pytest.approx(row.load_factor, rel=1e-12)


def test_programs_that_are_there_are_kept(outcomes, written, requested):
    before = index_of(written)
    write_programs(sources_of(outcomes), written)
    assert requested == []
    after = index_of(written)
    pd.testing.assert_frame_equal(
        *(own.sort_values("file", ignore_index=True) for own in (after, before))
    )


def test_what_was_changed_is_not_linked_and_is_written_again(outcomes, written, requested):
    name = "wall-1-mu-0.65-blocks.npz"
    (written / "instances" / name).write_bytes(b"changed")
    assert name not in program_files(written)
    write_programs(sources_of(outcomes), written)
    assert requested == [name]
    assert name in program_files(written)


def test_programs_of_other_code_are_written_again(outcomes, written, requested):
    place = written / "instances" / "index.csv"
    index = pd.read_csv(place, dtype=str, keep_default_na=False)
    index.assign(code="other").to_csv(place, index=False)
    write_programs(sources_of(outcomes), written)
    assert sorted(requested) == sorted(index.file)


def test_programs_that_belong_to_no_run_are_removed(outcomes, written):
    one = [outcome for outcome in outcomes if outcome.run.case.id == "wall-1"]
    write_programs(sources_of(one), written)
    assert program_files(written) == {"wall-1-mu-0.65-blocks.npz"}
    assert [path.name for path in (written / "instances").glob("*.npz")] == [
        *program_files(written)
    ]


def test_a_damaged_index_links_nothing(written):
    place = written / "instances" / "index.csv"
    for text in (b"", b"\xff", b"file,case\nwall-1-mu-0.65-blocks.npz,wall-1\n"):
        place.write_bytes(text)
        assert program_files(written) == frozenset()


def test_the_largest_programs_are_left_out(outcomes, monkeypatch):
    sizes = {name: own.row.n_dofs for name, own in sources_of(outcomes).items()}
    smallest = min(sizes, key=sizes.get)
    monkeypatch.setattr(compared_programs, "MOST_UNKNOWNS", sizes[smallest])
    assert [*sources_of(outcomes)] == [smallest]


def test_a_minimum_that_is_not_known_closely_is_not_stated(outcomes, tmp_path, monkeypatch):
    monkeypatch.setattr(instances, "CLOSE", 0.0)
    one = [outcome for outcome in outcomes if outcome.run.case.id == "wall-1"]
    write_programs(sources_of(one), tmp_path)
    (row,) = index_of(tmp_path).itertuples()
    assert row.status == "ALMOST_SOLVED"
    assert isnan(row.value)
    assert isnan(row.load_factor)
    assert row.residual > 0
    assert program_files(tmp_path) == {row.file}


def test_a_minimum_with_an_unknown_residual_is_not_stated(outcomes, tmp_path):
    one = next(outcome for outcome in outcomes if outcome.run.case.id == "wall-1")
    state = la.solve(one.run.problem(), coupling="associated")
    known = replace(instances.known_of(state, code=""), residual=nan)
    by = {"npz": instances.writer_of("npz")}
    (row,) = instances.write(one.run, state.discretisation, known, by, tmp_path)
    assert row.status == "ALMOST_SOLVED"
    assert isnan(row.value)


def test_a_program_that_cannot_be_written_keeps_its_command(outcomes, tmp_path, monkeypatch):
    class Broken:
        def program(self, source):
            raise ValueError("changed")

    monkeypatch.setattr(compared_programs, "ProgramWriter", Broken)
    write_programs(sources_of(outcomes), tmp_path)
    assert program_files(tmp_path) == frozenset()
    with (tmp_path / "instances" / "index.csv").open(encoding="utf-8") as file:
        assert [*csv.DictReader(file)] == []


def test_programs_are_copied_to_another_report(compared, tmp_path):
    copy_programs(compared.parent, tmp_path)
    assert program_files(tmp_path) == program_files(compared.parent)
    copy_programs(tmp_path / "none", tmp_path)
    copy_programs(tmp_path, tmp_path)
    assert program_files(tmp_path) == program_files(compared.parent)


def test_without_export_pages_state_the_command(tmp_path):
    words = ["--backends", "clarabel", "--no-export", "--out", tmp_path]
    result = lacore("compare", "block-slide:mu-0.2", *words)
    assert result.exit_code == 0, result.output
    assert not (tmp_path / "instances").exists()
    page = (tmp_path / "cases" / "block-slide.html").read_text(encoding="utf-8")
    assert "lacore export block-slide:mu-0.2" in page
    assert "../instances/" not in page


def test_the_program_of_a_frame_has_the_nodes_of_its_hinges(tmp_path):
    """Hinges form between the nodes of the problem, and the program has a node at each."""
    runs = comparison.plan(["propped-beam:propped"], ["clarabel"])
    (outcome,) = run_here(runs)
    assert outcome.row.n_dofs < 10
    write_programs(sources_of([outcome]), tmp_path)
    (row,) = index_of(tmp_path).itertuples()
    assert row.unknowns > outcome.row.n_dofs
    assert row.load_factor == outcome.row.load_factor
    solved = solve_file(tmp_path / "instances" / row.file)
    assert solved.value == pytest.approx(row.value, rel=1e-6)
