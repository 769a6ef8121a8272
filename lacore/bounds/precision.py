"""Residuals that count as zero in double precision, and meshes that prevent them."""

from collections.abc import Iterable

import numpy as np

from lacore.bounds.constants import EXACT
from lacore.model.bodies.continuum.body import Body


def exactness(bodies: Iterable[Body]) -> float:
    """Return the residual that counts as zero: 1e-12, or the precision of coordinates if larger.

    Edges in line within that precision make conditions that are dependent within it, and leave a
    residual of this size.
    """
    eps = np.finfo(float).eps
    return max([EXACT, *(eps * float(np.abs(b.mesh.p).max()) / b.size for b in bodies)])


def smallest_angle(body: Body) -> float:
    """Return the smallest angle of all elements, degrees; NaN for quadrilaterals and tetrahedra."""
    mesh = body.mesh
    if mesh.t.shape[0] != 3:
        return float("nan")
    corner = mesh.p[:, mesh.t]
    one, two = np.roll(corner, 1, axis=1) - corner, np.roll(corner, 2, axis=1) - corner
    sine = np.abs(one[0] * two[1] - one[1] * two[0])
    return float(np.degrees(np.arctan2(sine, np.sum(one * two, axis=0)).min()))
