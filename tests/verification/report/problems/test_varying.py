"""What `lacore solve` finds along a number of a file that varies, against closed forms."""

import json
import re
import subprocess
import sys
from math import radians, tan

import pytest

from lacore.files.problem.source import Source
from lacore_verification.report.problems import starters
from tests.verification.command_line import lacore

CRATE = """\
[bodies.crate]
kind = "block"
outline = [[0, 0], [1, 0], [1, 0.5], [0, 0.5]]
[[interfaces]]
slave = { body = "crate", where = { y = 0 } }
master = { point = [0, 0], normal = [0, 1] }
friction = 0.4
[[dead_loads]]
load = "weight"
body = "crate"
unit_weight = "20 kN/m3"
[[reference_loads]]
load = "point-force"
body = "crate"
at = [0.5, 0.05]
vector = ["1 kN/m", 0]
"""
SLOPE = """\
[bodies.crate]
kind = "block"
outline = [[0, 0], [1, 0], [1, 0.5], [0, 0.5]]
[[interfaces]]
slave = { body = "crate", where = { y = 0 } }
master = { point = [0, 0], normal = [0, 1] }
friction = { angle = "30 deg" }
[[dead_loads]]
load = "body-force"
body = "crate"
vector = ["SIDE kN/m3", "DOWN kN/m3"]
[[reference_loads]]
load = "point-force"
body = "crate"
at = [0.5, 0.05]
vector = ["1 kN/m", 0]
"""
BEAM = """\
[solve]
units = { length = "cm" }
[bodies.beam]
kind = "frame"
nodes = { A = [0, 0], B = [5, 0] }
members = { span = ["A", "B"] }
plastic_moment = "10 kN m"
[[supports]]
body = "beam"
where = ["A", "B"]
[[reference_loads]]
load = "point-force"
body = "beam"
at = [1, 0]
vector = [0, "-1 kN"]
"""


def asked(folder, text, *options):
    """The document, its folder, and what was said."""
    file = folder / "my.toml"
    file.write_text(text, encoding="utf-8")
    out = folder / "out"
    result = lacore("solve", file, "--out", out, "--json", *options, rendered=False)
    assert result.exit_code == 0, result.output
    return json.loads(result.stdout)


@pytest.mark.parametrize(
    ("range_", "ends"),
    [
        ("at[0]=5:450 cm", (0.05, 4.5)),  # one unit for both
        ("at[0]=5 cm:4.5 m", (0.05, 4.5)),
        ("at[0]=0.5:4.5", (0.5, 4.5)),  # of SI, whatever the units of the file are
    ],
)
def test_the_ends_of_a_range_have_units(tmp_path, range_, ends):
    file = tmp_path / "my.toml"
    file.write_text(BEAM, encoding="utf-8")
    from lacore.files.problem.varied import read_varied  # here: pydantic takes a while to load

    found = read_varied(Source.of(file), range_, "--vary")
    assert (found.low, found.high) == pytest.approx(ends, rel=1e-12)
    assert found.problem(2.5).reference_loads[0].point == pytest.approx((2.5, 0.0), rel=1e-12)


@pytest.mark.parametrize(
    ("varies", "target", "unit", "value"),
    [  # it slides at mu 10 kN/m over the force
        ("friction=0.1:0.6", "3", "", 0.3),
        ("reference_loads[0].vector[0]=1:9 kN/m", "1", "kN/m", 4.0),
        ("unit_weight=5 kN/m3:40 kN/m3", "6", "kN/m^3", 30.0),
    ],
)
def test_a_critical_value_is_certified_on_both_sides(tmp_path, varies, target, unit, value):
    found = asked(tmp_path, CRATE, "--vary", varies, "--critical", target)["critical"]
    assert (found["status"], found["unit"]) == ("found", unit)
    crossing = found["crossings"][0]
    # To the width that is searched to, 1e-7 of the larger end.
    assert crossing["low"] <= value * (1 + 1e-6)
    assert crossing["high"] >= value * (1 - 1e-6)
    assert crossing["high"] - crossing["low"] < 1e-5 * value
    sides = {row["parameter"]: row["load_factor"] for row in found["table"]}
    below, above = sides[crossing["low"]], sides[crossing["high"]]
    assert (below < float(target) < above) if crossing["rises"] else (above < float(target) < below)
    assert (tmp_path / "out" / "pictures" / "critical.png").stat().st_size > 5000


def test_the_limit_is_where_dead_loads_just_stand(tmp_path):
    """The crate slides down where the slope is steeper than friction: at 20 degrees."""
    side = 20 * tan(radians(20))
    text = SLOPE.replace("SIDE", f"{side}").replace("DOWN", "-20")
    found = asked(tmp_path, text, "--vary", "angle=10 deg:40 deg", "--limit")["limit"]
    assert found["unit"] == "deg"
    assert found["value"] == pytest.approx(20.0, rel=1e-6)
    assert found["crossings"][0]["rises"]
    page = (tmp_path / "out" / "index.html").read_text(encoding="utf-8")
    assert re.search(
        r"interfaces\[0\].friction.angle = (20|19.99999\d*) deg: the structure collapses at", page
    )


def test_the_worst_position_is_told_in_the_unit_of_lengths(tmp_path):
    """A force P on a span L bears M L / (P a b): least in the middle, 4 M / (P L) = 8."""
    document = asked(tmp_path, BEAM, "--vary", "at[0]=50 cm:4.5 m", "--worst")
    found = document["worst"]
    assert document["load_factor"] == pytest.approx(10 * 5 / 4)
    assert (found["unit"], found["parameter"]) == ("cm", "reference_loads[0].at[0]")
    # Of a minimum searched to 1e-3 of the way, 4 m, and as flat as a parabola there.
    assert found["position"] == pytest.approx(250, abs=1)
    assert found["load_factor"] == pytest.approx(8, rel=1e-5)


def test_a_file_may_say_it_and_the_script_asks_the_same(tmp_path):
    says = '\n[solve]\nvary = "friction = 0.1 : 0.6"\ncritical = 3\n'
    found = asked(tmp_path, CRATE + says)["critical"]
    command = [sys.executable, str(tmp_path / "out" / "problem.py")]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert f"Critical: {found['value']:.7g}, in [{found['crossings'][0]['low']:.10g}" in said


def test_a_script_leaves_out_what_it_has_no_number_for(tmp_path):
    """An angle of friction is its tangent in Python."""
    text = SLOPE.replace("SIDE", "2").replace("DOWN", "-20")
    asked(tmp_path, text, "--vary", "angle=20 deg:40 deg", "--critical", "3")
    script = (tmp_path / "out" / "problem.py").read_text(encoding="utf-8")
    assert "# interfaces[0].friction.angle varies in the file alone" in script
    assert "la.critical" not in script


WRONG = {
    "no number of that name": (
        ("--vary", "fricton=0.1:0.6", "--critical"),
        "--vary = 'fricton=0.1:0.6': the file has no such number.*did you mean",
    ),
    "no range": (("--vary", "friction=0.1", "--critical"), "not a name and a range; write NAME"),
    "order": (("--vary", "friction=0.6:0.1", "--limit"), "LOW is not below HIGH; give LOW:HIGH"),
    "kinds": (("--vary", "friction=0.1:0.6 m", "--limit"), "my.toml:7: interfaces.0..friction"),
    "negative": (("--vary", "friction=-1:0.6", "--limit"), "my.toml:7: interfaces.0..friction"),
    "a question": (("--vary", "friction=0.1:0.6"), "--vary .*: no analysis uses this number; add"),
    "a number": (("--worst",), "--worst: needs a number that varies; add --vary"),
    "no target": (
        ("--vary", "friction=0.1:0.6", "--critical", "nan"),
        "'--critical': nan is not a finite number",
    ),
    "another dimension": (
        ("--vary", "unit_weight=1 kPa:2 kPa", "--limit"),
        "--vary = 'unit_weight=1 kPa:2 kPa': .*unit_weight = '1 kPa': 'kPa' does not fit",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_what_cannot_vary_is_refused_before_any_solve(tmp_path, name):
    options, said = WRONG[name]
    file = tmp_path / "my.toml"
    file.write_text(CRATE, encoding="utf-8")
    result = lacore("solve", file, "--out", tmp_path / "out", *options)
    assert result.exit_code == 2
    assert re.search(said, result.output), result.output
    assert not (tmp_path / "out").exists()


def test_of_several_numbers_of_a_name_more_is_asked_for(tmp_path):
    file = tmp_path / "my.toml"
    file.write_text(starters.text("frame"), encoding="utf-8")
    result = lacore("solve", file, "--vary", "vector[0]=1 kN:2 kN", "--worst")
    assert result.exit_code == 2
    assert "2 numbers of the file have this name; write more of its name: refer" in result.output


def test_a_range_that_a_file_says_has_its_line(tmp_path):
    file = tmp_path / "my.toml"
    file.write_text(CRATE + '[solve]\nlimit = true\nvary = "q=1:2"\n', encoding="utf-8")
    result = lacore("solve", file)
    assert result.exit_code == 2
    assert "my.toml:19: solve.vary = 'q=1:2': the file has no such number" in result.output
    file.write_text(CRATE + "[solve]\nlimit = true\n", encoding="utf-8")
    result = lacore("solve", file)
    assert result.exit_code == 2
    assert "my.toml:18: solve.limit = True: needs a number that varies" in result.output
