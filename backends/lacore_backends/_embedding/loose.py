"""Motions without resistance as separate unknowns that only the loads act on.

A body without supports, or one that slides along a smooth wall, moves without strain. So does the
whole program at the load factor that balances it. With velocities

    u = Z a + v,   v = 0 where a moves,   rows Z = 0

no row contains a, and ``lambda F0.Z + tau Fd.Z = 0`` gives the load factor before the solve. At
most two of these motions count, since there are two loads; all others are fixed.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import qr
from scipy.sparse import csr_matrix, diags_array, vstack

from lacore.numerics.arrays import Bools, Floats, Ints, Sparse
from lacore.numerics.linear_algebra import SingularError, SymmetricSolver
from lacore_backends._embedding.arrays import Conic
from lacore_backends._embedding.rigid import softest, without_strain
from lacore_backends._embedding.rows import Rows

# power of a load by its nodal forces and the largest velocity, below which it is balanced
_WORKS = 1e-6
# limit for the power of the dead loads, which the round-off strain of a motion may cause
_STRAINED = 1e-8


@dataclass(frozen=True)
class Loose:
    """Program in unknowns q, some of which are a.

    Attributes:
        conic: program whose `loose` unknowns are a.
        basis: ``u = basis q``, shape (n, n).
    """

    conic: Conic
    basis: Sparse

    @property
    def driven(self) -> bool:
        """Whether F0 works on a."""
        return bool(np.any(self.conic.load[self.conic.loose]))

    def alone(self) -> tuple[Floats, float]:
        """Return the smallest a at the speed of the load, and the load factor that balances it.

        The former is returned as u.
        """
        own = self.conic.loose
        load, dead = self.conic.load[own], self.conic.dead[own]
        size = float(load @ load)
        return np.asarray(self.basis[:, own] @ load) / size, 0.0 - float(load @ dead) / size


def loosened(conic: Conic, solver: SymmetricSolver) -> Loose | None:
    """Return the program with such motions as separate unknowns; None if there are none."""
    try:
        modes = _modes(conic, solver)
    except SingularError:
        return None
    if not modes.shape[1]:
        return None
    n, count = modes.shape
    _, pivots = qr(modes.T, mode="r", pivoting=True)
    own = pivots[:count].astype(np.int64)
    loads = np.column_stack([conic.load, conic.dead])
    sums = np.abs(loads).sum(axis=0)
    turn, works, _ = np.linalg.svd(modes.T @ (loads / np.where(sums > 0, sums, 1.0)))
    known = int(np.sum(works > _WORKS))
    moving = modes @ turn[:, :known]
    # Motions driven by dead loads alone are unsafe or round-off, so the original program decides.
    if known == 2 or np.any(np.abs(conic.load @ moving) <= _WORKS * sums[0]):
        return None
    moving = moving / np.abs(moving).max(axis=0, initial=0.0)
    kept = np.ones(n)
    kept[own] = 0.0
    rows, columns = np.tile(np.arange(n), known), np.repeat(own[:known], n)
    moved = csr_matrix((moving.T.ravel(), (rows, columns)), (n, n))
    basis = csr_matrix(diags_array(kept) + moved)
    # Of several motions driven by F0, one would move against the others almost without power.
    balanced = np.abs(conic.dead @ moving) <= _STRAINED * sums[1]
    return Loose(_stated(conic, kept, basis, own[:known], balanced), basis)


def _modes(conic: Conic, solver: SymmetricSolver) -> Floats:
    """Return the motions without strain, orthonormal, shape (n, k)."""
    each = [
        diags_array(np.repeat(1 / np.sqrt(kind.norms), kind.dim)) @ kind.matrix
        for kind in conic.kinds
    ]
    rows = csr_matrix(vstack(each))
    loads = np.column_stack([conic.load, conic.dead])
    return without_strain(rows, softest(csr_matrix(rows.T @ rows), solver, loads))


def _stated(conic: Conic, kept: Floats, basis: Sparse, loose: Ints, balanced: Bools) -> Conic:
    """Return the program in q.

    Rows do not contain the motions, and dead loads do not act on motions in `balanced`.
    """
    straining = diags_array(kept)

    def cut(rows: Rows) -> Rows:
        matrix = csr_matrix(rows.matrix @ straining)
        matrix.eliminate_zeros()
        return replace(rows, matrix=matrix)

    dead = np.asarray(basis.T @ conic.dead)
    dead[loose[balanced]] = 0.0
    return replace(
        conic,
        costly=tuple(replace(one, rows=cut(one.rows)) for one in conic.costly),
        free=tuple(replace(kind, rows=cut(kind.rows)) for kind in conic.free),
        planes=tuple(replace(one, rows=cut(one.rows)) for one in conic.planes),
        equal=cut(conic.equal),
        load=np.asarray(basis.T @ conic.load),
        dead=dead,
        loose=loose,
    )
