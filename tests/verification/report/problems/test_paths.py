"""`lacore solve` of files with a table [path]."""

import json
import re
import subprocess
import sys
from dataclasses import replace
from xml.etree import ElementTree

import pandas as pd
import pytest

import lacore as la
from lacore.files.problem.reading import read
from lacore_verification.report.problems import starters
from lacore_verification.report.problems.path_page import certified
from tests.verification.command_line import lacore

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
    assert max(document["certificate"].values()) <= document["tolerance"]


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
    from lacore_verification.report.problems import following

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


def test_a_path_may_end_in_a_steady_state(bar, tmp_path):
    """The force changes by less than the given tolerance."""
    file = bar(("steps = 3", "steps = 20\nuntil = { tolerance = 0.9, flow = 0.9 }"))
    assert read(file).path["until"] == la.Steady(tolerance=0.9, flow=0.9)
    result = lacore("solve", file, "--out", tmp_path / "out", rendered=False)
    assert result.exit_code == 0, result.output
    assert re.search(r"path +\d+ steps to a travel of [\d.]+ mm, steady: ", result.stdout)


def test_read_problem_ignores_the_path(bar):
    problem = la.read_problem(bar())
    assert isinstance(problem, la.Problem)


TOOL = """\
[tools.punch]
tool = "outline"
points = [["20 mm", "-5 mm"], ["30 mm", "-5 mm"], ["30 mm", "30 mm"], ["20 mm", "30 mm"]]
touches = { body = "bar", where = "right" }
velocity = [-1, 0]
friction = 0.1
"""


@pytest.fixture
def punched(tmp_path):
    """Write a file whose bar is pressed by a tool, with some changes; the path of it."""

    def written(*changes):
        begin, end = BAR.index("[[reference_loads]]"), BAR.index("[path]")
        text = BAR[:begin] + TOOL + BAR[end:]
        for old, new in changes:
            assert old in text
            text = text.replace(old, new)
        file = tmp_path / "punched.toml"
        file.write_text(text, encoding="utf-8")
        return file

    return written


def test_a_tool_drives_the_path(punched, tmp_path):
    """The force on the tool is that of the history, and its outline is in the files."""
    meshio = pytest.importorskip("meshio")
    result = lacore("solve", punched(), "--out", tmp_path / "out", rendered=False)
    assert result.exit_code == 0, result.output
    (force,) = re.findall(r"force on tools +punch \((\S+), \S+\) MN/m", result.stdout)
    *_, last = result.stdout.split("largest strain")[1].strip().splitlines()
    assert float(force) == pytest.approx(float(last.split()[2]), rel=1e-3)
    assert "load factor" not in result.stdout
    shape = meshio.read(tmp_path / "out" / "shapes" / "step-0003.vtu")
    (line,) = (own.data for own in shape.cells if own.type == "line")
    assert shape.points[line.ravel(), 0].min() == pytest.approx(0.014)  # 20 mm - 6 mm
    names = {}
    code = (tmp_path / "out" / "problem.py").read_text(encoding="utf-8")
    exec(compile(code, "problem.py", "exec"), names)
    stored = pd.read_csv(tmp_path / "out" / "history.csv")["force"]
    assert names["path"].history["force"].tolist() == pytest.approx(stored.tolist())


def test_tools_are_those_of_python(punched):
    kinds = {
        "wedge": 'tip = [1, 0]\nhalf_angle = "30 deg"\naxis = [1, 0]\nturn = "18 deg/m"',
        "disc": "centre = [1, 0]\nradius = 0.5\nabout = [1, 1]",
        "plane": 'point = [1, 0]\nnormal = [-2, 0]\nfriction = "stick"',
    }
    start = TOOL[TOOL.index("tool =") : TOOL.index("touches")]
    made = {
        name: read(punched((start, f'tool = "{name}"\n{keys}\n'), ("friction = 0.1\n", ""))).path
        for name, keys in kinds.items()
    }
    tools = {name: own["tools"]["punch"] for name, own in made.items()}
    assert tools["wedge"].shape == la.shapes.wedge((1, 0), 30, (1, 0))
    assert tools["wedge"].turn == pytest.approx(0.3141592653589793)
    assert (tools["disc"].shape, tools["disc"].about) == (la.shapes.disc((1, 0), 0.5), (1, 1))
    assert tools["plane"].shape == la.shapes.plane((1, 0), (-1, 0))
    assert tools["plane"].friction == la.STICK
    assert {own.sides for own in tools.values()} == {(("bar", "right"),)}


def test_the_outline_of_a_tool_is_read_from_a_drawing(punched, tmp_path):
    corners = [[20, -5], [30, -5], [30, 30], [20, 30], [20, -5]]
    (tmp_path / "punch.geojson").write_text(
        json.dumps({"type": "Polygon", "coordinates": [corners]}), encoding="utf-8"
    )
    stated = read(punched())
    points = TOOL[TOOL.index("points") : TOOL.index("touches")]
    drawing = 'outline = { file = "punch.geojson", unit = "mm" }\nrounding = "1 mm"\n'
    drawn = read(punched((points, drawing))).path["tools"]["punch"]
    shape = stated.path["tools"]["punch"].shape
    assert [*sum(sorted(drawn.shape.points), ())] == pytest.approx([*sum(sorted(shape.points), ())])
    assert drawn.shape.radii == pytest.approx([0.001] * 4)
    for more, said in (
        ("outline = { file = 'no.dxf' }\n", "17: tools.punch.outline.file = .*no such file"),
        ("outline = { file = 'punch.geojson' }\n", "17: tools.punch.outline: .*no unit"),
        ("", "15: tools.punch: missing; add points, or outline"),
        (points + drawing, "18: tools.punch.outline: the points are given, too"),
    ):
        result = lacore("solve", punched((points, more)), "--out", tmp_path / "out")
        assert result.exit_code == 2, result.output
        assert re.search(rf"punched.toml:{said}", result.stderr), result.stderr


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('tool = "outline"', 'tool = "outlin"', "16: tools.punch.tool = 'outlin': .*outline"),
        ('where = "right" }', 'where = "rigt" }', "18: tools.punch.touches = .*'right'"),
        ("velocity = [-1, 0]", "", "15: tools.*: no tool moves, .*such as velocity = .0, -1."),
        ('"-5 mm"], ["30 mm", "30 mm"]', '"30 mm"], ["30 mm", 0]', "17: tools.punch.points.*: not"),
        ("[path]", "[pth]", "21: pth: unknown key"),
        ('[path]\ntravel = "6 mm"\nsteps = 3\n', "", "15: tools: tools move along a path only"),
        ('[["20 mm", "-5 mm"]', '[["18 mm", "-5 mm"]',
         "15: tools.punch: overlaps body 'bar' by 1.71 mm near .20, 0. mm before it moves"),
        ("friction = 0.1", "friction = -1", "20: tools.punch.friction = -1"),
        ("[tools.punch]", "[tools.bar]", "15: tools.*a body has this name"),
        ("[path]",
         '[[reference_loads]]\nload = "pressure"\nbody = "bar"\nwhere = "top"\nvalue = 1\n[path]',
         "19: tools.punch.velocity = .*: the problem has reference loads, .*leave reference_loads"),
        ('"6 mm"', '"6 mm"\nremesh = { quality = 2 }', "23: path.remesh.quality = 2: not between"),
    ],
)  # fmt: skip
def test_mistakes_of_tools_are_said_with_their_line(punched, tmp_path, old, new, said):
    result = lacore("solve", punched((old, new)), "--out", tmp_path / "out")
    assert result.exit_code == 2, result.output
    assert re.search(rf"punched.toml:{said}", result.stderr), result.stderr


@pytest.mark.slow
@pytest.mark.parametrize("name", ["extrusion", "upsetting", "wedge"])
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


def test_a_step_whose_gap_is_unknown_or_large_is_not_certified():
    path = la.sequential(la.examples.footing(), travel=0.01, steps=2)
    assert certified(path) == "certified in each step"
    for gap in (float("nan"), 1e-3):
        worse = replace(path, history=path.history.assign(gap=[1e-9, gap]))
        assert certified(worse) == "certified in 1 of 2 steps"
