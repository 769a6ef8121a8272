"""Velocity spaces (T22-T24): their elements, their strain points, and what they prove.

A space is strict if its dissipation is nowhere below that of the continuum at any of its
velocities, and its velocities are admissible: each element by the vertex rule, or with constant
strain.
"""

from dataclasses import dataclass

import numpy as np
from skfem import (
    Basis,
    Element,
    ElementDG,
    ElementQuad2,
    ElementTetP1,
    ElementTetP2,
    ElementTriP1,
    ElementTriP2,
    ElementVector,
    Mesh,
)
from skfem.mesh import MeshQuad1, MeshQuad2, MeshTet1, MeshTri1, MeshTri2

from lacore.model.materials.conic_form import SPACE
from lacore.numerics.arrays import Floats
from lacore.reporting.showing import Compact

_ROUND_OFF = 1e-12  # by a factor of order one


@dataclass(frozen=True, repr=False)
class VelocitySpace(Compact):
    """One velocity space.

    Attributes:
        name: name in ``Body(space=...)``.
        mesh: the type of mesh.
        element: element of one velocity component.
        degree: degree of the velocity along an element edge.
        points: strain points on the reference element, shape (d, q).
        weights: weights of the points, with sum 1, shape (q,).
        strict: whether its dissipation is never below that of the continuum.
        jumps: whether velocities are discontinuous between elements (T23).
        locks: whether incompressibility locks it on general meshes (T24).
        curved: type of isoparametric mesh that it also supports (T31); None: only straight edges.
        pressures: functions whose weighted sums with theta vanish, by their values at the strain
            points, shape (q, functions); None: theta vanishes at each point.
    """

    name: str
    mesh: type[Mesh]
    element: Element
    degree: int
    points: Floats
    weights: Floats
    strict: bool
    jumps: bool = False
    locks: bool = False
    curved: type[Mesh] | None = None
    pressures: Floats | None = None

    @property
    def linear(self) -> bool:
        """Whether strain rates are linear in a straight element: known from its strain points.

        Then ``theta = 0`` at three of them is ``theta = 0`` everywhere, wherever they are.
        """
        return self.mesh in (MeshTri1, MeshTet1)

    def to_vertices(self) -> Floats:
        """Return the matrix from strain rates at strain points to those at vertices.

        The shape is (vertices, q).
        """
        dimension, count = self.points.shape
        if count == 1:
            return np.ones((dimension + 1, 1))
        places = np.stack([1 - self.points.sum(axis=0), *self.points], axis=1)
        factors = np.linalg.inv(places)
        factors[np.abs(factors) < _ROUND_OFF] = 0.0
        return np.asarray(factors)

    def basis(self, mesh: Mesh) -> Basis:
        """Return the scikit-fem basis whose quadrature points are the strain points."""
        # volume of the reference element
        size = {MeshTri1: 1 / 2, MeshTet1: 1 / 6}.get(self.mesh, 1.0)
        return Basis(
            mesh, ElementVector(self.element), quadrature=(self.points, size * self.weights)
        )


_VERTICES = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
_INSIDE = np.array([[1 / 6, 2 / 3, 1 / 6], [1 / 6, 1 / 6, 2 / 3]])
_CENTRE = np.array([[1 / 3], [1 / 3]])


_LINE, _SHARE = np.sqrt(0.6) * np.array([-1.0, 0.0, 1.0]), np.array([5.0, 8.0, 5.0]) / 18
_GAUSS = (1 + np.stack([np.tile(_LINE, 3), np.repeat(_LINE, 3)])) / 2
_GAUSS_WEIGHTS = np.outer(_SHARE, _SHARE).ravel()
_BILINEAR = np.stack([np.ones(9), *(_GAUSS - 0.5), np.prod(_GAUSS - 0.5, axis=0)], axis=1)
_EQUAL, _ONE = np.full(3, 1 / 3), np.ones(1)
_P1, _P2 = ElementTriP1(), ElementTriP2()

SPACES = {
    space.name: space
    for space in (
        VelocitySpace("p2-vertex", MeshTri1, _P2, 2, _VERTICES, _EQUAL, strict=True),
        VelocitySpace("p2-gauss", MeshTri1, _P2, 2, _INSIDE, _EQUAL, strict=False, curved=MeshTri2),
        VelocitySpace(
            "p2-disc", MeshTri1, ElementDG(_P2), 2, _VERTICES, _EQUAL, strict=True, jumps=True
        ),
        VelocitySpace(
            "p1-disc", MeshTri1, ElementDG(_P1), 1, _CENTRE, _ONE, strict=True, jumps=True
        ),
        VelocitySpace("p1", MeshTri1, _P1, 1, _CENTRE, _ONE, strict=True, locks=True),
        VelocitySpace(
            "q2",
            MeshQuad1,
            ElementQuad2(),
            2,
            _GAUSS,
            _GAUSS_WEIGHTS,
            strict=False,
            curved=MeshQuad2,
            pressures=_BILINEAR,
        ),
    )
}

_CORNERS = np.array([[0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
_QUARTERS, _MIDDLE = np.full(4, 1 / 4), np.full((3, 1), 1 / 4)
_TET1, _TET2 = ElementTetP1(), ElementTetP2()

SOLID_SPACES = {
    space.name: space
    for space in (
        VelocitySpace("p2-vertex", MeshTet1, _TET2, 2, _CORNERS, _QUARTERS, strict=True),
        VelocitySpace(
            "p2-disc", MeshTet1, ElementDG(_TET2), 2, _CORNERS, _QUARTERS, strict=True, jumps=True
        ),
        VelocitySpace(
            "p1-disc", MeshTet1, ElementDG(_TET1), 1, _MIDDLE, _ONE, strict=True, jumps=True
        ),
    )
}
"""Spaces of tetrahedra, whose normal velocities are continuous by construction (T89, T90)."""

BOUNDING = next(
    name for name, space in SPACES.items() if space.strict and not (space.jumps or space.locks)
)
"""The space of upper bounds where nobody chooses: strict and continuous, on any triangles."""


def spaces_of(kinematics: str) -> dict[str, VelocitySpace]:
    """Return the spaces of bodies of some kinematics, by name."""
    return SOLID_SPACES if kinematics == SPACE else SPACES


def isoparametric(mesh: Mesh, wanted: str) -> VelocitySpace:
    """Return the space of a body with curved edges: the wanted one if possible, else the first.

    Args:
        mesh: mesh of triangles or of quadrilaterals.
        wanted: name of the space of the body.
    """
    known = (SPACES[wanted], *SPACES.values())
    return next(s for s in known if s.curved is not None and isinstance(mesh, s.mesh))
