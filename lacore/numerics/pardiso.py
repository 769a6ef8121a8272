"""Intel MKL PARDISO, of the extra ``fast``; raises ImportError if it is not installed."""

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

_PLACES = ("lib/libmkl_rt*", "Library/bin/mkl_rt*")  # places of MKL in its wheel


def _locate_library() -> None:
    """Set the path of MKL, because pypardiso would search every folder of the environment."""
    found = [file for place in _PLACES for file in Path(sys.prefix).glob(place)]
    if len(found) == 1:
        os.environ.setdefault("PYPARDISO_MKL_RT", str(found[0]))


_locate_library()
import pypardiso  # noqa: E402

_ANALYSE, _FACTORISE, _SOLVE = 11, 22, 33  # phases of PARDISO
_POSITIVE_DEFINITE, _INDEFINITE = 2, -2
_OWN_SETTINGS = 1  # others are 0: no refinement, minimum-degree ordering
_PHASE, _SIDES = 2, 4  # places of these arguments of its call
_SMALLEST, _BY_TWO = 13, 1  # pivots, as a power of ten; and those of two rows


class Pardiso:
    """Intel MKL PARDISO: analyses a pattern once, and factorises ten times faster than SuperLU."""

    name = "PARDISO"

    def __init__(self, refined: bool = True, definite: bool = True) -> None:
        """Prepare the solver.

        Args:
            refined: solutions are refined twice, which triples their time; else the caller does it.
            definite: matrices are positive definite; else pivots may have either sign.
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
        """Implement `SymmetricSolver`."""
        if not self._knows(matrix):
            row = np.repeat(np.arange(matrix.shape[0]), np.diff(matrix.indptr))
            self._upper = np.flatnonzero(matrix.indices >= row)
            starts = np.searchsorted(self._upper, matrix.indptr)
            self._analyse(matrix, starts, matrix.indices[self._upper])
        self._factorise(matrix.data[self._upper])

    def factorise_upper(self, matrix: Sparse) -> None:
        """Implement `SymmetricSolver`."""
        if not self._knows(matrix):
            self._upper = slice(None)
            self._analyse(matrix, matrix.indptr, matrix.indices)
        self._factorise(matrix.data)

    def solve(self, right: Floats) -> Floats:
        """Implement `SymmetricSolver`."""
        return self._call(_SOLVE, np.asfortranarray(right, dtype=float))

    def close(self) -> None:
        """Implement `SymmetricSolver`."""
        self._solver.free_memory(everything=True)
        self._pattern = None

    def _knows(self, matrix: Sparse) -> bool:
        """Return whether the matrix has the pattern of the last one."""
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
        """Look up constant addresses once, as this takes as long as a small solution."""
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
        # With pivots of both signs NaN would make it write outside its memory.
        require_numbers(data)
        self._data[:] = data
        self._call(_FACTORISE, np.zeros(self._starts.size - 1))

    def _call(self, phase: int, right: Floats) -> Floats:
        # The methods of pypardiso analyse every matrix again, which takes ten factorisations, and
        # convert the pattern to 32 bits for every solution.
        own, found = self._solver, np.zeros_like(right)
        self._numbers[_PHASE] = phase
        self._numbers[_SIDES] = 1 if right.ndim == 1 else right.shape[1]
        # With two threads it takes the same time and twice the processor time, and the order of
        # sums depends on their number.
        threads = own.libmkl.MKL_Set_Num_Threads_Local(1)
        _by_address()(*self._addresses, right.ctypes.data, found.ctypes.data, self._error)
        own.libmkl.MKL_Set_Num_Threads_Local(threads)
        if self._numbers[-1] != 0:
            raise SingularError(f"PARDISO: error {self._numbers[-1]}")
        return found


@cache
def _by_address() -> Any:
    """Return PARDISO with untyped pointers, since typed ones take as long as a small solution."""
    function = _loaded().libmkl["pardiso"]
    function.argtypes, function.restype = [ctypes.c_void_p] * 16, None
    return function


@cache
def _loaded() -> Any:
    """Return a solver that is never used: finding the library takes longer than a small solve."""
    return pypardiso.PyPardisoSolver(mtype=_POSITIVE_DEFINITE)
