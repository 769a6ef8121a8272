"""What newcomers get wrong: mends speak of files, values are as files write them."""

import re

import pytest

import lacore as la
from lacore_verification.report.problems import starters

PYTHON = re.compile(r"\b(la|lacore)\.|\w\(|SMOOTH|STICK|BOND|True|False|\bNone\b|numpy|array\(")


@pytest.mark.parametrize(
    ("name", "old", "new", "said"),
    [
        (
            "masonry-wall",
            "friction = 0.75",
            "friction = -0.75",
            r':10: .*= -0.75: .*"smooth" \(no',
        ),
        ("masonry-wall", "friction = 0.75", "friction = 37", r"= 37: .*\{ angle = \"37 deg\" \}"),
        (
            "masonry-wall",
            "friction = 0.75",
            "friction = { angle = 0.64 }",
            r"0.64: this looks like radians",
        ),
        ("masonry-wall", "height = 3", "height = 9", r":11: bodies.wall.openings: it leaves the"),
        ("masonry-wall", 'where = "base"', "where = { y = 5 }", r":17: .*the blocks lie in x = 0"),
        (
            "retaining-wall",
            '"30 deg" }\nmesh',
            "0.52 }\nmesh",
            r":7: .*angle = 0.52: this looks like radians",
        ),
        (
            "retaining-wall",
            "normal = [0, 1]",
            "normal = [0, -1]",
            r"\[1\].master.normal = \[0, -1\]: t",
        ),
        ("retaining-wall", "[bodies.wall]", "[body.wall]", r":10: body: unknown.*'bodies'"),
        ("arch", 'at = "7"', "at = 7", r":25: reference_loads\[0\].at = 7: not a text; write it"),
        (
            "arch",
            '"180 deg"',
            "3.14159",
            r":10: bodies.arch.embrace = 3.14159: this looks like radians",
        ),
        ("arch", 'unit_weight = "22 kN/m3"', 'unit_weight = 1\nwhere = "q"', r":21: .*where = 'q'"),
        ("footing", "{ x = [0, 0.5], y = 0 }", "{ x = 9 }", r":20: .*the mesh lies in x = 0 to 5"),
        ("footing", 'where = "right"', "where = { x = 6 }", r":33: .*the mesh lies in x = 0 to 5"),
    ],
)
def test_mends_speak_of_files(name, old, new, said, tmp_path):
    text = starters.text(name)
    assert old in text
    file = tmp_path / f"{name}.toml"
    file.write_text(text.replace(old, new, 1), encoding="utf-8")
    with pytest.raises(la.InputError, match=said) as told:
        la.read_problem(file)
    assert told.value.fix
    assert not PYTHON.search(told.value.fix)


def test_small_angles_are_meant_where_they_have_a_unit(tmp_path):
    text = starters.text("retaining-wall").replace('"30 deg" }\nmesh', '"0.52 deg" }\nmesh')
    (tmp_path / "wall.toml").write_text(text, encoding="utf-8")
    problem = la.read_problem(tmp_path / "wall.toml")
    la.write_problem(problem, tmp_path / "again.toml")
    again = la.read_problem(tmp_path / "again.toml")
    angles = [own.bodies["fill"].criterion.friction_angle for own in (problem, again)]
    assert angles == [0.52, 0.52]


FRAME = """\
[bodies.a]
kind = "block"
outline = [[0, 0], [1, 0], [1, 1], [0, 1]]
[bodies.b]
kind = "block"
outline = [[2, 0], [3, 0], [3, 1], [2, 1]]
[[supports]]
body = "a"
where = "block"
[[interfaces]]
slave = { body = "b", where = "block" }
master = { body = "a", where = "block" }
friction = 0.5
[[reference_loads]]
load = "point-force"
body = "b"
at = [2.5, 1]
vector = [1, 0]
"""


@pytest.mark.parametrize(
    ("changes", "fields"),
    [
        (
            {'kind = "block"\noutline = [[2': 'kind = "blok"\noutline = [[2', "0.5": '"2 x"'},
            ["5: bodies.b.kind", "13: interfaces[0].friction"],
        ),
        (
            {"[[0, 0], [1, 0]": "[[0, 0], [0, 0]", "0.5": "-0.5", "[1, 0]\n": "[nan, 0]\n"},
            ["18: reference_loads[0].vector[0]"],
        ),
        (
            {"[1, 1], [0, 1]": "[0, 1], [1, 1]", "0.5": "-0.5", 'body = "b"\nat': 'body = ""\nat'},
            ["3: bodies.a.outline", "13: interfaces[0].friction"],
        ),
    ],
)
def test_all_errors_of_a_file_are_reported_at_once(changes, fields, tmp_path):
    text = FRAME
    for old, new in changes.items():
        assert old in text
        text = text.replace(old, new, 1)
    file = tmp_path / "blocks.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(la.InputError) as caught:
        la.read_problem(file)
    errors = caught.value.errors
    assert [own.field for own in errors] == [f"{file}:{field}" for field in fields]
    assert str(caught.value).splitlines() == [str(own) for own in errors]


def test_errors_of_a_file_are_in_its_units(tmp_path):
    text = FRAME.replace("0.5", '{ mu = 0.5, adhesion = "1 kPa", tension = "4 kPa" }')
    file = tmp_path / "blocks.toml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(la.InputError) as caught:
        la.read_problem(file)
    assert "adhesion/mu = 2 kPa" in caught.value.reason
    assert caught.value.fix == "give at most 2 kPa, or a larger adhesion"
