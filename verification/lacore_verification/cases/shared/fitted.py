"""A mesh along the slip lines of Hill's mechanism of a smooth strip footing of half width 1.

Velocities jump between its elements, so that a mesh along the lines on which they jump needs few.
"""

from math import cos, pi, radians, tan

import numpy as np
from skfem import MeshTri

import lacore as la
from lacore.model.materials.criterion import Criterion
from lacore.numerics.arrays import Bools, Floats

_AROUND = 1.25  # size of the mesh around the edge of the footing, per that of the mechanism


def section(sectors: int, angle: float) -> MeshTri:
    """Return the triangles of a section; boundaries `left`, `top`, and `held` for all others.

    Wedges under the footing and next to it, a fan of `sectors` triangles between them, and a strip
    below, which stays at rest. With the friction angle, in degrees, the fan follows a spiral.
    """
    phi = radians(angle)
    wedge = pi / 4 + phi / 2
    edge = np.array([1.0, 0.0])
    turn = np.linspace(0.0, pi / 2, sectors + 1)
    radius = 0.5 / cos(wedge) * np.exp(turn * tan(phi))
    direction = pi + wedge + turn
    fan = edge + (radius * np.array([np.cos(direction), np.sin(direction)])).T
    end = [2 * fan[-1, 0] - 1, 0.0]
    inner = np.array([[0.0, 0.0], *fan, end])
    outer = edge + _AROUND * (inner - edge)
    outer[0] = 0.0, fan[0, 1]
    count = len(inner)
    this, following = 1 + np.arange(count - 1), 2 + np.arange(count - 1)
    triangles = np.concatenate(
        [
            [np.zeros_like(this), this, following],
            [this, this + count, following],
            [following, this + count, following + count],
        ],
        axis=1,
    )
    mesh = MeshTri(np.ascontiguousarray([edge, *inner, *outer]).T.copy(), triangles)
    facets = mesh.boundary_facets()
    x, y = mesh.p[:, mesh.facets[:, facets]]
    names = {"left": facets[np.all(x == 0.0, axis=0)], "top": facets[np.all(y == 0.0, axis=0)]}
    names["held"] = np.setdiff1d(facets, np.concatenate(list(names.values())))
    return mesh.with_boundaries(names)


def fitted_slab(ground: Criterion, sectors: int, angle: float, space: str) -> "la.Problem":
    """Return half of a slab between smooth walls under a smooth footing, see `section`."""
    mesh = la.meshes.extruded(section(sectors, angle), (0, 0.5), 1)
    return la.Problem(
        bodies={"soil": la.Body(mesh, ground, kinematics="3d", space=space)},
        supports=[
            *(la.Fix("soil", side, "normal") for side in ("left", "start", "end")),
            la.Fix("soil", "held", "xyz"),
        ],
        reference_loads=[la.RigidFooting("soil", _under, (0, -1, 0), rough=False)],
    )


def _under(x: Floats) -> Bools:
    return np.asarray((x[1] == 0.0) & (x[0] <= 1.0))
