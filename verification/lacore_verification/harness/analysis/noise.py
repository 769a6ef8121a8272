"""Noise of the machine, and rankings of backends by time that it leaves undecided."""

from dataclasses import dataclass
from itertools import combinations
from math import exp, isfinite, nan, sqrt
from typing import Any

import numpy as np
import pandas as pd

from lacore_verification.harness.analysis.columns import numbers, solver_columns, table, with_prefix
from lacore_verification.harness.analysis.profiles import costs

CALIBRATIONS = ("calibration_before", "calibration_after")
LEAST = 5
"""Times of the calibration from which a scatter is computed."""
_CENTRAL = (0.16, 0.84)  # Quantiles one standard deviation from the mean of a normal distribution.
_SIGNIFICANT = 1.96  # Standard deviations of a normal distribution that contain 95 %.
PAIRS = ("one", "other", "problems", "ratio", "undecided")


@dataclass(frozen=True)
class Noise:
    """Scatter of the times of a short program that was solved repeatedly.

    Attributes:
        count: number of times.
        median: median time, s; NaN without any.
        scatter: relative standard deviation, from the quantiles at 16 and 84 %, so that a few
            interruptions do not count; NaN if there are too few.
        factor: ratio of two times up to which they may differ by noise alone, in 95 % of pairs.
    """

    count: int
    median: float
    scatter: float
    factor: float

    def record(self) -> dict[str, float]:
        """Return the noise as plain data."""
        return dict(vars(self))


def noise(results: pd.DataFrame) -> Noise:
    """Return the noise of the calibrations of runs.

    Args:
        results: one row for each run; older results have no calibrations.
    """
    known = [numbers(results, name) for name in CALIBRATIONS if name in results.columns]
    times = np.concatenate([*known, np.zeros(0)])
    times = times[times > 0]
    if len(times) < LEAST:
        return Noise(len(times), float(np.median(times)) if len(times) else nan, nan, nan)
    low, high = np.quantile(np.log(times), _CENTRAL)
    scatter = float(high - low) / 2
    factor = exp(_SIGNIFICANT * sqrt(2) * scatter)
    return Noise(len(times), float(np.median(times)), scatter, factor)


def rankings(results: pd.DataFrame, found: Noise) -> pd.DataFrame:
    """Return all pairs of solvers, with the ratio of their times.

    Args:
        results: One row for each run, with a positive `solve_time` if it is certified.
        found: See `noise`.

    Returns:
        Columns ``one``, the faster one, and ``other``; ``problems`` that both solved with a
        certificate; ``ratio``, the geometric mean of the times of the other one relative to those
        of the first; ``undecided``, whether the noise of the machine can explain this ratio. None
        if the noise is not known.
    """
    solver = solver_columns(results)
    if "options" in results.columns:
        # Results that were stored without this column have the options in columns of their own.
        own = with_prefix(results, "option_")
        stated = results["options"].fillna("").ne("") | results[own].isna().all(axis=1)
        if stated.all():
            solver = [*(name for name in solver if name not in own), "options"]
    matrix = costs(results, "solve_time", "certificate", "keep", solver).cost
    rows: list[dict[str, Any]] = []
    for one, other in combinations(matrix.columns, 2):
        both = matrix[np.isfinite(matrix[one]) & np.isfinite(matrix[other])]
        if not len(both):
            continue
        ratio = exp(float(np.log(both[other] / both[one]).mean()))
        pair = (one, other) if ratio >= 1 else (other, one)
        ratio = max(ratio, 1 / ratio)
        undecided = bool(ratio <= found.factor) if isfinite(found.factor) else None
        values = (*pair, len(both), ratio, undecided)
        rows.append(dict(zip(PAIRS, values, strict=True)))
    rows.sort(key=lambda row: row["ratio"])
    return table(rows, PAIRS)
