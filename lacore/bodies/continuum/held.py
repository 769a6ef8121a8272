"""What supports and footings ask of the nodes of a continuum."""

import numpy as np

from lacore.arrays import Floats, Ints
from lacore.bodies.continuum.boundaries import outward_normals
from lacore.bodies.continuum.dofs import BodyDofs
from lacore.bodies.continuum.loaded import facets_of
from lacore.bodies.continuum.slip import Slip
from lacore.conditions.elimination import NodeConditions
from lacore.conditions.footings import Footing
from lacore.conditions.loads import Fix
from lacore.conditions.nodes import footing_conditions, support_conditions
from lacore.errors import InputError

_STRAIGHT = 1 - 1e-9  # cosine between normals of edges on one line
_CORNER = 0.5  # cosine of a corner that is meant: edges turn by 60 degrees and more


def _boundary_nodes(dofs: BodyDofs, facets: Ints) -> tuple[Ints, Floats]:
    """Nodes on facets, a each, and the outward normal there: (a n,), (a n, 2)."""
    nodes = dofs.facet_nodes(facets)
    shares = np.linspace(0.0, 1.0, len(nodes))
    outward = [outward_normals(dofs.body, facets, s).T for s in shares]
    return nodes.ravel() + dofs.first_node, np.concatenate(outward)


def support_of(support: Fix, dofs: BodyDofs, slip: Slip | None) -> NodeConditions:
    """What a support asks of the nodes of a body, where that does not slip past it."""
    facets = facets_of(support, dofs.body)
    if support.components in ("normal", "tangential"):
        _require_straight(support, dofs, facets)
    if slip is not None:
        facets = np.setdiff1d(facets, slip.of(-1))
    return support_conditions(support, *_boundary_nodes(dofs, facets))


def _require_straight(support: Fix, dofs: BodyDofs, facets: Ints) -> None:
    """Refuse polygons in place of arcs: two normals at each vertex would pin it."""
    start, *_, end = dofs.facet_nodes(facets)
    outward = [outward_normals(dofs.body, facets, s).T for s in (0.0, 1.0)]
    nodes, normals = np.concatenate([start, end]), np.concatenate(outward)
    order = np.argsort(nodes, kind="stable")
    same = nodes[order][1:] == nodes[order][:-1]
    cosine = np.sum(normals[order][1:] * normals[order][:-1], axis=1)[same]
    if np.any((cosine < _STRAIGHT) & (cosine > _CORNER)):
        raise InputError(
            "Fix.components",
            support.components,
            "its boundary turns by small angles, like a polygon in place of an arc: with two"
            " normals at a vertex, no velocity would be left there",
            "fix straight parts one by one, or the components x and y",
        )


def footing_of(footing: Footing, dofs: BodyDofs, slip: Slip | None, number: int) -> NodeConditions:
    """What the footing with a number asks of the nodes of a body, where that does not slip."""
    facets = facets_of(footing, dofs.body)
    if slip is not None:
        facets = np.setdiff1d(facets, slip.of(number))
    return footing_conditions(footing, *_boundary_nodes(dofs, facets), number)
