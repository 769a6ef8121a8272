"""Thumbnails in three dimensions, projected: axes in space take longer than all they show."""

from collections.abc import Mapping, Sequence

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from skfem import MeshTet

from lacore.arrays import Floats
from lacore.pictures.space.drawing import faces_of, on_screen
from lacore.pictures.space.structure import Blocks
from lacore.pictures.space.surface import EDGE, seen_faces
from lacore.pictures.thumbnails.paper import Size, faces_on_paper


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
    """Colours of the boundary faces, (faces, 3), by shares (0 to 1) of the elements behind them."""
    behind = mesh.f2t[0, mesh.boundary_facets()]
    return np.asarray(matplotlib.colormaps["YlOrRd"](shares[behind])[:, :3])
