"""Equivalent strains from one mesh to another of the same body (T31)."""

import numpy as np
import shapely
from skfem import Mesh

from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.bodies.continuum.nodal import node_means
from lacore.model.meshes.curved import subdivided
from lacore.numerics.arrays import Floats, Ints


def transferred(old: BodyDofs, strain: Floats, new: BodyDofs) -> Floats:
    """Strains (elements, q) at the strain points of a new mesh.

    Means around the vertices of the old mesh (`lacore.model.bodies.continuum.nodal.vertex_means`),
    linear between its nodes; beyond its boundary those of the nearest place. Uniform strains stay
    what they are, none becomes larger or smaller than all before; peaks are smoothed over an
    element. Each region gets its own strains.
    """
    places = np.asarray(new.basis.global_coordinates())
    found = np.empty(places.shape[1:])
    for was, now in zip(old.body.regions, new.body.regions, strict=True):
        own, there = was.elements, places[:, now.elements]
        means = node_means(old, strain, own)
        values, _ = at_places(old.body.mesh, means, there.reshape(2, -1), own)
        found[now.elements] = values.reshape(there.shape[1:])
    return found


def at_places(
    mesh: Mesh, at_nodes: Floats, places: Floats, elements: Ints | slice = slice(None)
) -> tuple[Floats, Floats]:
    """Interpolate values linearly between the nodes of a curved mesh.

    Args:
        mesh: with midside nodes.
        at_nodes: values, shape (..., nodes).
        places: shape (2, n); beyond the boundary the value is that at the nearest place.
        elements: among which the places are, by default all.

    Returns:
        Values, shape (..., n), and the distances from the elements, m, shape (n,).
    """
    parts = subdivided(mesh)
    cells = parts.t.reshape(3, -1, mesh.nelements)[:, :, elements].reshape(3, -1)
    corners = parts.p[:, cells]
    triangles = shapely.polygons(corners.transpose(2, 1, 0))
    wanted = shapely.points(places.T)
    triangle = shapely.STRtree(triangles).nearest(wanted)
    lines = shapely.shortest_line(triangles[triangle], wanted)
    points = shapely.get_coordinates(lines)[::2].T  # the point itself where it is inside
    a, b, c = corners[:, :, triangle].transpose(1, 0, 2)

    def area(p: Floats, q: Floats, r: Floats) -> Floats:
        return np.asarray((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))

    whole = area(a, b, c)
    shares = np.stack([area(points, b, c), area(a, points, c), area(a, b, points)]) / whole
    shares = np.maximum(shares, 0.0)  # round-off at edges
    nodal = at_nodes[..., cells[:, triangle]]
    values = np.sum(shares * nodal, axis=-2) / shares.sum(axis=0)
    return np.asarray(values), np.asarray(shapely.length(lines))


def transfer_errors(
    old: BodyDofs, strain: Floats, new: BodyDofs, after: Floats
) -> tuple[float, float]:
    """Compute what a transfer of strains has changed.

    Args:
        old, strain: before it.
        new, after: after it.

    Returns:
        The jump of the integral of the strain over the body, relative to it, and the largest
        difference at the strain points of the old mesh.
    """
    before, now = (float(np.sum(d.weights * own)) for d, own in ((old, strain), (new, after)))
    back = transferred(new, after, old)
    return (now / before - 1 if before else 0.0), float(np.abs(back - strain).max())
