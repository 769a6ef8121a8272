"""Velocity spaces (T22): where strain rates are taken, and with which weights.

`p2-vertex`: continuous P2 on straight triangles, cone and incompressibility terms at the three
vertices, weights A/3. The strain rate is linear in a triangle, so theta = 0 at the vertices is
theta = 0 everywhere, and the vertex sum over-estimates the convex dissipation: strict upper
bounds (Makrodimopoulos & Martin 2007).
`p2-gauss`: the same velocities, the interior 3-point rule: more accurate, and not a bound.
"""

from dataclasses import dataclass

import numpy as np
from skfem import Basis, ElementTriP2, ElementVector, MeshTri

from lacore.arrays import Floats


@dataclass(frozen=True)
class VelocitySpace:
    """One velocity space.

    Attributes:
        name: as given to ``Body(space=...)``.
        points: strain points on the reference triangle, shape (2, q).
        strict: whether its dissipation is never below that of the continuum.
    """

    name: str
    points: Floats
    strict: bool

    def basis(self, mesh: MeshTri) -> Basis:
        """scikit-fem basis whose quadrature points are the strain points, of equal weight."""
        count = self.points.shape[1]
        return Basis(
            mesh,
            ElementVector(ElementTriP2()),
            quadrature=(self.points, np.full(count, 0.5 / count)),
        )


SPACES = {
    space.name: space
    for space in (
        VelocitySpace("p2-vertex", np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), strict=True),
        VelocitySpace(
            "p2-gauss", np.array([[1 / 6, 2 / 3, 1 / 6], [1 / 6, 1 / 6, 2 / 3]]), strict=False
        ),
    )
}
