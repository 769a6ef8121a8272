"""Which solver factorises symmetric matrices: the best that is installed."""

from collections.abc import Callable
from functools import cache

from lacore.numerics.arrays import Sparse
from lacore.numerics.linear_algebra import SingularError, SuperLU, SymmetricSolver

_LARGE = 20_000  # rows from which half of the time is worth loading MKL: docs/design-decisions.md


def symmetric_solver(refined: bool = True, definite: bool = True) -> SymmetricSolver:
    """The best solver installed: PARDISO (extra ``fast``), else SuperLU.

    Args:
        refined: solutions are refined where the solver can; else whoever asks for them does it.
        definite: matrices are positive definite; else they have pivots of both signs, none zero.
    """
    fast = fast_solver()
    return SuperLU() if fast is None else fast(refined, definite)


def factorised(matrix: Sparse) -> SymmetricSolver:
    """Factors of one positive definite matrix with sorted indices, to be closed.

    By SuperLU, which is there at once; of a large matrix by the best solver installed, unless that
    finds it singular.

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
    """PARDISO where it is installed, else None."""
    try:
        # Here: MKL takes half a second to load, and only second-order methods have a use for it.
        from lacore.numerics.pardiso import Pardiso
    except ImportError:  # an extra
        return None
    return Pardiso
