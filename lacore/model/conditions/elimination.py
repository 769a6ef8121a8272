"""Supports and rigid footings as a linear map from the free unknowns to all velocities.

Each condition is local to a node: ``direction . u_node = sum_f factor_f q_f``, with the footing
velocities q_f as further unknowns; a support has no factors. A node keeps the directions without a
condition.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix

from lacore.numerics.arrays import Bools, Floats, Ints, Sparse
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact

_PARALLEL = 1e-12  # squared sine between directions that are equal: far above round-off
_CONFLICT = 1e-9


class HeldFootingError(InputError):
    """Raised for a footing that cannot move because of other conditions at a node."""


@dataclass(frozen=True, repr=False)
class NodeConditions(Compact):
    """Conditions on nodes.

    Attributes:
        nodes: shape (c,).
        directions: unit vectors, shape (c, 2).
        footing: number of the footing that moves the node, -1 for a support, shape (c,).
        factors: velocity along `directions` per footing velocity, shape (c,).
    """

    nodes: Ints
    directions: Floats
    footing: Ints
    factors: Floats


def held(nodes: Ints, directions: Floats) -> NodeConditions:
    """Return supports: no velocity along `directions`."""
    return NodeConditions(nodes, directions, np.full(nodes.size, -1), np.zeros(nodes.size))


def join(parts: list[NodeConditions]) -> NodeConditions:
    """Return all conditions joined."""
    return NodeConditions(
        np.concatenate([np.zeros(0, dtype=np.int64), *(part.nodes for part in parts)]),
        np.concatenate([np.zeros((0, 2)), *(part.directions for part in parts)]),
        np.concatenate([np.zeros(0, dtype=np.int64), *(part.footing for part in parts)]),
        np.concatenate([np.zeros(0), *(part.factors for part in parts)]),
    )


def free_basis(conditions: NodeConditions, node_dofs: Ints, footing_names: list[str]) -> Sparse:
    """Return a matrix whose columns span the free velocities.

    Args:
        conditions: conditions on nodes.
        node_dofs: the two dofs of each node, shape (2, nodes); footing f has dof 2 nodes + f.
        footing_names: one per footing, for messages.

    Raises:
        InputError: a footing cannot move because of its supports, or another footing.
    """
    n_nodes, n_footings = node_dofs.shape[1], len(footing_names)
    d = conditions.directions
    count, sliding, carried = _carried(conditions, n_nodes, n_footings)
    _check_consistent(conditions, carried, footing_names)

    tangent = np.zeros((n_nodes, 2))
    tangent[conditions.nodes] = np.stack([-d[:, 1], d[:, 0]], axis=1)
    free = np.flatnonzero(count <= 0)
    slide = np.flatnonzero(sliding)
    nodes, axes, footing = np.nonzero(carried)
    first_slide = 2 * free.size
    first_footing = first_slide + slide.size
    entries = [
        (node_dofs[:, free].ravel(), np.arange(2 * free.size), np.ones(2 * free.size)),
        *(
            (node_dofs[c, slide], first_slide + np.arange(slide.size), tangent[slide, c])
            for c in (0, 1)
        ),
        (node_dofs[axes, nodes], first_footing + footing, carried[nodes, axes, footing]),
        (
            2 * n_nodes + np.arange(n_footings),
            first_footing + np.arange(n_footings),
            np.ones(n_footings),
        ),
    ]
    rows, columns, values = (np.concatenate(part) for part in zip(*entries, strict=True))
    basis = csr_matrix(
        coo_matrix(
            (values, (rows, columns)), shape=(2 * n_nodes + n_footings, first_footing + n_footings)
        )
    )
    basis.eliminate_zeros()
    return basis


def contradictory(conditions: NodeConditions, n_nodes: int, n_footings: int) -> Ints:
    """Return the nodes, ascending, at which conditions contradict for arbitrary footing speeds."""
    _, _, carried = _carried(conditions, n_nodes, n_footings)
    wrong = _missing(conditions, carried).max(axis=1, initial=0.0) > _CONFLICT
    return np.unique(conditions.nodes[wrong])


def _carried(
    conditions: NodeConditions, n_nodes: int, n_footings: int
) -> tuple[Floats, Bools, Floats]:
    """Return the conditions at nodes, (nodes,), which may slide, and footing motions.

    The latter have the shape (nodes, 2, f).
    """
    d = conditions.directions
    gram = np.zeros((n_nodes, 2, 2))
    np.add.at(gram, conditions.nodes, d[:, :, None] * d[:, None, :])
    moved = np.zeros((n_nodes, 2, n_footings))
    of_footing = conditions.footing >= 0
    for axis in (0, 1):
        np.add.at(
            moved[:, axis],
            (conditions.nodes[of_footing], conditions.footing[of_footing]),
            d[of_footing, axis] * conditions.factors[of_footing],
        )
    count = np.trace(gram, axis1=1, axis2=2)
    determinant = np.linalg.det(gram)
    fixed = determinant > _PARALLEL * np.maximum(count, 1) ** 2
    sliding = (count > 0) & ~fixed
    carried = np.zeros_like(moved)
    carried[fixed] = np.linalg.solve(gram[fixed], moved[fixed])
    carried[sliding] = moved[sliding] / count[sliding, None, None]
    return count, sliding, carried


def _missing(conditions: NodeConditions, carried: Floats) -> Floats:
    """Return the error of each condition at a unit speed of each footing, (c, footings)."""
    wanted = np.zeros((conditions.nodes.size, carried.shape[2]))
    of_footing = np.flatnonzero(conditions.footing >= 0)
    wanted[of_footing, conditions.footing[of_footing]] = conditions.factors[of_footing]
    given = np.einsum("ci,cif->cf", conditions.directions, carried[conditions.nodes])
    return np.asarray(np.abs(given - wanted))


def _check_consistent(conditions: NodeConditions, carried: Floats, names: list[str]) -> None:
    wrong = _missing(conditions, carried).max(axis=0, initial=0.0) > _CONFLICT
    if wrong.any():
        raise HeldFootingError(
            "RigidFooting",
            names[int(np.flatnonzero(wrong)[0])],
            "a support or another footing at one of its nodes keeps it from moving",
            "let the other one end before it, release the component along its direction, for two"
            " footings at one place give both one direction and one roughness; or take the space"
            " 'p2-disc', whose velocities jump",
        )
