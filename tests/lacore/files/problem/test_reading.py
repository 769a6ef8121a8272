"""Problem files: what they state, and what is said of those that cannot be right."""

import re

import pytest

import lacore as la
from tests.conftest import ROOT
from tests.lacore.files.problem import footing

EXAMPLE = ROOT / "examples" / "gmsh"


def test_a_file_states_the_problem_that_python_would(tmp_path):
    file = tmp_path / "footing.toml"
    file.write_text(footing.TEXT, encoding="utf-8")
    read, written = la.solve(la.read_problem(file)), la.solve(footing.problem())
    # Same numbers in the same order: the same program, but for names.
    assert read.load_factor == pytest.approx(written.load_factor, rel=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "line", "said"),
    [
        ("nx = 6", "nx = 6.5", 5, r"bodies.clay.mesh.nx = 6.5: not a whole number; give"),
        ("nx = 6", "nn = 6", 5, r"bodies.clay.mesh.nn = 6: unknown key; did you mean 'nx'\?"),
        ("nx = 6, ", "", 5, r"bodies.clay.mesh: missing; add nx"),
        ("nx = 6", "nx = 60000", 5, r"bodies.clay.mesh.nx = 60000: with ny = 2 these are 120000"),
        ("[0.5, 3]", "[0.5, 0.3]", 5, r"bodies.clay.mesh.grade_x = .*ratio .* is below 1; give"),
        ('"3 m"', "nan", 5, r"bodies.clay.mesh.x\[1\] = nan: not finite; give"),
        ('"3 m"', "true", 5, r"bodies.clay.mesh.x\[1\] = True: not a number; give"),
        ('"3 m"', '"3 kg"', 5, r"mesh.x\[1\] = '3 kg': 'kg' does not fit: this is in m; give"),
        ('"3 m"', "-3", 5, r"bodies.clay.mesh.x = .*not an interval"),
        ('"3 m"', "3, 4", 5, r"bodies.clay.mesh.x = \[0, 3, 4\]: too many values; remove"),
        ("rectangle", "rectangel", 5, r"mesh.shape = 'rectangel': unknown; did you mean 'rect"),
        ('shape = "rectangle", ', "", 5, r"bodies.clay.mesh: missing; add shape"),
        ("von-mises", "mises", 6, r"material.criterion = 'mises': unknown; did you mean 'von-m"),
        ("20 kPa", "-20 kPa", 6, r"material.shear_strength = '-20 kPa': not a positive number"),
        ("20 kPa", "20,5 kPa", 6, r"strength = '20,5 kPa': a comma in a number; write a point"),
        (", shear_strength = \"20 kPa\"", "", 6, r"bodies.clay.material: needs exactly one of"),
        ("[0, 0.5]", "[0, 0.51]", 7, r"boundaries.footing: ends inside the edge of the mesh"),
        ("y = 0 }", "y = 1 }", 7, r"boundaries.footing: no edge of the boundary is there; the me"),
        ("{ x = [0, 0.5], y = 0 }", "{ }", 7, r"boundaries.footing: neither x nor y; give one"),
        ('kind = "continuum"', "", 3, r"bodies.clay: missing; add kind"),
        ("[bodies.clay]", "[body.clay]", 3, r"body: unknown key; did you mean 'bodies'\?"),
        ('"left"', '"lft"', 11, r"supports\[0\].where = 'lft': no such boundary; did you mean 'l"),
        ('= "x"', '= "z"', 12, r"supports\[0\].components = 'z': of the plane there is no"),
        ('"clay"\nwhere = "bottom"', '"cly"\nwhere = "bottom"', 15, r"\[1\].body = 'cly': no such"),
        ("{ x = 3 }", "{ x = 4 }", 20, r"supports\[2\].where: an empty boundary"),
        ("{ x = 3 }", "3", 20, r"supports\[2\].where = 3: not a text; write it in quotes"),
        ("rigid-footing", "foot", 23, r"\[0\].load = 'foot': unknown; known names: body-force"),
        ('"footing"\ndir', '"foting"\ndir', 25, r"where = 'foting': no such boundary; did you me"),
        ("[0, -1]\npre", "[0, 0]\npre", 26, r"direction = .*is zero: a footing is driven"),
        ("[0, -1]\npre", "3\npre", 26, r"reference_loads\[0\].direction = 3: not a list; write"),
        ("[0, -1]\npre", "[0]\npre", 26, r"reference_loads\[0\].direction = \[0\]: too few values"),
        ("18 kN/m3", "18 kPa", 32, r"dead_loads\[0\].unit_weight = '18 kPa': 'kPa' does not fit"),
        ("18 kN/m3", "1e90 kN/m3", 32, r"dead_loads\[0\].unit_weight = .*: outside of"),
        ("18 kN/m3", "-18 kN/m3", 32, r"unit_weight = '-18 kN/m3': a weight below 0; give"),
        (
            '"18 kN/m3"',
            "{ levels = [-2, 0], values = [-1, 1] }",
            32,
            r"dead_loads\[0\].unit_weight.*: a weight below 0; give",
        ),
        ('shape = "rect', 'file = "soil.msh", shape = "rect', 5, r"shape = .*: is given in"),
        ('title = "Footing"', 'title = "Foo', 1, r"is not valid TOML"),
        ("[[supports]]", "[[supports]", 9, r"is not valid TOML"),
        ("nx = 6", "x.nx = 6", 5, r"is not valid TOML: a key is given twice; write key"),
        ("[[reference_loads]]", "[[dead_loads]]", 1, r"reference_loads: missing; add reference"),
    ],
)  # fmt: skip
def test_errors_say_file_line_field_value_and_mend(tmp_path, old, new, line, said):
    assert old in footing.TEXT
    file = tmp_path / "footing.toml"
    file.write_text(footing.TEXT.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(la.InputError, match=rf"^{re.escape(str(file))}:{line}:? .*{said}") as told:
        la.read_problem(file)
    assert told.value.fix


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (None, "there is no such file; give the path of a problem file"),
        (b"title = '\xff'", r":1: is not text in UTF-8; save it"),
        (b"a = " + b"[" * 5000, "nested too deeply|is not valid TOML"),
        (b"", r"path = .*is empty; `lacore new` prints problem files"),
        (b"bodies = {}", r":1: reference_loads: missing; add reference_loads"),
        (b"# a comment", r":1: bodies: missing; add bodies"),
    ],
)
def test_what_is_no_problem_file_is_refused(tmp_path, content, said):
    file = tmp_path / "footing.toml"
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(la.InputError, match=said):
        la.read_problem(file)


def test_a_mark_before_the_text_is_no_part_of_it(tmp_path):
    """Editors of Windows write one."""
    file = tmp_path / "footing.toml"
    file.write_text(footing.TEXT, encoding="utf-8-sig")
    assert list(la.read_problem(file).bodies) == ["clay"]


def test_meshes_are_found_from_the_folder_of_the_file(tmp_path, monkeypatch):
    """Wherever the command is given."""
    monkeypatch.chdir(tmp_path)
    slope = la.read_problem(_of_mesh(tmp_path, "slope.msh"))
    assert "crest" in slope.bodies["soil"].mesh.boundaries
    with pytest.raises(
        la.InputError, match=r"slope.toml:3: bodies.soil.mesh.file = 'slop.msh'.*no"
    ):
        la.read_problem(_of_mesh(tmp_path, "slop.msh"))


def _of_mesh(folder, name):
    text = f"""\
[bodies.soil]
kind = "continuum"
mesh = {{ file = "{name}" }}
material = {{ criterion = "mohr-coulomb", cohesion = 5e3, friction_angle = 30 }}
[[supports]]
body = "soil"
where = "base"
[[reference_loads]]
load = "pressure"
body = "soil"
where = "crest"
value = 1000
"""
    own = folder / "own"
    own.mkdir(exist_ok=True)
    (own / "slope.msh").write_bytes((EXAMPLE / "slope.msh").read_bytes())
    (own / "slope.toml").write_text(text, encoding="utf-8")
    return own / "slope.toml"
