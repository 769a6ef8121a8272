"""Numbering of the velocity unknowns of all bodies."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix
from skfem import Basis

from lacore.arrays import Floats, Ints, Sparse
from lacore.bodies import Body
from lacore.spaces import SPACES

_ROUND_OFF = 1e-13  # of a shape function


@dataclass(frozen=True)
class BodyDofs:
    """Where a body's velocity stands in the vector of all unknowns.

    Attributes:
        body: the body.
        nodes: coordinates of the P2 nodes, vertices first, then edge midpoints, shape (2, nodes).
        dofs: unknowns (x, y) of each node, shape (2, nodes).
        first_node: number of the body's first node among those of all bodies.
        basis: scikit-fem basis at the strain points; its dofs start at `offset`.
        offset: number of the body's first unknown.
    """

    body: Body
    nodes: Floats
    dofs: Ints
    first_node: int
    basis: Basis
    offset: int
    degree = 2  # of the velocity along an edge

    @property
    def strength(self) -> float:
        """Shear stress that it can carry, Pa."""
        return self.body.criterion.k

    @property
    def extent(self) -> float:
        """Area, m^2."""
        return float(self.basis.dx.sum())

    def parts(self, facets: Ints) -> Ints:
        """The facets themselves: velocities differ from one to the next."""
        return facets

    def moving(self, facets: Ints) -> Ints:
        """What moves continuously: all of the body is one."""
        return np.zeros_like(facets)

    def velocity_rows(self, facets: Ints, points: Floats, n: int) -> tuple[Sparse, Sparse]:
        """Rows of u_x and u_y on facets at points of shape (2, k), each of shape (k, n)."""
        nodes = self.facet_nodes(facets)
        start, _, end = (self.nodes[:, node] for node in nodes)
        along = end - start
        s = np.sum((points - start) * along, axis=0) / np.sum(along**2, axis=0)
        shape = np.stack([(1 - s) * (1 - 2 * s), 4 * s * (1 - s), s * (2 * s - 1)], axis=1)
        kept = np.abs(shape) >= _ROUND_OFF
        first = np.concatenate([[0], np.cumsum(kept.sum(axis=1))])
        x, y = (
            csr_matrix((shape[kept], self.dofs[axis, nodes].T[kept], first), (facets.size, n))
            for axis in (0, 1)
        )
        return x, y

    def facet_nodes(self, facets: Ints) -> Ints:
        """The body's nodes (start, midpoint, end) on facets, shape (3, n)."""
        mesh = self.body.mesh
        start, end = mesh.facets[:, facets]
        return np.stack([start, facets + mesh.p.shape[1], end]).astype(np.int64)


def number(bodies: Mapping[str, Body]) -> dict[str, BodyDofs]:
    """Number the unknowns of bodies, one after the other, in their order."""
    numbered: dict[str, BodyDofs] = {}
    first_node = 0
    for name, body in bodies.items():
        basis = SPACES[body.space].basis(body.mesh)
        dofs = np.concatenate([basis.nodal_dofs, basis.facet_dofs], axis=1).astype(np.int64)
        numbered[name] = BodyDofs(
            body=body,
            nodes=basis.doflocs[:, dofs[0]],
            dofs=dofs + 2 * first_node,
            first_node=first_node,
            basis=basis,
            offset=2 * first_node,
        )
        first_node += dofs.shape[1]
    return numbered
