"""From names and predicates to boundary facets."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lacore as la
from lacore.model.bodies.continuum.boundaries import boundary_facets, facet_geometry

BODY = la.Body(
    la.meshes.rectangle((0, 2), (-1, 0.7), 8, 3).with_boundaries(
        {"diagonals": np.array([0, 1, 2, 3, 4, 5, 6, 7]), "nothing": np.array([], dtype=int)}
    ),
    la.VonMises(shear_strength=1.0),
)


def facets(where):
    return boundary_facets(BODY.mesh, where, "Fix.where")


def test_name_and_predicate_select_the_same():
    # No slack: an edge at y = 0.7 satisfies y == 0.7 along its whole length.
    assert np.array_equal(facets("top"), facets(lambda x: x[1] == 0.7))
    assert np.array_equal(facets("left"), facets(lambda x: x[0] == 0))


def test_predicate_that_ends_on_a_vertex():
    chosen = facets(lambda x: (x[1] == 0.7) & (x[0] <= 0.5))
    strict = facets(lambda x: (x[1] == 0.7) & (x[0] < 0.5))
    slack = facets(lambda x: (x[1] > 0.7 - 1e-9) & (x[0] < 0.5 + 1e-9))
    assert np.array_equal(chosen, strict)
    assert np.array_equal(chosen, slack)
    start, end, normal = facet_geometry(BODY.mesh, chosen)
    assert chosen.size == 2
    assert np.maximum(start[0], end[0]).max() == 0.5
    assert np.array_equal(normal, [[0, 0], [1, 1]])


@pytest.mark.parametrize("limit", [0.625, 0.501, 0.749], ids=["midside node", "early", "late"])
def test_predicate_that_ends_inside_an_edge(limit):
    with pytest.raises(la.InputError) as caught:
        facets(lambda x: (x[1] == 0.7) & (x[0] <= limit))
    message = str(caught.value)
    assert "Fix.where" in message
    assert "inside the element edge" in message
    assert "midside node" in message
    assert "put a vertex of the mesh where it ends" in message


@pytest.mark.parametrize(
    ("where", "parts"),
    [
        ("tpo", ("Fix.where = 'tpo'", "no such boundary", "did you mean 'top'")),
        ("zzzz", ("no such boundary", "known names: bottom, diagonals, left")),
        ("diagonals", ("inside the body", "boundary only")),
        ("nothing", ("'nothing'", "an empty boundary", "at least one")),
        (lambda x: x[0] > 99, ("an empty boundary",)),
        (lambda x: x[0] * 1.0, ("float64", "one bool a point", "shape (n,)")),
        (lambda x: True, ("one bool a point",)),
        (lambda x: x[1] == 1 and x[0] < 1, ("Fix.where: the predicate fails", "by & and |")),
        (7, ("Fix.where = 7", "not a boundary", "boundary name or a function")),
        (None, ("not a boundary",)),
    ],
)
def test_refused(where, parts):
    with pytest.raises(la.InputError) as caught:
        facets(where)
    assert all(part in str(caught.value) for part in parts), str(caught.value)


@pytest.mark.parametrize(
    "where", [la.Within(x=0), la.Along((0, 0), (0, 1)), la.Beyond((0, 0), (1, 0))]
)
def test_places_of_the_plane_are_none_in_space(where):
    """A line there is no line: (x, y) on it would be a plane, and z be left out."""
    box = la.Body(la.meshes.box((0, 1), (0, 1), (0, 1), 1, 1, 1), la.VonMises(1.0), "3d")
    with pytest.raises(
        la.InputError, match=r"supports\[0\].where = .* three-dimensional; give a function"
    ):
        la.Problem({"box": box}, [la.Pressure("box", "top")], [la.Fix("box", where)])


def test_a_mesh_without_names():
    bare = la.Body(BODY.mesh.refined(0).with_boundaries({}), la.VonMises(shear_strength=1.0))
    object.__setattr__(bare.mesh, "_boundaries", None)
    with pytest.raises(la.InputError, match="none is known"):
        boundary_facets(bare.mesh, "top", "Fix.where")


@given(angle=st.floats(0, 2 * np.pi), crossed=st.booleans())
def test_outward_normals_close_up(angle, crossed):
    """Green: the integrals of n and of x.n around a body are 0 and twice its area."""
    mesh = la.meshes.rectangle((0, 2), (0, 1), 3, 2, crossed)
    rotation = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    body = la.Body(replace(mesh, doflocs=rotation @ mesh.p), la.VonMises(shear_strength=1.0))
    start, end, normal = facet_geometry(body.mesh, body.mesh.boundary_facets())
    length = np.linalg.norm(end - start, axis=0)
    # Round-off of ten terms of order one.
    assert np.allclose(normal @ length, 0, atol=1e-13)
    assert np.sum((start + end) / 2 * normal * length) == pytest.approx(4.0, rel=1e-13)
