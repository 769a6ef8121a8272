"""Cases whose functions do what they should not: the others, and this process, go on."""

import json
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from lacore_verification.commands.cli import main
from tests.shares import one_in

HOSTILE = '''"""A block on a floor."""

import os
import sys
import time

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid


def build(mu: float) -> la.Problem:
    {does}
    return la.Problem(
        bodies={{"block": la.RigidBlock([(0, 0), (1, 0), (1, 1), (0, 1)])}},
        interfaces=[
            la.Interface(("block", lambda x: x[1] == 0), la.RigidObstacle(), friction=mu)
        ],
        dead_loads=[la.BodyForce("block", (0, -1))],
        reference_loads=[la.BodyForce("block", (1, 0))],
    )


def reference(mu: float) -> Reference:
    return Reference(mu, "mu", "by hand", "exact")


def band(elements: int, mu: float) -> Band:
    return rigid(dead=1.0)


CASE = Case(
    id="{name}",
    title="A block",
    tags=("mine",),
    unit="N",
    explanation=__doc__,
    hand_calculation="alpha = mu",
    build=build,
    reference=reference,
    band=band,
    variants=(Variant("half", {{"mu": 0.5}}),),
)
'''


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Working directory, whose folder of cases is found as long as the test runs."""
    (tmp_path / "cases").mkdir()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    return tmp_path


def write(folder: Path, name: str, does: str) -> None:
    text = HOSTILE.format(name=name.replace("_", "-"), does=does)
    (folder / "cases" / f"{name}.py").write_text(text)


def lacore(*words: str) -> tuple[int, str]:
    arguments = [*words, "--cases", "cases"]
    result = CliRunner().invoke(main, arguments)
    return result.exit_code, result.stdout


@pytest.mark.slow
def test_what_build_prints_and_where_it_goes_changes_nothing(folder: Path) -> None:
    """Standard output is the document alone, and relative folders are where they were."""
    write(folder, "hostile_talk", "print('hello'); os.chdir('/')")
    code, out = lacore(
        "verify", "hostile-talk", "--backends", "clarabel,highs", "--out", "found", "--json"
    )
    assert (code, json.loads(out)["summary"]["failed"]) == (0, 0)
    assert (folder / "found" / "results.sqlite").is_file()
    assert lacore("report", "found")[0] == 0
    # It has none of the kinds of lacore among its tags, either.
    assert lacore("manual", "--results", "found", "--out", "pages")[0] == 0
    assert "A block" in (folder / "pages" / "index.html").read_text()


ENDS = {"end": "os._exit(0)", "exit": "sys.exit(0)"}


@pytest.mark.parametrize(("name", "does"), one_in(2, ENDS.items()))
def test_build_that_ends_its_process_is_a_row_that_failed(
    folder: Path, name: str, does: str
) -> None:
    """`verify` builds problems before it runs them: that must not end it, with exit code 0 even."""
    write(folder, f"hostile_{name}", does)
    code, out = lacore(
        "verify", f"hostile-{name}", "--backends", "clarabel,highs", "--out", "found", "--json"
    )
    assert (code, json.loads(out)["summary"]["passed"]) == (1, 0)
    assert lacore("report", "found")[0] == 0
    page = (folder / "found" / "index.html").read_text()
    assert "1 case, 2 runs," in page
    assert "None of the runs is solved." in page  # in place of empty charts


@pytest.mark.slow
def test_manual_shows_a_case_that_cannot_be_built(folder: Path) -> None:
    """The page says why there is no sketch."""
    write(folder, "hostile_raises", "raise ValueError('<b>no</b>')")
    assert lacore("verify", "hostile-raises", "--backends", "clarabel", "--out", "found")[0] == 1
    assert lacore("manual", "--results", "found", "--out", "pages")[0] == 0
    page = (folder / "pages" / "cases" / "hostile-raises.html").read_text()
    assert "ValueError: &lt;b&gt;no" in page


@pytest.mark.slow
def test_cases_leave_no_trace_in_others(folder: Path) -> None:
    """One clears the path of its interpreter: the next finds all that it needs."""
    write(folder, "hostile_a", "sys.path.clear(); os.environ.clear()")
    write(folder, "hostile_b", "pass")
    code, out = lacore(
        "compare",
        "hostile-a",
        "hostile-b",
        "--backends",
        "clarabel,highs",
        "--out",
        "found",
        "--json",
    )
    rows = {row["case"]: row["verdict"] for row in json.loads(out)["rows"]}
    assert (code, rows) == (1, {"hostile-a": "FAIL", "hostile-b": "pass"})


@pytest.mark.slow
def test_report_of_a_case_that_was_changed_since(folder: Path) -> None:
    """Its stored state is none of the new problem: there is no picture, but a page that says so."""
    write(folder, "hostile_odd", "if os.path.exists('changed'): raise ValueError('changed')")
    assert lacore("compare", "hostile-odd", "--backends", "clarabel", "--out", "found")[0] == 0
    (folder / "changed").touch()
    assert lacore("report", "found")[0] == 0
    assert "cannot be drawn" in (folder / "found" / "cases" / "hostile-odd.html").read_text()


@pytest.mark.parametrize("command", [("compare",), ("verify",), ("sweep", "--vary", "mu=0.3")])
def test_mesh_level_that_no_case_has(folder: Path, command: tuple[str, ...]) -> None:
    """Also where only rigid bodies are run, which have no levels and take those of others."""
    result = CliRunner().invoke(main, [*command, "block-slide", "--meshes", "nope"])
    assert result.exit_code == 2
    assert "mesh = 'nope': unknown name" in result.stderr
