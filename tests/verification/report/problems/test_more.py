"""Questions of engineers by `lacore solve`: lines, page, script, and what cannot be asked."""

import json
import re
import subprocess
import sys

import pytest

import lacore as la
from tests.verification.command_line import lacore

PORTAL = """\
title = "Portal"

[bodies.portal]
kind = "frame"
nodes = { A = [0, 0], B = [0, 3], C = [4, 3], D = [4, 0] }
members = { left = ["A", "B"], beam = ["B", "C"], right = ["C", "D"] }
plastic_moment = "10 kN m"

[[supports]]
body = "portal"
where = ["A", "D"]
components = "clamped"

[[dead_loads]]
load = "point-force"
body = "portal"
at = [2, 3]
vector = [0, "-1 kN"]

[[reference_loads]]
load = "point-force"
body = "portal"
at = [2, 3]
vector = [0, "-1 kN"]
case = "floor"

[[reference_loads]]
load = "point-force"
body = "portal"
at = "B"
vector = ["1 kN", 0]
case = "wind"
"""
ASKED = ("stable", "sensitivity", "cases", "envelope")
PLACES = "\n[solve]\nstable = true\nsensitivity = true\ncases = true\nenvelope = true\n"


@pytest.fixture(scope="module")
def answer(tmp_path_factory):
    """Asked for in the file."""
    folder = tmp_path_factory.mktemp("more")
    (folder / "portal.toml").write_text(PORTAL + PLACES, encoding="utf-8")
    file, out = folder / "portal.toml", folder / "out"
    return folder, lacore("solve", file, "--out", out, "--json", rendered=False)


def test_each_answer_is_that_of_the_function(answer):
    _, result = answer
    assert result.exit_code == 0, result.output
    found = json.loads(result.stdout)
    assert found["stable"]["stands"] is True
    # Beam 8 M_p/L = 20 less the kN that is there; sway 4 M_p/h = 40/3.
    cases = {row["case"]: row["load_factor"] for row in found["cases"]["cases"]}
    assert cases == pytest.approx({"floor": 19.0, "wind": 40 / 3}, rel=1e-5)
    assert found["cases"]["governing"] == "wind"
    assert found["envelope"]["names"] == ["floor", "wind"]
    assert found["envelope"]["width"] <= 1e-4
    by = {row["parameter"]: row["elasticity"] for row in found["sensitivity"]["table"]}
    # Of all reference loads the elasticities add up to -1.
    live = sum(size for name, size in by.items() if name.startswith("reference_loads"))
    assert live == pytest.approx(-1.0, abs=1e-4)


def test_each_has_a_section_with_its_picture(answer):
    folder, _ = answer
    page = (folder / "out" / "index.html").read_text(encoding="utf-8")
    for name in ASKED:
        assert f"pictures/{name}.png" in page
        assert (folder / "out" / "pictures" / f"{name}.png").stat().st_size > 0


def test_the_script_asks_the_same(answer):
    folder, _ = answer
    text = (folder / "out" / "problem.py").read_text(encoding="utf-8")
    compile(text, "problem.py", "exec")
    for call in ("la.stable(", "la.sensitivity(", "la.load_cases(", "la.envelope("):
        assert call in text
    assert '"wind": [problem.reference_loads[1]]' in text


@pytest.mark.slow
def test_the_script_runs(answer):
    folder, _ = answer
    script = folder / "out" / "problem.py"
    run = subprocess.run([sys.executable, script], capture_output=True, text=True, check=True)
    assert "'wind' governs: lowest of 2 load cases, each alone" in run.stdout


WRONG = {
    "no case": ("--envelope", 'case = "wind"', "", "needs two or three cases, and the file has 1"),
    "no dead loads": ("--stable", "[[dead_loads]]", "[[reference_loads]]", "dead_loads: there is"),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_what_a_file_has_not_is_said_before_anything_is_solved(wrong, tmp_path, monkeypatch):
    monkeypatch.setattr(la, "solve", None)
    option, old, new, said = WRONG[wrong]
    file = tmp_path / "portal.toml"
    file.write_text(PORTAL.replace(old, new), encoding="utf-8")
    result = lacore("solve", file, option, "--out", tmp_path / "out")
    assert result.exit_code == 2
    assert re.search(rf"portal.toml:\d+: .*{said}", result.stderr)


def test_what_has_no_load_factor_has_no_sensitivity_and_is_still_a_page(tmp_path):
    file = tmp_path / "portal.toml"
    # No factor of floor and wind together holds up what is five times the load of the beam.
    file.write_text(PORTAL.replace("-1 kN", "-100 kN", 1), encoding="utf-8")
    out = tmp_path / "out"
    result = lacore("solve", file, "--sensitivity", "--stable", "--out", out, rendered=False)
    assert result.exit_code == 1
    assert "stable           the dead loads alone are not carried" in result.stdout
    assert "sensitivity      no result: state = 'unsafe'" in result.stdout
    assert (tmp_path / "out" / "pictures" / "stable.png").is_file()
