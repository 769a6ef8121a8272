"""`lacore solve` and `lacore new`, as a user meets them."""

import json
import re
import subprocess
import sys
import tomllib
from dataclasses import replace

import jsonschema
import pytest

import lacore as la
from lacore.limit.solve import solve
from lacore.reporting.findings import Finding
from lacore.reporting.kinds import Kind
from lacore.reporting.units import Units
from lacore_verification.report.problems import starters
from lacore_verification.report.problems.answers import ProblemResults
from lacore_verification.report.problems.words import lines
from tests.conftest import ROOT
from tests.lacore.files.problem import footing
from tests.verification.command_line import lacore

STARTERS = starters.titles()
PATHS = [name for name in STARTERS if "\n[path]" in starters.text(name)]  # see test_paths


def only_progress(text):
    """No warning: what a machine that is busy says of the time is none."""
    return all(re.fullmatch(r".*, \d+:\d\d:\d\d", line) for line in text.splitlines())


@pytest.fixture(scope="module")
def solved(tmp_path_factory):
    folder = tmp_path_factory.mktemp("solve")
    file = folder / "footing.toml"
    file.write_text(footing.TEXT, encoding="utf-8")
    return file, folder / "out", lacore("solve", file, "--out", folder / "out")


def test_an_answer_is_ten_lines(solved):
    _, out, result = solved
    assert result.exit_code == 0, result.output
    assert only_progress(result.stderr)
    lines = result.stdout.splitlines()
    assert len(lines) <= 10
    assert lines[0] == "Footing"
    names = ("load factor", "mechanism", "dead loads", "residual", "solver", "report")
    assert all(any(line.strip().startswith(name) for line in lines) for name in names)
    assert f"{la.solve(footing.problem()).load_factor:.6g}, strict upper bound" in lines[1]
    assert str(out / "index.html") in lines[-1]


def test_a_bracket_is_what_the_answer_begins_with(tmp_path):
    """One solve of the mesh of the file may lie outside of it, as here."""
    file = tmp_path / "footing.toml"
    file.write_text(lacore("new", "footing").stdout, encoding="utf-8")
    result = lacore("solve", file, "--out", tmp_path, "--bracket", "0.1", "--json", rendered=False)
    assert result.exit_code == 0, result.output
    document = json.loads(result.stdout)
    lower, upper = document["bracket"]["lower"], document["bracket"]["upper"]
    assert not lower <= document["load_factor"] <= upper
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert f"Collapse between {lower:.6g} and {upper:.6g} times the reference loads" in page
    facts = re.sub("<[^>]+>", " ", page)
    assert facts.index(f"{lower:.6g} &lt;= load") < facts.index(f"{document['load_factor']:.6g}")


def test_what_a_state_adds_to_its_load_factor_is_told():
    """That a box is too small, and that there may be other load factors, stands in the message of
    the state: who solves a file reads it, too, in the words of files."""
    mesh = la.meshes.rectangle(x=(0, 2), y=(-1, 0), nx=4, ny=2)
    sand = la.MohrCoulomb(1.0, 30, dilation_angle=20)
    problem = la.Problem(
        {"sand": la.Body(mesh, sand)},
        [la.RigidFooting("sand", lambda x: (x[1] == 0) & (x[0] <= 1), (0, -1), rough=False)],
        [la.Fix("sand", "left", "x"), la.Fix("sand", "right"), la.Fix("sand", "bottom")],
    )
    state = solve(problem, throw=True)  # no larger box is asked for
    kinds = [Kind.OTHER_LOAD_FACTORS, Kind.EQUILIBRIUM_ON_BOTH_SIDES]
    assert [own.kind for own in state.findings] == kinds
    reaches = Finding(Kind.REACHES_SUPPORT, ("sand.right",))
    reached = replace(state, findings=(*state.findings, reaches))
    told = lines(ProblemResults(reached, {}, 0.0), Units())
    other = (
        "other load factors may exist, because flow is not associated; --range searches for them; "
    )
    assert told["note"].startswith(other)
    assert "; the mechanism reaches sand.right" in told["note"]
    nothing = ProblemResults(replace(state, findings=()), {}, 0.0)
    assert "note" not in lines(nothing, Units())


def test_a_page_pictures_tables_and_paraview_come_with_it(solved):
    _, out, _ = solved
    page = (out / "index.html").read_text(encoding="utf-8")
    assert {"state.vtu", "problem.py", "pictures", "tables"} <= {own.name for own in out.iterdir()}
    for text in ("pictures/mechanism.png", "pictures/problem.png", "state.vtu", "equilibrium"):
        assert text in page


@pytest.mark.parametrize("name", ["frame", "layered", "arch"])
def test_a_page_is_in_one_choice_of_units(name, tmp_path):
    """That of the file, on the terminal, in pictures' legends, facts and tables."""
    file = tmp_path / f"{name}.toml"
    file.write_text(lacore("new", name).stdout, encoding="utf-8")
    result = lacore("solve", file, "--out", tmp_path / "out", rendered=False)
    page = (tmp_path / "out" / "index.html").read_text(encoding="utf-8")
    shown = page.partition('id="file"')[0]  # before the text of the file
    for text in (result.stdout, shown):
        assert not re.search(r"\d (Pa|N|N/m|N/m\^3|N m)\b", text)
        assert re.search(r"\d\)? k(Pa|N)", text)
    assert re.search(r"\[k(Pa|N|N m)\]", shown) or name == "layered"  # which has no such table


def test_the_script_finds_the_same_number(solved):
    _, out, result = solved
    again = subprocess.run(
        [sys.executable, out / "problem.py"], capture_output=True, text=True, cwd=out, check=True
    )
    assert again.stdout.split(" (")[0].strip() in " ".join(result.stdout.split())


def test_json_is_one_document(solved, tmp_path):
    file, _, _ = solved
    result = lacore("solve", file, "--out", tmp_path, "--json", rendered=False)
    found = json.loads(result.stdout)
    assert found["rigor"] == "upper"
    assert found["load_factor"] == pytest.approx(la.solve(footing.problem()).load_factor)
    assert found["certificate"]["gap"] < found["tolerance"]


def test_a_folder_that_cannot_be_written_is_said_before_anything_is_solved(tmp_path, monkeypatch):
    monkeypatch.setattr(la, "solve", None)
    file, taken = tmp_path / "footing.toml", tmp_path / "taken"
    file.write_text(footing.TEXT, encoding="utf-8")
    taken.write_text("")
    result = lacore("solve", file, "--out", taken)
    assert result.exit_code == 2
    assert "--out" in result.stderr


def test_bad_input_is_a_sentence_and_exit_code_2(tmp_path):
    file = tmp_path / "footing.toml"
    file.write_text(footing.TEXT.replace("left", "lft"), encoding="utf-8")
    result = lacore("solve", file, "--out", tmp_path / "out")
    assert result.exit_code == 2
    assert result.stdout == ""
    assert "footing.toml:11: supports[0].where = 'lft'" in result.stderr
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("asked", "said"),
    [
        ('backend = "clarable"', "backend = 'clarable': .*did you mean 'clarabel'"),
        ('coupling = "certifid"', "coupling = 'certifid': unknown name; did you mean 'certified'"),
        ("bracket = -0.1", "bracket = -0.1: not a positive number"),
        ("bracket = 5", "bracket = 5.*: not a share of the load factor; give 0.05 for 5 %"),
        ("range = 1", "range = 1: neither true nor false|range"),
        ('backend = "newton"\nrange = true', "--backend = 'newton': regularised backends"),
        ("interfaces = true", r"footing.toml:\d+: solve.interfaces = True: has an effect only"),
    ],
)
def test_what_is_asked_for_in_the_file_is_checked_before_it_is_solved(
    asked, said, tmp_path, monkeypatch
):
    monkeypatch.setattr(la, "solve", None)
    file = tmp_path / "footing.toml"
    file.write_text(f"{footing.TEXT}\n[solve]\n{asked}\n", encoding="utf-8")
    result = lacore("solve", file, "--out", tmp_path / "out")
    assert result.exit_code == 2
    assert re.search(said, result.stderr)


def test_a_width_in_per_cent_is_refused_by_its_option(tmp_path):
    file = tmp_path / "footing.toml"
    file.write_text(footing.TEXT, encoding="utf-8")
    result = lacore("solve", file, "--bracket", "5", "--out", tmp_path / "out")
    assert result.exit_code == 2
    assert "--bracket = 5.0: not a share of the load factor; give 0.05 for 5 %" in result.stderr


def test_what_is_seen_when_it_is_solved_is_said_with_its_line_too(tmp_path):
    file = tmp_path / "footing.toml"
    file.write_text(footing.TEXT.replace('where = "bottom"', 'where = "top"'), encoding="utf-8")
    result = lacore("solve", file, "--out", tmp_path / "out")
    assert result.exit_code == 2
    assert "footing.toml:22: reference_loads[0] = 'clay: footing': a support" in result.stderr


def test_an_answer_that_cannot_be_written_is_told(tmp_path, monkeypatch):
    """What was found is not lost with the disk that is full."""

    def full(state, place):
        place.write_text("half of it")
        raise la.InputError("path", str(place), "cannot be written", "free space")

    monkeypatch.setattr(la.LimitState, "to_vtu", full)
    file, out = tmp_path / "footing.toml", tmp_path / "out"
    file.write_text(footing.TEXT, encoding="utf-8")
    result = lacore("solve", file, "--out", out)
    assert result.exit_code == 2
    assert re.search(r"load factor +\d", result.stdout)
    assert not re.search("^  report", result.stdout, re.MULTILINE)
    assert "cannot be written; free space" in result.stderr
    assert not (out / "state.vtu").exists()
    document = json.loads(lacore("solve", file, "--out", out, "--json", rendered=False).stdout)
    assert document["page"] is None
    assert document["load_factor"] > 0


def test_what_moves_without_flowing_is_not_said_to_rest(tmp_path):
    """A body that nothing holds."""
    file = tmp_path / "footing.toml"
    text = footing.TEXT
    held = text[text.index("[[supports]]") : text.index("[[reference_loads]]")]
    file.write_text(text.replace(held, ""), encoding="utf-8")
    result = lacore("solve", file, "--out", tmp_path, rendered=False)
    assert result.exit_code == 1
    assert re.search(r"mechanism +clay moves without dissipation", result.stdout)


def test_ctrl_c_is_a_sentence(tmp_path, monkeypatch):
    def stopped(*words, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr(la, "solve", stopped)
    file = tmp_path / "footing.toml"
    file.write_text(footing.TEXT, encoding="utf-8")
    result = lacore("solve", file, "--out", tmp_path / "out")
    assert result.exit_code == 130
    assert result.stderr == "stopped before the load factor was computed\n"


def test_what_collapses_by_itself_is_exit_code_1(tmp_path):
    """Clay that weighs 100 times more than it can bear has no load factor; it is a page, too."""
    file = tmp_path / "heavy.toml"
    heavy = footing.TEXT.replace("{ x = 3 }", '"bottom"').replace("18 kN/m3", "8 MN/m3")
    file.write_text(heavy, encoding="utf-8")
    result = lacore("solve", file, "--out", tmp_path / "out")
    assert result.exit_code == 1
    assert "unsafe" in result.stdout
    assert (tmp_path / "out" / "index.html").is_file()


def test_what_there_is_to_begin_with_is_listed():
    listed = lacore("new").stdout
    assert all(name in listed and title in listed for name, title in STARTERS.items())
    assert len(STARTERS) >= 8
    assert json.loads(lacore("new", "--json").stdout) == STARTERS
    assert lacore("new", "fotting").exit_code == 2
    assert "did you mean 'footing'?" in lacore("new", "fotting").stderr


@pytest.fixture(scope="module")
def schema():
    text = json.loads(lacore("new", "--schema").stdout)
    kind = jsonschema.validators.validator_for(text)
    kind.check_schema(text)
    return kind(text)


@pytest.mark.parametrize("name", STARTERS)
def test_starters_are_what_the_schema_says(name, schema):
    schema.validate(tomllib.loads(lacore("new", name).stdout))


def test_the_schema_is_that_of_the_code():
    """Written anew by docs/problem_schema.py."""
    from docs import problem_schema  # here: pydantic takes a while to load

    file = ROOT / "lacore" / "files" / "problem" / "schema.json"
    assert file.read_text(encoding="utf-8") == problem_schema.schema()


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in STARTERS if name not in PATHS])
def test_starters_are_solved(name, tmp_path):
    file = tmp_path / f"{name}.toml"
    file.write_text(lacore("new", name).stdout, encoding="utf-8")
    result = lacore("solve", file, "--out", tmp_path / "out")
    assert result.exit_code == 0, result.output
    assert only_progress(result.stderr)
    script = subprocess.run(
        [sys.executable, "-W", "error", tmp_path / "out" / "problem.py"],
        capture_output=True,
        text=True,
        check=True,
    )
    said = script.stdout.split("load factor ")[1].split(" ")[0]
    assert f"load factor {said}" in " ".join(result.stdout.split())
