"""Check that the bodies of a file do not overlap."""

from collections.abc import Mapping
from functools import singledispatch
from itertools import combinations

import numpy as np
import shapely

from lacore.model.bodies.any_body import AnyBody
from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.blocks.overlap import depth_of, overlap_told
from lacore.model.bodies.continuum.body import Body
from lacore.reporting.errors import InputError

_DEEP = 0.02  # by the smaller body: adjacent round sides overlap by less because of their chords


def require_apart(bodies: Mapping[str, AnyBody]) -> None:
    """Raise `InputError` for overlapping bodies, which are usually a missing coordinate."""
    outlines = {name: _outline(body) for name, body in bodies.items()}
    for (one, here), (other, there) in combinations(outlines.items(), 2):
        if here is None or there is None or not shapely.intersects(here, there):
            continue
        common = shapely.intersection(here, there)
        size = min(bodies[one].size, bodies[other].size)
        if common.area and depth_of(common) > _DEEP * size:
            why = f"{one} and {other} {overlap_told(here, there)}"
            fix = "move one of them, or cut it out of the other"
            raise InputError(f"bodies[{other!r}]", other, why, fix)


@singledispatch
def _outline(body: AnyBody) -> shapely.Geometry | None:
    """Return the area that a body covers; None for lines."""
    return None


@_outline.register
def _of_blocks(body: BlockAssembly) -> shapely.Geometry:
    return shapely.union_all([shapely.Polygon(own) for own in body.polygons.values()])


@_outline.register
def _of_mesh(body: Body) -> shapely.Geometry:
    mesh = body.mesh
    facets = mesh.facets[:, mesh.boundary_facets()]
    lines = shapely.linestrings(np.transpose(mesh.p[:, facets], (2, 1, 0)))
    return shapely.build_area(shapely.union_all(lines))
