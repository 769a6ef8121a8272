"""Pairwise comparison of solvers: problems on which each is faster, or is the only one to solve."""

from itertools import combinations
from math import isfinite
from typing import Any

import numpy as np
import pandas as pd

from lacore.numerics.arrays import Floats
from lacore_verification.harness.analysis.columns import problem_columns, says, table
from lacore_verification.harness.analysis.noise import Noise
from lacore_verification.harness.analysis.profiles import costs, solver_names
from lacore_verification.harness.verdicts.words import SKIPPED

OUTCOMES = ("first_faster", "tie", "second_faster", "only_first", "only_second", "neither")
"""Columns of `pairwise_outcomes` that add up to the problems of a pair."""


def pairwise_outcomes(results: pd.DataFrame, found: Noise) -> pd.DataFrame:
    """Count for each pair of solvers the problems on which each is better.

    Only results of the backend itself that its verdict confirms count as solved.

    Args:
        results: One row for each problem, backend and coupling. Skipped runs do not count.
        found: Noise of the machine, which decides whether two times differ.

    Returns:
        Columns ``first``, ``second``; ``problems`` that both were run on; ``both``, problems that
        both solved; of these ``first_faster``, ``tie``, where the noise can explain the difference
        of the times, and ``second_faster``, all None if the noise is not known; ``only_first``,
        ``only_second``, ``neither``. Pairs without a common problem are omitted.

    Raises:
        InputError: There is no such column, or two runs of one solver on one problem.
    """
    ran = results[~says(results, "verdict", SKIPPED)]
    cost = costs(ran, "solve_time", "verdict", "keep").cost
    problem = ran.groupby(problem_columns(ran), dropna=False, sort=False).ngroup()
    names = np.array(solver_names(ran), dtype=object)
    tried = pd.crosstab(problem.to_numpy(), names) > 0  # Its rows are those of `cost`.
    rows = []
    for first, second in combinations(cost.columns, 2):
        common = (tried[first] & tried[second]).to_numpy()
        if common.any():
            times = cost[[first, second]].to_numpy(dtype=float)[common]
            rows.append({"first": first, "second": second, **_counts(times, found)})
    return table(rows, ["first", "second", "problems", "both", *OUTCOMES])


def _counts(times: Floats, found: Noise) -> dict[str, Any]:
    """Count the outcomes on problems with two times each, +inf where one is not solved."""
    one, other = np.isfinite(times).T
    first, second = times[one & other].T
    ranked: dict[str, Any] = dict.fromkeys(("first_faster", "tie", "second_faster"))
    if isfinite(found.factor):
        faster = int((second > found.factor * first).sum())
        slower = int((first > found.factor * second).sum())
        tie = len(first) - faster - slower
        ranked = {"first_faster": faster, "tie": tie, "second_faster": slower}
    return {
        "problems": len(times),
        "both": len(first),
        **ranked,
        "only_first": int((one & ~other).sum()),
        "only_second": int((other & ~one).sum()),
        "neither": int((~one & ~other).sum()),
    }
