"""Orders of the errors of paths in the number of steps (T30)."""

import pandas as pd

from lacore_verification.case.following import ORDERS
from lacore_verification.harness.analysis.columns import SOLVED, says, table
from lacore_verification.harness.analysis.slope_fits import (
    BAR,
    SLOPE_COLUMNS,
    other_columns,
    slopes,
)

STEPS = "param_steps"
"""Column of the number of steps."""
_SCHEME = "param_scheme"


def step_orders(results: pd.DataFrame) -> pd.DataFrame:
    """Return the order with which the largest error of a path falls with the number of its steps.

    Args:
        results: one row for each run; only solved ones with a known error count.

    Returns:
        As `lacore_verification.harness.analysis.slopes`, by all columns that distinguish runs
        except
        the number of steps and the name of the variant, which contains it; and ``order``,
        ``order_low``, ``order_high``, and ``expected``, that of the scheme.
    """
    if not {STEPS, _SCHEME} <= set(results):
        return table([], [*SLOPE_COLUMNS, "order", "order_low", "order_high", "expected"])
    by = [name for name in other_columns(results, STEPS) if name != "variant"]
    known = says(results, "status", SOLVED) & results["path_error"].notna().to_numpy()
    fitted = slopes(results[known], STEPS, "path_error", by, BAR, fewest=3, agreement=0.5)
    return fitted.assign(
        order=-fitted["slope"],
        order_low=-fitted["high"],
        order_high=-fitted["low"],
        expected=fitted[_SCHEME].map(dict(ORDERS)),
    )
