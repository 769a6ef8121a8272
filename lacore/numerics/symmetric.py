"""Which solver factorises symmetric matrices: the best that is installed."""

from collections.abc import Callable
from functools import cache

from lacore.numerics.linear_algebra import SuperLU, SymmetricSolver


def symmetric_solver(refined: bool = True, definite: bool = True) -> SymmetricSolver:
    """The best solver installed: PARDISO (extra ``fast``), else SuperLU.

    Args:
        refined: solutions are refined where the solver can; else whoever asks for them does it.
        definite: matrices are positive definite; else they have pivots of both signs, none zero.
    """
    fast = fast_solver()
    return SuperLU() if fast is None else fast(refined, definite)


@cache
def fast_solver() -> Callable[[bool, bool], SymmetricSolver] | None:
    """PARDISO where it is installed, else None."""
    try:
        # Here: MKL takes half a second to load, and only second-order methods have a use for it.
        from lacore.numerics.pardiso import Pardiso
    except ImportError:  # an extra
        return None
    return Pardiso
