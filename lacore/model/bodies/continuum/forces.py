"""Forces of loads on the unknowns of a continuum."""

from functools import singledispatch

import numpy as np
from skfem import Basis, ElementQuad1, ElementTetP1, ElementTriP1, FacetBasis, LinearForm
from skfem.assembly.basis import AbstractBasis
from skfem.mesh import MeshTet1, MeshTri1
from skfem.quadrature import get_quadrature
from skfem.refdom import RefQuad, RefTet, RefTri

from lacore.model.bodies.continuum.body_forces import elements_of
from lacore.model.bodies.continuum.boundaries import facets_of, vertex_at
from lacore.model.bodies.continuum.velocity_basis import VelocityBasis
from lacore.model.bodies.continuum.water import in_pores, on_facets
from lacore.model.conditions.body_forces import BodyForce
from lacore.model.conditions.loads import Load, PointForce, SurfaceLoad
from lacore.model.conditions.water import PorePressure, StandingWater
from lacore.model.meshes.curved import OnFacets, is_curved
from lacore.numerics.arrays import Floats, Ints

# This is exact for velocities of degree 2, times an area that is linear on straight quadrilaterals;
# on curved ones it is cubic in either direction, and the radius is quadratic.
_LOAD_ORDER, _CURVED_ORDER = 3, 7


@singledispatch
def force(load: Load, velocity: VelocityBasis) -> Floats:
    """Return the nodal forces of a load on the unknowns of its body, shape (count,), N/m."""
    raise TypeError(f"no forces at nodes: {type(load).__name__}")


@force.register(SurfaceLoad)
def _on_boundary(load: SurfaceLoad, velocity: VelocityBasis) -> Floats:
    basis = _facet_basis(velocity, facets_of(load, velocity.body.mesh))
    return _power(velocity, basis, load.on(np.asarray(basis.normals)))


@force.register(BodyForce)
def _of_volume(load: BodyForce, velocity: VelocityBasis) -> Floats:
    body, field = velocity.body, "BodyForce"
    part = None if load.where is None else elements_of(load, body.mesh, f"{field}.where")
    order = _load_order(velocity) if load.piecewise_uniform else _CURVED_ORDER
    basis = Basis(body.mesh, velocity.basis.elem, intorder=order, elements=part)
    elements = np.arange(body.mesh.nelements) if part is None else part
    places = np.asarray(basis.global_coordinates())  # shape (d, elements, points)
    numbers = np.repeat(elements, places.shape[2])
    vector = load.at(places.reshape(len(places), -1), numbers, body.mesh.nelements, field)
    return _power(velocity, basis, vector.reshape(places.shape))


@force.register(PointForce)
def _of_point(load: PointForce, velocity: VelocityBasis) -> Floats:
    total = np.zeros(velocity.count)
    vertex = vertex_at(velocity.body.mesh, load.at, "PointForce.at")
    # For discontinuous velocities the force acts on their mean.
    nodes = velocity.vertex_nodes(vertex)
    total[velocity.dofs[:, nodes]] = np.reshape(load.vector, (-1, 1)) / nodes.size
    return total


@force.register(PorePressure)
def _of_pores(load: PorePressure, velocity: VelocityBasis) -> Floats:
    # int u div(v), by parts for discontinuous velocities: -grad(u) in the volume of each element,
    # and u along the outward normal on the whole boundary.
    mesh, u = velocity.body.mesh, in_pores(load, velocity.body.mesh, "PorePressure")
    inside = Basis(mesh, velocity.basis.elem, intorder=_load_order(velocity))
    slope = np.asarray(_linear(inside).interpolate(u).grad)
    outline = _facet_basis(velocity, mesh.boundary_facets())
    pushed = np.asarray(_linear(outline).interpolate(u)) * np.asarray(outline.normals)
    return _power(velocity, inside, -slope) + _power(velocity, outline, pushed)


@force.register(StandingWater)
def _standing(load: StandingWater, velocity: VelocityBasis) -> Floats:
    facets = facets_of(load, velocity.body.mesh)
    basis = _facet_basis(velocity, facets)
    pressure = on_facets(load, velocity.body.mesh, facets, "StandingWater")
    along = np.asarray(_linear(basis).interpolate(pressure))
    return _power(velocity, basis, -along * np.asarray(basis.normals))


@singledispatch
def force_along(load: Load, velocity: VelocityBasis, facets: Ints, directions: Floats) -> Floats:
    """Return the nodal forces of the components of a load on some facets, shape (count,), N/m.

    Only tractions and pressures on boundaries have such forces.

    Args:
        load: Load on the body.
        velocity: Basis of the velocity of the body.
        facets: Facets of its boundary, shape (e,).
        directions: Directions of the components, orthonormal or zero, shape (k, d, e).
    """
    return np.zeros(velocity.count)


@force_along.register(SurfaceLoad)
def _along(load: SurfaceLoad, velocity: VelocityBasis, facets: Ints, directions: Floats) -> Floats:
    under = facets_of(load, velocity.body.mesh)
    loaded, own, _ = np.intersect1d(facets, under, return_indices=True)
    if not loaded.size:
        return np.zeros(velocity.count)
    basis = _facet_basis(velocity, loaded)
    held = directions[:, :, own]
    part = np.einsum("kde,deq->keq", held, load.on(np.asarray(basis.normals)))
    return _power(velocity, basis, np.einsum("kde,keq->deq", held, part))


def _linear(basis: AbstractBasis) -> AbstractBasis:
    """Return a linear basis for values at vertices, at the points of a basis."""
    known = {RefTri: ElementTriP1(), RefQuad: ElementQuad1(), RefTet: ElementTetP1()}
    return basis.with_element(known[basis.mesh.refdom])


def _power(velocity: VelocityBasis, basis: Basis, vector: Floats) -> Floats:
    """Return the nodal forces of forces per area or volume at the points of a basis."""
    thickness = velocity.body.thickness(_places(basis))

    @LinearForm
    def power(v, w):  # type: ignore[no-untyped-def]
        power = vector[0] * v[0] + vector[1] * v[1]
        return thickness * (power + vector[2] * v[2] if len(vector) == 3 else power)

    return np.asarray(power.assemble(basis))


def _places(basis: Basis) -> Floats:
    """Return the points of a basis, m, shape (d, ...)."""
    return np.asarray(basis.global_coordinates())


def area(velocity: VelocityBasis, facets: Ints) -> float:
    """Return the area of a part of the boundary, m^2; m per unit thickness."""
    basis = _facet_basis(velocity, facets)
    return float(np.sum(basis.dx * velocity.body.thickness(_places(basis))))


def _load_order(velocity: VelocityBasis) -> int:
    curved = is_curved(velocity.body.mesh) or velocity.body.axisymmetric
    return _CURVED_ORDER if curved else _LOAD_ORDER


def _facet_basis(velocity: VelocityBasis, facets: Ints) -> FacetBasis:
    """Return the basis of a part of the boundary."""
    mesh, order, mapping = velocity.body.mesh, _load_order(velocity), None
    if is_curved(mesh) or not isinstance(mesh, MeshTri1 | MeshTet1):
        mapping = OnFacets(mesh, facets, get_quadrature(mesh.brefdom, order)[0])
    return FacetBasis(mesh, velocity.basis.elem, mapping, facets=facets, intorder=order)
