"""Water loads that are the same on all meshes of a bracket: those of the first mesh (T64).

Pressures are linear between the vertices of an element. On a finer mesh those of a function would
differ, and bounds on different meshes would be bounds of different problems.
"""

from dataclasses import dataclass, replace
from functools import singledispatch

import numpy as np
import shapely
from skfem import MeshTri

from lacore.bounds.constants import SAME_PRESSURE
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.body_forces import free_of_mesh
from lacore.model.bodies.continuum.boundaries import facets_of
from lacore.model.bodies.continuum.water import in_pores, on_facets
from lacore.model.conditions.loads import Load
from lacore.model.conditions.water import PorePressure, StandingWater
from lacore.numerics.arrays import Floats
from lacore.reporting.showing import Compact


@dataclass(frozen=True, repr=False)
class Interpolated(Compact):
    """Function that is linear in each triangle of a mesh.

    Attributes:
        mesh: straight-edged triangles.
        values: values at its vertices, shape (vertices,).
    """

    mesh: MeshTri
    values: Floats

    def __call__(self, x: Floats) -> Floats:
        """Return the values at places of shape (2, n) in the mesh, shape (n,)."""
        corner = self.mesh.p[:, self.mesh.t]  # shape (2, 3, elements)
        tree = shapely.STRtree(shapely.polygons(corner.transpose(2, 1, 0)))
        inside = tree.nearest(shapely.points(x.T))
        a, b, c = corner[..., inside].swapaxes(0, 1)
        own = self.values[self.mesh.t[:, inside]]
        area = _cross(b - a, c - a)
        shares = np.stack([_cross(b - x, c - x), _cross(c - x, a - x), _cross(a - x, b - x)])
        return np.asarray(np.sum(own * shares, axis=0) / area)


@singledispatch
def kept(load: Load, body: Body) -> Load:
    """Return a load as on the mesh of a body, for any mesh of the same domain."""
    return free_of_mesh(load, body.mesh)


@kept.register(PorePressure)
@kept.register(StandingWater)
def _kept(load: PorePressure | StandingWater, body: Body) -> Load:
    return replace(load, pressure=_on_mesh(load, body))


@singledispatch
def differs(load: Load, body: Body, other: Body) -> bool:
    """Return whether a load differs on the mesh of the other body, between its vertices."""
    return False


@differs.register(PorePressure)
@differs.register(StandingWater)
def _differs(load: PorePressure | StandingWater, body: Body, other: Body) -> bool:
    one, two = _on_mesh(load, body), _on_mesh(load, other)
    places = np.concatenate([_places(load, own) for own in (body, other)], axis=1)
    apart = float(np.abs(one(places) - two(places)).max())
    return apart > SAME_PRESSURE * float(one.values.max())


@singledispatch
def _on_mesh(load: Load, body: Body) -> Interpolated:
    raise TypeError(f"no water: {type(load).__name__}")


@_on_mesh.register(PorePressure)
def _pores(load: PorePressure, body: Body) -> Interpolated:
    return Interpolated(body.mesh, in_pores(load, body.mesh, "PorePressure"))


@_on_mesh.register(StandingWater)
def _standing(load: StandingWater, body: Body) -> Interpolated:
    pressure = on_facets(load, body.mesh, facets_of(load, body.mesh), "StandingWater")
    return Interpolated(body.mesh, pressure)


@singledispatch
def _places(load: Load, body: Body) -> Floats:
    """Return the ends and midpoints of the edges on which a load acts, shape (2, n)."""
    raise TypeError(f"no water: {type(load).__name__}")


@_places.register(PorePressure)
def _everywhere(load: PorePressure, body: Body) -> Floats:
    return _ends_and_middles(body.mesh.p[:, body.mesh.facets])


@_places.register(StandingWater)
def _on_boundary(load: StandingWater, body: Body) -> Floats:
    return _ends_and_middles(body.mesh.p[:, body.mesh.facets[:, facets_of(load, body.mesh)]])


def _ends_and_middles(ends: Floats) -> Floats:
    start, end = ends.swapaxes(0, 1)
    return np.concatenate([start, end, (start + end) / 2], axis=1)


def _cross(u: Floats, v: Floats) -> Floats:
    return np.asarray(u[0] * v[1] - u[1] * v[0])
