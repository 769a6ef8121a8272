"""A body on another mesh of its domain, with its regions and values of elements."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import shapely
from skfem import MeshTri

from lacore.model.materials.criterion import Criterion
from lacore.model.materials.fields import Field, varying, with_fields
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.errors import InputError

_INSIDE = 1e-4  # share of the way to its centre: corners on edges of the other mesh lie within

if TYPE_CHECKING:
    from lacore.model.bodies.continuum.body import Body


def on_mesh(body: "Body", mesh: MeshTri, space: str) -> "Body":
    """Return the body on another mesh of the same domain, in a velocity space.

    Raises:
        InputError: an element of the mesh lies in several regions.
    """
    if mesh is body.mesh:
        return replace(body, space=space)
    if body.dimension == 3:  # Refined tetrahedra keep the names of their regions.
        return replace(body, mesh=mesh, space=space)
    field = "mesh"

    def carried(own: Field) -> Field:
        if callable(own.values):
            return own
        values = np.asarray(_inherited(body.mesh, mesh, own.values, field), dtype=np.float64)
        return replace(own, values=values)

    def moved(criterion: Criterion) -> Criterion:
        changed: Criterion = with_fields(criterion, carried)
        return changed

    if len(body.regions) == 1 and not body.regions[0].name:
        (region,) = body.regions
        listed = any(not callable(own.values) for own in varying(region.criterion).values())
        criterion = moved(region.criterion) if listed else region.criterion
        return replace(body, mesh=mesh, criterion=criterion, space=space)
    number = np.zeros(body.mesh.nelements, dtype=np.int64)
    for place, region in enumerate(body.regions):
        number[region.elements] = place
    of = _inherited(body.mesh, mesh, number, field)
    named = {region.name: np.flatnonzero(of == at) for at, region in enumerate(body.regions)}
    criteria = {region.name: moved(region.criterion) for region in body.regions}
    mesh = mesh.with_subdomains({**(mesh.subdomains or {}), **named})
    return replace(body, mesh=mesh, criterion=criteria, space=space)


def _inherited(coarse: MeshTri, finer: MeshTri, values: Floats | Ints, field: str) -> Floats | Ints:
    """Return the values of the elements of a mesh in those of another one, shape (elements, ...).

    Args:
        coarse: straight-edged triangles.
        finer: mesh of the same domain, each element within one of `coarse`, or within several of
            the
            same values.
        values: values of the elements of `coarse`, shape (elements, ...).
        field: name for messages.

    Raises:
        InputError: an element of `finer` lies in elements of different values.
    """
    corner = coarse.p[:, coarse.t]  # shape (2, 3, elements)
    tree = shapely.STRtree(shapely.polygons(corner.transpose(2, 1, 0)))
    own = finer.p[:, finer.t]
    middle = own.mean(axis=1)
    parents = _parents(tree, middle)
    found = values[parents]
    for end in own.transpose(1, 0, 2):
        beside = values[_parents(tree, end + _INSIDE * (middle - end))]
        other = np.flatnonzero((beside != found).reshape(len(found), -1).any(axis=1))
        if other.size:
            x, y = middle[:, other[0]]
            raise InputError(
                field,
                None,
                f"an element near ({x:.6g}, {y:.6g}) lies in parts of the problem's mesh"
                " that differ",
                "let edges of both meshes follow the regions",
            )
    return found


def _parents(tree: shapely.STRtree, places: Floats) -> Ints:
    return np.asarray(tree.nearest(shapely.points(places.T)), dtype=np.int64)
