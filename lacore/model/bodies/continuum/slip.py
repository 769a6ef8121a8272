"""Slip past a support, as facets that may move along it (T23)."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix

from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.conditions.elimination import NodeConditions, join
from lacore.numerics.arrays import Bools, Floats, Ints, Sparse
from lacore.reporting.showing import Compact


@dataclass(frozen=True, repr=False)
class Slip(Compact):
    """Facets of a body along which it may slip past a support.

    Attributes:
        facets: facets of its mesh, shape (e,).
        normal: outward unit normals, shape (2, e).
        footing: number of the footing that holds each, -1 for supports, shape (e,).
        unknown: speed of that footing among all unknowns; arbitrary for supports, shape (e,).
        motion: velocity of the support, per speed of the footing, shape (2, e); 0 for fixed
            supports.
        holds_normal: whether it holds the normal velocity too, shape (e,).
        stuck: which ends may not slip, in the order of ``mesh.facets``, shape (2, e).
    """

    facets: Ints
    normal: Floats
    footing: Ints
    unknown: Ints
    motion: Floats
    holds_normal: Bools
    stuck: Bools

    @property
    def tangent(self) -> Floats:
        """The normals turned by +90 degrees, shape (2, e)."""
        return np.stack([-self.normal[1], self.normal[0]])

    def of(self, footing: int) -> Ints:
        """Return the facets of a footing, or with -1 those of the supports."""
        return np.asarray(self.facets[self.footing == footing])

    def nodes(self, dofs: BodyDofs) -> Ints:
        """Return the nodes on its facets, numbered among those of all bodies, shape (a, e)."""
        return np.asarray(dofs.facet_nodes(self.facets) + dofs.first_node)

    def conditions(self, dofs: BodyDofs) -> NodeConditions:
        """Return the remaining conditions at the nodes of its facets."""
        nodes = self.nodes(dofs)
        ends = nodes[[0, -1]]
        parts = []
        for wanted, at, direction in (
            (np.broadcast_to(self.holds_normal, nodes.shape), nodes, self.normal),
            (self.stuck, ends, self.tangent),
        ):
            facet = np.nonzero(wanted)[1]
            along = np.sum(direction * self.motion, axis=0)
            own = NodeConditions(at[wanted], direction.T[facet], self.footing[facet], along[facet])
            parts.append(own)
        return join(parts)

    def held_velocity(self, velocity: Floats) -> Floats:
        """Return the velocity of the support of the facets, shape (2, e), from all unknowns."""
        return np.asarray(self.motion * velocity[self.unknown])

    def held_rows(self, copies: int, n: int) -> tuple[Sparse, Sparse]:
        """Return the rows of u_x and u_y of the supports, `copies` per facet, for n unknowns."""
        count = copies * self.facets.size
        columns, start = np.repeat(self.unknown, copies), np.arange(count + 1)
        x, y = (
            csr_matrix((np.repeat(part, copies), columns, start), (count, n))
            for part in self.motion
        )
        return x, y

    def layer(self, dofs: BodyDofs, velocity: Floats) -> Floats:
        """Return strain rates (xx, yy, gamma_xy) in the slip layers, times volumes, (e, 3)."""
        mesh = dofs.body.mesh
        values = velocity[dofs.dofs[:, dofs.facet_nodes(self.facets)]]  # shape (2, a, e)
        mean = np.array([1.0, 1.0] if dofs.degree == 1 else [1.0, 4.0, 1.0])
        mean = np.einsum("iae,a->ie", values, mean / mean.sum())
        start, end = mesh.p[:, mesh.facets[:, self.facets]].transpose(1, 0, 2)
        length = np.linalg.norm(end - start, axis=0)
        back = length * (self.stuck_to(mean, velocity) - mean)
        (n_x, n_y), (u_x, u_y) = self.normal, back
        return np.stack([n_x * u_x, n_y * u_y, n_x * u_y + n_y * u_x], axis=1)

    def stuck_to(self, values: Floats, velocity: Floats) -> Floats:
        """Return velocities on the facets, shape (2, ..., e), without their slip."""
        shape = (2, *(1,) * (values.ndim - 2), self.facets.size)
        tangent, held = self.tangent.reshape(shape), self.held_velocity(velocity).reshape(shape)
        slip = np.sum(tangent * (values - held), axis=0, keepdims=True)
        return np.asarray(values - tangent * slip)
