"""Contact points that segments share, points that a path keeps, and places at corners of shapes."""

import numpy as np
import pytest
from scipy.sparse import csr_matrix

import lacore as la
from lacore.model.contact.controls import Controls
from lacore.model.contact.laws import Laws
from lacore.model.contact.rows import ContactPoints, _along, _merged
from lacore.model.contact.shapes import outline


def merged(x, normal=(0.0, 1.0), kind=0, interface=0, moving=-1):
    """Points on the axis x, of which each stands for a length of 1, 2, ...

    All other arguments are of each point, or of all.
    """
    k = len(x)

    def each(value):
        return np.broadcast_to(value, k).astype(int)

    stand = Controls(
        np.stack([np.array(x, dtype=float), np.zeros(k)]),
        np.broadcast_to(np.array(normal, dtype=float).reshape(-1, 2), (k, 2)).T,
        np.arange(1.0, k + 1),
    )
    laws = Laws(*np.arange(4.0 * k).reshape(4, k))
    sides = np.stack([each(moving), np.full(k, -1)], axis=1)
    rows = tuple(csr_matrix(np.eye(k)[:, [own % k for own in range(k)]]) for _ in range(2))
    return _merged(stand, np.arange(k), each(kind), sides, each(interface), laws, rows)


@pytest.mark.parametrize("extent", [1e-3, 1.0, 1e4])
def test_points_at_one_place_are_one_that_stands_for_all_of_their_lengths(extent):
    """Up to a billionth of the extent of the contact."""
    found = merged(np.array([0.0, 1.0, 1.0 + 1e-10, 0.5]) * extent)
    assert found.position[:, 0] == pytest.approx(np.array([0, 0.5, 1.0]) * extent)
    assert found.weights == pytest.approx([1, 4, 5])
    assert len(merged(np.array([0.0, 1.0, 1.0 + 3e-8, 0.5]) * extent).weights) == 4


def test_a_single_place_has_no_extent():
    assert merged([3.0, 3.0]).weights == pytest.approx([3])
    assert merged([3.0]).weights == pytest.approx([1])


@pytest.mark.parametrize(
    "differ",
    [{"kind": [0, 1]}, {"interface": [0, 1]}, {"moving": [0, 1]}, {"normal": [(0, 1), (0.01, 1)]}],
    ids=str,
)
def test_points_at_one_place_that_differ_are_two(differ):
    assert len(merged([1.0, 1.0]).weights) == 1
    assert len(merged([1.0, 1.0], **differ).weights) == 2


def test_places_and_normals_on_an_axis_have_no_sign():
    assert len(merged([0.0, -0.0]).weights) == 1
    assert len(merged([1.0, 1.0], normal=[(0.0, 1.0), (-0.0, 1.0)]).weights) == 1


def test_round_off_of_directions_leaves_no_entries():
    axes = (csr_matrix([[1.0, 0.0]]), csr_matrix([[0.0, 1.0]]))
    assert _along(np.array([[1.0, 1e-14]]), axes).toarray().tolist() == [[1.0, 0.0]]
    assert _along(np.array([[1.0, 1e-14]]), axes).nnz == 1
    assert _along(np.array([[1.0, 1e-12]]), axes).toarray().tolist() == [[1.0, 1e-12]]


def test_points_that_are_kept_keep_their_gaps():
    place, moving = np.arange(6.0).reshape(3, 2), np.arange(6).reshape(3, 2)
    points = ContactPoints(place, -place, moving, ("one", "two"))
    mask = np.array([True, False, True])
    for own in (points.kept(mask), points.kept(np.array([0, 2]))):
        assert own.position.tolist() == place[[0, 2]].tolist()
        assert own.normal.tolist() == (-place[[0, 2]]).tolist()
        assert own.moving.tolist() == moving[[0, 2]].tolist()
        assert own.names == ("one", "two")
        assert own.gap is None
    gaps = ContactPoints(place, -place, moving, ("one",), gap=np.array([0.1, 0.2, 0.3]))
    assert gaps.kept(mask).gap.tolist() == [0.1, 0.3]


def test_tension_of_one_interface_is_that_of_its_points_alone():
    mesh = la.meshes.rectangle((0, 1), (0, 1), 1, 1)
    problem = la.Problem(
        {"block": la.Body(mesh, la.VonMises(1.0))},
        [la.Traction("block", "top", (1, 0))],
        interfaces=[
            la.Interface(("block", "bottom"), la.RigidObstacle(), 0.3),
            la.Interface(
                ("block", "left"), la.RigidObstacle(), la.Coulomb(0.5, adhesion=0.4, tension=0.2)
            ),
        ],
    )
    rows = la.discretise(problem).full.contact
    assert rows.tension == pytest.approx(np.where(rows.interface == 1, 0.2, 0.0))


HALF = np.sqrt(0.5)


@pytest.mark.parametrize("origin", [(0.0, 0.0), (-10.0, -10.0), (100.0, -50.0)])
def test_a_place_at_a_corner_has_the_mean_normal_of_both_sides(origin):
    """Up to a billionth of the coordinates; further off it has the direction from the corner."""
    square = np.array([(0, 0), (10, 0), (10, 10), (0, 10)]) + origin
    shape, corner = outline(square.tolist()), square[2]
    scale = np.abs(square).max()
    for angle in np.radians([10.0, 45.0, 80.0]):
        away = np.array([np.cos(angle), np.sin(angle)])
        near, far = (corner + share * scale * away for share in (1e-10, 1e-7))
        assert shape.normal(near[:, None])[:, 0] == pytest.approx([HALF, HALF])
        assert shape.normal(far[:, None])[:, 0] == pytest.approx(away, abs=1e-6)
        assert shape.distance(far[:, None])[0] == pytest.approx(1e-7 * scale, rel=1e-6)


@pytest.mark.parametrize("sign", [-1, 1])
def test_places_far_away_set_the_round_off_of_places_at_a_corner(sign):
    """Of coordinates of 1e5 m a difference of 1e-5 m is round-off, whatever their signs."""
    shape = outline([(0, 0), (-1, 0), (-1, -1), (0, -1)])
    places = np.array([[1e-5, sign * 1e5], [2e-5, sign * 1e5]])
    assert shape.normal(places)[:, 0] == pytest.approx([HALF, HALF])
    assert shape.normal(places[:, :1])[:, 0] == pytest.approx(np.array([1, 2]) / np.sqrt(5))
