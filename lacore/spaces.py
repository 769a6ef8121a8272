"""Velocity spaces (T22-T24): their elements, where strain rates are taken, what they prove.

A space is strict where its dissipation is nowhere below that of the continuum at any velocity it
holds, and its velocities are admissible: each element by the vertex rule, or of constant strain.
"""

from dataclasses import dataclass

import numpy as np
from skfem import (
    Basis,
    Element,
    ElementDG,
    ElementQuad2,
    ElementTriP1,
    ElementTriP2,
    ElementVector,
    Mesh,
)
from skfem.mesh import MeshQuad1, MeshQuad2, MeshTri1, MeshTri2

from lacore.arrays import Floats

_ROUND_OFF = 1e-12  # of a factor of order one


@dataclass(frozen=True)
class VelocitySpace:
    """One velocity space.

    Attributes:
        name: as given to ``Body(space=...)``.
        mesh: the type of mesh that it lives on.
        element: of one velocity component.
        degree: of the velocity along an element edge.
        points: strain points on the reference element, of equal weight, shape (2, q).
        strict: whether its dissipation is never below that of the continuum.
        jumps: whether velocities jump from element to element (T23).
        locks: whether incompressibility locks it on general meshes (T24).
        curved: type of isoparametric mesh that it lives on too (T31); None: it is for straight
            edges only.
    """

    name: str
    mesh: type[Mesh]
    element: Element
    degree: int
    points: Floats
    strict: bool
    jumps: bool = False
    locks: bool = False
    curved: type[Mesh] | None = None

    @property
    def linear(self) -> bool:
        """Whether strain rates are linear in a straight element: known from its strain points.

        Then ``theta = 0`` at three of them is ``theta = 0`` everywhere, wherever they are.
        """
        return self.mesh is MeshTri1

    def to_vertices(self) -> Floats:
        """Factors that take strain rates from the strain points to the vertices, shape (3, q)."""
        count = self.points.shape[1]
        if count == 1:
            return np.ones((3, 1))
        places = np.stack([1 - self.points.sum(axis=0), *self.points], axis=1)
        factors = np.linalg.inv(places)
        factors[np.abs(factors) < _ROUND_OFF] = 0.0
        return np.asarray(factors)

    def basis(self, mesh: Mesh) -> Basis:
        """scikit-fem basis whose quadrature points are the strain points, of equal weight."""
        count = self.points.shape[1]
        area = 0.5 if self.mesh is MeshTri1 else 1.0  # of the reference element
        return Basis(
            mesh,
            ElementVector(self.element),
            quadrature=(self.points, np.full(count, area / count)),
        )


_VERTICES = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
_INSIDE = np.array([[1 / 6, 2 / 3, 1 / 6], [1 / 6, 1 / 6, 2 / 3]])
_CENTRE = np.array([[1 / 3], [1 / 3]])
_LOW, _HIGH = 0.5 - np.sqrt(1 / 12), 0.5 + np.sqrt(1 / 12)
_GAUSS = np.array([[_LOW, _HIGH, _HIGH, _LOW], [_LOW, _LOW, _HIGH, _HIGH]])
_P1, _P2 = ElementTriP1(), ElementTriP2()

SPACES = {
    space.name: space
    for space in (
        VelocitySpace("p2-vertex", MeshTri1, _P2, 2, _VERTICES, strict=True),
        VelocitySpace("p2-gauss", MeshTri1, _P2, 2, _INSIDE, strict=False, curved=MeshTri2),
        VelocitySpace("p2-disc", MeshTri1, ElementDG(_P2), 2, _VERTICES, strict=True, jumps=True),
        VelocitySpace("p1-disc", MeshTri1, ElementDG(_P1), 1, _CENTRE, strict=True, jumps=True),
        VelocitySpace("p1", MeshTri1, _P1, 1, _CENTRE, strict=True, locks=True),
        VelocitySpace("q2", MeshQuad1, ElementQuad2(), 2, _GAUSS, strict=False, curved=MeshQuad2),
    )
}
