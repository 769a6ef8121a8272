"""Cost of runs: inner solves, iterations, contraction and time; and cost of accuracy."""

from collections.abc import Sequence
from math import isfinite, nan

import numpy as np
import pandas as pd

from lacore.numerics.arrays import Bools, Floats
from lacore.reporting.errors import require_positive
from lacore_verification.case import BRACKET, RANGE
from lacore_verification.harness.analysis.columns import (
    SOLVED,
    SOLVER,
    groups,
    numbers,
    require_columns,
    says,
    table,
)
from lacore_verification.harness.verdicts.words import FAIL, SKIPPED

BY = ("case", "variant", "backend", "coupling")
LEVELS = (1e-2, 1e-3, 1e-4)  # Relative errors of 1 %, 0.1 % and 0.01 %.


def efforts(results: pd.DataFrame, by: Sequence[str] = BY) -> pd.DataFrame:
    """Return iterations and contraction of the loops, medians over the certified runs of a group.

    Args:
        results: one row for each run; skipped ones do not count.
        by: columns that define a group.

    Returns:
        Columns `by`; ``runs``; ``certified``, the number with a certified load factor, to which all
        other columns refer: ``inner_solves`` and ``most_inner_solves``, median and largest number
        of inner solves of the loop; ``iterations``, of the solver, over all inner solves;
        ``iterations_per_solve``; ``contraction``, the observed ratio of consecutive changes of the
        loop (below 1 the plain loop converges), and ``worst_contraction``; ``solve_time``, s;
        ``time_per_solve``, s; ``peak_memory_mb``, the largest. NaN where nothing is known.

    Raises:
        InputError: there is no such column.
    """
    rows = []
    for names, part in groups(results[~says(results, "verdict", SKIPPED)], by):
        good = part[says(part, "status", SOLVED)]
        solves, steps = numbers(good, "outer_iterations"), numbers(good, "iterations")
        contraction, seconds = numbers(good, "contraction"), numbers(good, "solve_time")
        with np.errstate(divide="ignore", invalid="ignore"):
            steps_each, seconds_each = steps / solves, seconds / solves
        rows.append(
            {
                **names,
                "runs": len(part),
                "certified": len(good),
                "inner_solves": _median(solves),
                "most_inner_solves": _most(solves),
                "iterations": _median(steps),
                "iterations_per_solve": _median(steps_each),
                "contraction": _median(contraction),
                "worst_contraction": _most(contraction),
                "solve_time": _median(seconds),
                "time_per_solve": _median(seconds_each),
                "peak_memory_mb": _most(numbers(good, "peak_memory_mb")),
            }
        )
    return table(rows, [*by, *_EFFORT])


_EFFORT = (
    "runs",
    "certified",
    "inner_solves",
    "most_inner_solves",
    "iterations",
    "iterations_per_solve",
    "contraction",
    "worst_contraction",
    "solve_time",
    "time_per_solve",
    "peak_memory_mb",
)


def _median(values: Floats) -> float:
    known = values[np.isfinite(values)]
    return float(np.median(known)) if known.size else nan


def _most(values: Floats) -> float:
    known = values[np.isfinite(values)]
    return float(known.max()) if known.size else nan


def costs_of_accuracy(
    results: pd.DataFrame,
    levels: Sequence[float] = LEVELS,
    cost: str = "solve_time",
) -> pd.DataFrame:
    """Return the cheapest run of each group whose error is at most a level, for each level.

    Only certified runs (status ``solved``) count. If none is that accurate there is no cost,
    whatever the trend.

    Args:
        results: one row for each run.
        levels: of abs(error), > 0.
        cost: column.

    Returns:
        Columns `BY`; ``level``; ``cost``, in the unit of its column, NaN if not reached; ``run``,
        id of that run if there are any; ``mesh``, ``n_dofs``, ``reached``, abs(error), of that run;
        ``closest``, the smallest abs(error) of the group; ``reason``, why it is not reached.

    Raises:
        InputError: there is no such column, or a level is not positive.
    """
    for level in levels:
        require_positive("level", level)
    told = [name for name in ("run", "mesh", "n_dofs") if name in results.columns]
    told = [name for name in told if name not in BY]
    require_columns(results, [cost, "error"])
    rows = []
    for names, part in groups(results, BY):
        good = says(part, "status", SOLVED)
        size, price = np.abs(numbers(part, "error")), numbers(part, cost)
        good &= np.isfinite(size) & np.isfinite(price)
        closest = float(size[good].min()) if good.any() else nan
        for level in levels:
            row = {**names, "level": level, "cost": nan, "reached": nan, "closest": closest}
            near = np.flatnonzero(good & (size <= level))
            if near.size:
                best = near[np.argmin(price[near])]
                row |= {name: part[name].iloc[best] for name in told}
                row |= {"cost": float(price[best]), "reached": float(size[best]), "reason": ""}
            elif good.any():
                row["reason"] = f"never: {closest:.2g} is the closest"
            else:
                row["reason"] = "never: no certified run with an error"
            rows.append(row)
    return table(rows, [*BY, "level", "cost", *told, "reached", "closest", "reason"])


def couplings(results: pd.DataFrame) -> pd.DataFrame:
    """Return each coupling with each backend, over all variants that have a load factor.

    It is known, or some coupling has found one. Brackets and ranges are no couplings.

    Args:
        results: one row for each run; skipped ones do not count.

    Returns:
        Columns ``backend``, ``coupling``; ``cases``, runs of variants with a load factor;
        ``solved``, the number with a certified one; ``median`` and ``most``, inner solves of these,
        NaN without any; ``failed``, runs with a FAIL verdict.

    Raises:
        InputError: there is no such column.
    """
    looped = results[~says(results, "coupling", BRACKET, RANGE)]
    ran = looped[~says(looped, "verdict", SKIPPED)]
    having = set(_variants(looped[_has_load(looped)]))
    finite = [variant in having for variant in _variants(ran)]
    ran = ran.assign(finite=np.array(finite, dtype=bool) & ~np.isinf(numbers(ran, "reference")))
    rows = []
    for names, part in groups(ran, SOLVER):
        (effort,) = efforts(part[part["finite"]], by=()).to_dict("records")
        rows.append(
            {
                **names,
                "cases": effort["runs"],
                "solved": effort["certified"],
                "median": effort["inner_solves"],
                "most": _whole(effort["most_inner_solves"]),
                "failed": int(says(part, "verdict", FAIL).sum()),
            }
        )
    return table(rows, [*SOLVER, "cases", "solved", "median", "most", "failed"])


def _whole(count: float) -> float:
    return int(count) if isfinite(count) else count


def _variants(results: pd.DataFrame) -> list[tuple[str, str]]:
    return list(zip(results["case"], results["variant"], strict=True))


def _has_load(results: pd.DataFrame) -> Bools:
    """Return where a load factor is known, or was found without a reference."""
    reference = numbers(results, "reference")
    return np.isfinite(reference) | (np.isnan(reference) & says(results, "status", SOLVED))
