"""Cells of joints that crush tile them, and stand at their centroids (T95)."""

import numpy as np
import pytest

import lacore as la
from tests.lacore.model.bodies.blocks3d.solids import L_SHAPE, box, moved, prism, voronoi


def crushing(blocks, divisions, strength=1.0):
    return la.BlockAssembly3D(blocks, 0.5, crushing=la.Crushing(strength, divisions)).joints


def on_l():
    """A box on an L: what they share is an L, too, and its hull is none of theirs."""
    return {"L": prism(L_SHAPE, 1.0), "box": box((0, 0, 1), (3, 3, 2))}


@pytest.mark.parametrize("divisions", [1, 3])
@pytest.mark.parametrize("blocks", [voronoi(12, 3)[0], on_l()], ids=["voronoi", "L"])
def test_cells_have_the_area_and_the_first_moments_of_joints(blocks, divisions):
    whole = la.BlockAssembly3D(blocks, 0.5).joints
    own = crushing(blocks, divisions)
    assert whole.count == own.count > 0
    assert np.all(own.weight > 0)
    area = np.bincount(own.joint, own.weight)
    # Sums of a hundred areas, which are differences of products of coordinates about 1.
    assert np.abs(area - whole.area).max() < 1e-12
    fine = crushing(blocks, 4)
    for one, other in zip(own.points, fine.points, strict=True):
        moments = [np.bincount(j.joint, j.weight * x) for j, x in ((own, one), (fine, other))]
        assert np.abs(moments[0] - moments[1]).max() < 1e-12


def test_cells_of_a_square_are_rows_at_the_squares_of_n():
    own = crushing({"a": box((0, 0, 0), (2, 2, 1)), "b": box((0, 0, 1), (2, 2, 2))}, 2)
    ends = np.array([0, 0.25, 1, 1.75, 2])
    assert np.allclose(np.unique(own.points[0].round(12)), (ends[1:] + ends[:-1]) / 2)
    assert np.allclose(np.unique(own.weight.round(12)), np.unique(np.outer(*2 * [[0.25, 0.75]])))


def test_points_lie_in_their_joint_whichever_block_comes_first():
    blocks, shared = voronoi(12, 3)
    assembly = la.BlockAssembly3D(dict(reversed(blocks.items())), 0.5, crushing=1.0)
    own, names = assembly.joints, assembly.names
    for joint in range(own.count):
        pair = tuple(sorted((names[own.slave[joint]], names[own.master[joint]])))
        corners = shared[pair]
        points = own.points[:, own.joint == joint].T
        assert np.all(points >= corners.min(axis=0) - 1e-9)
        assert np.all(points <= corners.max(axis=0) + 1e-9)


def test_a_shape_far_away_and_small_has_the_same_cells():
    blocks = on_l()
    away = {name: moved(own, shift=(300, -200, 50), scale=1e-2) for name, own in blocks.items()}
    near, far = crushing(blocks, 3), crushing(away, 3)
    # Coordinates of 300 keep 6e-14 of it; points are that beside a size of 1e-2.
    assert np.allclose(far.weight, 1e-4 * near.weight, rtol=0, atol=1e-14 * 300)
    shift = np.array([[300], [-200], [50]])
    assert np.allclose(far.points - shift, 1e-2 * near.points, rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("given", "field"),
    [
        ({"strength": 0.0}, "Crushing.strength"),
        ({"strength": -1.0}, "Crushing.strength"),
        ({"strength": np.nan}, "Crushing.strength"),
        ({"strength": np.inf}, "Crushing.strength"),
        ({"strength": 1.0, "divisions": 0}, "Crushing.divisions"),
        ({"strength": 1.0, "divisions": 1.5}, "Crushing.divisions"),
        ({"strength": 1.0, "divisions": 33}, "Crushing.divisions"),
    ],
)
def test_what_is_no_strength_is_refused(given, field):
    with pytest.raises(la.InputError, match=field.replace(".", r"\.")):
        la.Crushing(**given)


def test_a_bare_strength_is_one():
    own = la.BlockAssembly3D({"a": box((0, 0, 0), (1, 1, 1))}, 0.5, crushing=3e6)
    assert own.crushing == la.Crushing(3e6)
    assert "3000000 Pa" in repr(own.facts())


BUILT = [
    lambda f: la.masonry3d.arch(5, 1.0, 0.2, 0.5, 0.6, crushing=f),
    lambda f: la.masonry3d.barrel_vault(5, 2, 1.0, 0.2, 1.0, 0.6, crushing=f),
    lambda f: la.masonry3d.corner((2, 2), 2, 0.6, crushing=f),
    lambda f: la.masonry3d.cross_vault(3, 1.0, 0.2, 1.5, 0.6, crushing=f),
    lambda f: la.masonry3d.dome(4, 2, 1.0, 0.2, 0.3, 0.6, crushing=f),
    lambda f: la.masonry3d.stairs(2, 0.3, 0.2, 1.0, 0.1, 0.6, crushing=f),
    lambda f: la.masonry3d.wall(([1, 1],), 0.6, crushing=f),
]


@pytest.mark.parametrize("build", BUILT)
def test_builders_take_it(build):
    assert build(2e6).crushing == la.Crushing(2e6)
    assert build(None).crushing is None
