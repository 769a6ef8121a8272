"""Vertices that nearly meet made one, and corners that nearly lie on edges put there.

What comes out depends neither on the order of lines nor on the direction in which they were drawn,
up to round-off: vertices are sorted before anything is added up, and of all ways to put corners on
edges the one that moves vertices least, in the sum of squares, is taken.
"""

from dataclasses import dataclass

import numpy as np
import shapely
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import lsmr
from scipy.spatial import cKDTree

from lacore.numerics.arrays import Floats, Ints

ROUNDS = 4  # normals turn with the edges: what is left over is squared each time
_EXACT = 1e-15  # relative, of the least squares


@dataclass(frozen=True)
class Merged:
    """Vertices of a drawing, those within the snap of each other as one.

    Attributes:
        place: their mean, (2, m), m; sorted.
        number: which of them each given vertex is, (n,).
        width: of the box around the given vertices of each, (m,), m.
    """

    place: Floats
    number: Ints
    width: Floats


def merged(points: Floats, snap: float) -> Merged:
    """Vertices (n, 2) in m, and those that are one."""
    order = np.lexsort(points.T[::-1])
    sorted_points = points[order]
    pairs = cKDTree(sorted_points).query_pairs(snap, output_type="ndarray")
    links = coo_matrix((np.ones(len(pairs)), pairs.T), shape=(len(points),) * 2)
    count, cluster = connected_components(links, directed=False)
    size = np.bincount(cluster, minlength=count)
    first = sorted_points[np.unique(cluster, return_index=True)[1]]
    # Of differences, so that what is drawn in one place stays there to the last digit.
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
    """Edges (e, 2) as pairs of vertices, each once, whatever its direction, sorted."""
    ordered = np.sort(edges.reshape(-1, 2), axis=1)
    return np.asarray(np.unique(ordered[ordered[:, 0] != ordered[:, 1]], axis=0))


def on_edges(place: Floats, vertices: Ints, edges: Ints, reach: float) -> tuple[Ints, Ints]:
    """Which vertices lie inside which edges, within a reach of them.

    Args:
        place: of all vertices, (2, m), m.
        vertices: to look at, sorted.
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
    """Vertices moved so that those within a reach of edges lie on them, (2, m), m.

    Each of them asks ``n.(v - (1 - s) a - s b) = 0``, n the normal of its edge a-b. In running bond
    vertices hold edges that hold vertices, along a whole course: so all are asked at once.
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
