"""Outlines that look like polygons in place of curves: no value of them is called a bound."""

from dataclasses import replace

import numpy as np
import pytest
from skfem import MeshTri

import lacore as la
from lacore.model.meshes.polygonal import looks_curved

STRONG = la.VonMises(shear_strength=1.0)


def ring(n=6, body=None, **kind):
    """A quarter ring under pressure from within: exact 2 k ln 2 = 1.3863."""
    mesh = la.meshes.quarter_ring(1.0, 2.0, n // 2, n)
    return la.Problem(
        {"ring": la.Body(mesh, STRONG, **kind)},
        [la.Pressure("ring", "bore", 1.0)],
        [la.Fix("ring", "x_axis", "y"), la.Fix("ring", "y_axis", "x")],
    )


def polygon(points, cuts=1):
    """A mesh of a star-shaped polygon about the mean of its corners, sides cut in `cuts`."""
    corners = np.asarray(points, dtype=float)
    share = np.arange(cuts) / cuts
    along = np.roll(corners, -1, axis=0) - corners
    rim = (corners[:, None] + share[None, :, None] * along[:, None]).reshape(-1, 2)
    number = np.arange(len(rim))
    centre = np.full(len(rim), len(rim))
    triangles = np.stack([number, np.roll(number, -1), centre])
    return MeshTri(np.append(rim, [corners.mean(axis=0)], axis=0).T.copy(), triangles)


def circle(n):
    angle = 2 * np.pi * np.arange(n) / n
    return np.stack([np.cos(angle), np.sin(angle)], axis=1)


RECTANGLE = [(0, 0), (4, 0), (4, 1), (0, 1)]
DAM = [(0, 0), (6, 0), (4, 2), (2, 2)]  # slopes of 45 degrees, and a crest
SLOPE = [(0, -3), (6, -3), (6, 3), (4, 3), (2, 1), (0, 1)]  # toe and crest turn the other way


@pytest.mark.parametrize("cuts", [1, 2, 5])
@pytest.mark.parametrize(
    ("points", "curved"),
    [(circle(n), True) for n in (8, 16, 100)]
    + [(points, False) for points in (RECTANGLE, DAM, SLOPE, circle(3), circle(4), circle(5))],
)
def test_outlines(points, cuts, curved):
    """However sides are cut, and however it is turned and scaled."""
    mesh = polygon(points, cuts)
    assert looks_curved(mesh) == curved
    turn = np.array([[0.8, -0.6], [0.6, 0.8]])
    assert looks_curved(MeshTri(1e3 * turn @ mesh.p + 7, mesh.t)) == curved
    assert la.Body(mesh, STRONG).geometry == ("approximated" if curved else "exact")


def test_a_hole_is_seen_from_within():
    """It turns to the other side."""
    mesh = la.meshes.quarter_ring(1.0, 20.0, 4, 6)
    far = np.linalg.norm(mesh.p, axis=0) > 19
    square = mesh.p.copy()
    square[:, far] /= np.abs(square[:, far]).max(axis=0) / 20
    assert looks_curved(MeshTri(square, mesh.t))


@pytest.mark.parametrize("n", [2, 4, 6])
def test_the_maker_of_a_mesh_knows(n):
    """Also of arcs of one chord, which no shape shows; `split` keeps what the mesh says."""
    mesh = la.meshes.quarter_ring(1.0, 2.0, n // 2, n)
    assert la.Body(mesh, STRONG).geometry == "approximated"
    assert la.Body(la.meshes.split(mesh, [0]), STRONG).geometry == "approximated"
    body = la.Body(mesh, STRONG, geometry="exact")  # the polygon is meant
    assert body.geometry == "exact"
    assert replace(body, mesh=mesh.refined()).geometry == "exact"


def test_refined_arcs_still_look_like_polygons():
    mesh = la.meshes.quarter_ring(1.0, 2.0, 3, 6)
    assert la.Body(mesh.refined(2), STRONG).geometry == "approximated"


def test_no_bound_of_a_ring_is_called_strict():
    problem = ring()
    lower, upper, state = la.lower_bound(problem), la.upper_bound(problem), la.solve(problem)
    assert {bound.rigor for bound in (lower, upper, state)} == {la.Rigor.DISCRETE}
    for message in (lower.message, state.message):
        assert "polygon" in message
    meant = ring(geometry="exact")
    assert la.upper_bound(meant).rigor is la.Rigor.UPPER
    assert la.lower_bound(meant).rigor is la.Rigor.LOWER
    assert "polygon" not in la.solve(meant).message


def test_what_a_bracket_says():
    """Of the ring it proved a target width, below the exact load of the body."""
    found = la.bracket(ring(), 0.2)
    assert found.status is la.Ending.REACHED
    assert not found.strict
    assert "proven" not in found.message
    assert "not of the body" in found.message
    assert "polygon" in found.plot().get_suptitle()
    meant = la.bracket(ring(geometry="exact"), 0.2)
    assert meant.strict
    assert "proven" in meant.message
    assert "polygon" not in meant.plot().get_suptitle()
