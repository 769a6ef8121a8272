"""Bodies: meshes that cannot be right are refused, with the fix."""

from dataclasses import replace

import numpy as np
import pytest
from skfem import MeshQuad, MeshTet, MeshTri, MeshTri2

import lacore as la

K = la.VonMises(shear_strength=1.0)


def mesh_of(points, triangles):
    return MeshTri(np.array(points, dtype=float).T, np.array(triangles).T)


UNIT = [(0, 0), (1, 0), (1, 1), (0, 1)]


def refused(*parts):
    return pytest.raises(la.InputError, match="(?s)" + ".*".join(parts))


def test_a_folded_neighbour_is_inverted():
    # The fourth vertex lies on the same side of the diagonal (0, 2) as the second.
    folded = mesh_of([(0, 0), (1, 0), (1, 1), (0.9, 0.1)], [(0, 1, 2), (0, 2, 3)])
    with refused("Body.mesh", "inverted", "do not overlap"):
        la.Body(folded, K)


def test_a_vertex_moved_across_its_opposite_edge_is_inverted():
    mesh = la.meshes.rectangle((0, 1), (0, 1), 3, 3)
    inner = np.flatnonzero(np.all((mesh.p > 0.2) & (mesh.p < 0.8), axis=0))[0]
    points = mesh.p.copy()
    points[:, inner] += 0.5
    with refused("inverted"):
        la.Body(replace(mesh, doflocs=points), K)


def test_orientation_alone_is_no_error():
    """Clockwise triangles are the same triangles."""
    la.Body(mesh_of(UNIT, [(0, 2, 1), (0, 2, 3)]), K)


@pytest.mark.parametrize("height", [0.0, 1e-12])
def test_degenerate(height):
    flat = mesh_of([(0, 0), (1, 0), (0.5, height), (0.5, 1)], [(0, 1, 2), (0, 2, 3)])
    with refused("Body.mesh", r"\[0\]", "without area"):
        la.Body(flat, K)


def test_degenerate_whatever_the_unit():
    la.Body(la.meshes.rectangle((0, 1e-9), (0, 1e-9), 2, 2), K)


@pytest.mark.parametrize(
    "second", [[(2, 0), (3, 0), (2, 1)], [(1, 0), (2, 0), (2, -1)]], ids=["apart", "coincident"]
)
def test_disconnected(second):
    with refused("Body.mesh = 2", "disconnected", "a Body of its own"):
        la.Body(mesh_of([(0, 0), (1, 0), (0, 1), *second], [(0, 1, 2), (3, 4, 5)]), K)


def test_joined_at_a_vertex_only_is_disconnected():
    with refused("disconnected", "no element edge"):
        la.Body(mesh_of([(0, 0), (1, 0), (0, 1), (2, 0), (2, -1)], [(0, 1, 2), (1, 3, 4)]), K)


def test_hanging_node():
    """One long edge below, two short ones above, their common vertex in its middle."""
    points = [(0, 0), (2, 0), (1, -1), (1, 0), (0, 1), (2, 1)]
    triangles = [(0, 1, 2), (0, 3, 4), (3, 1, 5), (3, 5, 4)]
    with refused(r"\[3\]", r"hanging nodes, the first at \(1, 0\)", r"from \(0, 0\) to \(2, 0\)"):
        la.Body(mesh_of(points, triangles), K)


def test_sides_of_a_crack_that_do_not_match_hang():
    points = [(0, 0), (2, 0), (1, -1), (0.6, 0), (1, 1), (2, 0)]
    with refused("hanging nodes", "split the element", "Interface"):
        la.Body(mesh_of(points, [(0, 1, 2), (0, 3, 4), (3, 5, 4)]), K)


def ring(turns, sectors=8):
    """A strip that turns around a point, less than once or more, without a fold."""
    angle = np.linspace(0, 2 * np.pi * turns, sectors + 1)
    points = np.concatenate(
        [r * np.stack([np.cos(angle), np.sin(angle)], axis=1) for r in (1.0, 2.0)]
    )
    inner = np.arange(sectors)
    a, b, c, d = inner, inner + sectors + 1, inner + sectors + 2, inner + 1
    return mesh_of(points, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]))


def test_a_strip_that_comes_over_itself_overlaps():
    """No neighbour is folded: only the third dimension could tell both ends apart."""
    la.Body(ring(0.9), K)
    with refused(r"elements that overlap at \(", "Bodies of the layers"):
        la.Body(ring(1.13, sectors=10), K)


def test_a_disc_that_is_covered_twice_overlaps():
    angle = 2 * np.pi * np.arange(10) / 5
    points = [(0, 0), *np.stack([np.cos(angle), np.sin(angle)], axis=1)]
    with refused("overlap"):
        la.Body(mesh_of(points, [(0, 1 + k, 1 + (k + 1) % 10) for k in range(10)]), K)


def test_an_edge_of_three_elements():
    points = [(0, 0), (1, 0), (0.5, 1), (0.5, -1), (0.6, -0.8)]
    with refused("more than two elements", r"from \(0, 0\) to \(1, 0\)", "remove"):
        la.Body(mesh_of(points, [(0, 1, 2), (0, 1, 3), (0, 1, 4)]), K)


@pytest.mark.parametrize(("height", "fine"), [(1e-5, True), (2e-7, False)])
def test_slivers(height, fine):
    """Quality is 4 sqrt(3) (h/2) / 1.5 with h << 1, so 2.3 h."""
    mesh = mesh_of([(0, 0), (1, 0), (0.5, height), (0.5, 1)], [(0, 1, 2), (0, 2, 3), (1, 3, 2)])
    least = la.meshes.quality(mesh).min()
    assert least == pytest.approx(4 / np.sqrt(3) * height, rel=1e-6)
    if fine:
        la.Body(mesh, K)
    else:
        with refused(r"\[0\]", "slivers", r"quality 4.6e-07 at \(0.5,", "1e-06 is the least"):
            la.Body(mesh, K)


def test_quality():
    """1 of equilateral triangles in any place; a square as its halves, sqrt(3)/2."""
    equilateral = mesh_of([(5, 1), (7, 1), (6, 1 + np.sqrt(3))], [(0, 1, 2)])
    assert la.meshes.quality(equilateral) == pytest.approx([1.0], rel=1e-14)
    assert la.meshes.quality(MeshQuad()) == pytest.approx([np.sqrt(3) / 2], rel=1e-14)


def test_places_are_named():
    with refused("disconnected", r"elements at \(0.333333, 0.333333\) and \(2.33333, 0.333333\)"):
        points = [(0, 0), (1, 0), (0, 1), (2, 0), (3, 0), (2, 1)]
        la.Body(mesh_of(points, [(0, 1, 2), (3, 4, 5)]), K)
    with refused("inverted", r"at the edge from \(0, 0\) to \(1, 1\)"):
        la.Body(mesh_of([(0, 0), (1, 0), (1, 1), (0.9, 0.1)], [(0, 1, 2), (0, 2, 3)]), K)


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
def test_checks_whatever_the_unit(scale):
    mesh = la.meshes.fan((0, 4), (-2, 0), (1, 0), 16, 8)
    la.Body(replace(mesh, doflocs=scale * mesh.p), K)
    with refused("overlap"):
        strip = ring(1.13, sectors=10)
        la.Body(replace(strip, doflocs=scale * strip.p), K)


def test_orphan_vertex():
    with refused("Body.mesh", r"\[4\]", "no element uses", "remove"):
        la.Body(mesh_of([*UNIT, (5, 5)], [(0, 1, 2), (0, 2, 3)]), K)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_vertices_that_are_no_numbers(value):
    with refused("Body.mesh", "not finite"):
        la.Body(mesh_of([(0, 0), (1, 0), (value, 1)], [(0, 1, 2)]), K)


@pytest.mark.parametrize("mesh", [MeshQuad(), MeshTet(), MeshTri2(), None, "mesh.msh"])
def test_wrong_kind_of_mesh(mesh):
    with refused("Body.mesh", "straight-edged triangles", "skfem.MeshTri"):
        la.Body(mesh, K)


@pytest.mark.parametrize(
    ("field", "given", "parts"),
    [
        ("kinematics", "plane_stran", ("Body.kinematics", "did you mean 'plane_strain'")),
        ("space", "p2-vertx", ("Body.space", "did you mean 'p2-vertex'")),
        ("geometry", "exct", ("Body.geometry", "did you mean 'exact'")),
        ("criterion", 1.0, ("Body.criterion = 1.0", "lacore.VonMises")),
    ],
)
def test_other_fields(field, given, parts):
    arguments = {"mesh": MeshTri(), "criterion": K, field: given}
    with refused(*parts):
        la.Body(**arguments)


@pytest.mark.parametrize("value", [-1.0, 0.0, np.nan, np.inf])
@pytest.mark.parametrize("name", ["shear_strength", "yield_stress"])
def test_strength(name, value):
    with refused(f"VonMises.{name} = ", "not a positive number", "strength > 0 in Pa"):
        la.VonMises(**{name: value})


@pytest.mark.parametrize("given", [{}, {"shear_strength": 1.0, "yield_stress": 1.7}])
def test_one_strength_is_needed(given):
    with refused("VonMises", "exactly one", "shear_strength"):
        la.VonMises(**given)


def test_strength_in_shear_and_in_tension():
    assert la.VonMises(yield_stress=np.sqrt(3)).k == pytest.approx(1.0, rel=1e-15)


def test_size_is_the_diagonal():
    assert la.Body(la.meshes.rectangle((1, 4), (0, 4), 1, 1), K).size == pytest.approx(5, rel=1e-15)
