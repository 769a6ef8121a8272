"""Values of strain points as values of elements and of nodes (T31)."""

import numpy as np

from lacore.arrays import Floats
from lacore.bodies.continuum.dofs import BodyDofs


def element_means(dofs: BodyDofs, values: Floats) -> Floats:
    """Means over the volumes of elements, shape (elements,), of values of shape (elements, q)."""
    return np.asarray(np.sum(dofs.weights * values, axis=1) / dofs.volumes)


def vertex_means(dofs: BodyDofs, values: Floats) -> Floats:
    """Means of values (elements, q) around vertices, shape (vertices,), by their hat functions.

    None is above or below all values around it, and their integral is that of the values: the
    projection onto linear (bilinear) fields with its matrix lumped.
    """
    mesh = dofs.body.mesh
    share = np.einsum("cq,eq->ceq", corner_shapes(dofs.space.points, len(mesh.t)), dofs.weights)
    size = np.bincount(mesh.t.ravel(), share.sum(axis=2).ravel(), minlength=mesh.nvertices)
    total = np.bincount(mesh.t.ravel(), np.einsum("ceq,eq->ce", share, values).ravel())
    return np.asarray(total / size)


def node_means(dofs: BodyDofs, values: Floats) -> Floats:
    """The same at all nodes of a continuous space, shape (nodes,): linear between vertices."""
    corners = dofs.body.mesh.t
    at = vertex_means(dofs, values)[corners]
    means = np.empty(dofs.nodes.shape[1])
    means[dofs.element_nodes[: len(corners)]] = at
    if dofs.degree == 2:
        # scikit-fem numbers the edges of a polygon (0, 1), (1, 2), ..., (0, last).
        sides = (at + np.roll(at, -1, axis=0)) / 2
        means[dofs.element_nodes[len(corners) : 2 * len(corners)]] = sides
    if len(dofs.element_nodes) == 2 * len(corners) + 1:
        means[dofs.element_nodes[-1]] = at.mean(axis=0)
    return means


def point_values(dofs: BodyDofs, values: Floats) -> Floats:
    """Values of vertices at the strain points, linear (bilinear) between, (elements, q)."""
    corners = dofs.body.mesh.t
    return np.asarray(values[corners].T @ corner_shapes(dofs.space.points, len(corners)))


def corner_shapes(points: Floats, corners: int) -> Floats:
    """Linear (bilinear) shape functions of the corners at reference points, (corners, points)."""
    if len(points) == 3:
        return np.concatenate([1 - points.sum(axis=0, keepdims=True), points])
    x, y = points
    if corners == 3:
        return np.stack([1 - x - y, x, y])
    return np.stack([(1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y])
