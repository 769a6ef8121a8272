"""The linear programs of assemblies that `lacore fuzz` judges by: closed forms, ten decades."""

import numpy as np
import pytest

from lacore_verification.fuzz.checks.block_program import known_of
from lacore_verification.fuzz.checks.linear_program import Program, maximum
from lacore_verification.fuzz.continua.quadrature import in_cells, on_edges
from lacore_verification.fuzz.drawn.cases import recipe_of

# The programs are solved to 1e-10 of each row.
BAR = 1e-9


def box(left, right, bottom, top):
    return [[left, bottom], [right, bottom], [right, top], [left, top]]


def assembly(polygons, live, dead, friction=0.3, joints=(), held=("base",)):
    return {
        "bodies": {
            "b": {
                "kind": "blocks",
                "polygons": polygons,
                "friction": friction,
                "joints": list(joints),
            }
        },
        "reference": [{"body": "b", **live}],
        "dead": [{"body": "b", **load} for load in dead],
        "supports": [{"body": "b", "where": name} for name in held],
        "interfaces": [],
    }


BASE = box(-3, 6, -1, 0)
WEIGHT = {"load": "BodyForce", "vector": [0.0, -1.0]}
PUSH = {"load": "BodyForce", "vector": [1.0, 0.0]}


@pytest.mark.parametrize("mu", [0.2, 0.4])
def test_a_block_slides_or_topples(mu):
    """A unit square slides at mu; one that is three times as high topples at 1/3."""
    square = known_of(assembly({"base": BASE, "s": box(0, 1, 0, 1)}, PUSH, [WEIGHT], mu))
    assert square.highest == pytest.approx(mu, rel=BAR)
    assert square.lowest == pytest.approx(0.0, abs=BAR)
    tall = known_of(assembly({"base": BASE, "t": box(0, 1, 0, 3)}, PUSH, [WEIGHT], 0.5))
    assert tall.highest == pytest.approx(1 / 3, rel=BAR)


@pytest.mark.parametrize("ratio", [1e-10, 1e-5, 1.0, 1e5, 1e10])
def test_a_stone_on_a_wall_of_any_weight(ratio):
    """It slides at its own friction, however little it weighs."""
    polygons = {"base": BASE, "wall": box(0, 1, 0, 1), "stone": box(0.2, 0.8, 1, 1.2)}
    dead = [
        {"load": "BodyForce", "vector": [0.0, -1.0], "where": "wall"},
        {"load": "BodyForce", "vector": [0.0, -ratio], "where": "stone"},
    ]
    live = {"load": "BodyForce", "vector": [ratio, 0.0], "where": "stone"}
    known = known_of(assembly(polygons, live, dead, 0.9, [["wall", "stone", 0.2]]))
    assert known.highest == pytest.approx(0.2, rel=BAR)


def test_forces_outside_of_their_bounds_carry_nothing():
    """Seven blocks, one of 3e-7 of the heaviest weight that its own dead load pushes away.

    Its horizontal dead load is 0.312 of its weight, more than its friction, 0.302: it falls. The
    tolerance of a linear program is more than all of its weight.
    """
    recipe = recipe_of("weights", 1, 555)
    light = {"load": "BodyForce", "body": "wall", "vector": [0.0, -0.03533], "where": "r2b1"}
    assert light in recipe["dead"]
    assert known_of(recipe).has_load is not True


def test_words():
    between = {"base": BASE, "left": box(-1, 0, 0, 1), "mid": box(0, 1, 0, 1)}
    pressed = {"load": "BodyForce", "vector": [-1.0, 0.0], "where": "mid"}
    locked = known_of(assembly(between, pressed, [WEIGHT], held=("base", "left")))
    assert locked.locked
    assert locked.has_load is False
    hanging = {"base": BASE, "top": box(0, 1, -2, -1)}
    unsafe = known_of(assembly(hanging, PUSH, [WEIGHT]))
    assert unsafe.highest == -np.inf
    assert unsafe.has_load is False


def test_a_program_beyond_double_precision():
    """x + y = 1e10 + 1, x <= 1e10: the largest y - x is told though it is ten decades smaller."""
    program = Program(
        cost=np.array([1.0, 0.0]),
        matrix=np.array([[1.0, 1e10]]),
        right=np.array([1e10 + 1.0]),
        low=np.array([0.0, 1.0]),
        high=np.array([np.inf, np.inf]),
    )
    assert maximum(program).value == pytest.approx(1.0, rel=1e-6)


def test_quadrature_is_exact():
    """x^2 y^2 over the unit square in two triangles and as one quadrilateral: 1/9; on an edge."""
    points = np.array([[0.0, 1.0, 1.0, 0.0], [0.0, 0.0, 1.0, 1.0]])
    for cells in (np.array([[0, 0], [1, 2], [2, 3]]), np.array([[0], [1], [2], [3]])):
        places, weights = in_cells(points, cells)
        assert np.sum(weights * places[0] ** 2 * places[1] ** 2) == pytest.approx(1 / 9, rel=1e-13)
    places, weights = on_edges(np.array([[0.0], [0.0]]), np.array([[2.0], [0.0]]))
    assert np.sum(weights * places[0] ** 7) == pytest.approx(32.0, rel=1e-13)
