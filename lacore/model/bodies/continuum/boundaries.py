"""Boundary facets from a name or a predicate on coordinates."""

from collections.abc import Callable

import numpy as np
from skfem import Mesh

from lacore.model.bodies.continuum.solid.faces import face_geometry
from lacore.model.bodies.touching import TOUCH
from lacore.model.conditions.footings import Footing
from lacore.model.conditions.loads import Fix, SurfaceLoad
from lacore.model.conditions.water import StandingWater
from lacore.model.conditions.where import Where, edges_inside
from lacore.model.meshes.curved import edge_curves, vertices
from lacore.model.meshes.solid.faces import selected_faces
from lacore.numerics.arrays import Bools, Floats, Ints
from lacore.reporting.errors import InputError, is_plane_vector, require_place, suggest_all
from lacore.reporting.showing import spanned
from lacore.reporting.text import Quantity, text

_UNNAMED = (
    "none is known: name boundaries by mesh.with_boundaries or by physical groups, or give a"
    " function of coordinates (d, n)"
)


Part = SurfaceLoad | Footing | StandingWater | Fix


def size_of(mesh: Mesh) -> float:
    """Return the diagonal of the bounding box, m."""
    return float(np.linalg.norm(np.ptp(mesh.p, axis=1)))


def allowed(mesh: Mesh) -> float:
    """Return the distance up to which coordinates in a mesh count as one, m."""
    return TOUCH * size_of(mesh)


def facets_of(part: Part, mesh: Mesh) -> Ints:
    """Return the boundary facets of a mesh that a load or a support acts on."""
    return boundary_facets(mesh, part.where, f"{type(part).__name__}.where")


def boundary_facets(mesh: Mesh, where: Where, field: str) -> Ints:
    """Return the facets of the part `where` of the boundary of a mesh, sorted.

    A name selects the facets of the mesh with this name, and several names those of all. A
    predicate gets coordinates of shape (d, n), returns a mask (n,), and selects the boundary facets
    that satisfy it along their whole length, or on their whole face; it must not end inside a facet
    (the velocity would need a jump there that the space does not have).

    Raises:
        InputError: unknown name, nothing selected, an interior facet, a predicate that ends
            inside a facet.
    """
    if isinstance(where, tuple) and where:
        own = [boundary_facets(mesh, name, f"{field}[{n}]") for n, name in enumerate(where)]
        return np.unique(np.concatenate(own))
    if isinstance(where, str):
        named = mesh.boundaries or {}
        if where not in named:
            fix = suggest_all(where, named) if named else _UNNAMED
            raise InputError(field, where, "no such boundary", fix)
        facets = np.unique(np.asarray(named[where], dtype=np.int64))
        if np.any(mesh.f2t[1, facets] >= 0):
            raise InputError(
                field, where, "holds facets inside the body", "name facets of the boundary only"
            )
    elif callable(where):
        facets = _selected(mesh, where, field)
    else:
        raise InputError(
            field,
            where,
            "not a boundary",
            "give a tuple of names, a boundary name or a function of coordinates (d, n)",
        )
    if facets.size == 0:
        shown = where if isinstance(where, str) else None
        fix = text(
            "select at least one boundary facet: the mesh lies in {}",
            spanned(mesh.p.min(axis=1), mesh.p.max(axis=1)),
        )
        raise InputError(field, shown, "an empty boundary", fix)
    return facets


def _selected(mesh: Mesh, where: Callable[[Floats], Bools], field: str) -> Ints:
    if len(mesh.p) == 3:
        return selected_faces(mesh, where, field)
    boundary = mesh.boundary_facets()
    curves = edge_curves(mesh, boundary)
    start, end = curves.start, curves.end
    whole, cut = edges_inside(where, start, end, field, curves.middle)
    if cut.size:
        first = cut[0]
        raise InputError(
            field,
            None,
            text(
                "it ends inside the element edge from {} to {} (at a midside node or "
                "elsewhere between vertices)",
                Quantity(tuple(start[:, first]), "m", ".6g"),
                Quantity(tuple(end[:, first]), "m", ".6g"),
            ),
            "put a vertex of the mesh where it ends",
        )
    return np.asarray(boundary[whole], dtype=np.int64)


def outward_normals(mesh: Mesh, facets: Ints, s: float) -> Floats:
    """Return the unit outward normals of boundary facets at a share of their parameter.

    The shape is (d, n).
    """
    if len(mesh.p) == 3:
        return face_geometry(mesh, facets)[1]
    *_, outward = facet_geometry(mesh, facets)
    return edge_curves(mesh, facets).normal(s, outward)


def facet_geometry(mesh: Mesh, facets: Ints) -> tuple[Floats, Floats, Floats]:
    """Return the ends and unit outward normals of (chords of) boundary facets.

    Three arrays (2, n).
    """
    start, end = mesh.p[:, mesh.facets[0, facets]], mesh.p[:, mesh.facets[1, facets]]
    along = end - start
    normal = np.stack([along[1], -along[0]]) / np.linalg.norm(along, axis=0)
    centre = mesh.p[:, mesh.t[:, mesh.f2t[0, facets]]].mean(axis=1)
    outward = np.sign(np.sum(normal * (start - centre), axis=0))
    return start, end, normal * outward


def vertex_at(mesh: Mesh, at: tuple[float, ...] | str, where: str) -> int:
    """Return the index of the mesh vertex at a point; raises `InputError` if there is none."""
    if len(mesh.p) == 3:
        why = "no single force acts on a body of tetrahedra"
        raise InputError(where, at, why, "give a lacore.Traction on some of its faces")
    if isinstance(at, str):
        raise InputError(where, at, "a continuum has no named points", "give (x, y)")
    if not is_plane_vector(at):
        raise InputError(where, at, "not a point", "give (x, y)")
    require_place(where, at)
    places = vertices(mesh)
    distance = np.linalg.norm(places - np.reshape(at, (-1, 1)), axis=0)
    nearest = int(np.argmin(distance))
    if distance[nearest] > allowed(mesh):
        raise InputError(
            where,
            at,
            "no vertex of the mesh is there",
            f"move it to the nearest one, {tuple(places[:, nearest].tolist())}, or the mesh",
        )
    return nearest
