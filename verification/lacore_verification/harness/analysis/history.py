"""Comparison of stored results of several versions: rates, times, errors, and changes.

Versions are compared on the runs that all of them have, because a version that ran fewer problems
is neither better nor worse.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite, nan
from numbers import Real
from typing import Any

import numpy as np
import pandas as pd

from lacore_verification.case import SOLVER
from lacore_verification.harness.analysis.columns import (
    answered_itself,
    numbers,
    problem_columns,
    says,
    solver_columns,
    table,
)
from lacore_verification.harness.analysis.profiles import (
    SOLVED_BY,
    costs,
    rates,
    shifted_geometric_means,
)
from lacore_verification.harness.verdicts.words import FAIL, PASS, SKIPPED

SHIFT = 0.1
"""Shift of the geometric means, s: solves that take much less count alike."""
_KEY = "_key"
_RATES = ("runs", "claimed", "certified", "correct", "wrong_claims")
_SHARES = ("success_rate", "certified_rate", "correctness_rate")


@dataclass(frozen=True)
class History:
    """Results of several versions.

    Attributes:
        versions: Names, in the given order.
        backends: One row for each backend and version: ``backend``, ``version``, ``all_runs``, and
            on the runs that all versions with this backend have: ``runs``, ``claimed``,
            ``certified``, ``correct``, ``wrong_claims``, their rates, ``mean_time``, the shifted
            geometric mean of the solve times in s, ``ratio`` to the first version, and
            ``worst_error``.
        changes: One row for each run whose verdict or load factor differs between a version and
            the previous one that has the run: ``case``, ``variant``, ``backend``, ``coupling``,
            ``mesh``, ``settings``, ``before``, ``after``, ``verdict_before``, ``verdict_after``,
            ``load_factor_before``, ``load_factor_after``, ``change``, relative, ``lacore_before``,
            ``lacore_after``, the version of lacore that computed each, if the results have it.
        only: Number of runs that not all versions have, by version.
    """

    versions: tuple[str, ...]
    backends: pd.DataFrame
    changes: pd.DataFrame
    only: Mapping[str, int]

    @property
    def worse(self) -> int:
        """Return how many runs passed in a version and fail in the next."""
        before, after = self.changes["verdict_before"], self.changes["verdict_after"]
        return int(((before == PASS) & (after == FAIL)).sum())


def history(versions: Mapping[str, pd.DataFrame], tolerance: float = SOLVER) -> History:
    """Compare the results of versions.

    Args:
        versions: Results by the name of the version, in their order, one row for each run.
        tolerance: Relative change of a load factor that is reported.

    Raises:
        InputError: A column is missing, or a solved run has no time.
    """
    keyed = {name: _with_keys(results) for name, results in versions.items()}
    everywhere = set.intersection(*(set(frame[_KEY]) for frame in keyed.values()))
    backends = dict.fromkeys(name for frame in keyed.values() for name in frame["backend"])
    rows = [row for backend in backends for row in _backend_rows(str(backend), keyed)]
    columns = ("backend", "version", "all_runs", *_RATES, *_SHARES, "mean_time", "ratio")
    return History(
        tuple(keyed),
        table(rows, [*columns, "worst_error"]),
        _changes(keyed, tolerance),
        {name: int((~frame[_KEY].isin(everywhere)).sum()) for name, frame in keyed.items()},
    )


def _with_keys(results: pd.DataFrame) -> pd.DataFrame:
    """Add the identity of a run in all versions; of several rows of a run the last one remains."""
    names = sorted({*problem_columns(results), *solver_columns(results)})
    keys = [
        tuple((name, text) for name in names if (text := _text(record[name])))
        for record in results[names].astype(object).to_dict("records")
    ]
    keyed = results.assign(**{_KEY: pd.Series(keys, index=results.index, dtype=object)})
    return keyed[~keyed[_KEY].duplicated(keep="last")]


def _text(value: object) -> str:
    """Return a value as text that does not depend on its type in a table; empty without one."""
    if pd.isna(value):  # type: ignore[call-overload]
        return ""
    if isinstance(value, Real) and not isinstance(value, bool | np.bool_):
        return f"{float(value):.12g}"
    return str(value)


def _backend_rows(backend: str, keyed: Mapping[str, pd.DataFrame]) -> list[dict[str, Any]]:
    own = {name: frame[says(frame, "backend", backend)] for name, frame in keyed.items()}
    ran = {name: part[~says(part, "verdict", SKIPPED)] for name, part in own.items()}
    ran = {name: part for name, part in ran.items() if len(part)}
    if not ran:
        return []
    common = set.intersection(*(set(part[_KEY]) for part in ran.values()))
    shared = {name: part[part[_KEY].isin(common)] for name, part in ran.items()}
    means = _mean_times(shared)
    rows = []
    for name, part in shared.items():
        (rate,) = rates(part, by=()).to_dict("records") if len(part) else [{}]
        first = next(iter(means.values()), nan)
        mean = means.get(name, nan)
        rows.append(
            {
                "backend": backend,
                "version": name,
                "all_runs": len(ran[name]),
                **{column: rate.get(column, 0) for column in _RATES},
                **{column: rate.get(column, nan) for column in _SHARES},
                "mean_time": mean,
                "ratio": mean / first if first > 0 else nan,
                "worst_error": _worst_error(part),
            }
        )
    return rows


def _mean_times(shared: Mapping[str, pd.DataFrame]) -> dict[str, float]:
    """Return shifted geometric means over the runs that any version solved.

    A run that another version solved counts with the longest time of all. Runs that any version
    has no time of are left out.
    """
    parts = [part.assign(version=name) for name, part in shared.items() if len(part)]
    if not parts:
        return {}
    frame = pd.concat(parts, ignore_index=True)
    times = numbers(frame, "solve_time")
    untimed = set(frame[_KEY][~(np.isfinite(times) & (times > 0))])
    frame = frame[~frame[_KEY].isin(untimed)]
    found = costs(frame, "solve_time", "verdict", "drop", solver=["version"], problem=[_KEY])
    cost = found.cost.to_numpy(dtype=float)
    longest = float(np.max(cost[np.isfinite(cost)], initial=0.0))
    if not longest > 0:
        return {}
    means = shifted_geometric_means(found, SHIFT, longest).set_index("solver")["mean"]
    return {name: float(means[name]) for name in shared if name in means.index}


def _worst_error(part: pd.DataFrame) -> float:
    good = part[SOLVED_BY["certificate"](part) & answered_itself(part)] if len(part) else part
    errors = np.abs(numbers(good, "error"))
    known = errors[np.isfinite(errors)]
    return float(known.max()) if known.size else nan


def _changes(keyed: Mapping[str, pd.DataFrame], tolerance: float) -> pd.DataFrame:
    """Compare each run with the same run in the last version before that has it."""
    rows: list[dict[str, Any]] = []
    last: dict[Any, tuple[str, Mapping[Any, Any]]] = {}
    for name, frame in keyed.items():
        for record in frame.astype(object).to_dict("records"):
            key = record[_KEY]
            if key in last:
                rows += _change(last[key], (name, record), tolerance)
            last[key] = (name, record)
    columns = ("case", "variant", "backend", "coupling", "mesh", "settings", "before", "after")
    values = ("verdict_before", "verdict_after", "load_factor_before", "load_factor_after")
    return table(rows, [*columns, *values, "change", "lacore_before", "lacore_after"])


def _change(
    one: tuple[str, Mapping[Any, Any]], other: tuple[str, Mapping[Any, Any]], tolerance: float
) -> Sequence[dict[str, Any]]:
    (before, old), (after, new) = one, other
    first, second = (_number(record["load_factor"]) for record in (old, new))
    change = _relative(first, second)
    moved = abs(change) > tolerance or isfinite(first) != isfinite(second)
    if old["verdict"] == new["verdict"] and not moved:
        return []
    named = ("case", "variant", "backend", "coupling", "mesh")
    more = [f"{name}={text}" for name, text in new[_KEY] if name not in named]
    return [
        {
            **{name: new[name] for name in named},
            "settings": ", ".join(more),
            "before": before,
            "after": after,
            "verdict_before": old["verdict"],
            "verdict_after": new["verdict"],
            "load_factor_before": first,
            "load_factor_after": second,
            "change": change,
            "lacore_before": old.get("lacore", ""),
            "lacore_after": new.get("lacore", ""),
        }
    ]


def _number(value: Any) -> float:
    return nan if pd.isna(value) else float(value)


def _relative(first: float, second: float) -> float:
    """Return the change per size of the first value; of values around zero, the change itself."""
    if not (isfinite(first) and isfinite(second)):
        return nan
    return (second - first) / (abs(first) if abs(first) > SOLVER else 1.0)
