"""What couplings come to with each backend: how many runs they certify, in how many solves."""

from math import isfinite

import numpy as np
import pandas as pd

from lacore.arrays import Bools
from verification.analysis.columns import SOLVED, SOLVER, groups, numbers, says, table
from verification.analysis.effort import efforts
from verification.case.beside import RANGE
from verification.case.bracketing import BRACKET
from verification.verdicts.words import FAIL, SKIPPED


def couplings(results: pd.DataFrame) -> pd.DataFrame:
    """Each coupling with each backend, over all variants that have a load factor.

    That is known, or some coupling has found one. Brackets and ranges are no couplings.

    Args:
        results: one row a run; skipped ones do not count.

    Returns:
        Columns ``backend``, ``coupling``; ``cases``, runs that were to end with a number;
        ``solved``, how many of them ended with a certified one; ``median`` and ``most``, inner
        solves of these, NaN without any; ``failed``, runs judged wrong.

    Raises:
        InputError: no such column.
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
    """Where a load factor is known, or is found where nothing is known."""
    reference = numbers(results, "reference")
    return np.isfinite(reference) | (np.isnan(reference) & says(results, "status", SOLVED))
