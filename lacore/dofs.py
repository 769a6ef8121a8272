"""Numbering of the velocity unknowns of all bodies."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from skfem import Basis

from lacore.arrays import Floats, Ints
from lacore.bodies import Body
from lacore.spaces import SPACES


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
