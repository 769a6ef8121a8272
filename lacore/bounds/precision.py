"""What counts as exact in double precision, and which meshes stand in its way."""

from collections.abc import Iterable

import numpy as np

from lacore.model.bodies.continuum.body import Body

_EXACT = 1e-12  # of quantities of order one, sums of thousands of terms


def exactness(bodies: Iterable[Body]) -> float:
    """Residual that counts as zero: 1e-12, or where that is more the precision of coordinates.

    Edges in line within it make conditions that depend on each other within it, and leave as much.
    """
    eps = np.finfo(float).eps
    return max([_EXACT, *(eps * float(np.abs(b.mesh.p).max()) / b.size for b in bodies)])


def smallest_angle(body: Body) -> float:
    """Of all elements of a body, degrees; NaN for quadrilaterals and tetrahedra."""
    mesh = body.mesh
    if mesh.t.shape[0] != 3:
        return float("nan")
    corner = mesh.p[:, mesh.t]
    one, two = np.roll(corner, 1, axis=1) - corner, np.roll(corner, 2, axis=1) - corner
    sine = np.abs(one[0] * two[1] - one[1] * two[0])
    return float(np.degrees(np.arctan2(sine, np.sum(one * two, axis=0)).min()))
