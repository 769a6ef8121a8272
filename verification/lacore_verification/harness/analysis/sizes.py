"""Success rates by problem size, and accuracy against time.

Only results of the backend itself count, as in `lacore_verification.harness.analysis.profiles`.
"""

from collections.abc import Sequence
from itertools import pairwise
from math import exp, expm1, inf, nan

import numpy as np
import pandas as pd

from lacore.numerics.arrays import Bools, Floats
from lacore_verification.harness.analysis.columns import (
    SOLVER,
    answered_itself,
    groups,
    numbers,
    problem_columns,
    require_columns,
    says,
    table,
    with_prefix,
)
from lacore_verification.harness.analysis.profiles import SOLVED_BY, rates
from lacore_verification.harness.verdicts.words import BOUND_ONLY, NO_REFERENCE, PASS, SKIPPED

SIZES = (100, 1000, 10_000)
"""Largest number of unknowns of each class of problems; the last class has no limit."""
UNKNOWNS = "unknowns"
"""Column with the size class of a problem."""
RESIDUALS = (
    *("equilibrium", "yield_violation", "cone"),
    *("divergence", "penetration", "flow", "slip"),
    "gap",
)
"""Residuals of the certificate, of forces, of velocities and of both."""
RESIDUAL_SHIFT = 1e-12
"""Shift of their geometric means: smaller residuals count alike."""
LEAST_RESIDUAL = 1e-16  # Round-off, as the logarithm of 0 has no mean.


def size_classes(sizes: Sequence[int] = SIZES) -> list[str]:
    """Return the names of the size classes, from small to large.

    Example:
        >>> size_classes((100, 1000))
        ['up to 100', '101 to 1000', 'more than 1000']
    """
    middle = [f"{low + 1} to {high}" for low, high in pairwise(sizes)]
    return [f"up to {sizes[0]}", *middle, f"more than {sizes[-1]}"]


def with_size_classes(results: pd.DataFrame, sizes: Sequence[int] = SIZES) -> pd.DataFrame:
    """Add the column ``unknowns`` with the size class of the problem.

    A lost run has no number of unknowns. It gets the class of the other runs of its problem, so
    that large problems that a solver loses still count as large.

    Args:
        results: One row for each run, with the columns of the problem and ``n_dofs``.
        sizes: Largest number of unknowns of each class but the last.

    Returns:
        The rows whose size is known from any run.

    Raises:
        InputError: There is no such column.
    """
    names = problem_columns(results)
    require_columns(results, names)
    dofs = results[names].assign(_dofs=numbers(results, "n_dofs"))
    largest = dofs.groupby(names, dropna=False, sort=False)["_dofs"].transform("max")
    unknowns: Floats = np.array(largest.to_numpy(dtype=float))
    labels = size_classes(sizes)
    classes = [labels[place] for place in np.searchsorted(sizes, unknowns).clip(0, len(sizes))]
    known: Bools = np.isfinite(unknowns)
    return results.assign(**{UNKNOWNS: classes})[known]


def rates_by_size(results: pd.DataFrame) -> pd.DataFrame:
    """Return the `rates` of each solver for each size class, the classes from small to large.

    Args:
        results: One row for each run.

    Returns:
        The columns of `rates`, with ``unknowns`` after those that identify a solver.

    Raises:
        InputError: There is no such column.
    """
    found = rates(with_size_classes(results), (*SOLVER, UNKNOWNS))
    order = {name: number for number, name in enumerate(size_classes())}
    placed = found.assign(_place=found[UNKNOWNS].map(order))
    ordered = placed.sort_values([*SOLVER, "_place"], kind="stable", ignore_index=True)
    return ordered.drop(columns=["_place"])


def accuracies(results: pd.DataFrame) -> pd.DataFrame:
    """Return time, error and largest residual of the runs with results of the solvers themselves.

    Args:
        results: One row for each run. Runs that were skipped do not count, nor those without a
            result or with a result that the residuals refute.

    Returns:
        The rows that remain, with ``error`` as an absolute value and ``residual``, the largest of
        the columns ``residual_*``, NaN without any.

    Raises:
        InputError: There is no such column.
    """
    certified = SOLVED_BY["certificate"](results) & ~says(results, "verdict", SKIPPED)
    good = results[certified & np.isfinite(numbers(results, "solve_time"))]
    return good.assign(error=np.abs(numbers(good, "error")), residual=largest_residuals(good))


def largest_residuals(results: pd.DataFrame) -> Floats:
    """Return the largest of the columns ``residual_*`` of each row, NaN without any."""
    names = with_prefix(results, "residual_")
    columns = [np.nan_to_num(np.abs(numbers(results, name)), nan=-inf) for name in names]
    largest = np.max(columns, axis=0) if columns else np.full(len(results), -inf)
    return np.where(largest < 0, nan, largest)


def residual_means(results: pd.DataFrame) -> pd.DataFrame:
    """Return the accuracy of solvers: geometric mean and maximum of the largest residual of runs.

    Args:
        results: One row for each run.

    Returns:
        Columns that identify a solver; ``measured``, runs with residuals; ``mean_residual``;
        ``worst_residual``; ``worst_error``, the largest error of all runs with a certified result.
        NaN without any.

    Raises:
        InputError: There is no such column.
    """
    rows = []
    for names, part in groups(accuracies(results), SOLVER):
        residual, error = numbers(part, "residual"), numbers(part, "error")
        known, errors = residual[np.isfinite(residual)], error[np.isfinite(error)]
        logarithms = np.log(np.maximum(known, LEAST_RESIDUAL))
        rows.append(
            {
                **names,
                "measured": len(known),
                "mean_residual": exp(float(logarithms.mean())) if known.size else nan,
                "worst_residual": float(known.max()) if known.size else nan,
                "worst_error": float(errors.max()) if errors.size else nan,
            }
        )
    return table(rows, [*SOLVER, "measured", "mean_residual", "worst_residual", "worst_error"])


def separate_residual_means(results: pd.DataFrame) -> pd.DataFrame:
    """Return the shifted geometric mean of each residual of the certified runs of each solver.

    Args:
        results: One row for each run.

    Returns:
        Columns that identify a solver, and a column ``mean_NAME`` for each of `RESIDUALS`,
        ``exp(mean(log(residual + shift))) - shift`` with the shift `RESIDUAL_SHIFT`; NaN where no
        run has this residual.

    Raises:
        InputError: There is no such column.
    """
    rows = [
        names
        | {
            f"mean_{name}": _shifted_mean(numbers(part, f"residual_{name}"))
            for name in RESIDUALS
            if f"residual_{name}" in part.columns
        }
        for names, part in groups(accuracies(results), SOLVER)
    ]
    return table(rows, [*SOLVER, *(f"mean_{name}" for name in RESIDUALS)])


def _shifted_mean(residual: Floats) -> float:
    known = np.abs(residual[np.isfinite(residual)])
    if not known.size:
        return nan
    return RESIDUAL_SHIFT * expm1(float(np.log1p(known / RESIDUAL_SHIFT).mean()))


def answers(results: pd.DataFrame, by: Sequence[str] = SOLVER) -> pd.DataFrame:
    """Count for each solver which component found the results of its runs.

    Args:
        results: One row for each run. Results of older versions do not have this information.
        by: Columns that identify a solver.

    Returns:
        Columns `by`; ``runs``; ``alone``, runs with a result of the backend itself;
        ``with_lacore``, runs with a result that lacore found, or helped to find, by following a
        path; ``unanswered``, all others.

    Raises:
        InputError: There is no such column.
    """
    rows = []
    for names, part in groups(results[~says(results, "verdict", SKIPPED)], by):
        itself = answered_itself(part)
        given = says(part, "verdict", PASS, BOUND_ONLY, NO_REFERENCE)
        given |= np.isfinite(numbers(part, "load_factor"))
        alone, helped = int((given & itself).sum()), int((~itself).sum())
        rows.append(
            {
                **names,
                "runs": len(part),
                "alone": alone,
                "with_lacore": helped,
                "unanswered": len(part) - alone - helped,
            }
        )
    return table(rows, [*by, "runs", "alone", "with_lacore", "unanswered"])
