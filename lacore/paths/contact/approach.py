"""Contact rows along a path: boundaries that touch plane obstacles, or may within a step (T28).

On a plane the distance of a curved edge is quadratic in its parameter and lies in the hull of its
Bernstein control values, as its velocity does: where ``gap + dt u_n >= 0`` holds at these, no point
of the edge is behind the plane at the end of the step.
"""

import numpy as np
from scipy.sparse import csr_matrix, vstack

from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.contact.laws import Laws
from lacore.model.contact.obstacles import Obstacle
from lacore.model.meshes.curved import EdgeCurves
from lacore.numerics.arrays import Floats
from lacore.paths.configuration import Configuration
from lacore.paths.contact.stations import Station

# Gauss rule on (0, 1): exact up to degree 5, and where the length of a curved edge is smooth.
_PLACES, _WEIGHTS = (np.polynomial.legendre.leggauss(3)[0] + 1) / 2, np.array([5, 8, 5]) / 18


def gaps(obstacle: Obstacle, nodes: Floats, dofs: BodyDofs) -> Floats:
    """Distances at the control values of the edges of an obstacle, m: vertices, then middles."""
    start, middle, end = dofs.facet_nodes(obstacle.facets)
    ends = np.unique([start, end])
    controls = 2 * nodes[:, middle] - (nodes[:, start] + nodes[:, end]) / 2
    return obstacle.shape.distance(np.concatenate([nodes[:, ends], controls], axis=1))


def obstacle_station(own: Obstacle, dofs: BodyDofs, n: int, begin: Configuration) -> Station:
    """Control values of the edges of an obstacle, those at vertices, then those at middles.

    Args:
        own: the obstacle.
        dofs: of its body where the step is solved: weights are lengths there.
        n: unknowns.
        begin: where the step begins: distances are those there.
    """
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
    gap = own.shape.distance(began)
    laws = (own.law.coefficient, own.law.limit, 0.0, 0.0)
    return Station(
        name=own.name,
        bodies=(own.body,),
        places=np.asarray(controls @ dofs.nodes.T),
        normals=own.shape.normal(began).T,
        weights=np.concatenate([weights, share[1]]),
        gaps=gap,
        laws=Laws(*(np.full(gap.size, float(value)) for value in laws)),
        away=gap > own.near,
        x=x,
        y=y,
        moving=np.column_stack([np.zeros(gap.size, np.int64), np.full(gap.size, -1)]),
    )
