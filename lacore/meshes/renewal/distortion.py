"""How far curved elements are distorted."""

import numpy as np
from skfem import Mesh

from lacore.arrays import Floats
from lacore.meshes.curved import signed_jacobians

_TRIANGLE = np.array([[1.0, -1 / np.sqrt(3)], [0.0, 2 / np.sqrt(3)]])
"""Takes the triangle of reference to the equilateral one: the inverse of that map is needed."""


def mean_ratios(mesh: Mesh) -> Floats:
    """Compute the mean ratio of each element, the least at its vertices and midside nodes.

    It is ``2 det J / ||J||^2`` of the map from the equilateral triangle, or from the square: 1 for
    these shapes, 0 where an element is degenerate, negative where it is inverted at a node.

    Args:
        mesh: of triangles or quadrilaterals, edges straight or curved.

    Returns:
        Array of shape (elements,).
    """
    corners = mesh.elem.refdom.p
    middles = (corners + np.roll(corners, -1, axis=1)) / 2
    jacobian = np.asarray(mesh.mapping().DF(np.hstack([corners, middles])))
    if corners.shape[1] == 3:
        jacobian = np.einsum("ijep,jk->ikep", jacobian, _TRIANGLE)
    determinant = jacobian[0, 0] * jacobian[1, 1] - jacobian[0, 1] * jacobian[1, 0]
    ratios = 2 * determinant / np.sum(jacobian**2, axis=(0, 1))
    turn = np.sign(signed_jacobians(mesh).sum(axis=1))
    return np.asarray((ratios * turn[:, None]).min(axis=1))
