"""Merging of vertices that nearly meet, and of corners with edges that they nearly touch.

The result depends neither on the order of lines nor on their direction, up to round-off: vertices
are sorted before sums are formed, and corners are put on edges such that vertices move least in the
sum of squares.
"""

from dataclasses import dataclass

import numpy as np
import shapely
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import lsmr
from scipy.spatial import cKDTree

from lacore.numerics.arrays import Floats, Ints

ROUNDS = 4  # Normals turn with the edges: each iteration squares the residual.
_EXACT = 1e-15  # relative tolerance of the least squares


@dataclass(frozen=True)
class Merged:
    """Vertices of a drawing, merged within the snap.

    Attributes:
        place: their mean, (2, m), m; sorted.
        number: merged vertex of each given vertex, (n,).
        width: width of the box around the given vertices of each, (m,), m.
    """

    place: Floats
    number: Ints
    width: Floats


def merged(points: Floats, snap: float) -> Merged:
    """Return the merged vertices of given ones (n, 2), m."""
    order = np.lexsort(points.T[::-1])
    sorted_points = points[order]
    pairs = cKDTree(sorted_points).query_pairs(snap, output_type="ndarray")
    links = coo_matrix((np.ones(len(pairs)), pairs.T), shape=(len(points),) * 2)
    count, cluster = connected_components(links, directed=False)
    size = np.bincount(cluster, minlength=count)
    first = sorted_points[np.unique(cluster, return_index=True)[1]]
    # Differences are averaged, so that vertices drawn in one place stay there to the last digit.
    off = sorted_points - first[cluster]
    mean = first.T + np.stack([np.bincount(cluster, own, count) for own in off.T]) / size
    low, high = np.full((2, count), np.inf), np.full((2, count), -np.inf)
    for own, limit in ((np.minimum, low), (np.maximum, high)):
        for axis in range(2):
            own.at(limit[axis], cluster, sorted_points[:, axis])
    rank = np.lexsort(mean[::-1])
    new = np.empty(count, dtype=np.int64)
    new[rank] = np.arange(count)
    number = np.empty(len(points), dtype=np.int64)
    number[order] = new[cluster]
    return Merged(mean[:, rank], number, np.linalg.norm(high - low, axis=0)[rank])


def unique_edges(edges: Ints) -> Ints:
    """Return the edges (e, 2) as pairs of vertices, each once, whatever its direction, sorted."""
    ordered = np.sort(edges.reshape(-1, 2), axis=1)
    return np.asarray(np.unique(ordered[ordered[:, 0] != ordered[:, 1]], axis=0))


def on_edges(place: Floats, vertices: Ints, edges: Ints, reach: float) -> tuple[Ints, Ints]:
    """Return which vertices lie inside which edges, within a reach of them.

    Args:
        place: places of all vertices, (2, m), m.
        vertices: vertices to check, sorted.
        edges: pairs of vertices, (e, 2).
        reach: m.

    Returns:
        the vertices and the edges, (k,) each, sorted.
    """
    lines = shapely.linestrings(place.T[edges])
    own, edge = shapely.STRtree(lines).query(
        shapely.points(place.T[vertices]), predicate="dwithin", distance=reach
    )
    vertex = vertices[own]
    start, end = place[:, edges[edge, 0]], place[:, edges[edge, 1]]
    along = end - start
    share = np.sum((place[:, vertex] - start) * along, axis=0) / np.sum(along**2, axis=0)
    inside = (vertex[None] != edges[edge].T).all(axis=0) & (share > 0) & (share < 1)
    order = np.lexsort((vertex[inside], edge[inside]))
    return vertex[inside][order], edge[inside][order]


def straightened(place: Floats, vertices: Ints, edges: Ints, reach: float) -> Floats:
    """Return the vertices moved so that those within a reach of edges lie on them, (2, m), m.

    The conditions are ``n.(v - (1 - s) a - s b) = 0``, with n the normal of the edge a-b. In
    running bond, vertices determine edges that determine vertices along a whole course, so all
    conditions are solved together.
    """
    vertex, edge = on_edges(place, vertices, edges, reach)
    if not vertex.size:
        return place
    moved, (a, b) = place, edges[edge].T
    rows = np.tile(np.arange(vertex.size), 6)
    columns = np.concatenate([2 * own + axis for own in (vertex, a, b) for axis in (0, 1)])
    for _ in range(ROUNDS):
        along = moved[:, b] - moved[:, a]
        length = np.linalg.norm(along, axis=0)
        normal = np.stack([-along[1], along[0]]) / length
        away = moved[:, vertex] - moved[:, a]
        off = np.sum(normal * away, axis=0)
        if np.abs(off).max() <= 4 * np.finfo(float).eps * np.abs(place).max():
            break
        share = np.sum(away * along, axis=0) / length**2
        values = [
            factor * own for factor in (np.ones_like(share), share - 1, -share) for own in normal
        ]
        system = coo_matrix((np.concatenate(values), (rows, columns)), (vertex.size, place.size))
        step = lsmr(
            system.tocsr(), -off, atol=_EXACT, btol=_EXACT, conlim=0.0, maxiter=100 * off.size
        )[0]
        moved = moved + step.reshape(-1, 2).T
    return moved
