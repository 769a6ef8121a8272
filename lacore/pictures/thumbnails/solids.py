"""Thumbnails in three dimensions, projected: axes in space take longer than all they show."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from lacore.arrays import Floats
from lacore.bodies.continuum.body import Body
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
    bodies: Mapping[str, Body],
    corners: Mapping[str, Floats],
    colours: Mapping[str, Floats],
) -> Figure:
    """Draw the boundary faces of bodies of tetrahedra.

    Args:
        size: Of the figure, inches.
        bodies: By name.
        corners: Of the boundary faces of each body, m, shape (3, 3, faces).
        colours: Of these faces, shape (faces, 3).
    """
    polygons, depths, fills = [], [], []
    for name, body in bodies.items():
        seen, shaded = seen_faces(body.mesh, colours[name])
        flat, near = on_screen(corners[name][:, :, seen])
        polygons.append(flat.transpose(2, 1, 0))
        depths.append(near.mean(axis=0))
        fills.append(shaded)
    order = np.argsort(np.concatenate(depths))
    filled = np.concatenate(fills)[order]
    return faces_on_paper(size, list(np.concatenate(polygons)[order]), filled, EDGE * filled)
