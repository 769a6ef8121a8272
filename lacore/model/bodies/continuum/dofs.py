"""Numbering of the velocity unknowns of all bodies."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix
from skfem import Basis

from lacore.model.bodies.continuum.body import Body, on_axis
from lacore.model.bodies.continuum.boundaries import facets_of
from lacore.model.bodies.continuum.forces import area, force
from lacore.model.bodies.continuum.plasticity import plasticity
from lacore.model.bodies.continuum.solid.faces import face_nodes
from lacore.model.bodies.continuum.spaces import VelocitySpace
from lacore.model.bodies.continuum.velocity_basis import VelocityBasis
from lacore.model.conditions.footings import Footing
from lacore.model.conditions.loads import Load
from lacore.model.meshes.curved import EdgeCurves, edge_curves, is_curved
from lacore.numerics.arrays import Floats, Ints, Sparse
from lacore.program.kinematic import DissipationGroup
from lacore.reporting.showing import Compact

_ROUND_OFF = 1e-13  # by a shape function


@dataclass(frozen=True, repr=False)
class BodyDofs(Compact):
    """Place of the velocity of a body among all unknowns.

    Attributes:
        velocity: basis of the velocity of the body.
        nodes: coordinates of its nodes, shape (d, nodes): vertices, then edge midpoints, then
            centres; for discontinuous velocities the nodes of the first element, then of the
            second, ...
        dofs: unknowns (x, y), or (x, y, z), of each node, shape (d, nodes).
        element_nodes: its nodes by element, vertices, then edges, shape (a, elements).
        first_node: number of the body's first node among those of all bodies.
        offset: number of the body's first unknown.
    """

    velocity: VelocityBasis
    nodes: Floats
    dofs: Ints
    element_nodes: Ints
    first_node: int
    offset: int

    @property
    def body(self) -> Body:
        """The body."""
        return self.velocity.body

    @property
    def basis(self) -> Basis:
        """Scikit-fem basis at the strain points; its unknowns start at 0."""
        return self.velocity.basis

    @property
    def space(self) -> VelocitySpace:
        """The velocity space."""
        return self.velocity.space

    @classmethod
    def at(cls, body: Body, offset: int) -> "BodyDofs":
        """Return the unknowns of a body that begin at a given number."""
        velocity, d = VelocityBasis.of(body), body.dimension
        return cls(
            velocity=velocity,
            nodes=velocity.basis.doflocs[:, ::d],
            dofs=offset + velocity.dofs,
            element_nodes=velocity.element_nodes,
            first_node=offset // d,
            offset=offset,
        )

    @property
    def count(self) -> int:
        """Number of unknowns."""
        return int(self.dofs.size)

    @property
    def bent(self) -> bool:
        """Whether edges are curves."""
        return is_curved(self.body.mesh)

    @property
    def axisymmetric(self) -> bool:
        """Whether it is axisymmetric."""
        return self.body.axisymmetric

    @property
    def pieces_of_unknowns(self) -> Ints:
        """One piece: shape (count,)."""
        return np.zeros(self.count, dtype=np.int64)

    def groups(self, name: str, n: int) -> tuple[DissipationGroup, ...]:
        """Return the dissipation of strains at its points, over n unknowns.

        Jumps are other groups.
        """
        return plasticity(name, self.velocity, self.offset, n)

    def force(self, load: Load) -> Floats:
        """Return the nodal forces of a load, shape (count,), N/m."""
        return force(load, self.velocity)

    def area(self, footing: Footing) -> float:
        """Return the area under a footing, m^2; m per unit thickness."""
        return area(self.velocity, facets_of(footing, self.body.mesh))

    def thickness(self, places: Floats) -> Floats:
        """Return the thickness, see `Body.thickness`."""
        return self.body.thickness(places)

    @property
    def degree(self) -> int:
        """Degree of the velocity along an edge."""
        return self.space.degree

    @property
    def linear(self) -> bool:
        """Whether strain rates are linear in each element, see `VelocitySpace.linear`."""
        return self.velocity.linear

    @property
    def strength(self) -> float:
        """Largest shear stress that the body can carry, Pa; any value with friction."""
        return self.body.largest_shear

    @property
    def extent(self) -> float:
        """Area, m^2."""
        return float(self.areas.sum())

    @property
    def areas(self) -> Floats:
        """Areas of the elements, shape (elements,), m^2."""
        return self.velocity.areas

    @property
    def volumes(self) -> Floats:
        """Volumes of the elements, shape (elements,), m^3; m^2 per unit thickness."""
        return np.asarray(self.weights.sum(axis=1))

    @property
    def axis_nodes(self) -> Ints:
        """Nodes of an axisymmetric body on its axis, numbered among those of all bodies."""
        return self.first_node + np.flatnonzero(on_axis(self.body, self.nodes))

    @property
    def weights(self) -> Floats:
        """Volumes of the strain points, shape (elements, q), m^3; m^2 per unit thickness."""
        return self.velocity.weights

    @property
    def normal_flow(self) -> bool:
        """Whether velocities jump, and normal ones do not by construction: not of soil (T90)."""
        return self.body.dimension == 3 and self.space.jumps and not self.body.pressure_dependent

    def parts(self, facets: Ints) -> Ints:
        """Return the facets, because velocities differ between them."""
        return facets

    def moving(self, facets: Ints) -> Ints:
        """Return the numbers of parts that move continuously: the whole body, or each element."""
        return self.body.mesh.f2t[0, facets] if self.space.jumps else np.zeros_like(facets)

    def curves(self, facets: Ints) -> EdgeCurves:
        """The facets as curves."""
        return edge_curves(self.body.mesh, facets)

    def velocity_rows(self, facets: Ints, points: Floats, n: int) -> tuple[Sparse, Sparse]:
        """Return the rows of u_x and u_y on facets at points of shape (2, k), each of shape (k, n).

        On a curved edge the place is that across its chord from the point.
        """
        nodes = self.facet_nodes(facets)
        shape = edge_shapes(self.curves(facets).parameter(points), self.degree)
        kept = np.abs(shape) >= _ROUND_OFF
        first = np.concatenate([[0], np.cumsum(kept.sum(axis=1))])
        x, y = (
            csr_matrix((shape[kept], self.dofs[axis, nodes].T[kept], first), (facets.size, n))
            for axis in (0, 1)
        )
        return x, y

    def facet_nodes(self, facets: Ints, side: int = 0) -> Ints:
        """Return the nodes (start, end) or (start, midpoint, end) on facets, shape (degree + 1, n).

        In three dimensions they are the vertices, and then the midpoints of edges, see
        `face_nodes`.

        Args:
            facets: facets of the mesh.
            side: which of the two elements at a facet; a boundary facet has only 0.
        """
        mesh = self.body.mesh
        if self.body.dimension == 3:
            return face_nodes(mesh, self.element_nodes, self.degree, facets, side)
        element = mesh.f2t[side, facets]
        corners = len(mesh.t)

        def local(numbers: Ints, wanted: Ints) -> Ints:
            return np.asarray(np.argmax(numbers[:, element] == wanted, axis=0))

        nodes = [local(mesh.t, end) for end in mesh.facets[:, facets]]
        if self.degree == 2:
            nodes.insert(1, corners + local(mesh.t2f, facets))
        return np.asarray(self.element_nodes[np.stack(nodes), element])


def edge_shapes(s: Floats, degree: int) -> Floats:
    """Return the shape functions of nodes along an edge at shares `s`, (s, degree + 1)."""
    if degree == 1:
        return np.stack([1 - s, s], axis=1)
    return np.stack([(1 - s) * (1 - 2 * s), 4 * s * (1 - s), s * (2 * s - 1)], axis=1)
