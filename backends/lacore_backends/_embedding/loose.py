"""Motions that nothing resists, as unknowns of their own, which the loads alone know.

A body that no support holds, or that slides along a smooth wall, moves without any strain, and so
does the whole program at the load factor that puts it in balance. With velocities

    u = Z a + v,   v = 0 where a moves,   rows Z = 0

no row knows a, and ``lambda F0.Z + tau Fd.Z = 0`` says the load factor before anything is solved.
Of these motions two at most count, as there are two loads; all others stand still.
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

_WORKS = 1e-6  # of the nodal forces of a load, times the fastest: less is in balance
_STRAINED = 1e-8  # of those of the dead ones: so much may be what round-off strains of a motion


@dataclass(frozen=True)
class Loose:
    """A program in q, of which a part is a.

    Attributes:
        conic: its `loose` unknowns are a.
        basis: ``u = basis q``, shape (n, n).
    """

    conic: Conic
    basis: Sparse

    @property
    def driven(self) -> bool:
        """Whether F0 works on a."""
        return bool(np.any(self.conic.load[self.conic.loose]))

    def alone(self) -> tuple[Floats, float]:
        """The least a at the speed of the load, as u, and the load factor that balances it."""
        own = self.conic.loose
        load, dead = self.conic.load[own], self.conic.dead[own]
        size = float(load @ load)
        return np.asarray(self.basis[:, own] @ load) / size, 0.0 - float(load @ dead) / size


def loosened(conic: Conic, solver: SymmetricSolver) -> Loose | None:
    """The program with such motions as unknowns of their own; None where there are none."""
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
    # Motions that dead loads alone drive are unsafe, or round-off: as stated, what resists decides.
    if known == 2 or np.any(np.abs(conic.load @ moving) <= _WORKS * sums[0]):
        return None
    moving = moving / np.abs(moving).max(axis=0, initial=0.0)
    kept = np.ones(n)
    kept[own] = 0.0
    rows, columns = np.tile(np.arange(n), known), np.repeat(own[:known], n)
    moved = csr_matrix((moving.T.ravel(), (rows, columns)), (n, n))
    basis = csr_matrix(diags_array(kept) + moved)
    # Of several motions that F0 drives one would run off against the others for next to nothing.
    balanced = np.abs(conic.dead @ moving) <= _STRAINED * sums[1]
    return Loose(_stated(conic, kept, basis, own[:known], balanced), basis)


def _modes(conic: Conic, solver: SymmetricSolver) -> Floats:
    """Motions without any rate, orthonormal, shape (n, k)."""
    each = [
        diags_array(np.repeat(1 / np.sqrt(kind.norms), kind.dim)) @ kind.matrix
        for kind in conic.kinds
    ]
    rows = csr_matrix(vstack(each))
    loads = np.column_stack([conic.load, conic.dead])
    return without_strain(rows, softest(csr_matrix(rows.T @ rows), solver, loads))


def _stated(conic: Conic, kept: Floats, basis: Sparse, loose: Ints, balanced: Bools) -> Conic:
    """The program in q: rows know what is not a motion, dead loads no motion in `balanced`."""
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
