"""What lies in each other is told with the place and the depth."""

import pytest
import shapely

import lacore as la
from lacore.files.problem.apart import require_apart
from lacore.model.bodies.blocks.overlap import depth_of, overlap_told

GROUND = """\
[bodies.soil]
kind = "continuum"
mesh = { shape = "rectangle", x = [0, 2], y = [-2, 0], nx = 4, ny = 4 }
material = { criterion = "von-mises", shear_strength = "10 kPa" }
[bodies.stone]
kind = "block"
outline = [[0.5, BASE], [1.5, BASE], [1.5, 1], [0.5, 1]]
[[supports]]
body = "soil"
where = "bottom"
[[interfaces]]
slave = { body = "stone", where = { y = BASE } }
master = { body = "soil", where = "top" }
friction = "bond"
[[reference_loads]]
load = "point-force"
body = "stone"
at = "block"
vector = [0, "-1 kN/m"]
"""
SECOND = """\
[bodies.other]
kind = "block"
outline = [[LEFT, 0], [1.8, 0], [1.8, 1], [LEFT, 1]]
[[interfaces]]
slave = { body = "other", where = { y = 0 } }
master = { body = "soil", where = "top" }
friction = "bond"
"""
WALL = """\
[bodies.wall]
kind = "blocks"
friction = 0.5
[bodies.wall.blocks]
low = [[0, 0], [1, 0], [1, 1], [0, 1]]
high = [[0, 0.98], [1, 0.98], [1, 2], [0, 2]]
[[supports]]
body = "wall"
where = "low"
[[reference_loads]]
load = "weight"
body = "wall"
unit_weight = "20 kN/m3"
direction = [1, 0]
"""


def read(folder, text):
    file = folder / "my.toml"
    file.write_text(text, encoding="utf-8")
    return la.read_problem(file)


@pytest.mark.parametrize(
    ("text", "line", "said"),
    [
        (
            GROUND.replace("BASE", "-0.05"),
            5,
            r"soil and stone overlap at \(1, -0.025\) m, 0.05 m deep, over 0.05 m\^2; move one",
        ),
        (
            GROUND.replace("BASE", "0") + SECOND.replace("LEFT", "1.2"),
            20,
            r"stone and other overlap at \(1.35, 0.5\) m, 0.3 m deep, over 0.3 m\^2",
        ),
        (WALL, 4, r"these blocks overlap at \(0.5, 0.99\) m, 0.02 m deep, over 0.02 m\^2"),
    ],
)
def test_bodies_and_blocks(tmp_path, text, line, said):
    with pytest.raises(la.InputError, match=rf"my.toml:{line}: bodies\..*{said}"):
        read(tmp_path, text)


def test_what_touches_is_no_overlap(tmp_path):
    text = GROUND.replace("BASE", "0") + SECOND.replace("LEFT", "1.5")
    assert len(read(tmp_path, text).bodies) == 3


def test_chords_of_round_sides_are_none():
    """A quarter of a ring around one of other segments: chords cross by 1 % of the size."""
    mesh = la.meshes.quarter_ring(1.0, 2.0, 1, 4)
    around = la.meshes.quarter_ring(2.0, 3.0, 1, 5)
    require_apart({"in": la.Body(mesh, la.VonMises(1.0)), "out": la.Body(around, la.VonMises(1.0))})


def test_the_depth_is_the_least_width_of_the_largest_part():
    square = shapely.box(0, 0, 1, 1)
    turned = shapely.Polygon([(0.9, 0.5), (1.9, -0.5), (2.9, 0.5), (1.9, 1.5)])
    assert depth_of(shapely.intersection(square, turned)) == pytest.approx(0.1)
    two = shapely.union_all([shapely.box(0.5, 0.2, 3, 0.3), shapely.box(0.5, 0.6, 3, 0.8)])
    assert depth_of(shapely.intersection(square, two)) == pytest.approx(0.2)
    assert overlap_told(square, two).startswith("overlap at (0.75, ")
