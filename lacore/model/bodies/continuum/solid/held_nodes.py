"""Free continuous three-dimensional velocities under conditions at nodes, node by node.

As `lacore.model.conditions.elimination` in the plane; a node keeps the directions without a
condition.
"""

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix

from lacore.numerics.arrays import Floats, Ints, Sparse
from lacore.reporting.errors import InputError

_PARALLEL = 1e-12  # by squared sizes: directions that are equal, far above round-off
_CONFLICT = 1e-9


def flowing_between_nodes(
    at: Ints, d: Floats, wanted: Floats, node_dofs: Ints, footings: list[str]
) -> tuple[Sparse, Sparse]:
    """Return the velocities of nodes by their free unknowns, and by the speeds of footings.

    Args:
        at: nodes of conditions, shape (c,).
        d: their directions, shape (c, 3).
        wanted: velocity along these per speed of the footings, shape (c, s).
        node_dofs: the three unknowns of each node, shape (3, nodes), from 0 on.
        footings: names, one for each speed, for messages.

    Raises:
        InputError: a footing cannot move because of its supports, or another footing.
    """
    count = node_dofs.shape[1]
    gram = np.zeros((count, 3, 3))
    np.add.at(gram, at, d[:, :, None] * d[:, None, :])
    moved = np.zeros((count, 3, len(footings)))
    np.add.at(moved, at, d[:, :, None] * wanted[:, None, :])
    size, axes = np.linalg.eigh(gram)  # axes[node, :, k] of size[node, k]
    bound = size > _PARALLEL * np.maximum(size.max(axis=1, keepdims=True), 1.0)
    inverse = np.where(bound, 1 / np.where(bound, size, 1.0), 0.0)
    carried = np.einsum("nik,nk,njk,njf->nif", axes, inverse, axes, moved)
    given = np.einsum("ci,cif->cf", d, carried[at])
    wrong = np.abs(given - wanted).max(axis=0, initial=0.0) > _CONFLICT
    if wrong.any():
        raise InputError(
            "RigidFooting",
            footings[int(np.flatnonzero(wrong)[0])],
            "a support or another footing at one of its nodes keeps it from moving",
            "let the other one end before it, or take the space 'p2-disc', which slips there",
        )
    axes[~bound.any(axis=1)] = np.eye(3)  # without conditions: along x, y and z
    node, axis = np.nonzero(~bound)
    column = np.arange(node.size)
    entries = (axes[node, :, axis].T, node_dofs[:, node], np.broadcast_to(column, (3, node.size)))
    values, rows, columns = (own.ravel() for own in entries)
    basis = csr_matrix(coo_matrix((values, (rows, columns)), shape=(node_dofs.size, node.size)))
    basis.eliminate_zeros()
    by_speed = np.zeros((node_dofs.size, len(footings)))
    by_speed[node_dofs.T] = carried
    return basis, csr_matrix(by_speed)
