"""Limits of values: under refinement with an unknown order, for r -> 0 with known ones."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields, replace
from math import nan
from typing import Any

import numpy as np
import pandas as pd
from scipy.optimize import brentq

from lacore.numerics.arrays import Floats
from lacore_verification.harness.analysis.columns import (
    SOLVED,
    groups,
    numbers,
    problem_columns,
    says,
    solver_columns,
    table,
)

LOWEST, HIGHEST = 0.1, 10.0  # Orders outside are no convergence, or implausibly high.
ACCURACY = 1e-8  # Relative tolerance of the solvers of regularised programs.
_PENALTIES = ("option_eta", "option_bulk", "option_normal", "option_tangential")
SETTLED, THREE, HERMITE = "settled", "Richardson, three values", "Hermite, two values (T19)"


@dataclass(frozen=True)
class Extrapolation:
    """A limit, with its uncertainty.

    Attributes:
        value: in the unit of the values; NaN where it is refused.
        uncertainty: an estimate, no bound; same unit.
        order: estimated; NaN where it is refused or not needed.
        reason: why it is refused; empty otherwise.
    """

    value: float = nan
    uncertainty: float = nan
    order: float = nan
    reason: str = ""


def richardson(size: Floats, values: Floats, accuracy: float = 0.0) -> Extrapolation:
    """Return the limit of values for size -> 0 by ``value = limit + c size**order``, order unknown.

    The three smallest sizes give limit, c and order. With one triple the uncertainty is the whole
    correction ``|limit - last value|``: nothing shows that the order is correct. With more it is
    the largest change of the limit against the two triples before the last one.

    Refused: fewer than three values; values that do not change monotonously, over the triples that
    are used; differences below the accuracy; an order outside [0.1, 10].

    Args:
        size: of the mesh (or a penalty), positive, in any order.
        values: finite ones count.
        accuracy: of the values, in their unit.
    """
    size, values = np.broadcast_arrays(size, values)
    keep = np.isfinite(size) & np.isfinite(values) & (size > 0)
    order = np.argsort(size[keep])[::-1]
    h, v = size[keep][order], values[keep][order]
    if len(np.unique(h)) < len(h):
        return Extrapolation(reason="several values at one size: group by more columns")
    if len(h) < 3:
        return Extrapolation(reason=f"{len(h)} values, 3 make an extrapolation")
    triples = [_triple(h[i : i + 3], v[i : i + 3], accuracy) for i in range(len(h) - 2)][-3:]
    last = triples[-1]
    if last.reason:
        return last
    before = [triple.value for triple in triples[:-1] if not triple.reason]
    if len(before) < len(triples) - 1 or not before:
        return last
    uncertainty = max(abs(last.value - value) for value in before)
    return Extrapolation(last.value, max(uncertainty, accuracy), last.order)


def _triple(h: Floats, v: Floats, accuracy: float) -> Extrapolation:
    first, second = v[0] - v[1], v[1] - v[2]
    if min(abs(first), abs(second)) <= accuracy:
        return Extrapolation(reason="the values differ by no more than their accuracy")
    ratio = first / second
    if ratio < 0:
        return Extrapolation(reason="the values do not change monotonously")

    def excess(order: float) -> float:
        return float((h[0] ** order - h[1] ** order) / (h[1] ** order - h[2] ** order) - ratio)

    h = h / h[0]
    if not excess(LOWEST) < 0 < excess(HIGHEST):
        return Extrapolation(reason=f"the order is outside [{LOWEST:g}, {HIGHEST:g}]")
    order = float(brentq(excess, LOWEST, HIGHEST))
    correction = -second * h[2] ** order / (h[1] ** order - h[2] ** order)
    return Extrapolation(float(v[2] + correction), abs(float(correction)), order)


def refinement_limits(results: pd.DataFrame) -> pd.DataFrame:
    """Return load factors extrapolated to an infinitely fine mesh.

    Args:
        results: one row for each run on a plane mesh; only those with status ``solved`` count. The
            order refers to ``h = n_elements**(-1/2)``.

    Returns:
        One row for each group, by all columns that distinguish runs except mesh and its sizes, of
        those with two values or more: ``values``, their number; ``finest``, the load factor on the
        finest mesh; ``limit``, ``uncertainty``, ``order``, ``reason`` as in `Extrapolation`;
        ``reference`` of the case.

    Raises:
        InputError: there is no such column.
    """
    names = [*problem_columns(results), *solver_columns(results)]
    by = [name for name in names if not name.startswith(("mesh", "size_"))]
    rows = []
    for key, part in groups(results[says(results, "status", SOLVED)], by):
        if len(part) < 2:
            continue
        count, values = numbers(part, "n_elements"), numbers(part, "load_factor")
        found = asdict(richardson(count**-0.5, values))
        limit = {"limit": found.pop("value"), **found}
        reference = numbers(part, "reference")[0]
        finest = values[np.nanargmax(count)] if np.isfinite(count).any() else nan
        rows.append({**key, "values": len(part), "finest": finest, **limit, "reference": reference})
    kept = ("limit", "uncertainty", "order", "reason")
    return table(rows, [*by, "values", "finest", *kept, "reference"])


@dataclass(frozen=True)
class LambdaLimit:
    """Limit of lambda for r -> 0, from regularised solves at two or three r.

    Attributes:
        r: the smallest one used.
        r_before: the next larger one.
        lambda_: value of lambda at `r`; its column is ``lambda``.
        alpha_reg: at `r`.
        limit: extrapolated value; NaN where it is refused.
        uncertainty: estimate of its error, no bound.
        order: of the convergence of lambda, where that was estimated.
        rule: method of the extrapolation.
        reason: why it is refused.
    """

    r: float
    r_before: float
    lambda_: float
    alpha_reg: float
    limit: float = nan
    uncertainty: float = nan
    order: float = nan
    rule: str = ""
    reason: str = ""


LIMIT_COLUMNS = tuple("lambda" if f.name == "lambda_" else f.name for f in fields(LambdaLimit))


def hermite_limit(r: Floats, alpha_reg: Floats, energy: Floats) -> tuple[float, float]:
    r"""Return the limit of ``alpha_reg`` for r -> 0 from two r, with penalties proportional to 1/r.

    By duality ``alpha_reg(r) = max (alpha - r Q*(sigma))`` over statically admissible stresses
    (T17, T18), with Q* the complementary energy of the penalties at r = 1. The maximiser has
    ``alpha = lambda`` and ``r Q* = C``; it is a maximum of functions affine in r, hence convex, and

        d alpha_reg / dr = -C / r,    lambda = alpha_reg + C = alpha_reg - r d alpha_reg / dr.

    Thus lambda is where the tangent at r meets r = 0: one solve, with the leading order eliminated,
    which is why ``lambda <= alpha*`` and why its order is one higher (T19). With ``alpha_reg =
    alpha* - a r + b r^2 - c r^3``: ``lambda = alpha* - b r^2 + 2 c r^3``. Two solves at ``r_1 > r_2
    = r_1/q`` eliminate more:

        lambda_2 + (lambda_2 - lambda_1)/(q^2 - 1)                        error O(r^3)
        value at 0 of the cubic with both values and both slopes          error O(r^4)

    All of this is valid at frozen reactions only, which `lambda_limits` respects.

    Args:
        r: larger and smaller one, shape (2,).
        alpha_reg, energy: alpha_reg and C of T19 there, shape (2,).

    Returns:
        The limit of error O(r^4), and that of error O(r^3).
    """
    slope = -energy / r
    step = r[0] - r[1]
    t = -r[1] / step  # 0 at r_2, 1 at r_1.
    cubic = (
        (2 * t**3 - 3 * t**2 + 1) * alpha_reg[1]
        + (t**3 - 2 * t**2 + t) * step * slope[1]
        + (3 * t**2 - 2 * t**3) * alpha_reg[0]
        + (t**3 - t**2) * step * slope[0]
    )
    lambdas = alpha_reg + energy
    squares = lambdas[1] + (lambdas[1] - lambdas[0]) / ((r[0] / r[1]) ** 2 - 1)
    return float(cubic), float(squares)


def lambda_limits(results: pd.DataFrame, by: Sequence[str] | None = None) -> pd.DataFrame:
    """Return the extrapolation of lambda in r: one row for each r but the largest of a sweep.

    One solve without a loop on reactions, at r and at the next larger one: `hermite_limit`
    (``rule`` is "Hermite, two values (T19)"; uncertainty: its difference from the limit of one
    order less). After a loop on reactions these orders are not known, as reactions depend on r,
    too: Richardson with an estimated order on lambda at r and the two next larger ones
    ("Richardson, three values"). Where lambda changed by no more than its accuracy it is its own
    limit, and the change its uncertainty ("settled"). The accuracy is added to each uncertainty.

    Args:
        results: one row for each run; only solved ones with alpha_reg and energy count, and none
            with a separate penalty (``option_eta``, ...), which does not follow r.
        by: columns whose equal values define a sweep; None: all that distinguish runs, except r.

    Returns:
        Columns `by` and those of `LambdaLimit`, r falling.

    Raises:
        InputError: there is no such column.
    """
    if by is None:
        names = [*problem_columns(results), *solver_columns(results)]
        by = [name for name in names if name != "option_r"]
    rows: list[dict[str, Any]] = []
    usable = says(results, "status", SOLVED)
    for name in ("option_r", "alpha_reg", "energy"):
        usable &= np.isfinite(numbers(results, name))
    for name in _PENALTIES:
        if name in results.columns:
            usable &= np.isnan(numbers(results, name))
    for key, part in groups(results[usable], by):
        ordered = part.iloc[np.argsort(numbers(part, "option_r"))[::-1]]
        for limit in _limits_of(ordered):
            values = asdict(limit)
            values["lambda"] = values.pop("lambda_")
            rows.append({**key, **values})
    return table(rows, [*by, *LIMIT_COLUMNS])


def _limits_of(sweep: pd.DataFrame) -> list[LambdaLimit]:
    r, alpha_reg, energy = (numbers(sweep, name) for name in ("option_r", "alpha_reg", "energy"))
    looped = numbers(sweep, "outer_iterations") > 1
    lambdas = alpha_reg + energy
    found = []
    for i in range(1, len(r)):
        value = float(lambdas[i])
        here = LambdaLimit(float(r[i]), float(r[i - 1]), value, float(alpha_reg[i]))
        noise = ACCURACY * abs(value)
        pair, three = slice(i - 1, i + 1), slice(max(i - 2, 0), i + 1)
        if len(np.unique(r[pair])) < 2:
            here = replace(here, reason="several values at one r: group by more columns")
        elif abs(lambdas[i] - lambdas[i - 1]) <= noise:
            far = abs(float(lambdas[i] - lambdas[i - 1])) + noise
            here = replace(here, limit=value, uncertainty=far, rule=SETTLED)
        elif looped[pair].any():
            last = richardson(r[three], lambdas[three], noise)
            here = replace(here, limit=last.value, order=last.order, rule=THREE, reason=last.reason)
            here = replace(here, uncertainty=last.uncertainty + noise)
        else:
            cubic, squares = hermite_limit(r[pair], alpha_reg[pair], energy[pair])
            far = abs(cubic - squares) + noise
            here = replace(here, limit=cubic, uncertainty=far, rule=HERMITE)
        found.append(here)
    return found
