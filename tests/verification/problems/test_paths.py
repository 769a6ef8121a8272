"""`lacore solve` of files with a table [path]."""

import json
import re
import subprocess
import sys
from xml.etree import ElementTree

import pandas as pd
import pytest

import lacore as la
from lacore.files.problem.reading import read
from tests.verification.command_line import lacore
from verification.problems import starters

BAR = """\
title = "A bar that is drawn out"
[bodies.bar]
kind = "continuum"
space = "q2"
mesh = { shape = "quadrilaterals", x = [0, "20 mm"], y = [0, "20 mm"], nx = 1, ny = 1 }
material = { criterion = "von-mises", hardening = { law = "linear", yield_stress = "1 MPa", slope = "1 MPa" } }
[[supports]]
body = "bar"
where = "left"
components = "x"
[[supports]]
body = "bar"
where = "bottom"
components = "y"
[[reference_loads]]
load = "rigid-footing"
body = "bar"
where = "right"
direction = [1, 0]
pressure = "1 MPa"
rough = false
[path]
travel = "6 mm"
steps = 3
"""  # noqa: E501
POINT = 'control = { measure = "point", body = "bar", at = ["20 mm", 0], direction = [1, 0] }\n'


@pytest.fixture
def bar(tmp_path):
    """Write the file with some changes; the path of it."""

    def written(*changes, more=""):
        text = BAR + more
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        file = tmp_path / "bar.toml"
        file.write_text(text, encoding="utf-8")
        return file

    return written


def test_a_path_is_followed_and_told_in_the_units_of_the_file(bar, tmp_path):
    out = tmp_path / "out"
    result = lacore("solve", bar(), "--out", out)
    assert result.exit_code == 0, result.output
    said = result.stdout
    assert "3 steps to a travel of 6 mm, reached" in said
    path = read(bar()).followed(backend="auto")
    head, *rows = said[said.index("step  travel [mm]") :].splitlines()
    assert re.split(r"\s{2,}", head.strip()) == [
        *("step", "travel [mm]", "load factor", "force [MN/m]", "largest strain")
    ]
    (last,) = path.history.tail(1).itertuples()
    shown = [float(own) for own in rows[2].split()]
    wanted = [3, 1e3 * last.travel, last.load_factor, last.force / 1e6, last.max_strain]
    assert shown == pytest.approx(wanted, rel=1e-4)


def test_files_of_a_path(bar, tmp_path):
    out = tmp_path / "out"
    lacore("solve", bar(more="animation = true\n"), "--out", out)
    table = pd.read_csv(out / "history.csv")
    assert table["end"].tolist() == pytest.approx([0.002, 0.004, 0.006])  # SI
    series = ElementTree.parse(out / "shapes" / "path.pvd").getroot().findall(".//DataSet")
    assert [float(own.get("timestep")) for own in series] == pytest.approx([0, 0.002, 0.004, 0.006])
    assert all((out / "shapes" / own.get("file")).is_file() for own in series)
    assert (out / "path.gif").read_bytes().startswith(b"GIF")
    page = (out / "index.html").read_text(encoding="utf-8")
    for text in ("pictures/path.png", "pictures/force.png", "shapes/path.pvd", "path.gif"):
        assert text in page


def test_the_script_follows_the_same_path(bar, tmp_path):
    out = tmp_path / "out"
    lacore("solve", bar(("steps = 3", POINT)), "--out", out)
    code = (out / "problem.py").read_text(encoding="utf-8")
    names = {}
    exec(compile(code, "problem.py", "exec"), names)
    stored = pd.read_csv(out / "history.csv")["load_factor"]
    assert names["path"].history["load_factor"].tolist() == pytest.approx(stored.tolist())


def test_json_of_a_path(bar, tmp_path):
    result = lacore("solve", bar(), "--out", tmp_path / "out", "--json", rendered=False)
    document = json.loads(result.stdout)
    assert document["status"] == "reached"
    assert [row["step"] for row in document["history"]] == [1, 2, 3]
    assert document["history"][0]["travel"] == pytest.approx(1)  # mm
    assert document["units"]["length"] == "mm"


def test_a_path_that_ends_early_says_why_and_keeps_its_steps(bar, tmp_path):
    """A bar that is pressed together by more than its length."""
    file = bar(("6 mm", "30 mm"), ("steps = 3", "steps = 6"), ("direction = [1", "direction = [-1"))
    result = lacore("solve", file, "--out", tmp_path / "out", rendered=False)
    assert result.exit_code == 1
    steps = int(re.search(r"path +(\d) steps to a travel of \d+ mm, inversion: ", result.stdout)[1])
    assert 0 < steps < 4
    assert len(pd.read_csv(tmp_path / "out" / "history.csv")) == steps
    assert (tmp_path / "out" / "index.html").is_file()


def test_an_interrupted_path_says_what_is_kept(bar, tmp_path, monkeypatch):
    from verification.problems import following

    def interrupt(steps, now):
        steps.finished += 1
        if steps.finished == 2:
            raise KeyboardInterrupt

    monkeypatch.setattr(following.Steps, "_count", interrupt)
    result = lacore("solve", bar(), "--out", tmp_path / "out")
    assert result.exit_code == 130
    assert "stopped after 2 steps; see " in result.stderr
    assert len(pd.read_csv(tmp_path / "out" / "history.csv")) == 2


def test_interfaces_and_approaching_bodies_and_tools_are_stated():
    stated = read_text(starters.text("upsetting"))
    pairs = [own.name for own in stated.path["approaching"]]
    assert pairs == ["billet.right|upper.block", "billet.right|lower.block"]
    turned = starters.text("upsetting").replace("lower = [0, 1]", 'lower = [0, 1, "9 deg/m"]')
    velocity = read_text(turned).path["control"].velocity
    assert velocity["lower"] == pytest.approx((0, 1, 0.15707963267948966))


def read_text(text):
    import tempfile
    from pathlib import Path

    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "my.toml"
        file.write_text(text, encoding="utf-8")
        return read(file)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("6 mm", "6 kPa", r"23: path.travel = '6 kPa': 'kPa' does not fit: this is in m"),
        ('"6 mm"', "-1", r"23: path.travel = -1: not a positive number"),
        ("steps = 3", "steps = 0", "24: path.steps = 0: out of range"),
        ("steps = 3", "steps = { first = 3 }", r"24: path.steps.first = 3: outside \[smallest"),
        ("steps = 3", 'scheme = "leap"', "24: path.scheme = 'leap': unknown.*'leapfrog'"),
        ("steps = 3", "selection = { within = 1 }", "24: path.selection.within = 1: .*at most 0.1"),
        ("steps = 3", 'control = { measure = "poin" }', "24: path.control.measure = 'poin'.*point"),
        ("steps = 3", POINT.replace("20 mm", "5 mm"), "24: path.control.at = .*: no vertex"),
        ("steps = 3", 'control = { measure = "time" }', "23: path.travel = '6 mm': .*this is in s"),
        ("steps = 3", 'control = { measure = "tools", velocity = { die = [0, 1] } }',
         '24: path.control.velocity.die = .*: no rigid block.*add a body of kind "block"'),
        ('travel = "6 mm"', "", "22: path: missing; add travel"),
        ("[path]", '[solve]\nrange = true\n[path]', "23: solve.range = True: .*has a table .path."),
        ("[path]", '[solve]\ncoupling = "davis"\n[path]', "23: solve.coupling = 'davis'"),
    ],
)  # fmt: skip
def test_mistakes_are_said_with_their_line(bar, tmp_path, old, new, said):
    result = lacore("solve", bar((old, new)), "--out", tmp_path / "out")
    assert result.exit_code == 2
    assert re.search(rf"bar.toml:{said}", result.stderr), result.stderr


@pytest.mark.parametrize("option", [("--range",), ("--bracket", "0.1"), ("--safety",)])
def test_analyses_of_one_shape_are_refused(bar, tmp_path, option):
    result = lacore("solve", bar(), *option, "--out", tmp_path / "out")
    assert result.exit_code == 2
    assert f"{option[0]}: applies to the load factor of one shape" in result.stderr


def test_no_footing_and_no_control(bar, tmp_path):
    text = BAR[: BAR.index('load = "rigid-footing"')]
    load = 'load = "pressure"\nbody = "bar"\nwhere = "right"\nvalue = -1\n[path]\ntravel = 0.1\n'
    file = tmp_path / "my.toml"
    file.write_text(text + load, encoding="utf-8")
    result = lacore("solve", file, "--out", tmp_path / "out")
    assert result.exit_code == 2
    assert 'path: the reference load is not one load = "rigid-footing"; give control =' in (
        result.stderr
    )


def test_read_problem_ignores_the_path(bar):
    problem = la.read_problem(bar())
    assert isinstance(problem, la.Problem)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["upsetting"])
def test_starters_with_a_path_are_followed(name, tmp_path):
    file = tmp_path / f"{name}.toml"
    file.write_text(lacore("new", name).stdout, encoding="utf-8")
    result = lacore("solve", file, "--out", tmp_path / "out")
    assert result.exit_code == 0, result.output
    script = subprocess.run(
        [sys.executable, "-W", "error", tmp_path / "out" / "problem.py"],
        capture_output=True,
        text=True,
        check=True,
    )
    told = result.stdout.split("to a travel of ")[0].split()[-2:]
    assert f"path of {' '.join(told)} to travel" in script.stdout
