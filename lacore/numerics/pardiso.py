"""Intel MKL PARDISO, of the extra ``fast``: ImportError where that is not installed."""

from copy import copy
from functools import cache
from typing import Any

import numpy as np
import pypardiso
from pypardiso.pardiso_wrapper import PyPardisoError
from scipy.sparse import csr_array

from lacore.arrays import Floats, Sparse
from lacore.numerics.linear_algebra import SingularError

_ANALYSE, _FACTORISE, _SOLVE = 11, 22, 33  # phases of PARDISO
_POSITIVE_DEFINITE = 2
_OWN_SETTINGS = 1  # all others 0: no refinement, order by minimum degree


class Pardiso:
    """Intel MKL PARDISO: analyses a pattern once, and factorises ten times faster than SuperLU."""

    name = "PARDISO"

    def __init__(self, refined: bool = True) -> None:
        """Solutions are refined twice, which triples their time; or not, by whoever does it."""
        self._solver = copy(_loaded())
        self._solver.pt = np.zeros_like(self._solver.pt)
        self._solver.iparm = np.zeros_like(self._solver.iparm)
        self._solver.iparm[0] = 0 if refined else _OWN_SETTINGS
        self._pattern: tuple[Any, Any] | None = None
        self._upper: Any = None  # which entries of the matrix are in its upper triangle
        self._matrix: Any = None

    def factorise(self, matrix: Sparse) -> None:
        """See `SymmetricSolver`."""
        if self._pattern is None or not (
            np.array_equal(self._pattern[0], matrix.indptr)
            and np.array_equal(self._pattern[1], matrix.indices)
        ):
            self._analyse(matrix)
        self._matrix.data[:] = matrix.data[self._upper]
        self._call(_FACTORISE, np.zeros(matrix.shape[0]))

    def solve(self, right: Floats) -> Floats:
        """See `SymmetricSolver`."""
        return np.asarray(self._call(_SOLVE, np.array(right)))

    def close(self) -> None:
        """See `SymmetricSolver`."""
        self._solver.free_memory(everything=True)
        self._pattern = None

    def _analyse(self, matrix: Sparse) -> None:
        self._solver.free_memory(everything=True)
        row = np.repeat(np.arange(matrix.shape[0]), np.diff(matrix.indptr))
        self._upper = np.flatnonzero(matrix.indices >= row)
        starts = np.searchsorted(self._upper, matrix.indptr)
        self._matrix = csr_array(
            (matrix.data[self._upper], matrix.indices[self._upper], starts), shape=matrix.shape
        )
        self._call(_ANALYSE, np.zeros(matrix.shape[0]))
        self._pattern = (matrix.indptr.copy(), matrix.indices.copy())

    def _call(self, phase: int, right: Floats) -> Any:
        # Its public methods analyse anew with every matrix, which takes ten factorisations.
        self._solver.set_phase(phase)
        try:
            return self._solver._call_pardiso(self._matrix, right)
        except PyPardisoError as error:
            raise SingularError(f"PARDISO: {error}") from error


@cache
def _loaded() -> Any:
    """A solver that is never used: looking for the library takes longer than a small solve."""
    return pypardiso.PyPardisoSolver(mtype=_POSITIVE_DEFINITE)
