"""Exact discrete values alpha* for regularised rows, and their errors (T19)."""

import numpy as np
import pandas as pd

from lacore.coupling.kinds import COUPLINGS
from lacore_verification.harness.analysis.columns import SOLVED, numbers, problem_columns, says
from lacore_verification.harness.analysis.extrapolation import lambda_limits

OF_THEIR_OWN = tuple(name for name, kind in COUPLINGS.items() if kind.model)
"""Couplings that solve another problem than Coulomb's: each has its own alpha*."""
EXTRAPOLATED = "extrapolated"
_LAWS = "laws"


def with_exact(results: pd.DataFrame) -> pd.DataFrame:
    """Return regularised rows with the exact value of the same problem, mesh and friction laws.

    It is the load factor of an exact backend, the one with the smallest gap of several, or else the
    limit of `lambda_limits` with the smallest uncertainty, or else NaN. Where Coulomb load factors
    are not unique, an exact and a regularised solve may have found different ones, and the error is
    no regularisation error. The gap does not bound the error of a Coulomb load factor (T15): to
    resolve small errors of a sweep, solve the exact one to 1e-9.

    Args:
        results: one row for each run.

    Returns:
        The solved regularised rows, with all their columns, and ``alpha_star``;
        ``alpha_star_from``: the backend, "extrapolated", or empty; ``alpha_star_noise``: its
        accuracy, gap times value or the uncertainty of the limit; ``error_alpha_reg`` and
        ``error_lambda``: ``alpha* - alpha_reg`` and ``alpha* - lambda``, in the unit of the load
        factor, positive at frozen reactions.

    Raises:
        InputError: a column is missing.
    """
    solved = results[says(results, "status", SOLVED)].copy()
    solved[_LAWS] = np.where(says(solved, "coupling", *OF_THEIR_OWN), solved["coupling"], "Coulomb")
    regularised = np.isfinite(numbers(solved, "lambda"))
    rows = solved[regularised]
    keys = [*problem_columns(solved), _LAWS]
    known = _known([_exact(solved[~regularised], keys), _limits(rows, keys)])
    found = _best(pd.concat(known), keys).astype(solved[keys].dtypes.to_dict())
    joined = rows.merge(found, on=keys, how="left", validate="many_to_one").drop(columns=_LAWS)
    joined["alpha_star_from"] = joined["alpha_star_from"].fillna("")
    star = numbers(joined, "alpha_star")
    joined["error_alpha_reg"] = star - numbers(joined, "alpha_reg")
    joined["error_lambda"] = star - numbers(joined, "lambda")
    return joined


def _exact(solved: pd.DataFrame, keys: list[str]) -> pd.DataFrame:
    value = numbers(solved, "load_factor")
    found = solved[keys].assign(
        alpha_star=value,
        alpha_star_from=solved["backend"],
        alpha_star_noise=np.abs(value) * np.nan_to_num(numbers(solved, "gap")),
        rank=0,
    )
    return found[np.isfinite(value)]


def _limits(rows: pd.DataFrame, keys: list[str]) -> pd.DataFrame:
    if "option_r" not in rows.columns:
        return rows[keys].iloc[:0]
    by = [name for name in rows.columns if name.startswith(("setting_", "option_"))]
    limits = lambda_limits(
        rows, [*keys, "backend", "coupling", *(name for name in by if name != "option_r")]
    )
    found = limits[keys].assign(
        alpha_star=limits["limit"],
        alpha_star_from=EXTRAPOLATED,
        alpha_star_noise=limits["uncertainty"],
        rank=1,
    )
    return found[np.isfinite(numbers(found, "alpha_star"))]


def _known(parts: list[pd.DataFrame]) -> list[pd.DataFrame]:
    return [part for part in parts if len(part)] or parts[:1]


def _best(found: pd.DataFrame, keys: list[str]) -> pd.DataFrame:
    """Return the best value for each key: exact before extrapolated, then the smallest noise."""
    ordered = found.sort_values(["rank", "alpha_star_noise"], kind="stable")
    return ordered.drop_duplicates(keys).drop(columns="rank")
