"""Conversion of values at strain points to values of elements and of nodes (T31)."""

import numpy as np

from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.numerics.arrays import Floats, Ints


def element_means(dofs: BodyDofs, values: Floats) -> Floats:
    """Return the means of values, shape (elements, q), over the volumes of elements."""
    return np.asarray(np.sum(dofs.weights * values, axis=1) / dofs.volumes)


def vertex_means(dofs: BodyDofs, values: Floats, elements: Ints | slice = slice(None)) -> Floats:
    """Return the means of values around vertices, shape (vertices,), by their hat functions.

    Each mean lies between the values around it, and their integral is that of the values: the
    projection onto linear (bilinear) fields with its matrix lumped.

    Args:
        dofs: unknowns of the body.
        values: values at its strain points, shape (elements, q).
        elements: elements whose values count, by default all; NaN at other vertices.
    """
    mesh, weights = dofs.body.mesh, dofs.weights[elements]
    corners = mesh.t[:, elements]
    share = np.einsum("cq,eq->ceq", corner_shapes(dofs.space.points, len(corners)), weights)
    size, total = (
        np.bincount(corners.ravel(), own.ravel(), minlength=mesh.nvertices)
        for own in (share.sum(axis=2), np.einsum("ceq,eq->ce", share, values[elements]))
    )
    means = np.full(size.size, np.nan)
    means[size > 0] = total[size > 0] / size[size > 0]
    return means


def node_means(dofs: BodyDofs, values: Floats, elements: Ints | slice = slice(None)) -> Floats:
    """Return these means at all nodes of a continuous space, (nodes,), linear between vertices."""
    corners, nodes = dofs.body.mesh.t[:, elements], dofs.element_nodes[:, elements]
    at = vertex_means(dofs, values, elements)[corners]
    means = np.full(dofs.nodes.shape[1], np.nan)
    means[nodes[: len(corners)]] = at
    if dofs.degree == 2:
        # scikit-fem numbers the edges of a polygon (0, 1), (1, 2), ..., (0, last).
        sides = (at + np.roll(at, -1, axis=0)) / 2
        means[nodes[len(corners) : 2 * len(corners)]] = sides
    if len(nodes) == 2 * len(corners) + 1:
        means[nodes[-1]] = at.mean(axis=0)
    return means


def point_values(dofs: BodyDofs, values: Floats) -> Floats:
    """Return vertex values at the strain points, (bi)linear between, (elements, q)."""
    corners = dofs.body.mesh.t
    return np.asarray(values[corners].T @ corner_shapes(dofs.space.points, len(corners)))


def corner_shapes(points: Floats, corners: int) -> Floats:
    """Return the (bi)linear shape functions of corners at reference points, (corners, points)."""
    if len(points) == 3:
        return np.concatenate([1 - points.sum(axis=0, keepdims=True), points])
    x, y = points
    if corners == 3:
        return np.stack([1 - x - y, x, y])
    return np.stack([(1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y])
