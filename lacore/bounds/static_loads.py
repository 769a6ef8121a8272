"""Loads as forces on the multipliers of equilibrium elements (T25)."""

from functools import singledispatch
from typing import TYPE_CHECKING

import numpy as np

from lacore.arrays import Floats, Ints
from lacore.bodies.continuum.body_forces import force_field
from lacore.bodies.continuum.boundaries import facet_geometry, outward_normals
from lacore.bodies.continuum.loaded import facets_of
from lacore.bodies.continuum.water import in_pores, on_facets
from lacore.conditions.body_forces import BodyForce
from lacore.conditions.loads import Load, Pressure, Traction
from lacore.conditions.water import PorePressure, StandingWater

if TYPE_CHECKING:
    from lacore.bounds.equilibrium import EquilibriumDofs


@singledispatch
def multiplied(load: Load, dofs: "EquilibriumDofs") -> Floats:
    """Forces of a load, shape (count,), N/m; point forces are refused before."""
    raise TypeError(f"no forces on multipliers: {type(load).__name__}")


@multiplied.register(Traction)
@multiplied.register(Pressure)
def _on_boundary(load: Traction | Pressure, dofs: "EquilibriumDofs") -> Floats:
    facets, d = facets_of(load, dofs.body), dofs.body.dimension
    share = dofs.lengths(facets) / d * load.on(outward_normals(dofs.body, facets, 0.5))
    return _at(dofs, dofs.facet_nodes(facets).ravel(), np.tile(share, d))


@multiplied.register(BodyForce)
def _of_volume(load: BodyForce, dofs: "EquilibriumDofs") -> Floats:
    own = force_field(load, dofs.body, "BodyForce")
    return _at(dofs, dofs.element_nodes[own.elements], dofs.areas[own.elements] * own.mean)


@multiplied.register(StandingWater)
def _standing(load: StandingWater, dofs: "EquilibriumDofs") -> Floats:
    facets = facets_of(load, dofs.body)
    return _pushed(dofs, facets, -on_facets(load, dofs.body, facets, "StandingWater"))


@multiplied.register(PorePressure)
def _of_pores(load: PorePressure, dofs: "EquilibriumDofs") -> Floats:
    # The power of -u I on the vertex strains: of the multipliers of facets inside nothing is left.
    u, outline = in_pores(load, dofs.body, "PorePressure"), dofs.body.mesh.boundary_facets()
    return _at(dofs, dofs.element_nodes, -dofs.rises(u)) + _pushed(dofs, outline, u)


def _pushed(dofs: "EquilibriumDofs", facets: Ints, pressure: Floats) -> Floats:
    """Pressures at vertices, linear along facets, with the outward normal."""
    start, end, outward = facet_geometry(dofs.body, facets)
    ends = dofs.body.mesh.facets[:, facets]
    half = np.linalg.norm(end - start, axis=0) / 2
    force = np.concatenate([half * pressure[own] * outward for own in ends], axis=1)
    return _at(dofs, dofs.facet_nodes(facets).ravel(), force)


def _at(dofs: "EquilibriumDofs", nodes: Ints, force: Floats) -> Floats:
    """Forces (d, k) at nodes (k,), which may be there twice."""
    total = np.zeros((dofs.n_nodes, dofs.body.dimension))
    np.add.at(total, nodes - dofs.first_node, force.T)
    return total.ravel()
