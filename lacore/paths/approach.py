"""Contact rows along a path: boundaries that touch plane obstacles, or may within a step (T28).

On a plane the distance of a curved edge is quadratic in its parameter and lies in the hull of its
Bernstein control values, as its velocity does: where ``gap + dt u_n >= 0`` holds at these, no point
of the edge is behind the plane at the end of the step.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix, vstack

from lacore.arrays import Floats, Sparse
from lacore.bodies.continuum.dofs import BodyDofs
from lacore.contact.obstacles import Obstacle
from lacore.contact.rows import ContactPoints
from lacore.meshes.curved import EdgeCurves
from lacore.paths.configuration import Configuration
from lacore.program import ContactRows

# Gauss rule on (0, 1): exact up to degree 5, and where the length of a curved edge is smooth.
_PLACES, _WEIGHTS = (np.polynomial.legendre.leggauss(3)[0] + 1) / 2, np.array([5, 8, 5]) / 18


def approaching_rows(
    obstacles: Sequence[Obstacle],
    bodies: Mapping[str, BodyDofs],
    n: int,
    begin: Configuration,
    duration: float,
) -> tuple[ContactRows, ContactPoints]:
    """Rows of all obstacles for n unknowns, and where their points are.

    Args:
        obstacles: with their faces.
        bodies: where the step is solved: weights are lengths there.
        n: unknowns.
        begin: where the step begins: distances are those there.
        duration: of the step, s.
    """
    parts = [_obstacle(own, bodies[own.body], n, begin, duration) for own in obstacles]
    places = np.concatenate([np.zeros((0, 2)), *(part.places for part in parts)])
    weights, gaps = (
        np.concatenate([np.zeros(0), *(getattr(part, name) for part in parts)])
        for name in ("weights", "gaps")
    )
    x, y = (
        csr_matrix(vstack([csr_matrix((0, n)), *(getattr(part, axis) for part in parts)]))
        for axis in ("x", "y")
    )
    counts = [part.gaps.size for part in parts]

    def each(values: Sequence[float]) -> Floats:
        return np.repeat(np.array(values, dtype=float), counts)

    normal = np.concatenate([np.zeros((0, 2)), *(part.normals for part in parts)])
    away = gaps > np.repeat([own.near for own in obstacles], counts)
    limit = each([own.law.limit for own in obstacles])
    rows = ContactRows(
        normal=_along(normal, x, y),
        tangential=_along(np.stack([-normal[:, 1], normal[:, 0]], axis=1), x, y),
        tangent_dim=1,
        weights=weights,
        coefficient=each([own.law.coefficient for own in obstacles]),
        limit=np.where(away, 0.0, limit),  # what does not touch neither sticks nor rubs
        dilatancy=np.zeros(gaps.size),
        interface=np.repeat(np.arange(len(obstacles)), counts),
        closing=gaps / duration if away.any() else None,
    )
    moving = np.column_stack([np.zeros(gaps.size, np.int64), np.full(gaps.size, -1)])
    names = tuple(own.name for own in obstacles)
    return rows, ContactPoints(places, normal, moving, names, gaps, tuple(obstacles))


@dataclass(frozen=True)
class _Part:
    """Control values of the edges of one obstacle: those at vertices, then those at middles."""

    places: Floats
    weights: Floats
    gaps: Floats
    normals: Floats
    x: Sparse
    y: Sparse


def gaps(obstacle: Obstacle, nodes: Floats, dofs: BodyDofs) -> Floats:
    """Distances at the control values of the edges of an obstacle, m: vertices, then middles."""
    start, middle, end = dofs.facet_nodes(obstacle.facets)
    ends = np.unique([start, end])
    controls = 2 * nodes[:, middle] - (nodes[:, start] + nodes[:, end]) / 2
    return obstacle.shape.distance(np.concatenate([nodes[:, ends], controls], axis=1))


def _obstacle(
    own: Obstacle, dofs: BodyDofs, n: int, begin: Configuration, duration: float
) -> _Part:
    start, middle, end = dofs.facet_nodes(own.facets)
    curves = EdgeCurves(dofs.nodes[:, start], dofs.nodes[:, middle], dofs.nodes[:, end])
    share = np.zeros((3, start.size))
    for s, weight in zip(_PLACES, _WEIGHTS, strict=True):
        length = np.linalg.norm(curves.tangent(s), axis=0) * dofs.body.thickness(curves.at(s))
        share += weight * np.outer([(1 - s) ** 2, 2 * s * (1 - s), s**2], length)
    ends, where = np.unique(np.concatenate([start, end]), return_inverse=True)
    count, edges = ends.size, np.arange(start.size)
    weights = np.bincount(where.ravel(), np.concatenate([share[0], share[2]]), minlength=count)
    # Rows of control values in terms of nodes.
    total = int(dofs.nodes.shape[1])
    at_ends = csr_matrix((np.ones(count), (np.arange(count), ends)), (count, total))
    at_middles = csr_matrix(
        (
            np.repeat([2.0, -0.5, -0.5], start.size),
            (np.tile(edges, 3), np.concatenate([middle, start, end])),
        ),
        (start.size, total),
    )
    controls = csr_matrix(vstack([at_ends, at_middles]))
    began = (controls @ begin.nodes[own.body].T).T
    x, y = (
        csr_matrix(
            (controls.data, dofs.dofs[axis, controls.indices], controls.indptr),
            (controls.shape[0], n),
        )
        for axis in (0, 1)
    )
    return _Part(
        places=np.asarray(controls @ dofs.nodes.T),
        weights=np.concatenate([weights, share[1]]),
        gaps=own.shape.distance(began),
        normals=own.shape.normal(began).T,
        x=x,
        y=y,
    )


def _along(direction: Floats, x: Sparse, y: Sparse) -> Sparse:
    rows = csr_matrix(x.multiply(direction[:, :1]) + y.multiply(direction[:, 1:]))
    rows.eliminate_zeros()
    return rows
