"""The same equations with stiff parts as unknowns, for cases where velocities lose the forces.

Contact that does not open and bodies that do not strain are 1e9 times as stiff as the rest. Forces
computed from velocities through this stiffness are then out of balance by as many times the
round-off. Each stiffness ``S = (C + delta)^-1`` is therefore split in two, one of them moderate,

    S = S_1 + L L^T,  S_1 = (C + Delta)^-1,    z = S_1 (a - D u) + L q,  q = L^T (a - D u)

and ``[-K_1, D^T L; L^T D, 1]`` is factorised. It is symmetric and indefinite, and none of its
blocks is ill-conditioned. The forces of q balance like those of unknowns. It takes three times the
work of K, and is used for programs that K does not solve.
"""

from functools import partial

import numpy as np
from scipy.sparse import csr_matrix, diags_array, hstack, identity, vstack

from lacore.numerics.arrays import Floats, Ints, Sparse
from lacore.numerics.linear_algebra import SymmetricSolver
from lacore_backends._embedding.arrays import Conic
from lacore_backends._embedding.stiffness import Stiffness
from lacore_backends._embedding.system import System
from lacore_backends._embedding.vectors import Vector

_STIFFER = 1e2  # stiffness of cones and of rows that hold exactly, by their limits in K
_MODERATE = 1e3  # stiffness in K_1, by that of flowing cones


class Whole(System):
    """Solver of the equations with stiff parts as unknowns; see the module.

    Args:
        indefinite: solver of symmetric matrices with pivots of both signs.
    """

    def __init__(
        self,
        conic: Conic,
        stiffness: Stiffness,
        solver: SymmetricSolver,
        indefinite: SymmetricSolver,
    ) -> None:
        super().__init__(conic, stiffness, solver)
        self._indefinite = indefinite
        every = [rows.matrix[_by_component(rows.dim, rows.count)] for rows in conic.kinds]
        self._rows = csr_matrix(vstack(every))

    def _factorised(self, reference: float) -> Floats:
        moderate, rest = [], []
        for rows, own, least in zip(self._conic.kinds, self._soft, self._least, strict=True):
            delta = least / _STIFFER
            more = np.maximum(reference / _MODERATE * rows.norms, 2 * delta)
            moderate.append(own.inverse(more).blocks)
            rest.append(own.through(partial(_rest, delta=delta, more=more)).blocks)
        stiffness, diagonal = self._summed(moderate)
        self._moderate, self._rest = _diagonal(moderate), _diagonal(rest)
        self._unit = 1 / np.sqrt(diagonal)
        unit = diags_array(self._unit)
        across = csr_matrix(self._rest @ self._rows @ unit)
        corner = -csr_matrix(unit @ stiffness @ unit)
        none = csr_matrix(across.shape)
        upper = hstack([corner, across.T]), hstack([none, identity(across.shape[0])])
        matrix = csr_matrix(vstack(upper))
        matrix.sort_indices()
        self._indefinite.factorise_upper(matrix)
        return self._summed(self._stiff_blocks())[1]

    def _inner(self, *rights: Vector) -> list[Vector]:
        n = self._conic.load.size
        every = np.column_stack([right.data[:-2] for right in rights])
        force, a = every[:n], every[n:]
        force = self._unit[:, None] * (force - self._rows.T @ (self._moderate @ a))
        found = self._indefinite.solve(np.vstack([force, self._rest.T @ a]))
        u, q = self._unit[:, None] * found[:n], found[n:]
        z = self._moderate @ (a - self._rows @ u) + self._rest @ q
        both = np.vstack([u, z, np.zeros((2, len(rights)))])
        return [Vector(self.layout, x) for x in np.ascontiguousarray(both.T)]

    def leaves(self, right: Vector, x: Vector) -> Vector:
        return self.left(right, x)


def _rest(c: Floats, delta: Floats, more: Floats) -> Floats:
    """Return the eigenvalues of L by those of C."""
    return np.asarray(np.sqrt((more - delta) / ((c + more) * (c + delta))))


def _by_component(dim: int, count: int) -> Ints:
    """Return the rows in the order of a `Vector`, those of a component of all points together."""
    return np.arange(dim * count).reshape(count, dim).T.ravel()


def _diagonal(blocks: list[Floats]) -> Sparse:
    """Return blocks of shape (dim, dim, m) of each kind as a matrix for the array of a `Vector`."""
    data, rows, columns, first = [], [], [], 0
    for block in blocks:
        dim, _, count = block.shape
        i, j, point = np.indices(block.shape)
        data.append(block.ravel())
        rows.append((first + i * count + point).ravel())
        columns.append((first + j * count + point).ravel())
        first += dim * count
    places = np.concatenate(rows), np.concatenate(columns)
    return csr_matrix((np.concatenate(data), places), (first, first))
