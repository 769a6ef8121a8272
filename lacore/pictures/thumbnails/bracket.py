"""Thumbnails of brackets."""

import matplotlib
import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from skfem import MeshTet, MeshTri

from lacore.arrays import Floats
from lacore.meshes.solid.faces import face_corners
from lacore.pictures.bracket import parts
from lacore.pictures.thumbnails.paper import SIZE, Size, finish_around_contents, paper
from lacore.pictures.thumbnails.solids import surface_colours, surfaces_on_paper


def thumbnail_of_shares(mesh: MeshTri | MeshTet, shares: Floats, size: Size = SIZE) -> Figure:
    """Draw the contributions of the elements of a mesh to a gap, and nothing else.

    Args:
        mesh: Mesh of a bound.
        shares: Of its elements, shape (elements,).
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
