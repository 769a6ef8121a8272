"""Linear programs solved beyond double precision, by repeated solves for the residual.

Gleixner, Steffy & Wolter, INFORMS J. Computing 28 (2016) 449: scaled residuals of a solution are
the data of the next program. Weights that are ten decades apart need it.
"""

from dataclasses import dataclass, replace
from math import inf, nan

import numpy as np
from scipy.optimize import linprog

from lacore.numerics.arrays import Floats

_ROUNDS = 6
_ENOUGH = 1e-11  # Relative to the scale of each row.
_LARGEST = 1e14  # Largest factor on residuals.


@dataclass(frozen=True)
class Program:
    """``max c x`` where ``A x = b`` and ``low <= x <= high``, rows of order one."""

    cost: Floats
    matrix: Floats
    right: Floats
    low: Floats
    high: Floats


@dataclass(frozen=True)
class Optimum:
    """The largest value of a program, and its point.

    Attributes:
        value: -inf if infeasible, +inf if unbounded, NaN if the solver failed.
        point: x; None where the value is not finite.
    """

    value: float
    point: Floats | None = None


def maximum(program: Program) -> Optimum:
    """Return the largest value, to about 1e-10 of each row's scale."""
    answer = _solve(program)
    if answer is None:
        return Optimum(nan)
    if isinstance(answer, float):
        return Optimum(answer)
    x, y = answer
    matrix = program.matrix.astype(np.longdouble)
    for _ in range(_ROUNDS):
        left = program.right.astype(np.longdouble) - matrix @ x
        outside = np.maximum(np.maximum(program.low - x, x - program.high), 0.0)
        reduced = program.cost.astype(np.longdouble) - matrix.T @ y
        wrong = np.where(x > program.low, np.maximum(-reduced, 0), 0)
        wrong = np.maximum(wrong, np.where(x < program.high, np.maximum(reduced, 0), 0))
        primal, dual = max(abs(left).max(initial=0), outside.max(initial=0)), wrong.max(initial=0)
        if primal == 0 and dual == 0:
            break
        up = 1 / max(float(primal), 1 / _LARGEST)
        rise = 1 / max(float(dual), 1 / _LARGEST)
        rest = Program(
            cost=np.asarray(rise * reduced, dtype=float),
            matrix=program.matrix,
            right=np.asarray(up * left, dtype=float),
            low=np.asarray(up * (program.low - x), dtype=float),
            high=np.asarray(up * (program.high - x), dtype=float),
        )
        step = _solve(rest)
        if step is None or isinstance(step, float):
            break
        x, y = x + step[0] / up, y + step[1] / rise
    # A violation of bounds counts by its effect on the rows: for a light block, a small force is
    # enough to carry it.
    outside = np.maximum(np.maximum(program.low - x, x - program.high), 0.0)
    off = abs(program.right - matrix @ x) + np.abs(matrix) @ outside
    scale = np.abs(matrix) @ abs(x) + abs(program.right)
    if np.any(off > _ENOUGH * scale):
        return Optimum(nan)
    return Optimum(float(program.cost @ x), np.asarray(x, dtype=float))


def _solve(program: Program) -> tuple[Floats, Floats] | float | None:
    """Return the point and multipliers; a float if it is infinite, None if the solver fails."""
    size = np.abs(program.matrix).max(axis=0)
    size[size == 0] = 1.0
    found = linprog(
        -program.cost / size,
        A_eq=program.matrix / size,
        b_eq=program.right,
        bounds=list(zip(program.low * size, program.high * size, strict=True)),
        method="highs-ds",
    )
    if found.status == 2:
        return -inf
    if found.status == 3:
        # Presolve distinguishes unbounded from infeasible only without a cost.
        empty = replace(program, cost=np.zeros_like(program.cost))
        again = _solve(empty) if np.any(program.cost) else None
        return -inf if again == -inf else inf
    if found.status != 0:
        return None
    return (
        np.asarray(found.x / size, dtype=np.longdouble),
        np.asarray(-found.eqlin.marginals, dtype=np.longdouble),
    )
