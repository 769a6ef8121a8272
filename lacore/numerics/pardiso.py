"""Intel MKL PARDISO, of the extra ``fast``: ImportError where that is not installed."""

import ctypes
import os
import sys
from copy import copy
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from lacore.numerics.arrays import Floats, Sparse
from lacore.numerics.linear_algebra import SingularError, require_numbers

_PLACES = ("lib/libmkl_rt*", "Library/bin/mkl_rt*")  # of MKL as its wheel installs it


def _locate_library() -> None:
    """Tell pypardiso where MKL is: it would search every folder of the environment."""
    found = [file for place in _PLACES for file in Path(sys.prefix).glob(place)]
    if len(found) == 1:
        os.environ.setdefault("PYPARDISO_MKL_RT", str(found[0]))


_locate_library()
import pypardiso  # noqa: E402

_ANALYSE, _FACTORISE, _SOLVE = 11, 22, 33  # phases of PARDISO
_POSITIVE_DEFINITE, _INDEFINITE = 2, -2
_OWN_SETTINGS = 1  # all others 0: no refinement, order by minimum degree
_PHASE, _SIDES = 2, 4  # which of the numbers it is called with
_SMALLEST, _BY_TWO = 13, 1  # pivots, as a power of ten; and those of two rows


class Pardiso:
    """Intel MKL PARDISO: analyses a pattern once, and factorises ten times faster than SuperLU."""

    name = "PARDISO"

    def __init__(self, refined: bool = True, definite: bool = True) -> None:
        """Solutions are refined twice, which triples their time; or not, by whoever does it.

        Not definite, a matrix is factorised with pivots that may have either sign.
        """
        self._solver = copy(_loaded())
        self._solver.pt = np.zeros_like(self._solver.pt)
        self._solver.iparm = np.zeros_like(self._solver.iparm)
        self._solver.iparm[0] = 0 if refined else _OWN_SETTINGS
        if not definite:
            self._solver.mtype = _INDEFINITE
            self._solver.iparm[[9, 20]] = _SMALLEST, _BY_TWO
        self._pattern: tuple[Any, Any] | None = None
        self._upper: Any = None  # which entries of the matrix are in its upper triangle

    def factorise(self, matrix: Sparse) -> None:
        """See `SymmetricSolver`."""
        if not self._knows(matrix):
            row = np.repeat(np.arange(matrix.shape[0]), np.diff(matrix.indptr))
            self._upper = np.flatnonzero(matrix.indices >= row)
            starts = np.searchsorted(self._upper, matrix.indptr)
            self._analyse(matrix, starts, matrix.indices[self._upper])
        self._factorise(matrix.data[self._upper])

    def factorise_upper(self, matrix: Sparse) -> None:
        """See `SymmetricSolver`."""
        if not self._knows(matrix):
            self._upper = slice(None)
            self._analyse(matrix, matrix.indptr, matrix.indices)
        self._factorise(matrix.data)

    def solve(self, right: Floats) -> Floats:
        """See `SymmetricSolver`."""
        return self._call(_SOLVE, np.asfortranarray(right, dtype=float))

    def close(self) -> None:
        """See `SymmetricSolver`."""
        self._solver.free_memory(everything=True)
        self._pattern = None

    def _knows(self, matrix: Sparse) -> bool:
        """Whether it has the pattern of the last."""
        return self._pattern is not None and (
            np.array_equal(self._pattern[0], matrix.indptr)
            and np.array_equal(self._pattern[1], matrix.indices)
        )

    def _analyse(self, matrix: Sparse, starts: Any, columns: Any) -> None:
        """Take the pattern of a matrix, its upper triangle as that counts from one."""
        self._solver.free_memory(everything=True)
        self._starts = np.asarray(starts, dtype=np.int32) + np.int32(1)
        self._columns = np.asarray(columns, dtype=np.int32) + np.int32(1)
        self._data = np.zeros(self._columns.size)
        self._address(matrix.shape[0])
        self._call(_ANALYSE, np.zeros(matrix.shape[0]))
        self._pattern = (matrix.indptr.copy(), matrix.indices.copy())

    def _address(self, size: int) -> None:
        """Where all that stays is, looked up once: it takes as long as a small solution."""
        own = self._solver
        # One, the kind of matrix, the phase, the size, right-hand sides, no messages, the error.
        self._numbers = np.array([1, own.mtype, _ANALYSE, size, 1, 0, 0], dtype=np.int32)
        begin, each = self._numbers.ctypes.data, self._numbers.itemsize
        one, kind, which, size_at, sides, silent, self._error = (begin + each * i for i in range(7))
        self._perm = own.perm
        arrays = self._data, self._starts, self._columns, self._perm
        self._addresses = (
            own.pt.ctypes.data,
            *(one, one, kind, which, size_at),
            *(array.ctypes.data for array in arrays),
            *(sides, own.iparm.ctypes.data, silent),
        )

    def _factorise(self, data: Floats) -> None:
        require_numbers(data)  # with pivots of both signs it writes beside its memory else
        self._data[:] = data
        self._call(_FACTORISE, np.zeros(self._starts.size - 1))

    def _call(self, phase: int, right: Floats) -> Floats:
        # The methods of pypardiso analyse anew with every matrix, which takes ten factorisations,
        # and turn the pattern into 32 bits with every solution.
        own, found = self._solver, np.zeros_like(right)
        self._numbers[_PHASE] = phase
        self._numbers[_SIDES] = 1 if right.ndim == 1 else right.shape[1]
        # On two threads it takes as long by the clock, and twice the processor time; and sums in
        # an order that depends on how many there are.
        threads = own.libmkl.MKL_Set_Num_Threads_Local(1)
        _by_address()(*self._addresses, right.ctypes.data, found.ctypes.data, self._error)
        own.libmkl.MKL_Set_Num_Threads_Local(threads)
        if self._numbers[-1] != 0:
            raise SingularError(f"PARDISO: error {self._numbers[-1]}")
        return found


@cache
def _by_address() -> Any:
    """PARDISO, which takes all by address: pointers of types take as long as a small solution."""
    function = _loaded().libmkl["pardiso"]
    function.argtypes, function.restype = [ctypes.c_void_p] * 16, None
    return function


@cache
def _loaded() -> Any:
    """A solver that is never used: looking for the library takes longer than a small solve."""
    return pypardiso.PyPardisoSolver(mtype=_POSITIVE_DEFINITE)
