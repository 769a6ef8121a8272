"""Comparison of the domains of two meshes: bounds on equal domains are of one problem."""

import numpy as np
import shapely
from skfem import MeshTri

from lacore.bounds.constants import PLACED
from lacore.bounds.precision import exactness
from lacore.model.bodies.continuum.body import Body
from lacore.numerics.arrays import Floats, Ints

_SHOWN = "{:.6g}"


def difference(one: Body, other: Body) -> str:
    """Describe where the domain of the second body, or of a name in it, differs.

    Edges are straight. Outlines are compared to the precision of coordinates, by the area between
    them, and by the places of all boundary edges (slits have no area) and of those of every name in
    both meshes.

    Returns:
        Why they differ; empty if they do not.
    """
    near = PLACED * exactness([one, other])
    origin, size = one.mesh.p.min(axis=1), one.size
    edges, others = (body.mesh.boundary_facets() for body in (one, other))
    mine, its = _lines(one.mesh, edges, origin, size), _lines(other.mesh, others, origin, size)
    areas = [shapely.build_area(lines) for lines in (mine, its)]
    between = shapely.area(shapely.symmetric_difference(*areas))
    if between > near * (shapely.length(mine) + shapely.length(its)):
        area, its_area, apart = (
            _SHOWN.format(value * size**2) for value in (*map(shapely.area, areas), between)
        )
        return f"an area of {its_area} against {area} of the problem's mesh, {apart} not in both"
    if _elsewhere(mine, its, near):
        return "its boundary lies elsewhere than that of the problem's mesh, as at a slit"
    names, other_names = one.mesh.boundaries or {}, other.mesh.boundaries or {}
    for name in sorted(set(names) & set(other_names)):
        mine = _lines(one.mesh, np.asarray(names[name]), origin, size)
        its = _lines(other.mesh, np.asarray(other_names[name]), origin, size)
        if _elsewhere(mine, its, near):
            lengths = [_SHOWN.format(shapely.length(lines) * size) for lines in (its, mine)]
            return f"its boundary {name!r} lies elsewhere (lengths {lengths[0]} and {lengths[1]})"
    return ""


def _lines(mesh: MeshTri, facets: Ints, origin: Floats, size: float) -> shapely.MultiLineString:
    ends = (mesh.p.T - origin) / size
    return shapely.multilinestrings(shapely.linestrings(ends[mesh.facets[:, facets].T]))


def _elsewhere(one: shapely.MultiLineString, other: shapely.MultiLineString, near: float) -> bool:
    """Return whether lines differ in length, or have ends or midpoints that are not on both."""
    if one.is_empty or other.is_empty:
        return bool(one.is_empty != other.is_empty)
    longer = abs(shapely.length(one) - shapely.length(other))
    apart = shapely.hausdorff_distance(one, other, densify=0.5)
    return bool(max(longer / max(shapely.length(one), 1.0), apart) > near)
