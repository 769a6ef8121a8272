"""Thumbnails: a problem, mechanism, bracket or path alone, in the size on a page."""

from collections.abc import Mapping, Sequence

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from skfem import MeshTet, MeshTri

from lacore.limit.state import LimitState
from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.blocks3d.block_assembly import BlockAssembly3D
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.nodal import element_means
from lacore.model.conditions.footings import footings
from lacore.model.meshes.curved import edge_lines, outlines
from lacore.model.meshes.solid.faces import face_corners
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats
from lacore.paths.configuration import Configuration
from lacore.paths.path import Path
from lacore.paths.stage import Stage
from lacore.pictures.bracket import parts
from lacore.pictures.contact import PLANE_DEPTH, draw_obstacle
from lacore.pictures.continua import BEFORE
from lacore.pictures.displaced import displacement_of, draw_displaced
from lacore.pictures.path import FOOTING, draw_blocks
from lacore.pictures.sketch.problem import draw_problem, extent_of
from lacore.pictures.sketch.sheet import Sheet
from lacore.pictures.space.acting import face_colours
from lacore.pictures.space.drawing import faces_of, on_screen
from lacore.pictures.space.mechanism import colours_of
from lacore.pictures.space.problem import block_colours
from lacore.pictures.space.structure import Blocks, blocks_of, motion_of, stretch_of
from lacore.pictures.space.surface import EDGE, displaced_faces, seen_faces
from lacore.reporting.units import Units

_SYMBOLS = 0.3  # share of the paper for symbols around the bodies

Size = tuple[float, float]
"""Width and height of a figure, inches."""
SIZE: Size = (4.6, 3.2)
"""Twice the 230 x 160 pixels of a thumbnail on a page, at `DPI`."""
DPI = 100
"""Pixels per inch of `SIZE`: lines of one point are then 0.7 pixels wide on the page."""
_MARGIN = 0.04  # on each side, by the size of the contents
_POINTS = 72.0  # per inch
_THIN = 0.4  # points: edges of faces


def paper(size: Size) -> Axes:
    """Create a white figure of a size, covered by axes without a frame."""
    figure = Figure(figsize=size)
    figure.set_facecolor("white")
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    return axes


def scale_of(size: Size, extent: Floats) -> float:
    """Find the scale at which contents of an extent (m) fill a size, points per metre."""
    return float(_POINTS / ((1 + 2 * _MARGIN) * np.max(extent / np.array(size))))


def finish(axes: Axes, low: Floats, high: Floats) -> Figure:
    """Set the limits so that a box, given by two corners (m), fills the figure."""
    figure = axes.figure
    assert isinstance(figure, Figure)
    size = np.array(figure.get_size_inches())
    half = (0.5 + _MARGIN) * np.max((high - low) / size) * size
    (left, bottom), (right, top) = (low + high) / 2 - half, (low + high) / 2 + half
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, top)
    return figure


def finish_around_contents(axes: Axes) -> Figure:
    """Set the limits so that all that was drawn fills the figure."""
    corners = axes.dataLim.get_points()
    return finish(axes, corners.min(axis=0), corners.max(axis=0))


def faces_on_paper(size: Size, corners: Sequence[Floats], filled: Floats, lined: Floats) -> Figure:
    """Draw polygons in the order in which they hide each other.

    Args:
        size: Of the figure, inches.
        corners: Polygons on the screen, m, shape (points, 2) each.
        filled, lined: Colours of the polygons and of their edges, shape (polygons, 3).
    """
    axes = paper(size)
    axes.add_collection(
        PolyCollection(corners, facecolors=filled, edgecolors=lined, linewidths=_THIN)
    )
    return finish_around_contents(axes)


def blocks_on_paper(size: Size, blocks: Blocks, points: Floats, colours: Sequence[str]) -> Figure:
    """Draw blocks with their vertices at points (3, n), m, in a colour each."""
    shown = faces_of(points, blocks, colours)
    flat, near = on_screen(points)
    depth = np.array([near[blocks.faces[face]].mean() for face in shown.face.tolist()])
    order = np.concatenate([own[np.argsort(depth[own])] for own in shown.from_behind])
    corners = [flat[:, blocks.faces[face]].T for face in shown.face[order].tolist()]
    return faces_on_paper(size, corners, shown.filled[order], shown.lined[order])


def surfaces_on_paper(
    size: Size,
    meshes: Mapping[str, MeshTet],
    corners: Mapping[str, Floats],
    colours: Mapping[str, Floats],
) -> Figure:
    """Draw the boundary faces of bodies of tetrahedra.

    Args:
        size: Of the figure, inches.
        meshes: Of the bodies, by name.
        corners: Of the boundary faces of each body, m, shape (3, 3, faces).
        colours: Of these faces, shape (faces, 3).
    """
    polygons, depths, fills = [], [], []
    for name, mesh in meshes.items():
        seen, shaded = seen_faces(mesh, colours[name])
        flat, near = on_screen(corners[name][:, :, seen])
        polygons.append(flat.transpose(2, 1, 0))
        depths.append(near.mean(axis=0))
        fills.append(shaded)
    order = np.argsort(np.concatenate(depths))
    filled = np.concatenate(fills)[order]
    return faces_on_paper(size, list(np.concatenate(polygons)[order]), filled, EDGE * filled)


def surface_colours(mesh: MeshTet, shares: Floats) -> Floats:
    """Return the colours of boundary faces, (faces, 3), by shares of the elements behind them.

    The shares are between 0 and 1.
    """
    behind = mesh.f2t[0, mesh.boundary_facets()]
    return np.asarray(matplotlib.colormaps["YlOrRd"](shares[behind])[:, :3])


def thumbnail_of_problem(problem: Problem, size: Size = SIZE) -> Figure:
    """Draw bodies, supports, contact and loads without text.

    Args:
        problem: Any problem.
        size: Width and height, inches; the sketch fills it.
    """
    solids = of_kind(problem.bodies, BlockAssembly3D)
    if solids:
        blocks = blocks_of(solids.items())
        return blocks_on_paper(size, blocks, blocks.points, block_colours(problem, blocks))
    if problem.dimension == 3:
        meshes = {name: body.mesh for name, body in of_kind(problem.bodies, Body).items()}
        corners = {name: face_corners(own, own.boundary_facets()) for name, own in meshes.items()}
        return surfaces_on_paper(size, meshes, corners, face_colours(problem))
    axes = paper(size)
    point = 1 / ((1 - _SYMBOLS) * scale_of(size, extent_of(problem)))
    sheet = Sheet(axes, point, Units())
    draw_problem(sheet, problem)
    return finish(axes, *sheet.bounds())


def thumbnail_of_state(state: LimitState, size: Size = SIZE) -> Figure:
    """Draw the collapse mechanism and nothing else: no title, axes, colour bar or legend.

    The displacements and colours are those of `lacore.pictures.mechanism.plot_mechanism`.

    Args:
        state: Any state with a point.
        size: Width and height, inches; the mechanism fills it.

    Raises:
        ValueError: The state has no point.
    """
    discretisation = state.discretisation
    if discretisation.solids:
        motion = motion_of(state)
        moved = motion.blocks.points + stretch_of(motion) * motion.vertices
        return blocks_on_paper(size, motion.blocks, moved, colours_of(motion))
    if discretisation.problem.dimension == 3:
        bodies, corners, shares = displaced_faces(state)
        meshes = {name: body.mesh for name, body in bodies.items()}
        colours = {name: surface_colours(own, shares[name]) for name, own in meshes.items()}
        return surfaces_on_paper(size, meshes, corners, colours)
    shown, axes = displacement_of(state), paper(size)
    draw_displaced(axes, shown, Units(), scale_of(size, np.asarray(shown.extent)), edges=0.0)
    return finish_around_contents(axes)


def thumbnail_of_shares(mesh: MeshTri | MeshTet, shares: Floats, size: Size = SIZE) -> Figure:
    """Draw the contributions of the elements of a mesh to a gap, and nothing else.

    Args:
        mesh: Mesh of a bound.
        shares: Shares of its elements, shape (elements,).
        size: Width and height, inches; the mesh fills it.
    """
    part, norm = parts(shares)
    if isinstance(mesh, MeshTet):
        corners = face_corners(mesh, mesh.boundary_facets())
        colours = surface_colours(mesh, np.asarray(norm(part)))
        return surfaces_on_paper(size, {"body": mesh}, {"body": corners}, {"body": colours})
    axes = paper(size)
    axes.add_collection(
        PolyCollection(
            list(mesh.p[:, mesh.t].transpose(2, 1, 0)),
            array=part,
            norm=norm,
            cmap=matplotlib.colormaps["YlOrRd"],
            edgecolors=(0, 0, 0, 0.3),
            linewidths=0.3,
        )
    )
    return finish_around_contents(axes)


def thumbnail_of_path(path: Path, size: Size = SIZE) -> Figure:
    """Draw the bodies at the end of a path and nothing else: no title, axes, load or legend.

    Args:
        path: Any path.
        size: Width and height, inches; the bodies fill it.
    """
    last = path.snapshots[-1]
    return thumbnail_of_shape(path.stage_of(last), path.stage, last.configuration, size)


def thumbnail_of_shape(
    stage: Stage, before: Stage, configuration: Configuration, size: Size = SIZE
) -> Figure:
    """Draw bodies on a configuration, over their outlines before.

    Args:
        stage: Stage with the meshes of the configuration.
        before: Stage with the bodies at the beginning of the path.
        configuration: Places of the nodes, and strains.
        size: Width and height, inches; the bodies fill it.
    """
    axes = paper(size)
    for body in before.bodies.values():
        lines = edge_lines(body.mesh, body.mesh.boundary_facets())
        axes.add_collection(LineCollection(lines, **BEFORE, zorder=1))
    dofs = stage.dofs_at(configuration)
    strains = {name: element_means(own, configuration.strain[name]) for name, own in dofs.items()}
    largest = max(float(own.max()) for own in strains.values())
    for name, own in dofs.items():
        mesh = own.body.mesh
        # Smoothed sides of polygons without lines between them would leave hairlines.
        axes.add_collection(
            PolyCollection(
                list(outlines(mesh)),
                array=strains[name],
                norm=Normalize(0.0, largest or 1.0),
                cmap=matplotlib.colormaps["YlOrRd"],
                linewidths=0,
                antialiaseds=False,
                zorder=2,
            )
        )
        lines = edge_lines(mesh, mesh.boundary_facets())
        axes.add_collection(LineCollection(lines, colors="#222222", linewidths=1.0, zorder=4))
    meshes = stage.meshes_at(configuration)
    for footing in footings(before.problem.reference_loads):
        mesh = meshes[footing.body]
        lines = edge_lines(mesh, np.asarray(mesh.boundaries[str(footing.where)]))
        axes.add_collection(LineCollection(lines, colors=FOOTING, linewidths=3.0, zorder=5))
    draw_blocks(axes, stage, configuration)
    corners = axes.dataLim.get_points()
    low, high = corners.min(axis=0), corners.max(axis=0)
    obstacles = stage.obstacles_at(configuration)
    if obstacles:
        margin = PLANE_DEPTH * float(np.linalg.norm(high - low))
        low, high = low - margin, high + margin
    for obstacle in obstacles:
        draw_obstacle(axes, obstacle.shape, low, high)
    return finish(axes, low, high)
