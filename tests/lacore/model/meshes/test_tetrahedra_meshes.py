"""Boxes of tetrahedra, and meshes of them that cannot be right."""

import numpy as np
import pytest
from skfem import MeshTet

import lacore as la
from lacore.model.meshes.solid.bisection import bisected_tetrahedra
from lacore.model.meshes.solid.checks import check_tetrahedra
from lacore.model.meshes.solid.roundness import looks_round, solid_geometry_of
from lacore.model.meshes.solid.shape import shapes, signed_volumes

SIDES = ("left", "right", "front", "back", "bottom", "top")


@pytest.mark.parametrize(("crossed", "cell"), [(False, 6), (True, 24)])
def test_a_box_is_filled_once_and_its_sides_have_names(crossed, cell):
    mesh = la.meshes.box((0, 2), (-1, 1), (0, 3), 2, 3, 1, crossed, grade_z=None)
    assert mesh.nelements == 6 * cell
    assert np.abs(signed_volumes(mesh)).sum() == pytest.approx(12.0)
    check_tetrahedra(mesh, "mesh")
    named = np.concatenate([mesh.boundaries[name] for name in SIDES])
    np.testing.assert_array_equal(np.sort(named), np.sort(mesh.boundary_facets()))
    for name, (axis, at) in zip(
        SIDES, [(0, 0), (0, 2), (1, -1), (1, 1), (2, 0), (2, 3)], strict=True
    ):
        assert np.all(mesh.p[axis][mesh.facets[:, mesh.boundaries[name]]] == at)


def test_faces_and_elements_are_named_by_their_places(tmp_path):
    box = la.meshes.box((0, 2), (0, 1), (0, 1), 2, 1, 2)
    mesh = la.meshes.named(
        box,
        {"footing": lambda x: (x[0] <= 1) & (x[2] == 1), "side": lambda x: x[1] == 0},
        {"below": lambda x: x[2] <= 0.5, "above": lambda x: x[2] >= 0.5},
    )
    for name, area in (("footing", 1.0), ("side", 2.0)):
        corner = mesh.p[:, mesh.facets[:, mesh.boundaries[name]]]
        across = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0], axis=0)
        assert np.linalg.norm(across, axis=0).sum() / 2 == pytest.approx(area)
    volume = np.abs(signed_volumes(mesh))
    below, above = (mesh.subdomains[name] for name in ("below", "above"))
    assert volume[below].sum() == pytest.approx(volume[above].sum()) == pytest.approx(1.0)
    assert not np.intersect1d(below, above).size
    la.meshes.save(mesh, tmp_path / "own.npz")
    again = la.meshes.load(tmp_path / "own.npz")
    np.testing.assert_array_equal(again.boundaries["footing"], mesh.boundaries["footing"])


@pytest.mark.parametrize(
    ("boundaries", "regions", "match"),
    [
        ({"a": lambda x: (x[0] <= 0.7) & (x[2] == 1)}, {}, "ends inside the face around"),
        ({"a": lambda x: x[2] == 3}, {}, "no face of the boundary"),
        (
            {"a": la.Along((0, 0), (1, 0))},
            {},
            "places in the plane, and the body is three-dimensional",
        ),
        ({"a": lambda x: x[3] > 0}, {}, "fails"),
        ({}, {"a": lambda x: x[2] <= 0.7}, r"around \(.*, .*, .*\)"),
    ],
)
def test_places_that_no_faces_or_elements_fill_are_refused(boundaries, regions, match):
    box = la.meshes.box((0, 1), (0, 1), (0, 1), 2, 1, 2)
    with pytest.raises(la.InputError, match=match):
        la.meshes.named(box, boundaries, regions)


def test_cells_are_cut_along_the_planes_of_symmetry_of_a_square():
    """All of each element of a grid of cubes lies on one side of x = y (T89)."""
    mesh = la.meshes.box((0, 2), (0, 2), (0, 1), 3, 3, 2, grade_x=(1.0, 3.0), grade_y=(1.0, 3.0))
    away = (mesh.p[0] - mesh.p[1])[mesh.t]
    assert np.all((away >= 0).all(axis=0) | (away <= 0).all(axis=0))


def test_shapes_are_one_of_a_regular_tetrahedron_and_do_not_know_size():
    corner = np.array([[1.0, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]).T
    for scale in (1e-3, 1.0, 1e3):
        mesh = MeshTet(np.ascontiguousarray(scale * corner), np.array([[0], [1], [2], [3]]))
        np.testing.assert_allclose(shapes(mesh), 1.0, rtol=1e-12)


def _mesh(points, elements):
    return MeshTet(*map(np.ascontiguousarray, (np.array(points, float).T, np.array(elements).T)))


UNIT = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
TWO = [*UNIT, (1, 1, 1)]


@pytest.mark.parametrize(
    ("mesh", "match"),
    [
        (_mesh([*UNIT, (9, 9, 9)], [(0, 1, 2, 3)]), "no element uses"),
        (_mesh([*UNIT[:3], (1, 1, 0)], [(0, 1, 2, 3)]), "without volume"),
        (_mesh([*UNIT[:3], (1, 1, 1e-8)], [(0, 1, 2, 3)]), "slivers"),
        (_mesh([*UNIT, (0.2, 0.2, 0.2)], [(0, 1, 2, 3), (1, 2, 3, 4)]), "inverted"),
        (_mesh([*TWO, (2, 2, 3)], [(0, 1, 2, 3), (1, 2, 3, 4), (1, 2, 3, 5)]), "more than two"),
        (_mesh([*UNIT, *(np.array(UNIT) + 5)], [(0, 1, 2, 3), (4, 5, 6, 7)]), "disconnected"),
        (_mesh([*UNIT, *(np.array(UNIT) + 0.1)], [(0, 1, 2, 3), (4, 5, 6, 7)]), "overlap"),
        (
            _mesh(
                [*UNIT, (0.5, 0.5, 0), (1, 1, -1)],
                [(0, 1, 2, 3), (0, 1, 4, 5), (0, 2, 4, 5)],
            ),
            "hanging",
        ),
        (_mesh([*UNIT[:3], (0, 0, np.nan)], [(0, 1, 2, 3)]), "not finite"),
    ],
)
def test_what_cannot_be_right_is_refused_with_its_place(mesh, match):
    with pytest.raises(la.InputError, match=match):
        check_tetrahedra(mesh, "Body.mesh")


def test_a_ball_looks_round_and_a_box_does_not():
    ball, box = MeshTet.init_ball(), la.meshes.box((0, 1), (0, 1), (0, 1), 2, 2, 2)
    assert looks_round(ball)
    assert solid_geometry_of(ball) == "approximated"
    assert not looks_round(box)
    assert solid_geometry_of(box) == "exact"


def test_a_body_of_a_ball_proves_nothing_of_the_ball():
    ball = la.Body(MeshTet.init_ball(), la.VonMises(shear_strength=1.0), kinematics="3d")
    assert ball.geometry == "approximated"
    assert "tetrahedra" in ball.contents


def test_bisection_keeps_the_body_its_names_and_its_shapes():
    """Towards a place inside, seven times: no node hangs, none of the volume is lost."""
    mesh = la.meshes.box((0, 2), (0, 2), (-1, 0), 3, 3, 2).with_subdomains(
        {"low": lambda x: x[2] < -0.5}
    )
    worst = shapes(mesh).min()
    for _ in range(5):
        away = np.linalg.norm(mesh.p[:, mesh.t].mean(axis=1).T - [1.0, 0.7, 0.0], axis=1)
        marked = np.argsort(away)[: mesh.nelements // 5]
        finer, parents = bisected_tetrahedra(mesh, marked)
        check_tetrahedra(finer, "mesh")
        sizes = np.bincount(parents, np.abs(signed_volumes(finer)))
        np.testing.assert_allclose(sizes, np.abs(signed_volumes(mesh)), rtol=1e-10)
        assert np.bincount(parents)[marked].min() >= 2
        mesh = finer
    named = np.concatenate([mesh.boundaries[name] for name in SIDES])
    np.testing.assert_array_equal(np.sort(named), np.sort(mesh.boundary_facets()))
    assert np.all(mesh.p[2][mesh.facets[:, mesh.boundaries["top"]]] == 0)
    low = mesh.p[2][mesh.t[:, mesh.subdomains["low"]]]
    assert low.max() <= -0.5
    assert np.abs(signed_volumes(mesh))[mesh.subdomains["low"]].sum() == pytest.approx(2.0)
    assert shapes(mesh).min() > 0.2 * worst
