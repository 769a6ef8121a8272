"""Choice of the solver of symmetric matrices: the fastest one that is installed."""

from collections.abc import Callable
from functools import cache

from lacore.numerics.arrays import Sparse
from lacore.numerics.linear_algebra import SingularError, SuperLU, SymmetricSolver

_LARGE = 20_000  # number of rows from which loading MKL pays: docs/design-decisions.md


def symmetric_solver(refined: bool = True, definite: bool = True) -> SymmetricSolver:
    """Return the best installed solver: PARDISO (extra ``fast``), else SuperLU.

    Args:
        refined: solutions are refined if the solver can; else the caller does it.
        definite: matrices are positive definite; else they have pivots of both signs, none zero.
    """
    fast = fast_solver()
    return SuperLU() if fast is None else fast(refined, definite)


def factorised(matrix: Sparse) -> SymmetricSolver:
    """Return the factors of one positive definite matrix with sorted indices, to be closed.

    SuperLU is used, as it is loaded at once; for a large matrix the best installed solver, unless
    that finds it singular.

    Raises:
        SingularError: it cannot be factorised.
    """
    if matrix.shape[0] >= _LARGE:
        solver = symmetric_solver(refined=False)
        try:
            solver.factorise(matrix)
        except SingularError:
            solver.close()
        else:
            return solver
    solver = SuperLU()
    solver.factorise(matrix)
    return solver


@cache
def fast_solver() -> Callable[[bool, bool], SymmetricSolver] | None:
    """Return PARDISO if it is installed, else None."""
    try:
        # Import it here, because MKL takes half a second to load and only second-order methods use
        # it.
        from lacore.numerics.pardiso import Pardiso
    except ImportError:  # an optional dependency
        return None
    return Pardiso
