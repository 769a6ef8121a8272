"""Motions without strain of bodies, found from the rows of their strain rates."""

from collections.abc import Sequence

import numpy as np
from scipy.sparse import csc_matrix, csr_matrix, diags_array, hstack, identity, vstack
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from lacore.numerics.arrays import Ints, Sparse
from lacore.program.kinematic import DissipationGroup

_SHIFT = 1e-10  # shift, by the stiffness, that separates rigid motions from the softest others
_SWEEPS = 4  # number of inverse iterations, each of which gains the digits of the shift
_RIGID = 1e-11  # strain of a rigid motion, by the stiffness


def motions_without_strain(groups: Sequence[DissipationGroup]) -> Sparse:
    """Return a basis of the velocities without strain in any of the groups, shape (n, free).

    Each is of one connected part; unknowns without a group are free, with one column each.
    """
    return kernel(csr_matrix(vstack([weighted_rows(group) for group in groups])))


def kernel(rows: Sparse) -> Sparse:
    """Return a basis of the vectors that rows map to zero, shape (n, free).

    Each vector is of one connected part.
    """
    n = rows.shape[1]
    stiffness = csr_matrix(rows.T @ rows)
    count, part = connected_components(stiffness, directed=False)
    untouched = stiffness.diagonal() == 0
    columns = [csr_matrix(identity(n, format="csr")[:, np.flatnonzero(untouched)])]
    for number in range(count):
        own = np.flatnonzero((part == number) & ~untouched)
        if own.size:
            columns.append(_motions_of(csc_matrix(stiffness[own][:, own]), own, n))
    return csr_matrix(hstack(columns))


def weighted_rows(group: DissipationGroup) -> Sparse:
    """Return the rows of strain and volume times the roots of their weights."""
    root = np.sqrt(group.weights)
    return csr_matrix(
        vstack(
            [
                diags_array(np.repeat(root, group.dim)) @ group.rows,
                diags_array(np.sqrt(group.volume_weights)) @ group.volumetric,
            ]
        )
    )


def _motions_of(stiffness: csc_matrix, own: Ints, n: int) -> Sparse:
    """Return the motions of one part, by inverse iteration on a block of growing size."""
    size = float(stiffness.diagonal().max())
    factor = splu(csc_matrix(stiffness + _SHIFT * size * identity(own.size, format="csc")))
    rng, width = np.random.default_rng(0), min(4, own.size)
    while True:
        block = rng.standard_normal((own.size, width))
        for _ in range(_SWEEPS):
            block = np.linalg.qr(factor.solve(block))[0]
        values, vectors = np.linalg.eigh(block.T @ (stiffness @ block))
        rigid = block @ vectors[:, values <= _RIGID * size]
        if rigid.shape[1] < width or width == own.size:
            break
        width = min(2 * width, own.size)
    rigid /= np.abs(rigid).max(axis=0, initial=np.finfo(float).tiny)
    motions = csr_matrix(rigid)
    at = np.repeat(own, np.diff(motions.indptr))
    return csr_matrix((motions.data, (at, motions.indices)), (n, rigid.shape[1]))
