"""Sections of bodies of tetrahedra: areas by hand, volumes and powers from stacks of them."""

from itertools import pairwise

import numpy as np
import pytest

import lacore as la
from lacore.pictures.space.cut import cut_by, plane_of, velocity_in

ROUND_OFF = 1e-12  # relative: sums of some hundred areas
BOX = la.meshes.box((0, 2), (0, 1), (0, 3), 4, 2, 6)


def column():
    mesh = la.meshes.box((0, 1), (0, 1), (0, 2), 1, 1, 2)
    return la.Problem(
        {"column": la.Body(mesh, la.VonMises(40e3), kinematics="3d", space="p2-disc")},
        [la.Pressure("column", "top", 1e3)],
        [la.Fix("column", side, "normal") for side in ("left", "front", "bottom")],
    )


@pytest.fixture(scope="module")
def state():
    return la.solve(column())


def area(point, normal, mesh=BOX):
    return cut_by(plane_of(point, normal), mesh).area.sum()


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("at", [0.0, 0.3, 0.5, 1.0])  # sides, inside of cells, faces of the mesh
def test_cross_sections_of_a_box(at, sense):
    """Faces in the plane are counted once: inside, and at either end of the box."""
    across = sense * np.eye(3)
    assert area((2 * at, 0, 0), across[0]) == pytest.approx(3, rel=ROUND_OFF)
    assert area((0, at, 0), across[1]) == pytest.approx(6, rel=ROUND_OFF)
    assert area((0, 0, 3 * at), across[2]) == pytest.approx(2, rel=ROUND_OFF)


def test_tilted_cross_sections():
    tilted = (np.sin(0.4), 0, np.cos(0.4))  # it leaves by the sides, and is that much longer
    assert area((1, 0, 1.5), tilted) == pytest.approx(2 / np.cos(0.4), rel=ROUND_OFF)
    cube = la.meshes.box((0, 1), (0, 1), (0, 1), 2, 2, 2)
    diagonal = (1, 1, 1)
    hexagon, triangle = 3 * np.sqrt(3) / 4, np.sqrt(3) / 2  # of sides sqrt(1/2) and sqrt(2)
    assert area((0.5, 0.5, 0.5), diagonal, cube) == pytest.approx(hexagon, rel=ROUND_OFF)
    assert area((1, 0, 0), diagonal, cube) == pytest.approx(triangle, rel=ROUND_OFF)
    assert area((0, 0, 0), (1, -1, 0), cube) == pytest.approx(np.sqrt(2), rel=ROUND_OFF)


def test_a_plane_that_touches_a_corner_or_an_edge_cuts_nothing():
    for normal in ((1, 1, 1), (1, 0, 1)):
        assert not cut_by(plane_of((0, 0, 0), normal), BOX).element.size


def test_a_step_of_the_surface_in_the_plane_is_counted_once():
    """Of an L the plane of the step is inside of one leg and the end of the other."""
    x, _, z = BOX.p[:, BOX.t].mean(axis=1)
    for kept in ((x < 1) | (z < 1.5), (x < 1) | (z > 1.5)):
        mesh = BOX.restrict(np.flatnonzero(kept))
        for normal in ((0, 0, 1), (0, 0, -1)):
            assert area((0, 0, 1.5), normal, mesh) == pytest.approx(2, rel=ROUND_OFF)


def test_polygons_go_around_and_centroids_lie_in_the_plane():
    plane = plane_of((1.1, 0.4, 1.3), (1, 2, -3))
    cut = cut_by(plane, BOX)
    x, y = cut.corners
    shoelace = np.sum(x * np.roll(y, -1, axis=0) - y * np.roll(x, -1, axis=0), axis=0) / 2
    assert np.abs(shoelace) == pytest.approx(cut.area, rel=1e-9)  # small parts cancel
    centroid = cut.centroid(BOX)
    assert plane.normal @ (centroid - plane.point[:, None]) == pytest.approx(0, abs=1e-12)
    assert cut.share.min() >= 0
    # The section of the box as a whole, by hand: its cut by x + 2 y - 3 z = c is a parallelogram
    # over all x and y, whose centroid is that of the box in plan.
    middle = centroid @ cut.area / cut.area.sum()
    assert middle[:2] == pytest.approx([1, 0.5], rel=1e-12)


def test_a_stack_of_sections_has_the_volume_and_the_dissipation(state):
    """Cuts of tetrahedra are quadratic in height between vertices: two Gauss points are exact."""
    dofs, power = state.discretisation.continua["column"], state.dissipation["column"]
    mesh = dofs.body.mesh
    for normal in ((0, 0, 1), (1, 2, 3)):
        height = np.unique(np.round(np.asarray(normal) @ mesh.p, 9))
        volume = worked = 0.0
        for low, high in pairwise(height):
            for sign in (-1, 1):
                at = (low + high) / 2 + sign * (high - low) / np.sqrt(12)
                cut = cut_by(plane_of((0, 0, at / normal[2]), normal), mesh)
                thick = (high - low) / 2 / np.linalg.norm(normal)
                volume += thick * cut.area.sum()
                worked += thick * cut.area @ power[cut.element]
        assert volume == pytest.approx(2, rel=1e-9)
        assert worked == pytest.approx(dofs.volumes @ power, rel=1e-9)


@pytest.mark.parametrize("space", ["p2-disc", "p2-vertex"])
def test_velocities_in_the_plane_are_those_of_the_field(space):
    """A quadratic field, which both spaces have, at centroids."""
    body = la.Body(BOX, la.VonMises(1.0), kinematics="3d", space=space)
    problem = la.Problem({"box": body}, [la.BodyForce("box", (0, 0, 1))], [la.Fix("box", "bottom")])
    dofs = la.discretise(problem).continua["box"]

    def field(x, y, z):
        return np.stack([x * y + z, z**2 - x, x * z - 2 * y**2])

    plane = plane_of((1.1, 0.4, 1.3), (1, 2, -3))
    cut = cut_by(plane, BOX)
    found = velocity_in(plane, cut, dofs, field(*dofs.nodes))
    assert found == pytest.approx(plane.axes @ field(*cut.centroid(BOX)), abs=1e-12)


@pytest.mark.parametrize(
    ("normal", "names"),
    [
        ((0, 0, -2), ["x", "y"]),
        ((0, 1, 0), ["x", "z"]),
        ((3, 0, 0), ["y", "z"]),
        ((0, 1, -1), ["x", "along (0, 0.71, 0.71)"]),
        ((1, -1, 0), ["along (0.71, 0.71, 0)", "z"]),
    ],
)
def test_names_of_axes(normal, names):
    plane = plane_of((0, 0, 0), normal)
    assert plane.names == names
    assert plane.axes @ plane.axes.T == pytest.approx(np.eye(2), abs=1e-12)
    assert plane.axes @ plane.normal == pytest.approx(0, abs=1e-12)


def test_the_picture_has_values_of_the_elements_and_arrows(state):
    figure = state.plot_section((0, 0.5, 0), (0, 1, 0))
    (axes,) = figure.axes
    (bar,) = axes.child_axes
    polygons, arrows = axes.collections
    power = state.dissipation["column"]
    cut = cut_by(
        plane_of((0, 0.5, 0), (0, 1, 0)), state.discretisation.continua["column"].body.mesh
    )
    shares = np.asarray(polygons.get_array())
    assert shares == pytest.approx(power[cut.element] / power.max())
    # Uniform compression of one that keeps its volume: u = (x, y, -2 z) times a rate.
    x, z = arrows.XY.T
    assert (
        pytest.approx(-2 * z * arrows.U / x, abs=1e-4 * np.hypot(arrows.U, arrows.V).max())
        == arrows.V
    )
    assert bar.get_ylabel() == "dissipation density / largest value"


def test_arrows_are_seen_where_the_plane_cuts_off_a_corner(state):
    axes = state.plot_section((0.9, 0, 0), (1, -1, -1)).axes[0]
    _, arrows = axes.collections
    assert np.hypot(arrows.U, arrows.V).max() > 0.05 * np.ptp(axes.get_xlim())


def test_a_lower_bound_shows_its_strength():
    figure = la.lower_bound(column()).plot_section((0, 0, 1), (0, 0, 1))
    used = np.asarray(figure.axes[0].collections[0].get_array())
    assert used == pytest.approx(np.ones(used.size), abs=1e-4)  # all of it yields
    assert figure.axes[0].get_legend() is None


@pytest.mark.parametrize(
    ("point", "normal", "told"),
    [
        ((0, 0), (0, 1, 0), r"point = \(0, 0\): not three"),
        ((0, 0, np.nan), (0, 1, 0), "point = .*: not three"),
        ((0, 0, 0), (0, 1), r"normal = \(0, 1\): not three"),
        ((0, 0, 0), (0, 0, 0), r"normal = \(0, 0, 0\): it has no direction"),
        ((0, 0, 2.5), (0, 0, 1), r"point = .*misses.*goes through \(0, 0, 2\)"),
    ],
)
def test_what_is_refused(state, point, normal, told):
    with pytest.raises(la.InputError, match=told):
        state.plot_section(point, normal)


def test_bodies_of_the_plane_have_no_section():
    with pytest.raises(la.InputError, match="none is of tetrahedra"):
        la.solve(la.examples.column()).plot_section((0, 0, 0), (0, 1, 0))
    wall = la.masonry3d.wall([[1]], 0.5)
    pushed = la.Problem(
        {"wall": wall},
        [la.BodyForce("wall", (1, 0, 0))],
        [la.Fix("wall", "base")],
        dead_loads=[la.BodyForce("wall", (0, 0, -1))],
    )
    with pytest.raises(la.InputError, match="none is of tetrahedra"):
        la.solve(pushed).plot_section((0, 0, 0), (0, 1, 0))
