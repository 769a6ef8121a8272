"""Loads on a continuum: checks of a problem, and forces on its unknowns."""

from functools import singledispatch
from typing import TYPE_CHECKING

import numpy as np
from skfem import Basis, ElementQuad1, ElementTetP1, ElementTriP1, FacetBasis, LinearForm
from skfem.assembly.basis import AbstractBasis
from skfem.mesh import MeshTet1, MeshTri1
from skfem.quadrature import get_quadrature
from skfem.refdom import RefQuad, RefTet, RefTri

from lacore.model.bodies.continuum.body_forces import elements_of, force_field
from lacore.model.bodies.continuum.boundaries import boundary_facets, vertex_at
from lacore.model.bodies.continuum.water import in_pores, on_facets
from lacore.model.conditions.body_forces import BodyForce
from lacore.model.conditions.footings import Footing, RigidFooting, Twist
from lacore.model.conditions.loads import Fix, Load, PointForce, SurfaceLoad
from lacore.model.conditions.water import PorePressure, StandingWater
from lacore.model.meshes.curved import OnFacets, is_curved
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.errors import InputError

if TYPE_CHECKING:
    from lacore.model.bodies.continuum.body import Body
    from lacore.model.bodies.continuum.dofs import BodyDofs

# This is exact for velocities of degree 2, times an area that is linear on straight quadrilaterals;
# on curved ones it is cubic in either direction, and the radius is quadratic.
_LOAD_ORDER, _CURVED_ORDER = 3, 7


@singledispatch
def check_load(load: Load, body: "Body", field: str) -> None:
    """Raise `InputError` where a body cannot carry a load; it names the `field` of the load."""
    raise TypeError(f"not a load: {type(load).__name__}")


@check_load.register(SurfaceLoad)
@check_load.register(RigidFooting)
@check_load.register(Twist)
def _check_boundary(load: SurfaceLoad | Footing, body: "Body", field: str) -> None:
    boundary_facets(body, load.where, f"{field}.where")


@check_load.register(PointForce)
def _check_point(load: PointForce, body: "Body", field: str) -> None:
    vertex_at(body, load.at, f"{field}.at")


@check_load.register(BodyForce)
def _check_volume(load: BodyForce, body: "Body", field: str) -> None:
    force_field(load, body, field)


@check_load.register(PorePressure)
def _check_pores(load: PorePressure, body: "Body", field: str) -> None:
    _require_plane(body, field)
    if body.kinematics == "plane_stress":
        raise InputError(
            f"{field}.body",
            load.body,
            "plane stress: what is free to grow across the plane has no water to hold in",
            "take kinematics='plane_strain'",
        )
    in_pores(load, body, field)


@check_load.register(StandingWater)
def _check_standing(load: StandingWater, body: "Body", field: str) -> None:
    _require_plane(body, field)
    facets = boundary_facets(body, load.where, f"{field}.where")
    on_facets(load, body, facets, field)


def _require_plane(body: "Body", field: str) -> None:
    if body.dimension == 3:
        raise InputError(
            f"{field}.body", None, "no water in bodies of tetrahedra", "take a plane body"
        )


@singledispatch
def force(load: Load, dofs: "BodyDofs") -> Floats:
    """Return the nodal forces of a load on the unknowns of its body, shape (count,), N/m."""
    raise TypeError(f"no forces at nodes: {type(load).__name__}")


@force.register(SurfaceLoad)
def _on_boundary(load: SurfaceLoad, dofs: "BodyDofs") -> Floats:
    basis = _facet_basis(dofs, facets_of(load, dofs.body))
    return _power(dofs, basis, load.on(np.asarray(basis.normals)))


@force.register(BodyForce)
def _of_volume(load: BodyForce, dofs: "BodyDofs") -> Floats:
    body, field = dofs.body, "BodyForce"
    part = None if load.where is None else elements_of(load, body, f"{field}.where")
    order = _load_order(dofs) if load.piecewise_uniform else _CURVED_ORDER
    basis = Basis(body.mesh, dofs.basis.elem, intorder=order, elements=part)
    elements = np.arange(body.mesh.nelements) if part is None else part
    places = np.asarray(basis.global_coordinates())  # shape (d, elements, points)
    numbers = np.repeat(elements, places.shape[2])
    vector = load.at(places.reshape(len(places), -1), numbers, body.mesh.nelements, field)
    return _power(dofs, basis, vector.reshape(places.shape))


@force.register(PointForce)
def _of_point(load: PointForce, dofs: "BodyDofs") -> Floats:
    total = np.zeros(dofs.count)
    vertex = vertex_at(dofs.body, load.at, "PointForce.at")
    nodes = dofs.vertex_nodes(vertex)  # For discontinuous velocities the force acts on their mean.
    total[dofs.dofs[:, nodes] - dofs.offset] = np.reshape(load.vector, (-1, 1)) / nodes.size
    return total


@force.register(PorePressure)
def _of_pores(load: PorePressure, dofs: "BodyDofs") -> Floats:
    # int u div(v), by parts for discontinuous velocities: -grad(u) in the volume of each element,
    # and u along the outward normal on the whole boundary.
    mesh, u = dofs.body.mesh, in_pores(load, dofs.body, "PorePressure")
    inside = Basis(mesh, dofs.basis.elem, intorder=_load_order(dofs))
    slope = np.asarray(_linear(inside).interpolate(u).grad)
    outline = _facet_basis(dofs, mesh.boundary_facets())
    pushed = np.asarray(_linear(outline).interpolate(u)) * np.asarray(outline.normals)
    return _power(dofs, inside, -slope) + _power(dofs, outline, pushed)


@force.register(StandingWater)
def _standing(load: StandingWater, dofs: "BodyDofs") -> Floats:
    facets = facets_of(load, dofs.body)
    basis = _facet_basis(dofs, facets)
    pressure = on_facets(load, dofs.body, facets, "StandingWater")
    along = np.asarray(_linear(basis).interpolate(pressure))
    return _power(dofs, basis, -along * np.asarray(basis.normals))


@singledispatch
def force_along(load: Load, dofs: "BodyDofs", facets: Ints, directions: Floats) -> Floats:
    """Return the nodal forces of the components of a load on some facets, shape (count,), N/m.

    Only tractions and pressures on boundaries have such forces.

    Args:
        load: Load on the body.
        dofs: Unknowns of the body.
        facets: Facets of its boundary, shape (e,).
        directions: Directions of the components, orthonormal or zero, shape (k, d, e).
    """
    return np.zeros(dofs.count)


@force_along.register(SurfaceLoad)
def _along(load: SurfaceLoad, dofs: "BodyDofs", facets: Ints, directions: Floats) -> Floats:
    loaded, own, _ = np.intersect1d(facets, facets_of(load, dofs.body), return_indices=True)
    if not loaded.size:
        return np.zeros(dofs.count)
    basis = _facet_basis(dofs, loaded)
    held = directions[:, :, own]
    part = np.einsum("kde,deq->keq", held, load.on(np.asarray(basis.normals)))
    return _power(dofs, basis, np.einsum("kde,keq->deq", held, part))


def _linear(basis: AbstractBasis) -> AbstractBasis:
    """Return a linear basis for values at vertices, at the points of a basis."""
    known = {RefTri: ElementTriP1(), RefQuad: ElementQuad1(), RefTet: ElementTetP1()}
    return basis.with_element(known[basis.mesh.refdom])


def _power(dofs: "BodyDofs", basis: Basis, vector: Floats) -> Floats:
    """Return the nodal forces of forces per area or volume at the points of a basis."""
    thickness = dofs.body.thickness(_places(basis))

    @LinearForm
    def power(v, w):  # type: ignore[no-untyped-def]
        power = vector[0] * v[0] + vector[1] * v[1]
        return thickness * (power + vector[2] * v[2] if len(vector) == 3 else power)

    return np.asarray(power.assemble(basis))


def _places(basis: Basis) -> Floats:
    """Return the points of a basis, m, shape (d, ...)."""
    return np.asarray(basis.global_coordinates())


Part = SurfaceLoad | Footing | StandingWater | Fix


def facets_of(part: Part, body: "Body") -> Ints:
    """Return the boundary facets of a body that a load or a support acts on."""
    return boundary_facets(body, part.where, f"{type(part).__name__}.where")


def area(dofs: "BodyDofs", facets: Ints) -> float:
    """Return the area of a part of the boundary, m^2; m per unit thickness."""
    basis = _facet_basis(dofs, facets)
    return float(np.sum(basis.dx * dofs.body.thickness(_places(basis))))


def _load_order(dofs: "BodyDofs") -> int:
    curved = is_curved(dofs.body.mesh) or dofs.body.axisymmetric
    return _CURVED_ORDER if curved else _LOAD_ORDER


def _facet_basis(dofs: "BodyDofs", facets: Ints) -> FacetBasis:
    """Return the basis of a part of the boundary."""
    mesh, order, mapping = dofs.body.mesh, _load_order(dofs), None
    if is_curved(mesh) or not isinstance(mesh, MeshTri1 | MeshTet1):
        mapping = OnFacets(mesh, facets, get_quadrature(mesh.brefdom, order)[0])
    return FacetBasis(mesh, dofs.basis.elem, mapping, facets=facets, intorder=order)
