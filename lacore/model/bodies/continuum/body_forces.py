"""Forces per volume in the elements of a continuum, and their transfer to other meshes."""

from dataclasses import dataclass
from functools import singledispatch

import numpy as np
import shapely
from skfem import Mesh, MeshTri

from lacore.model.bodies.continuum.regions.looking import looked_at
from lacore.model.conditions.body_forces import BodyForce
from lacore.model.conditions.loads import Load
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting import terms
from lacore.reporting.errors import InputError, suggest_all
from lacore.reporting.showing import Compact
from lacore.reporting.text import Term, text


@dataclass(frozen=True, repr=False, eq=False)
class ForceField(Compact):
    """Body force in the elements that it acts on.

    Attributes:
        elements: numbers of the elements, ascending, shape (e,).
        vertex: values at the vertices of each element, from within it, N/m^3, shape (d, e, a).
        linear: whether it is linear in each.
    """

    elements: Ints
    vertex: Floats
    linear: bool

    @property
    def mean(self) -> Floats:
        """Means over elements in which it is linear, N/m^3, shape (d, e)."""
        first = self.vertex[..., :1]
        return np.asarray(first[..., 0] + (self.vertex - first).mean(axis=2))  # exact if uniform


@dataclass(frozen=True, repr=False)
class OfElements(Compact):
    """Value for each triangle of a mesh, as a function of place.

    Attributes:
        mesh: straight-edged triangles.
        values: shape (elements,).
    """

    mesh: MeshTri
    values: tuple[float, ...]

    def __call__(self, x: Floats) -> Floats:
        """Return the values at places of shape (2, n) in the mesh, shape (n,)."""
        corner = self.mesh.p[:, self.mesh.t]  # shape (2, 3, elements)
        tree = shapely.STRtree(shapely.polygons(corner.transpose(2, 1, 0)))
        return np.asarray(np.asarray(self.values)[tree.nearest(shapely.points(x.T))])


def force_field(load: BodyForce, mesh: Mesh, field: str) -> ForceField:
    """Return a body force in the elements of a mesh.

    Raises:
        InputError: unknown regions, functions that fail, or values of other elements.
    """
    elements = elements_of(load, mesh, f"{field}.where")
    count = mesh.nelements
    found = []
    for axis in range(len(mesh.p)):

        def along(places: Floats, parts: Ints, axis: int = axis) -> Floats:
            return np.asarray(load.at(places, parts, count, field)[axis])

        found.append(looked_at(along, mesh, elements))
    linear = load.piecewise_uniform or all(own[2] for own in found)
    return ForceField(elements, np.stack([own[1] for own in found]), linear)


def elements_of(load: BodyForce, mesh: Mesh, field: str) -> Ints:
    """Return the elements that a body force acts on: all, or those of regions, ascending.

    Raises:
        InputError: unknown regions of the mesh.
    """
    if load.where is None:
        return np.arange(mesh.nelements)
    known = mesh.subdomains or {}
    names = (load.where,) if isinstance(load.where, str) else load.where
    for name in names:
        if name not in known:
            fix = suggest_all(str(name), known) if known else "the mesh has none: leave it out"
            raise InputError(field, name, "no such region of the mesh", fix)
    parts = [np.asarray(known[name], dtype=np.int64) for name in names]
    return np.unique(np.concatenate(parts))


def largest(load: BodyForce, mesh: Mesh, field: str) -> float:
    """Return its largest size at the vertices of elements, N/m^3."""
    vertex = force_field(load, mesh, field).vertex
    return float(np.linalg.norm(vertex, axis=0).max(initial=0.0))


@singledispatch
def free_of_mesh(load: Load, mesh: Mesh) -> Load:
    """Return a load that does not depend on the mesh, with element values as function of place."""
    return load


@free_of_mesh.register(BodyForce)
def _of_place(load: BodyForce, mesh: Mesh) -> BodyForce:
    if not load.by_elements:
        return load
    return load.changed(lambda values: OfElements(mesh, values))


@singledispatch
def require_linear(load: Load, mesh: Mesh, field: str) -> None:
    """Raise `InputError` where a body force is not linear in each element of a mesh."""


@require_linear.register(BodyForce)
def _linear(load: BodyForce, mesh: Mesh, field: str) -> None:
    if not force_field(load, mesh, field).linear:
        raise InputError(
            field,
            load.told,
            "is not linear in each element: a bound would have to know all of it there",
            text(
                "let edges of the mesh follow its jumps and bends, as {} does; {}or take {}",
                terms.LAYERED,
                Term(
                    "take for the force what is uniform in each element,"
                    " force(mesh.p[:, mesh.t].mean(axis=1)); ",
                    "",
                ),
                terms.SOLVE,
            ),
        )


@singledispatch
def linear(load: Load, mesh: Mesh) -> bool:
    """Return whether a load is linear in each element of a mesh, so that its power is exact."""
    return True


@linear.register(BodyForce)
def _known(load: BodyForce, mesh: Mesh) -> bool:
    return force_field(load, mesh, "BodyForce").linear


@singledispatch
def require_carried(load: Load, mesh: Mesh, field: str) -> None:
    """Raise `InputError` where no stresses of the elements of a mesh balance a load."""


@require_carried.register(BodyForce)
def _carried(load: BodyForce, mesh: Mesh, field: str) -> None:
    if len(mesh.p) == 3 and not load.piecewise_uniform:
        raise InputError(
            field,
            load.told,
            "varies within elements: lower bounds in three dimensions take forces that are uniform"
            " in each",
            text(
                "{}",
                Term(
                    "give a value for each element, force(mesh.p[:, mesh.t].mean(axis=1)); or take"
                    " `upper_bound`, which is exact of what is linear in each",
                    "give a number, or take `lacore solve` without --bracket",
                ),
            ),
        )


@singledispatch
def at_vertices(load: Load, mesh: Mesh, field: str) -> Floats:
    """Return the forces per volume at the vertices of all elements, from within, N/m^3.

    The shape is (d, e, a).
    """
    return np.zeros((len(mesh.p), *mesh.t.T.shape))


@at_vertices.register(BodyForce)
def _in_volume(load: BodyForce, mesh: Mesh, field: str) -> Floats:
    found, own = np.zeros((len(mesh.p), *mesh.t.T.shape)), force_field(load, mesh, field)
    found[:, own.elements] = own.vertex
    return found
