"""Meshes: graded rows, rectangles, fans, the quarter ring, split elements."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from skfem import MeshHex

import lacore as la
from lacore.model.meshes.structured import graded

ROUND_OFF = 1e-12  # of lengths of order one, after some hundred operations


def areas(mesh):
    a, b, c = np.moveaxis(mesh.p[:, mesh.t], 1, 0)
    return ((b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0]) / 2


@given(
    start=st.floats(-1e3, 1e3),
    length=st.floats(1e-3, 1e3),
    place=st.floats(0, 1),
    cells=st.integers(2, 60),
    ratio=st.floats(1, 100),
)
def test_graded_row(start, length, place, cells, ratio):
    stop = start + length
    at = min(start + place * length, stop)
    # A point within an ulp's reach of an end cannot be a vertex of its own.
    assume(min(at - start, stop - at) == 0 or min(at - start, stop - at) > 1e-6 * length)
    row = graded(start, stop, cells, (at, ratio))
    assert row.shape == (cells + 1,)
    assert row[0] == start
    assert row[-1] == stop
    assert at in row, "the point is a vertex, exactly"
    assert np.all(np.diff(row) > 0)
    size = np.diff(row)
    right, left = size[row[:-1] >= at], size[row[1:] <= at]
    # Cells grow away from the point; tolerance: cancellation in differences of coordinates.
    slack = 1e-12 * max(abs(start), abs(stop), length)
    assert np.all(np.diff(right) >= -slack)
    assert np.all(np.diff(left) <= slack)


@pytest.mark.parametrize("ratio", [1.0, 4.0, 20.0])
def test_ratio_of_largest_to_smallest_cell(ratio):
    # Cell size is e^(share) of distance: across a cell it varies by ratio^(1/cells), hence within
    # one cell's growth of the ratio asked for.
    cells = 64
    size = np.diff(graded(0.0, 1.0, cells, (0.0, ratio)))
    assert ratio ** (1 - 2 / cells) <= size[-1] / size[0] * (1 + ROUND_OFF)
    assert size[-1] / size[0] <= ratio * (1 + ROUND_OFF)


def test_without_grade_cells_are_equal():
    assert np.allclose(np.diff(graded(-1, 2, 6)), 0.5, atol=ROUND_OFF)


@pytest.mark.parametrize(
    ("arguments", "parts"),
    [
        ((1, 0, 3), ("extent", "not an interval")),
        ((0, np.nan, 3), ("extent", "not an interval")),
        ((0, np.inf, 3), ("extent", "not an interval")),
        ((0, 1, 0), ("cells", "at least one")),
        ((0, 1, 2.5), ("cells", "2.5")),
        ((0, 1, 3, (2.0, 4)), ("grade", "outside", "move it inside")),
        ((0, 1, 3, (np.nan, 4)), ("grade", "outside")),
        ((0, 1, 3, (0.0, 0.5)), ("grade", "ratio >= 1")),
        ((0, 1, 3, 4.0), ("grade = 4.0", "(at, ratio)")),
        ((0, 1, 3, (0.0, np.nan)), ("grade", "ratio >= 1")),
        ((0, 1, 1, (0.5, 4)), ("cells", "at least two")),
    ],
)
def test_graded_refuses(arguments, parts):
    with pytest.raises(la.InputError) as caught:
        graded(*arguments)
    assert all(part in str(caught.value) for part in parts)


@given(
    nx=st.integers(1, 6),
    ny=st.integers(1, 6),
    width=st.floats(0.1, 10),
    height=st.floats(0.1, 10),
    crossed=st.booleans(),
    ratio=st.floats(1, 30),
)
def test_rectangle(nx, ny, width, height, crossed, ratio):
    mesh = la.meshes.rectangle(
        (-1, -1 + width), (2, 2 + height), nx, ny, crossed, (-1, ratio), (2 + height, ratio)
    )
    assert mesh.nelements == nx * ny * (4 if crossed else 2)
    # Sum of positive areas is that of the rectangle: no gap, no overlap.
    assert np.abs(areas(mesh)).sum() == pytest.approx(width * height, rel=ROUND_OFF)
    assert sorted(mesh.boundaries) == ["bottom", "left", "right", "top"]
    lines = {"left": (0, -1), "right": (0, -1 + width), "bottom": (1, 2), "top": (1, 2 + height)}
    for name, (axis, value) in lines.items():
        facets = mesh.boundaries[name]
        assert facets.size == (ny if axis == 0 else nx)
        assert np.allclose(mesh.p[axis, mesh.facets[:, facets]], value, atol=1e-11)
    la.Body(mesh, la.VonMises(shear_strength=1.0))  # accepted as it is


@given(n_radial=st.integers(1, 5), n_angular=st.integers(2, 8), ratio=st.floats(1, 5), cross=...)
def test_quarter_ring(n_radial: int, n_angular: int, ratio: float, cross: bool):
    inner, outer = 1.0, 2.0
    mesh = la.meshes.quarter_ring(inner, outer, n_radial, n_angular, cross, ratio)
    la.Body(mesh, la.VonMises(shear_strength=1.0), geometry="approximated")
    assert sorted(mesh.boundaries) == ["bore", "outside", "x_axis", "y_axis"]
    ends = {name: mesh.p[:, mesh.facets[:, f].ravel()] for name, f in mesh.boundaries.items()}
    assert np.allclose(np.linalg.norm(ends["bore"], axis=0), inner, rtol=ROUND_OFF)
    assert np.allclose(np.linalg.norm(ends["outside"], axis=0), outer, rtol=ROUND_OFF)
    assert np.all(ends["x_axis"][1] == 0)
    assert np.all(ends["y_axis"][0] == 0)
    # The polygon of n chords over a quarter circle of radius R has the area (n/2) R^2 sin(pi/2n).
    polygon = n_angular / 2 * np.sin(np.pi / 2 / n_angular) * (outer**2 - inner**2)
    assert np.abs(areas(mesh)).sum() == pytest.approx(polygon, rel=ROUND_OFF)


@pytest.mark.parametrize("inner", [0.0, -1.0, float("nan")])
def test_quarter_ring_refuses_its_inner_radius(inner):
    with pytest.raises(la.InputError, match="inner"):
        la.meshes.quarter_ring(inner, 2.0, 2, 2)


@pytest.mark.parametrize("place", [0.0, 1e3, 1e6])
@pytest.mark.parametrize("height", [1.0, 100.0])
def test_boundary_names_wherever_and_however_slim(place, height):
    mesh = la.meshes.rectangle((place, place + 1), (place, place + height), 20, 2)
    sizes = {name: facets.size for name, facets in mesh.boundaries.items()}
    assert sizes == {"left": 2, "right": 2, "bottom": 20, "top": 20}


def test_quarter_ring_of_cells_thinner_than_their_bulge():
    # Half the thickness, 1/32, is below the bulge R (1 - cos(pi/16)) = 0.038 of the outer arc.
    mesh = la.meshes.quarter_ring(1.0, 2.0, 16, 4)
    la.Body(mesh, la.VonMises(shear_strength=1.0), geometry="approximated")


@given(
    place=st.sampled_from([0.0, 0.3, 1.0]),
    height=st.sampled_from([0.0, 0.6, 1.0]),
    sectors=st.integers(8, 20).map(lambda half: 2 * half),
    rings=st.integers(1, 12),
    cross=st.booleans(),
)
def test_fan(place, height, sectors, rings, cross):
    """A whole rectangle of proper elements, its sides named, equal sectors at the point."""
    at = (4 * place, -2 + 2 * height)
    mesh = la.meshes.fan((0, 4), (-2, 0), at, sectors, rings, crossed=cross)
    la.Body(mesh, la.VonMises(shear_strength=1.0))  # no gaps, nothing folded
    area = np.abs(areas(mesh))
    assert area.sum() == pytest.approx(8.0, rel=ROUND_OFF)
    named = np.concatenate(list(mesh.boundaries.values()))
    assert np.array_equal(np.sort(named), mesh.boundary_facets())
    (centre,) = np.flatnonzero((mesh.p[0] == at[0]) & (mesh.p[1] == at[1]))
    around = mesh.t[:, (mesh.t == centre).any(axis=0)]
    spokes = np.setdiff1d(around, centre)
    if rings > 1:
        turn = np.sort(np.arctan2(*(mesh.p[:, spokes] - mesh.p[:, [centre]])[::-1]))
        gaps = np.diff(np.append(turn, turn[0] + 2 * np.pi))
        inside = gaps[gaps < np.pi / 4]  # the others are outside of the rectangle
        # Rays bend in proportion to the square of the distance, by half a sector at the end.
        reach = np.linalg.norm(mesh.p[:, spokes] - mesh.p[:, [centre]], axis=0).max()
        assert np.allclose(inside, np.pi / sectors, rtol=reach, atol=ROUND_OFF)
    full = {0: 2 * sectors, 1: sectors, 2: sectors // 2}[
        sum(v in (0.0, 1.0) for v in (place, height))
    ]
    assert around.shape[1] == full


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"at": (5, 0)}, "outside"),
        ({"sectors": 7}, "even"),
        ({"sectors": 2}, "even"),
        ({"rings": 0}, "at least one"),
        ({"y": (-0.01, 0)}, "too few for the corners"),
    ],
)
def test_fan_refuses(change, words):
    given_ = {"x": (0, 4), "y": (-2, 0), "at": (1, 0), "sectors": 8, "rings": 4}
    with pytest.raises(la.InputError, match=words):
        la.meshes.fan(**(given_ | change))


def test_split_keeps_the_boundary():
    mesh = la.meshes.rectangle((0, 2), (0, 1), 3, 2, crossed=False)
    finer = la.meshes.split(mesh, [0, 3, 3])
    assert finer.nelements == mesh.nelements + 4
    assert np.abs(areas(finer)).sum() == pytest.approx(2.0, rel=ROUND_OFF)
    for name, facets in mesh.boundaries.items():
        middle, its = (
            m.p[:, m.facets[:, f]].mean(axis=1)
            for m, f in ((mesh, facets), (finer, finer.boundaries[name]))
        )
        assert np.array_equal(middle, its)
    with pytest.raises(la.InputError, match="not elements"):
        la.meshes.split(mesh, [mesh.nelements])


def dependent_divergences(mesh):
    """How many linear pressures, but for those of edges outside, no velocity of degree 2 feels."""
    soil = la.Body(mesh, la.VonMises(1.0), space="p2-gauss")
    stated = la.Problem({"soil": soil}, [la.Pressure("soil", "top", 1.0)])
    (group,) = la.discretise(stated).full.groups
    rows = group.volumetric.toarray()
    return rows.shape[0] - np.linalg.matrix_rank(rows)


MESHES = {
    "rectangle": la.meshes.rectangle((0, 2), (0, 1), 3, 2, grade_x=(0, 3)),
    "turned": la.meshes.rectangle((0, 2), (0, 1), 3, 2).translated((1, 0)),
    "fan": la.meshes.fan((0, 2), (-1, 0), (0.5, 0), 4, 2),
}


@pytest.mark.parametrize("mesh", MESHES)
def test_centres_off_the_diagonals_leave_no_pressure_unfelt(mesh):
    """Scott and Vogelius: one for each crossed cell, and none if no vertex is singular."""
    plain = MESHES[mesh]
    moved = la.meshes.unaligned(plain)
    assert dependent_divergences(plain) > 0 == dependent_divergences(moved)
    assert np.array_equal(moved.t, plain.t)
    assert np.abs(areas(moved)).sum() == pytest.approx(np.abs(areas(plain)).sum(), rel=ROUND_OFF)
    assert moved.boundaries.keys() == plain.boundaries.keys()
    at = np.any(moved.p != plain.p, axis=0)
    assert not at[plain.boundary_nodes()].any()


def test_centres_move_to_shares_of_their_cell_from_its_lower_left():
    moved = la.meshes.unaligned(la.meshes.rectangle((1, 3), (0, 1), 1, 1), (0.7, 0.64))
    centre = np.setdiff1d(np.arange(moved.nvertices), moved.boundary_nodes())
    assert moved.p[:, centre].ravel() == pytest.approx([2.4, 0.64], rel=ROUND_OFF)


def test_meshes_without_crossed_cells_stay():
    mesh = la.meshes.rectangle((0, 2), (0, 1), 3, 2, crossed=False)
    assert np.array_equal(la.meshes.unaligned(mesh).p, mesh.p)


@pytest.mark.parametrize("to", [(0.5, 0.5), (0.3, 0.7), (1.0, 0.6), (float("nan"), 0.6)])
def test_centres_stay_within_and_off_the_diagonals(to):
    with pytest.raises(la.InputError, match="off its diagonals"):
        la.meshes.unaligned(la.meshes.rectangle((0, 2), (0, 1), 3, 2), to)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (lambda: la.meshes.read(["soil.msh"]), "path = .*no path"),
        (lambda: la.meshes.load(3), "path = 3: no path"),
        (lambda: la.meshes.layered((0, 1), [(0, 1)], 2, 2), "layers = .*no mapping; give {name:"),
        (
            lambda: la.meshes.patches(la.meshes.rectangle((0, 1), (0, 1), 1, 1)),
            "no list of patches",
        ),
        (lambda: la.meshes.save(la.meshes.rectangle((0, 1), (0, 1), 1, 1), None), "path: None: no"),
        (
            lambda: la.meshes.isoparametric(la.meshes.rectangle((0, 1), (0, 1), 1, 1), 2),
            "onto = 2: cannot be called",
        ),
    ],
)
def test_what_is_of_another_kind_is_refused_by_name(wrong, said):
    with pytest.raises(la.InputError, match=said):
        wrong()


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        (lambda: la.meshes.layered((0, 1), {"clay": (0, 1)}, 2, 0), "ny = 0: not a positive whole"),
        (lambda: la.meshes.layered((1, 0), {"clay": (0, 1)}, 2, 2), "x = "),
        (lambda: la.meshes.layered((0, 1), {"clay": (0, 1)}, 0, 2), "nx = 0"),
        (
            lambda: la.meshes.save(MeshHex(), "own.npz"),
            "mesh = 'MeshHex1': no body has such a mesh",
        ),
    ],
)
def test_what_makes_no_mesh_of_a_body_is_refused_by_its_own_name(
    wrong, said, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(la.InputError, match=said):
        wrong()
    assert not list(tmp_path.iterdir())


def test_patches_with_other_cells_on_a_side_say_so():
    left = la.meshes.Patch([(0, 0), (1, 0), (1, 1), (0, 1)], nx=2, ny=2)
    right = la.meshes.Patch([(1, 0), (2, 0), (2, 1), (1, 1)], nx=2, ny=3)
    with pytest.raises(la.InputError, match=r"parts: hanging nodes, .* as many cells \(nx, ny\)"):
        la.meshes.patches([left, right])


@pytest.mark.parametrize(
    "asked",
    [
        la.meshes.quality,
        la.meshes.unaligned,
        la.meshes.named,
        lambda mesh: la.meshes.remeshed(mesh, size=0.5),
        lambda mesh: la.meshes.split(mesh, [0]),
        lambda mesh: la.meshes.save(mesh, "mesh.npz"),
    ],
)
def test_a_body_in_place_of_its_mesh_is_told_so(asked):
    body = la.Body(la.meshes.rectangle((0, 1), (0, 1), 1, 1), la.VonMises(1.0))
    with pytest.raises(la.InputError, match=r"mesh = .*: no Mesh.*; give .* is body\.mesh"):
        asked(body)
