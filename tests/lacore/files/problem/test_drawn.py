"""Drawings by their paths, their layers and densities, and fills: as the same in Python."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

import lacore as la
from lacore.files.problem.reading import read
from lacore.files.problem.script import script
from tests.lacore.model.bodies.drawings import compas, drawn, dxf, geojson

WALL = la.masonry.running_bond(la.masonry.regular_bond(2, 3), 0.65)
FACADE_OF_GUIDE = Path(__file__).with_name("facade.toml")
FACADE = """\
[bodies.front]
kind = "drawing"
file = "{file}"
unit = "{unit}"
snap = "0.1 mm"
[bodies.front.layers]
stone = {{ friction = 0.65, density = "2400 kg/m3" }}
brick = {{ friction = {{ mu = 0.7, adhesion = "1 kPa" }}, density = "1.8 t/m3" }}
ground = {{ friction = 0.65, density = 0 }}
[[bodies.front.joints]]
between = ["stone", "brick"]
friction = 0.5
[[supports]]
body = "front"
where = {{ layer = "ground" }}
[[dead_loads]]
load = "weight"
body = "front"
[[reference_loads]]
load = "weight"
body = "front"
direction = [1, 0]
"""
ARCH = """\
[bodies."an arch"]
kind = "arch"
voussoirs = 9
inner_radius = 2
thickness = 0.5
friction = 0.6
[[supports]]
body = "an arch"
where = ["left", "right"]
[[dead_loads]]
load = "weight"
body = "an arch"
unit_weight = "20 kN/m3"
[[dead_loads]]
load = "fill"
body = "an arch"
unit_weight = "18 kN/m3"
level = 3
lateral = 0.3
[[dead_loads]]
load = "weight"
body = "an arch"
unit_weight = "1 kN/m3"
where = "{block}"
[[reference_loads]]
load = "fill"
body = "an arch"
unit_weight = 1000
level = 3
where = ["1", "2", "3"]
"""


def of_drawing(path, unit):
    """The facade in Python."""
    layers = {
        "stone": la.masonry.Layer(0.65, 2400),
        "brick": la.masonry.Layer(la.Coulomb(0.7, adhesion=1e3), 1800),
        "ground": la.masonry.Layer(0.65, 0),
    }
    own = la.masonry.read(
        path, layers, snap=1e-4, unit=unit, joint_friction={("stone", "brick"): 0.5}
    )
    return la.Problem(
        bodies={"front": own.blocks},
        supports=[la.Fix("front", own.named("ground"))],
        dead_loads=own.weight("front"),
        reference_loads=own.weight("front", (1, 0)),
    )


def arch():
    own = la.masonry.arch(9, 2.0, 0.5, friction=0.6)
    return la.Problem(
        bodies={"an arch": own},
        supports=[la.Fix("an arch", ("left", "right"))],
        dead_loads=[
            la.BodyForce("an arch", (0, -20e3)),
            *la.masonry.fill("an arch", own, 18e3, 3.0, 0.3),
            la.BodyForce("an arch", (0, -1e3), "5"),
        ],
        reference_loads=la.masonry.fill("an arch", own, 1e3, 3.0, where=("1", "2", "3")),
    )


def same(one, other):
    """The same program to the last digit, but for round-off of what units convert."""
    first, second = (la.discretise(own).program for own in (one, other))
    for own, its in (
        (first.reference_load, second.reference_load),
        (first.dead_load, second.dead_load),
        (first.contact.coefficient, second.contact.coefficient),
        (first.contact.limit, second.contact.limit),
    ):
        assert own == pytest.approx(its, rel=1e-12, abs=1e-9)


def stated(folder, text, name="own"):
    file = folder / f"{name}.toml"
    file.write_text(text, encoding="utf-8")
    return file


@pytest.mark.parametrize(
    ("write", "name", "unit"),
    [(dxf, "a.dxf", "mm"), (geojson, "a.geojson", "m"), (compas, "a.json", "m")],
)
def test_a_drawing_is_the_problem_that_python_would_make_of_it(write, name, unit, tmp_path):
    layers = drawn(WALL)
    if write is compas:  # knows of no layers but its own two
        text = FACADE.replace("stone =", "block =").replace('"stone"', '"block"')
        text = "\n".join(line for line in text.splitlines() if not line.startswith("brick"))
        text = text.replace("ground", "support").replace('["block", "brick"]', '["block", "block"]')
    else:
        text = FACADE
    write(tmp_path / name, layers)
    file = stated(tmp_path, text.format(file=name, unit=unit))
    problem = la.read_problem(file)
    assert len(problem.bodies["front"].names) == len(layers)
    if write is not compas:
        same(problem, of_drawing(tmp_path / name, unit))
    la.write_problem(problem, tmp_path / "again.toml")
    assert 'kind = "blocks"' in (tmp_path / "again.toml").read_text()
    same(la.read_problem(tmp_path / "again.toml"), problem)


def test_the_file_of_the_guide_is_solved(tmp_path):
    dxf(
        tmp_path / "facade.dxf",
        [(own.replace("brick", "stone"), ring) for own, ring in drawn(WALL)],
    )
    problem = la.read_problem(stated(tmp_path, FACADE_OF_GUIDE.read_text(encoding="utf-8")))
    state = la.solve(problem)
    assert state.status is la.Status.SOLVED
    # It is wider than high, so that it slides on its base before it topples.
    assert state.load_factor == pytest.approx(0.65, rel=state.tolerance)


def test_fills_lie_on_arches(tmp_path):
    file = stated(tmp_path, ARCH.format(block="5"))
    same(la.read_problem(file), arch())
    la.write_problem(la.read_problem(file), tmp_path / "again.toml")
    same(la.read_problem(tmp_path / "again.toml"), arch())


def test_loads_after_a_fill_are_found_on_their_lines(tmp_path):
    """The fill has become many loads: what lacore calls the tenth is the third of the file."""
    with pytest.raises(la.InputError, match=r":24: dead_loads\[2\].where = '55': no such block"):
        la.read_problem(stated(tmp_path, ARCH.format(block="55")))


@pytest.mark.parametrize("kind", ["drawing", "arch"])
def test_the_script_makes_the_same_problem(kind, tmp_path):
    text = FACADE.format(file="a.dxf", unit="mm") if kind == "drawing" else ARCH.format(block="5")
    dxf(tmp_path / "a.dxf", drawn(WALL))
    own = read(stated(tmp_path, text))
    lines = script(own.program, tmp_path)
    assert max(map(len, lines.splitlines())) <= 100
    ends = "print(la.solve(problem).load_factor)\n"
    begin = "from pathlib import Path\n\nimport lacore as la\n\n"
    (tmp_path / "own.py").write_text(f"{begin}{lines}{ends}", encoding="utf-8")
    ran = subprocess.run(
        [sys.executable, "-W", "error", tmp_path / "own.py"],
        capture_output=True,
        text=True,
        check=True,
    )
    # The same calls with the same numbers.
    assert float(ran.stdout) == pytest.approx(la.solve(own.problem).load_factor, rel=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('"a.dxf"', '"b.dxf"', r":3: bodies.front.file = 'b.dxf': no such file"),
        ('"a.dxf"', '"own.toml"', r":3: bodies.front.file = 'own.toml': a format that is not kn"),
        ('unit = "mm"', 'unit = "furlong"', r":4: bodies.front.unit = 'furlong': unknown"),
        ('"0.1 mm"', '"-1 mm"', r":5: bodies.front.snap = '-1 mm': not a positive number"),
        ('"0.1 mm"', '"1 kPa"', r":5: bodies.front.snap = '1 kPa': 'kPa' does not fit"),
        ("stone = {", "ston = {", r":6: bodies.front.layers = 'ston': .* no such layer.*'stone'"),
        ('"2400 kg/m3"', '"24 kN/m3"', r":7: .*stone.density = .*'kN/m3' does not fit: .*kg/m\^3"),
        ('"2400 kg/m3"', "-1", r":7: bodies.front.layers.stone.density = -1: not a density"),
        ("friction = 0.65, ", "friction = 33, ", r":7: .*stone.friction = 33: an angle in d"),
        ('["stone", "brick"]', '["stone", "bric"]', r":10: .*joints = 'bric': unkn.*'brick'"),
        ('layer = "ground"', 'layer = "groun"', r":15: supports\[0\].where.layer = 'groun': .*gro"),
        ('layer = "ground"', 'lay = "ground"', r":15: supports\[0\].where.lay = 'ground': unknown"),
        (
            '"front"\nwhere = { l',
            '"frnt"\nwhere = { l',
            r":14: supports\[0\].body = 'frnt': no such body; did you mean 'front'",
        ),
        ("[1, 0]", "[0, 0]", r":22: reference_loads\[0\].* not a direction"),
        (
            "direction = [1, 0]",
            'where = "stone 1"',
            r":22: reference_loads\[0\].where = 'stone 1': without unit_weight",
        ),
    ],
)
def test_what_is_wrong_is_said_with_line_and_mend(old, new, said, tmp_path):
    dxf(tmp_path / "a.dxf", drawn(WALL))
    text = FACADE.format(file="a.dxf", unit="mm")
    assert old in text
    with pytest.raises(la.InputError, match=said) as told:
        la.read_problem(stated(tmp_path, text.replace(old, new, 1)))
    assert told.value.fix


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("level = 3\nlat", "level = -9\nlat", r":18: dead_loads\[1\].level = -9: the fill covers"),
        ("lateral = 0.3", "lateral = -0.3", r":19: dead_loads\[1\].lateral = -0.3: not a number"),
        ("lateral = 0.3", "latral = 0.3", r":19: dead_loads\[1\].latral = 0.3: unknown key"),
        (
            'unit_weight = "20 kN/m3"',
            "",
            r":10: dead_loads\[0\]: missing: 'an arch' is not a drawing.*add unit_weight",
        ),
        (
            'where = ["left", "right"]',
            'where = { layer = "left" }',
            r":9: supports\[0\].where.layer = 'left': 'an arch' is not a drawing",
        ),
    ],
)
def test_what_only_drawings_and_blocks_have(old, new, said, tmp_path):
    text = ARCH.format(block="5")
    assert old in text
    with pytest.raises(la.InputError, match=said) as told:
        la.read_problem(stated(tmp_path, text.replace(old, new, 1)))
    assert told.value.fix


def test_what_is_wrong_in_a_drawing_is_said_at_its_path(tmp_path):
    geojson(tmp_path / "a.geojson", drawn(WALL))
    content = json.loads((tmp_path / "a.geojson").read_text())
    again = json.loads(json.dumps(content["features"][1]))
    again["geometry"]["coordinates"] = [
        [[x + 0.1, y] for x, y in ring] for ring in again["geometry"]["coordinates"]
    ]
    content["features"].append(again)
    (tmp_path / "a.geojson").write_text(json.dumps(content))
    with pytest.raises(la.InputError, match=r":3: bodies.front.file = 'a.geojson': layer .* over"):
        la.read_problem(stated(tmp_path, FACADE.format(file="a.geojson", unit="m")))
