"""Blocks in space that meet with an edge or a corner: refused where nothing else is there (T71)."""

from itertools import product

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import lacore as la
from tests.lacore.model.bodies.blocks3d.solids import box, moved, prism

FLOOR = box((-2, -2, -1), (4, 4, 0))
WEDGE = moved(  # an edge below, along x
    prism(((0, 0), (1, 1), (-1, 1)), 1.0), Rotation.from_matrix([[0, 0, 1], [1, 0, 0], [0, 1, 0]])
)
ALONE = {
    "edges of cubes": (
        {"a": box((0, 0, 0), (1, 1, 1)), "b": box((1, 1, 0), (2, 2, 1))},
        (1, 1, 0.5),
    ),
    "corners of cubes": (
        {
            "a": box((0, 0, 0), (1, 1, 1)),
            "plinth": box((1.5, 1.5, 0), (2, 2, 1)),
            "b": box((1, 1, 1), (2, 2, 2)),
        },
        (1, 1, 1),
    ),
    "an edge on a face": (
        {"a": WEDGE, "post": box((-0.5, -2, 0), (0, 2, 2))},
        (0.5, 0, 0),
    ),
    "edges that cross": (
        {
            "a": moved(WEDGE, Rotation.from_rotvec((0, np.pi, 0)), (0.5, 0, 1)),
            "b": moved(WEDGE, Rotation.from_rotvec((0, 0, np.pi / 2)), (0, -0.5, 1)),
            "post": box((-0.5, 0.5, 1.5), (0.5, 1, 2.5)),
        },
        (0, 0, 1),
    ),
}


def problem(blocks, held=("floor",), **options):
    return la.Problem(
        bodies={"blocks": la.BlockAssembly3D({"floor": FLOOR, **blocks}, 0.5, **options)},
        supports=[la.Fix("blocks", held)],
        dead_loads=[la.BodyForce("blocks", (0, 0, -1))],
        reference_loads=[la.BodyForce("blocks", (1, 0, 0))],
    )


@pytest.mark.parametrize("crushing", [None, 1e3])
@pytest.mark.parametrize("kind", ALONE)
def test_what_meets_with_an_edge_alone_is_refused_by_its_place(kind, crushing):
    blocks, place = ALONE[kind]
    held = ("floor", *(name for name in blocks if name == "post"))
    with pytest.raises(la.InputError, match="edge or a corner only") as found:
        problem(blocks, held, crushing=crushing)
    told = str(found.value)
    for word in ("'a'", "'floor'" if kind == "an edge on a face" else "'b'"):
        assert word in told
    given = np.array(eval(told.split("touch at ")[1].split(" m ")[0]))
    assert np.abs(given - place).max() < 1e-5


def test_what_is_held_may_touch():
    blocks, _ = ALONE["edges of cubes"]
    extra = {**blocks, "on": box((0, 0, 1), (0.9, 0.9, 2))}
    assert problem(extra, held=("floor", "a", "b"))


def test_what_is_apart_may_be_near():
    blocks = {"a": box((0, 0, 0), (1, 1, 1)), "b": box((1, 1 + 1e-3, 0), (2, 2, 1))}
    assert problem(blocks)


def test_diagonal_neighbours_of_walls_pass():
    """Cubes in stack bond touch others along edges and at corners, between faces of more."""
    cubes = {
        f"{x}{y}{z}": box((x, y, z), (x + 1, y + 1, z + 1))
        for x, y, z in product(range(3), repeat=3)
    }
    assert problem(cubes)


@pytest.mark.parametrize(
    "built",
    [
        lambda: la.masonry3d.wall(([1, 1, 1], [0.5, 1, 1, 0.5], [1, 1, 1]), 0.6, slices=2),
        lambda: la.masonry3d.dome(6, 3, 1.0, 0.2, 0.3, 0.6),
        lambda: la.masonry3d.dome(6, 3, 1.0, 0.2, 0.3, 0.6, bond=True),
        lambda: la.masonry3d.cross_vault(5, 1.0, 0.2, 1.5, 0.6),
        lambda: la.masonry3d.stairs(3, 0.3, 0.2, 1.0, 0.1, 0.6, bearing=0.2),
    ],
)
def test_what_builders_make_passes(built):
    blocks = built()
    base = tuple(n for n in blocks.names if n.startswith(("base", "above", "below", "landing")))
    assert la.Problem(
        bodies={"blocks": blocks},
        supports=[la.Fix("blocks", base)],
        dead_loads=[la.BodyForce("blocks", (0, 0, -1))],
        reference_loads=[la.BodyForce("blocks", (1, 0, 0))],
    )
