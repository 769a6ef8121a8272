"""Invalid input: one sentence with the closest valid name, exit code 2, and nothing on stdout."""

import json

import pytest

from lacore_verification.commands import cli
from lacore_verification.report.problems import starters
from tests.verification.command_line import lacore

COMMANDS = list(cli.main.commands)
NEEDED = {
    **{"solve": ["FILE.toml"], "report": ["DIR"], "sweep": ["CASE"], "programs": ["BACKEND"]},
    "history": ["RESULTS"],
}
"""Arguments of the commands that need one."""


@pytest.fixture
def somewhere(tmp_path, monkeypatch):
    """A folder with a problem file, an empty file, and an empty folder."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "footing.toml").write_text(starters.text("footing"), encoding="utf-8")
    (tmp_path / "empty.toml").write_text("")
    (tmp_path / "folder").mkdir()
    (tmp_path / "models").mkdir()
    (tmp_path / "models" / "slope.toml").write_text(starters.text("slope"), encoding="utf-8")
    return tmp_path


def refused(*words):
    """Return the sentence that reports invalid input."""
    result = lacore(*words)
    assert result.exit_code == 2, result.output
    assert result.stdout == ""
    (sentence,) = result.stderr.splitlines()
    assert sentence.startswith("Error: ")
    return sentence


def test_without_arguments_the_first_commands_are_shown():
    result = lacore()
    assert result.exit_code == 0
    for text in ("lacore new footing", "lacore solve footing.toml", "lacore compare", "--help"):
        assert text in result.stdout
    assert len(result.stdout.splitlines()) <= 8


@pytest.mark.parametrize(
    ("name", "meant"), [("slove", "solve"), ("comp", "compare"), ("backend", "backends")]
)
def test_a_mistyped_command(name, meant):
    assert f"did you mean '{meant}'?" in refused(name)


def test_a_command_like_no_other_lists_all():
    sentence = refused("xyz")
    assert all(command in sentence for command in COMMANDS)


@pytest.mark.parametrize("command", COMMANDS)
def test_a_mistyped_option(command):
    assert "did you mean --json?" in refused(command, *NEEDED.get(command, []), "--jsno")


@pytest.mark.parametrize("command", COMMANDS)
def test_a_superfluous_or_unknown_argument(command):
    sentence = refused(command, "no-such-thing", "nor-this")
    assert "no-such-thing" in sentence or "nor-this" in sentence


@pytest.mark.parametrize("command", NEEDED)
def test_a_missing_argument(command):
    assert f"{command} --help`" in refused(command)


@pytest.mark.parametrize("command", ["compare", "verify", "export", "manual"])
@pytest.mark.parametrize(
    ("name", "meant"),
    [("prandl-punch", "'prandtl-punch'?"), ("prandtl-punch:smoth", "'smooth'?"), ("q", "cases`")],
)
def test_a_mistyped_case_or_variant(somewhere, command, name, meant):
    assert meant in refused(command, name)
    assert sorted(own.name for own in somewhere.iterdir()) == [
        *("empty.toml", "folder", "footing.toml", "models")
    ]


@pytest.mark.parametrize(
    "words",
    [
        ("compare", "--backends", "clarbel"),
        ("verify", "--backends", "clarbel"),
        ("sweep", "wall-1", "--backends", "clarbel"),
        ("solve", "footing.toml", "--backend", "clarbel"),
        ("conformance", "clarbel"),
        ("programs", "clarbel"),
    ],
)
def test_a_mistyped_backend(somewhere, words):
    assert "did you mean 'clarabel'?" in refused(*words)


@pytest.mark.parametrize("words", [("compare",), ("verify",), ("export",), ("sweep", "wall-1")])
def test_a_mistyped_mesh_level(words):
    assert "did you mean 'coarse'?" in refused(*words, "--meshes", "corse")


@pytest.mark.parametrize(
    ("words", "meant"),
    [
        (("compare", "--couplings", "certfied"), "did you mean 'certified'?"),
        (("sweep", "wall-1", "--vary", "anderso=1"), "did you mean 'anderson'?"),
        (("fuzz", "--classes", "blcks"), "did you mean 'blocks'?"),
        (("programs", "clarabel", "--families", "sol"), "did you mean 'soil'?"),
        (("cases", "--tag", "framse"), "did you mean 'frames'?"),
        (("export", "--formats", "cbff"), "did you mean 'cbf'?"),
        (("new", "fotting"), "did you mean 'footing'?"),
        (("new", "fotting", "--schema"), "did you mean 'footing'?"),
        (("compare", "--jobs", "0"), "0 is not a whole number of at least 1"),
        (("compare", "--jobs", "two"), "two is not a whole number of at least 1"),
        (("fuzz", "--count", "0.5"), "0.5 is not a whole number"),
        (("verify", "--time-limit", "0"), "0 is not a finite number above 0"),
        (("solve", "x.toml", "--bracket", "wide"), "wide is not a finite number above 0"),
        (("solve", "x.toml", "--critical", "nan"), "nan is not a finite number"),
        (("compare", "--backends"), "requires an argument"),
        (("report", "models", "--pictures", "-1"), "-1 is not a whole number"),
    ],
)
def test_a_wrong_value_of_an_option(words, meant):
    assert meant in refused(*words)


@pytest.mark.parametrize(
    ("path", "meant"),
    [
        ("fotting.toml", "there is no such file; did you mean 'footing.toml'?"),
        ("footing", "there is no such file; did you mean 'footing.toml'?"),
        ("models/slop.toml", "did you mean 'models/slope.toml'?"),
        ("q.toml", "`lacore new` prints problem files"),
        ("models", "is a folder, not a file; did you mean 'models/slope.toml'?"),
        ("folder", "is a folder, not a file"),
        ("empty.toml", "is empty; `lacore new` prints problem files"),
    ],
)
def test_a_problem_file_that_cannot_be_read(somewhere, path, meant):
    assert meant in refused("solve", path)


@pytest.mark.parametrize("options", [("report",), ("manual", "--results")])
@pytest.mark.parametrize(
    ("path", "meant"),
    [
        ("folder", "contains no results"),
        ("footing.toml", "is a file without results"),
        ("report/compar", "did you mean 'report/compare'?"),
    ],
)
def test_a_folder_without_results(somewhere, options, path, meant):
    (somewhere / "report" / "compare").mkdir(parents=True)
    (somewhere / "report" / "compare" / "results.sqlite").write_bytes(b"")
    assert meant in refused(*options, path)


def test_results_that_do_not_exist_yet(somewhere):
    assert "run `lacore verify" in refused("manual", "--results", "missing")


@pytest.mark.parametrize(
    ("path", "meant"),
    [
        ("modles", "did you mean 'models'?"),
        ("footing.toml", "cannot be read (Not a directory)"),
        ("folder", "contains no case"),
    ],
)
@pytest.mark.parametrize("command", ["cases", "compare", "verify", "export", "manual"])
def test_a_folder_without_cases(somewhere, command, path, meant):
    assert meant in refused(command, "--cases", path)


@pytest.mark.parametrize("below", ["footing.toml", "footing.toml/below"])
@pytest.mark.parametrize(
    "words",
    [
        *(("compare", "shear-patch"), ("verify", "shear-patch"), ("export", "shear-patch")),
        *(("sweep", "shear-patch"), ("manual", "shear-patch"), ("report", "folder")),
        *(("fuzz", "--count", "1"), ("solve", "footing.toml")),
    ],
)
def test_a_file_in_place_of_a_folder_for_results(somewhere, words, below):
    assert "footing.toml is a file; give a folder" in refused(*words, "--out", below)


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help_and_json(command):
    result = lacore(command, "--help")
    assert result.exit_code == 0
    assert "--json" in result.stdout
    listed = next(
        line for line in lacore("--help").stdout.splitlines() if line.strip().startswith(command)
    )
    assert not listed.endswith("...")


def test_starter_files_and_their_schema_are_json():
    (title, *_) = starters.titles().values()
    document = json.loads(lacore("new", "arch", "--json").stdout)
    assert document == {"name": "arch", "title": title, "text": starters.text("arch")}
    assert json.loads(lacore("new", "--schema", "--json").stdout)["title"]
