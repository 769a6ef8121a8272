"""Sizes of elements: length of edges at places of a mesh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree
from skfem import Mesh

from lacore.model.meshes.curved import jacobians, vertices
from lacore.numerics.arrays import Floats

Sizes = Callable[[Floats], Floats]
"""Lengths of edges, m, shape (n,), at points of shape (2, n)."""

_NEIGHBOURS = 4  # number of vertices for the interpolation of sizes


@dataclass(frozen=True)
class Uniform:
    """The same size everywhere."""

    size: float

    def __call__(self, points: Floats) -> Floats:
        """Return the size at points of shape (2, n)."""
        return np.full(points.shape[1], self.size)


def element_sizes(mesh: Mesh) -> Sizes:
    """Return a function for the edge lengths of equilateral triangles as large as the elements.

    A quadrilateral counts as two triangles. As plastic flow of metals preserves areas, elements
    that are distorted have the size that they had at the beginning. Between vertices the sizes are
    interpolated.

    Args:
        mesh: of triangles or quadrilaterals, edges straight or curved.

    Returns:
        Function of points (2, n) that returns sizes (n,), m.

    Example:
        >>> mesh = la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=4, ny=2)
        >>> sizes = la.meshes.element_sizes(mesh)  # as `size` of `lacore.model.meshes.remeshed`
    """
    # The mean of Bernstein coefficients is that of the polynomial. Either shape is halved: the
    # reference triangle has half of the area of the square.
    areas = jacobians(mesh).mean(axis=1) / 2
    lengths = np.log(4 / np.sqrt(3) * areas) / 2
    count = np.bincount(mesh.t.ravel(), minlength=mesh.nvertices)
    total = np.bincount(mesh.t.ravel(), np.tile(lengths, len(mesh.t)), minlength=mesh.nvertices)
    at_vertices = total / count
    tree = cKDTree(vertices(mesh).T)

    def sizes(points: Floats) -> Floats:
        distance, nearest = tree.query(points.T, k=min(_NEIGHBOURS, at_vertices.size))
        share = 1 / np.maximum(distance, 1e-12 * np.exp(at_vertices[nearest])) ** 2
        means = np.sum(share * at_vertices[nearest], axis=1) / share.sum(axis=1)
        return np.asarray(np.exp(means))

    return sizes
