"""Tetrahedra from files, of gmsh and others, and above sections of triangles."""

from math import cos, pi, sin, sqrt
from pathlib import Path

import meshio
import numpy as np
import pytest
from skfem import MeshTet, MeshTri

import lacore as la
from lacore.model.meshes.solid.checks import check_tetrahedra
from lacore.model.meshes.solid.shape import signed_volumes
from tests.lacore.tetrahedra import CRITERION

FOOTING = Path(__file__).parent / "footing.msh"
UNIT = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]


def on_symmetry(x):
    return np.abs(x[0] - x[1]) < 1e-9


def test_names_of_a_file_of_gmsh():
    mesh = la.meshes.read(FOOTING)
    check_tetrahedra(mesh, "mesh")
    size = np.abs(signed_volumes(mesh))
    assert size.sum() == pytest.approx(2.0, rel=1e-12)
    assert size[mesh.subdomains["under"]].sum() == pytest.approx(0.5, rel=1e-12)
    assert size[mesh.subdomains["beside"]].sum() == pytest.approx(1.5, rel=1e-12)
    for name, axis, at in (("front", 1, 0), ("right", 0, 2), ("bottom", 2, -1), ("footing", 2, 0)):
        np.testing.assert_allclose(mesh.p[axis][mesh.facets[:, mesh.boundaries[name]]], at)
    assert mesh.p[0][mesh.facets[:, mesh.boundaries["footing"]]].max() == 1
    under = la.meshes.read(FOOTING, surface="under")
    assert under.nelements == mesh.subdomains["under"].size
    with pytest.raises(la.InputError, match=r"(?s)group of volumes.*under"):
        la.meshes.read(FOOTING, surface="undr")


def test_homogeneous_compression_exactly_on_a_mesh_of_gmsh():
    """Uniform stress and strain rate are in every space, on any mesh."""
    body = la.Body(la.meshes.read(FOOTING), CRITERION, kinematics="3d", space="p1-disc")
    assert body.geometry == "exact"
    problem = la.Problem(
        {"clay": body},
        [la.Pressure("clay", lambda x: x[2] == 0)],
        [la.Fix("clay", where, "normal") for where in ("front", "bottom", on_symmetry)],
    )
    low, high = (f(problem, "interior_point") for f in (la.lower_bound, la.upper_bound))
    assert low.load_factor == pytest.approx(sqrt(3), rel=1e-7)  # the backend's tolerance
    assert high.load_factor == pytest.approx(sqrt(3), rel=1e-7)


@pytest.mark.parametrize("ending", ["vtu", "msh", "npz"])
def test_round_trip(tmp_path, ending):
    mesh = la.meshes.box((0, 2), (0, 1), (0, 1), 2, 1, 1)
    path = tmp_path / f"box.{ending}"
    if ending == "npz":
        la.meshes.save(mesh, path)
        again = la.meshes.load(path)
        for name, own in mesh.boundaries.items():
            np.testing.assert_array_equal(again.boundaries[name], own)
    else:
        meshio.Mesh(mesh.p.T, [("tetra", mesh.t.T)]).write(path)
        again = la.meshes.read(path)
    np.testing.assert_array_equal(again.p, mesh.p)
    np.testing.assert_array_equal(np.sort(again.t, axis=0), np.sort(mesh.t, axis=0))


def _write(path, points, tetrahedra):
    cells = [("tetra10" if len(tetrahedra[0]) == 10 else "tetra", np.array(tetrahedra))]
    meshio.Mesh(np.array(points, dtype=float), cells).write(path)
    return path


def test_second_order_is_reduced_to_its_vertices(tmp_path):
    ends = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))
    corner = np.array(UNIT, dtype=float)
    points = np.concatenate([corner, [(corner[a] + corner[b]) / 2 for a, b in ends]])
    path = _write(tmp_path / "two.vtu", points, [range(10)])
    np.testing.assert_array_equal(la.meshes.read(path).p.T, corner)
    points[9] += 0.01
    path = _write(tmp_path / "two.vtu", points, [range(10)])
    with pytest.raises(la.InputError, match=r"curved edge.*first order"):
        la.meshes.read(path)


@pytest.mark.parametrize(
    ("points", "tetrahedra", "match"),
    [
        ([*UNIT, (1, 1, 1e-8)], [(0, 1, 2, 3), (0, 1, 2, 4)], "slivers"),
        ([*UNIT, (0.2, 0.2, 0.2)], [(0, 1, 2, 3), (1, 2, 3, 4)], "inverted"),
        ([*UNIT[:3], (1, 1, 0)], [(0, 1, 2, 3)], "without volume"),
        ([*UNIT, *(np.array(UNIT) + 5.0)], [(0, 1, 2, 3), (4, 5, 6, 7)], "joined by no .* face"),
    ],
)
def test_bad_elements_of_files_are_refused_with_their_place(tmp_path, points, tetrahedra, match):
    mesh = la.meshes.read(_write(tmp_path / "bad.vtu", points, tetrahedra))
    with pytest.raises(la.InputError, match=match):
        la.Body(mesh, CRITERION, kinematics="3d")


def test_sides_that_are_no_faces_are_refused(tmp_path):
    cells = [("tetra", np.array([(0, 1, 2, 3)])), ("triangle", np.array([(0, 1, 4)]))]
    tags = [np.array([2]), np.array([1])]
    file = meshio.Mesh(
        np.array([*UNIT, (1, 1, 1)], dtype=float),
        cells,
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={"side": np.array([1, 2]), "all": np.array([2, 3])},
    )
    meshio.gmsh.write(tmp_path / "bad.msh", file, fmt_version="2.2", binary=False)
    with pytest.raises(la.InputError, match=r"(?s)triangle of the group 'side'.*no face"):
        la.meshes.read(tmp_path / "bad.msh")


def test_a_prism_keeps_the_names_of_its_section():
    section = la.meshes.rectangle((0, 2), (0, 1), 4, 2).with_subdomains(
        {"west": lambda x: x[0] < 1}
    )
    mesh = la.meshes.extruded(section, (1, 3), 3, (1, 2.0))
    check_tetrahedra(mesh, "mesh")
    size = np.abs(signed_volumes(mesh))
    assert size.sum() == pytest.approx(4.0, rel=1e-12)
    assert size[mesh.subdomains["west"]].sum() == pytest.approx(2.0, rel=1e-12)
    assert mesh.p[0][mesh.t[:, mesh.subdomains["west"]]].max() == 1
    sides = [("start", 2, 1), ("end", 2, 3), ("left", 0, 0), ("right", 0, 2), ("bottom", 1, 0)]
    for name, axis, at in [*sides, ("top", 1, 1)]:
        np.testing.assert_array_equal(mesh.p[axis][mesh.facets[:, mesh.boundaries[name]]], at)
    named = np.concatenate([*mesh.boundaries.values()])
    np.testing.assert_array_equal(np.sort(named), np.sort(mesh.boundary_facets()))


def test_a_prism_on_a_polygon_says_whether_it_stands_for_a_cylinder():
    turn = 2 * pi * np.arange(12) / 12
    rim = [(cos(angle), sin(angle)) for angle in turn]
    fan = np.array([(0, 1 + k, 1 + (k + 1) % 12) for k in range(12)])
    section = MeshTri(np.array([(0.0, 0.0), *rim]).T.copy(), fan.T.copy())
    mesh = la.meshes.extruded(section, (0, 1), 1)
    assert la.Body(mesh, CRITERION, kinematics="3d").geometry == "approximated"
    with pytest.raises(la.InputError, match="straight-edged triangles"):
        la.meshes.extruded(MeshTet(), (0, 1), 1)
    twice = section.with_boundaries({"end": section.boundary_facets()})
    with pytest.raises(la.InputError, match="names of the ends"):
        la.meshes.extruded(twice, (0, 1), 1)


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"x": (1, 0)}, r"^x = \(1, 0\)"),
        ({"y": 3}, "^y = 3"),
        ({"nz": 0}, "^nz = 0"),
        ({"grade_z": (4, 2.0)}, "^grade_z"),
    ],
)
def test_errors_of_boxes_name_what_was_given(change, match):
    given = {"x": (0, 1), "y": (0, 1), "z": (0, 1), "nx": 1, "ny": 1, "nz": 1}
    with pytest.raises(la.InputError, match=match):
        la.meshes.box(**{**given, **change})
