"""Free unknowns under supports and footings."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import cast

import numpy as np
from scipy.sparse import block_diag, csr_matrix, hstack

from lacore.assembly.bonds import Ties, rigid_basis, supports_of
from lacore.assembly.ordering import column_order
from lacore.assembly.unknowns import Unknowns
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.boundaries import facets_of, outward_normals
from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.bodies.continuum.slip import Slip
from lacore.model.bodies.continuum.solid.holding import solid_free_basis
from lacore.model.conditions.elimination import NodeConditions, free_basis, held, join
from lacore.model.conditions.footings import Footing, RigidFooting
from lacore.model.conditions.loads import Fix
from lacore.model.conditions.nodes import footing_conditions, support_conditions
from lacore.model.meshes.curved import is_curved
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Bools, Floats, Ints, Sparse
from lacore.reporting.errors import InputError

_STRAIGHT = 1 - 1e-9  # cosine between normals of edges on one line
_CORNER = 0.5  # cosine of an intended corner: edges turn by 60 degrees and more

_ADMISSIBLE = 1e-9  # by a motion: round-off of a component that supports remove


@dataclass(frozen=True)
class Held:
    """Free unknowns under supports and footings.

    Attributes:
        basis: all unknowns from the free ones, shape (n, free).
        nodes: which nodes of continua a support or a footing acts on, shape (nodes,).
    """

    basis: Sparse
    nodes: Bools


def held_by(problem: Problem, unknowns: Unknowns, slipping: Mapping[str, Slip], tied: Ties) -> Held:
    """Return the free unknowns under supports, footings and bonds, past which bodies may slip.

    Raises:
        InputError: a footing cannot move, or a polygon in place of an arc is held.
    """
    rigid = _driven(rigid_basis(problem, unknowns.rigid, unknowns.n), problem, unknowns)
    if unknowns.continua and unknowns.dimension == 3:
        footings = tuple(unknowns.footings)
        deforming, nodes = solid_free_basis(unknowns.continua, problem.supports, footings)
    else:
        deforming, nodes = _in_plane(problem, unknowns, slipping, tied)
    basis = csr_matrix(block_diag([deforming, rigid], format="csr"))
    return Held(csr_matrix(basis[:, column_order(basis, unknowns.blocks)]), nodes)


def _driven(basis: Sparse, problem: Problem, unknowns: Unknowns) -> Sparse:
    """Return a basis in which all driven rigid blocks move by one unknown.

    Args:
        basis: basis of rigid bodies with their supports.
        problem: problem whose blocks may be driven.
        unknowns: unknowns of all bodies.

    Raises:
        InputError: a support holds a driven block.
    """
    if not problem.driven:
        return basis
    first = unknowns.n - basis.shape[0]
    column, kept = np.zeros(basis.shape[0]), np.ones(basis.shape[1], dtype=bool)
    for name, motion in problem.driven.items():
        dofs = unknowns.blocks[name]
        rows = np.arange(dofs.count) + dofs.offset - first
        free, wanted = basis[rows].toarray(), dofs.unknowns(motion[:, None])
        possible = free @ np.linalg.lstsq(free, wanted, rcond=None)[0]
        if np.linalg.norm(possible - wanted) > _ADMISSIBLE * np.linalg.norm(wanted):
            raise InputError(
                f"ToolTravel.velocity[{name!r}]",
                tuple(motion.tolist()),
                "a support holds the block against this motion",
                "leave the support out, or give a velocity that it allows",
            )
        column[rows] = wanted
        kept &= ~np.any(free, axis=0)
    moving = column[:, None][:, [bool(column.any())]]  # There is no column if all are at rest.
    return csr_matrix(hstack([basis[:, kept], csr_matrix(moving)], format="csr"))


def _in_plane(
    problem: Problem, unknowns: Unknowns, slipping: Mapping[str, Slip], tied: Ties
) -> tuple[Sparse, Bools]:
    """Return a basis of plane continua and footings, and which nodes something acts on."""
    bodies, node_dofs = unknowns.continua, unknowns.node_dofs
    asked = [
        *(
            _support_of(support, bodies[support.body], slipping.get(support.body))
            for support in supports_of(problem)
            if support.body in bodies
        ),
        *(
            _footing_of(footing, bodies[footing.body], slipping.get(footing.body), number)
            for number, footing in enumerate(unknowns.footings)
        ),
        *(slip.conditions(bodies[name]) for name, slip in slipping.items()),
    ]
    conditions = join(asked)
    slid = [slip.nodes(bodies[name]).ravel() for name, slip in slipping.items()]
    nodes = np.isin(np.arange(node_dofs.shape[1]), np.concatenate([conditions.nodes, *slid]))
    nodes = tied.all_of(nodes)
    # On an axis u_r = 0 follows from continuity, so there is no support and no reaction.
    axes = np.concatenate([np.zeros(0, dtype=np.int64), *(b.axis_nodes for b in bodies.values())])
    conditions = join([conditions, held(axes, np.tile([1.0, 0.0], (axes.size, 1)))])
    # Tied nodes are held, and then move with the first ones, to which all their conditions apply.
    conditions = replace(conditions, nodes=tied.first[conditions.nodes])
    conditions = join([conditions, *(held(tied.following, axis) for axis in tied.both_axes)])
    deforming = free_basis(conditions, node_dofs, [own.name for own in unknowns.footings])
    return tied.spread(deforming, node_dofs), nodes


def _boundary_nodes(dofs: BodyDofs, facets: Ints) -> tuple[Ints, Floats]:
    """Return the nodes on facets, several each, and the outward normal there: (a n,), (a n, 2)."""
    nodes = dofs.facet_nodes(facets)
    shares = np.linspace(0.0, 1.0, len(nodes))
    outward = [outward_normals(dofs.body.mesh, facets, s).T for s in shares]
    return nodes.ravel() + dofs.first_node, np.concatenate(outward)


def _support_of(support: Fix, dofs: BodyDofs, slip: Slip | None) -> NodeConditions:
    """Return the conditions of a support at the nodes of a body where it does not slip."""
    facets = facets_of(support, dofs.body.mesh)
    if support.components in ("normal", "tangential"):
        _require_straight(support, dofs, facets)
    if slip is not None:
        facets = np.setdiff1d(facets, slip.of(-1))
    return support_conditions(support, *_boundary_nodes(dofs, facets))


def _require_straight(support: Fix, dofs: BodyDofs, facets: Ints) -> None:
    """Reject polygons in place of arcs: two normals at each vertex would fix it."""
    start, *_, end = dofs.facet_nodes(facets)
    outward = [outward_normals(dofs.body.mesh, facets, s).T for s in (0.0, 1.0)]
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


def _footing_of(footing: Footing, dofs: BodyDofs, slip: Slip | None, number: int) -> NodeConditions:
    """Return the conditions of a footing at the nodes of a body where it does not slip."""
    facets = facets_of(footing, dofs.body.mesh)
    if slip is not None:
        facets = np.setdiff1d(facets, slip.of(number))
    nodes, outward = _boundary_nodes(dofs, facets)
    if not dofs.space.jumps and (dofs.body.geometry != "exact" or is_curved(dofs.body.mesh)):
        outward = _rounded(nodes, outward)
    return footing_conditions(footing, nodes, outward, number)


def slides_on_chords(footing: Footing, body: Body) -> bool:
    """Return whether a smooth footing slides on straight edges that replace an arc of a plane body.

    Continuous velocities follow the arc there, and not the edges.
    """
    if body.dimension != 2 or body.geometry == "exact" or is_curved(body.mesh):
        return False
    if cast(RigidFooting, footing).rough:  # Only three-dimensional bodies have twisting plates.
        return False
    facets = facets_of(footing, body.mesh)
    outward = np.tile(outward_normals(body.mesh, facets, 0.0), 2).T
    mean = _rounded(body.mesh.facets[:, facets].ravel(), outward)
    return bool(np.any(np.sum(mean * outward, axis=1) < _STRAIGHT))


def _rounded(nodes: Ints, outward: Floats) -> Floats:
    """Return outward normals, averaged at nodes of a curved boundary, where two would fix a node.

    At an intended corner of facets both normals are kept.
    """
    _, place = np.unique(nodes, return_inverse=True)
    total = np.zeros((place.max(initial=-1) + 1, 2))
    np.add.at(total, place, outward)
    mean = total[place] / np.linalg.norm(total[place], axis=1, keepdims=True)
    # For two normals, this is the cosine of half of the angle between them.
    turned = np.sum(mean * outward, axis=1)
    return np.where((2 * turned**2 - 1 > _CORNER)[:, None], mean, outward)
