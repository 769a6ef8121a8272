"""Comparison of solvers: performance profiles, data profiles, shifted geometric means, rates.

Two filters are decisive, and both are arguments without a default that are named in the result:
which runs count as solved, and whether problems that no solver solved are kept.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import exp, inf, nan
from types import MappingProxyType

import numpy as np
import pandas as pd

from lacore.numerics.arrays import Bools, Floats
from lacore.reporting.errors import InputError, require_known, require_positive
from lacore_verification.harness.analysis.columns import (
    SOLVED,
    SOLVER,
    answered_itself,
    groups,
    numbers,
    problem_columns,
    require_columns,
    says,
    table,
    truths,
)
from lacore_verification.harness.verdicts.words import BOUND_ONLY, NO_REFERENCE, PASS, SKIPPED

SOLVED_BY: Mapping[str, Callable[[pd.DataFrame], Bools]] = MappingProxyType(
    {
        "claim": lambda results: truths(results, "claimed"),
        "certificate": lambda results: says(results, "status", SOLVED) & answered_itself(results),
        "verdict": lambda results: (
            says(results, "verdict", PASS, BOUND_ONLY, NO_REFERENCE) & answered_itself(results)
        ),
    }
)
""" Criteria for solved runs: the solver's claim; residuals computed here; these and a reference.

Only results of the backend itself count, not those that lacore found by following a path. The last
one is used as far as there is a reference. A verdict also accepts a run that ends with the correct
status, such as ``locked``.
"""
UNSOLVED: Mapping[str, str] = MappingProxyType(
    {"keep": "problems that nobody solved are kept", "drop": "they are left out"}
)


@dataclass(frozen=True)
class Costs:
    """Costs of each solver for each problem.

    Attributes:
        cost: one row for each problem, one column for each solver (index and columns are named by
            its labels); +inf where it was not solved or not run.
        unit: number by which the cost of each problem may be divided, shape (problems,).
        nobody: problems that no solver solved, before the filter.
        filters: both filters, and the measure, as text.
    """

    cost: pd.DataFrame
    unit: Floats
    nobody: int
    filters: Mapping[str, str | int]


def costs(
    results: pd.DataFrame,
    measure: str,
    solved_by: str,
    unsolved: str,
    solver: Sequence[str] = SOLVER,
    problem: Sequence[str] | None = None,
    per: str | None = None,
) -> Costs:
    """Return costs of solved runs as a matrix of problems and solvers.

    Skipped runs, and problems that a solver was not run on, are not solved by it.

    Args:
        results: one row for each run.
        measure: column of the cost, positive: ``solve_time``, ``iterations``, ...
        solved_by: ``claim``, ``certificate`` or ``verdict``; see `SOLVED_BY`.
        unsolved: problems that no solver solved: ``keep`` or ``drop``.
        solver: columns that identify a solver.
        problem: columns that identify a problem; None: case, variant, mesh, ``param_*``,
            ``size_*``.
        per: column of `unit`, the same for all runs of a problem; None: 1.

    Raises:
        InputError: an unknown name; two runs of one solver on one problem; a solved run without a
            positive cost.
    """
    require_known("solved_by", solved_by, SOLVED_BY)
    require_known("unsolved", unsolved, UNSOLVED)
    problem = list(problem_columns(results) if problem is None else problem)
    require_columns(results, [*solver, *problem])
    value, good = numbers(results, measure), SOLVED_BY[solved_by](results)
    good &= ~says(results, "verdict", SKIPPED)
    if np.any(good & ~((value > 0) & np.isfinite(value))):
        bad = value[good & ~((value > 0) & np.isfinite(value))][0]
        raise InputError(measure, float(bad), "no cost of a solved run", "name another measure")
    frame = results[[*problem]].assign(
        _solver=solver_names(results, solver),
        _cost=np.where(good, value, inf),
        _unit=1.0 if per is None else numbers(results, per),
    )
    if frame.duplicated([*problem, "_solver"]).any():
        twice = frame[frame.duplicated([*problem, "_solver"])].iloc[0]
        raise InputError(
            "solver",
            twice["_solver"],
            "has two runs of one problem",
            "name the columns that tell them apart, or leave rows out",
        )
    names = list(dict.fromkeys(frame["_solver"]))
    rows, units = [], []
    for _, part in groups(frame, problem):
        by_solver = dict(zip(part["_solver"], numbers(part, "_cost"), strict=True))
        rows.append([by_solver.get(name, inf) for name in names])
        known = numbers(part, "_unit")[np.isfinite(numbers(part, "_unit"))]
        units.append(known[0] if known.size else nan)
    matrix = np.array(rows, dtype=float).reshape(len(rows), len(names))
    alive = np.isfinite(matrix).any(axis=1)
    kept = alive if unsolved == "drop" else np.ones(len(matrix), dtype=bool)
    filters: dict[str, str | int] = {
        "measure": measure,
        "solved_by": solved_by,
        "unsolved": unsolved,
        "problems": int(kept.sum()),
        "nobody": int((~alive).sum()),
    }
    frame = pd.DataFrame(matrix[kept], columns=names)
    return Costs(frame, np.array(units, dtype=float)[kept], int((~alive).sum()), filters)


def solver_names(results: pd.DataFrame, solver: Sequence[str] = SOLVER) -> list[str]:
    """Return the name of the solver of each run: its values of some columns, empty ones omitted."""
    columns = [results[name] for name in solver]
    return [
        " ".join(str(value) for value in values if not pd.isna(value) and value != "")
        for values in zip(*columns, strict=True)
    ]


def performance_profile(found: Costs) -> pd.DataFrame:
    """Return Dolan-Moré profiles: the share of problems solved within a factor of the best solver.

    Returns:
        ``solver``; ``factor``, tau >= 1; ``share``, rho(tau) in [0, 1], of all problems kept: the
        corners of a step function that jumps at `factor` and is constant up to the next one, each
        solver from factor 1 to the largest of all; and ``measure``, ``solved_by``, ``unsolved``,
        ``problems``, ``nobody`` of `costs`, which are in ``attrs``, too.
    """
    matrix = found.cost.to_numpy(dtype=float)
    best = matrix.min(axis=1, keepdims=True) if matrix.size else np.empty((len(matrix), 1))
    with np.errstate(invalid="ignore"):
        ratio = np.where(np.isfinite(matrix), matrix / best, inf)
    return _profile(found, ratio, "factor", 1.0)


def data_profile(found: Costs) -> pd.DataFrame:
    """Return Moré-Wild profiles.

    The share of problems solved within a budget per unit of the problem.

    The budget is the cost over `Costs.unit` + 1: with ``per="n_dofs"`` and iterations as measure
    those per unknown. For the plain cost see `budget_profile`.

    Returns:
        As `performance_profile`, with ``budget`` in place of ``factor``, from 0 on.

    Raises:
        InputError: a problem that some solver solved has no unit.
    """
    matrix = found.cost.to_numpy(dtype=float)
    if np.isnan(found.unit[np.isfinite(matrix).any(axis=1)]).any():
        raise InputError("per", None, "a solved problem has no such number", "name another column")
    return _profile(found, matrix / (np.nan_to_num(found.unit)[:, None] + 1), "budget", 0.0)


def budget_profile(found: Costs) -> pd.DataFrame:
    """Return the share of problems solved within a cost: ``budget``, in its unit, from 0 on.

    Returns:
        As `data_profile`.
    """
    return _profile(found, found.cost.to_numpy(dtype=float), "budget", 0.0)


def _profile(found: Costs, need: Floats, axis: str, start: float) -> pd.DataFrame:
    end = float(np.max(need[np.isfinite(need)], initial=start))
    rows = []
    for column, name in enumerate(found.cost.columns):
        own = need[:, column]
        steps = np.unique([start, *own[np.isfinite(own)], end])
        for step in steps:
            share = float(np.mean(own <= step)) if len(own) else nan
            rows.append({"solver": name, axis: float(step), "share": share, **found.filters})
    return _with_filters(table(rows, ["solver", axis, "share", *found.filters]), found)


def _with_filters(frame: pd.DataFrame, found: Costs) -> pd.DataFrame:
    frame.attrs.update(found.filters)
    return frame


def shifted_geometric_means(found: Costs, shift: float, limit: float) -> pd.DataFrame:
    """Return ``exp(mean(log(cost + shift))) - shift`` of each solver, over all problems kept.

    Args:
        found: from `costs`.
        shift: in the unit of the cost, >= 0: costs far below it count alike.
        limit: cost of a problem that the solver did not solve, the time limit.

    Returns:
        ``solver``; ``mean``; ``ratio`` to the smallest mean; ``solved``, problems solved;
        ``shift``, ``limit``; the filters as in `performance_profile`; the best solver first.

    Raises:
        InputError: a shift < 0, or a limit below the cost of a solved problem.
    """
    require_positive("limit", limit)
    if not shift >= 0:
        raise InputError("shift", shift, "negative", "give 0 or more")
    matrix = found.cost.to_numpy(dtype=float)
    most = float(np.max(matrix[np.isfinite(matrix)], initial=0.0))
    if most > limit:
        raise InputError("limit", limit, f"a solved problem costs {most:g}", "give at least that")
    capped = np.minimum(matrix, limit) + shift
    rows = [
        {
            "solver": name,
            "mean": exp(float(np.mean(np.log(capped[:, i])))) - shift if len(matrix) else nan,
            "ratio": nan,
            "solved": int(np.isfinite(matrix[:, i]).sum()),
            "shift": shift,
            "limit": limit,
            **found.filters,
        }
        for i, name in enumerate(found.cost.columns)
    ]
    columns = ["solver", "mean", "ratio", "solved", "shift", "limit", *found.filters]
    frame = table(rows, columns).sort_values("mean", kind="stable", ignore_index=True)
    frame["ratio"] = frame["mean"] / frame["mean"].min()
    return _with_filters(frame, found)


def rates(results: pd.DataFrame, by: Sequence[str] = SOLVER) -> pd.DataFrame:
    """Return rates of claimed, certified and correct results.

    Args:
        results: one row for each run; skipped ones do not count.
        by: columns that identify a solver.

    Returns:
        Columns `by`; ``runs``; ``claimed``, runs that the solver itself reported as solved;
        ``certified``, runs whose recomputed residuals prove the value; ``correct``, runs that pass
        against certificate and reference; ``unjudged``, proven, but without a reference;
        ``wrong_claims``, claimed, and neither correct nor unjudged; ``success_rate =
        claimed/runs``, ``certified_rate``; ``correctness_rate``, of the runs with a reference, NaN
        without any.

    Raises:
        InputError: there is no such column.
    """
    rows = []
    for names, part in groups(results[~says(results, "verdict", SKIPPED)], by):
        claimed, certified = (SOLVED_BY[name](part) for name in ("claim", "certificate"))
        itself = answered_itself(part)
        correct = says(part, "verdict", PASS, BOUND_ONLY) & itself
        unjudged = says(part, "verdict", NO_REFERENCE) & itself
        count, judged = len(part), int((~unjudged).sum())
        rows.append(
            {
                **names,
                "runs": count,
                "claimed": int(claimed.sum()),
                "certified": int(certified.sum()),
                "correct": int(correct.sum()),
                "unjudged": int(unjudged.sum()),
                "wrong_claims": int((claimed & ~correct & ~unjudged).sum()),
                "success_rate": float(claimed.sum() / count),
                "certified_rate": float(certified.sum() / count),
                "correctness_rate": float(correct.sum() / judged) if judged else nan,
            }
        )
    counts = ("runs", "claimed", "certified", "correct", "unjudged", "wrong_claims")
    return table(rows, [*by, *counts, "success_rate", "certified_rate", "correctness_rate"])
