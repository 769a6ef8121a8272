"""Velocity of a body in its elements, without a place among the unknowns of other bodies."""

from dataclasses import dataclass

import numpy as np
from skfem import Basis

from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.spaces import VelocitySpace, spaces_of
from lacore.model.meshes.curved import is_curved
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.showing import Compact


@dataclass(frozen=True, repr=False)
class VelocityBasis(Compact):
    """Basis functions of the velocity of a body.

    Attributes:
        body: the body.
        basis: scikit-fem basis at the strain points; its unknowns start at 0.
    """

    body: Body
    basis: Basis

    @classmethod
    def of(cls, body: Body) -> "VelocityBasis":
        """Return the basis that the space of a body has on its mesh."""
        return cls(body, spaces_of(body.kinematics)[body.space].basis(body.mesh))

    @property
    def space(self) -> VelocitySpace:
        """The velocity space."""
        return spaces_of(self.body.kinematics)[self.body.space]

    @property
    def count(self) -> int:
        """Number of unknowns."""
        return int(self.basis.N)

    @property
    def dofs(self) -> Ints:
        """Unknowns of each node, shape (d, nodes): scikit-fem numbers them node by node."""
        return np.arange(self.count, dtype=np.int64).reshape(-1, self.body.dimension).T

    @property
    def element_nodes(self) -> Ints:
        """Nodes by element, vertices, then edges, shape (a, elements)."""
        d = self.body.dimension
        return np.asarray(self.basis.element_dofs[::d].astype(np.int64) // d)

    @property
    def linear(self) -> bool:
        """Whether strain rates are linear in each element, see `VelocitySpace.linear`."""
        straight = self.space.linear and not is_curved(self.body.mesh)
        return straight and not self.body.axisymmetric

    @property
    def areas(self) -> Floats:
        """Areas of the elements, shape (elements,), m^2."""
        return np.asarray(self.basis.dx.sum(axis=1))

    @property
    def weights(self) -> Floats:
        """Volumes of the strain points, shape (elements, q), m^3; m^2 per unit thickness."""
        places = np.asarray(self.basis.global_coordinates())
        return np.asarray(self.basis.dx * self.body.thickness(places))

    def vertex_nodes(self, vertex: int) -> Ints:
        """Return the nodes at a vertex of the mesh: one, or one in each element."""
        mesh = self.body.mesh
        return np.unique(self.element_nodes[: len(mesh.t)][mesh.t == vertex])
