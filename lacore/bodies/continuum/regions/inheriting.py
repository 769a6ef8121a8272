"""A body on another mesh of its domain: regions and values of elements go along."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from skfem import MeshTri

from lacore.materials.criterion import Criterion
from lacore.materials.fields import Field, varying, with_fields
from lacore.meshes.inheriting import inherited

if TYPE_CHECKING:
    from lacore.bodies.continuum.body import Body


def on_mesh(body: "Body", mesh: MeshTri, space: str) -> "Body":
    """The body on another mesh of the same domain, in a velocity space.

    Raises:
        InputError: an element of the mesh that lies in several regions.
    """
    if mesh is body.mesh:
        return replace(body, space=space)
    if body.dimension == 3:  # what is refined in space keeps the names of its regions
        return replace(body, mesh=mesh, space=space)
    field = "mesh"

    def carried(own: Field) -> Field:
        if callable(own.values):
            return own
        values = np.asarray(inherited(body.mesh, mesh, own.values, field), dtype=np.float64)
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
    of = inherited(body.mesh, mesh, number, field)
    named = {region.name: np.flatnonzero(of == at) for at, region in enumerate(body.regions)}
    criteria = {region.name: moved(region.criterion) for region in body.regions}
    mesh = mesh.with_subdomains({**(mesh.subdomains or {}), **named})
    return replace(body, mesh=mesh, criterion=criteria, space=space)
