"""Power laws between an error and a parameter: slope, its range, and the floor below it.

Nothing is fitted beyond the points: without a range there is a reason in place of a slope.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from itertools import combinations
from math import exp, log, nan

import numpy as np
import pandas as pd
from scipy import stats

from lacore.numerics.arrays import Bools, Floats
from lacore.reporting.errors import InputError, require_positive
from lacore_verification.harness.analysis.columns import (
    SOLVED,
    groups,
    numbers,
    problem_columns,
    require_columns,
    says,
    solver_columns,
    table,
)

FLAT = 0.25  # Smaller slopes mean that the error does not depend on the parameter.
APART = 2.0  # Factor from the fitted line beyond which the error no longer follows it.
BAR = 1e-6  # Relative tolerance of the certificate; smaller errors are no discretisation errors.


@dataclass(frozen=True)
class Slope:
    """A power law ``|error| = coefficient * parameter**slope``, and its range.

    Attributes:
        slope: of log |error| against log parameter; NaN where there is none.
        standard_error: of the slope, by regression.
        low, high: confidence interval of the slope (Student, points - 2 degrees of freedom). Errors
            of a discretisation are not random: it measures the scatter of points about the line.
        coefficient: |error| at parameter 1 on the line, in units of the error.
        start, stop: smallest and largest parameter of the range.
        points: number of points in the range.
        usable: points with a finite error and a positive parameter.
        spread: between the smallest and the largest local slope in the range.
        floor: median |error| of the points beyond the range, on the side to which the line falls,
            that no longer follow it; NaN if there are none: it is not reached. Without a slope that
            of the points below the noise, or of the longest flat run.
        floor_points: how many these are.
        reason: why there is no slope; empty otherwise.
    """

    slope: float = nan
    standard_error: float = nan
    low: float = nan
    high: float = nan
    coefficient: float = nan
    start: float = nan
    stop: float = nan
    points: int = 0
    usable: int = 0
    spread: float = nan
    floor: float = nan
    floor_points: int = 0
    reason: str = ""


SLOPE_COLUMNS = tuple(entry.name for entry in fields(Slope))


def fit_slope(
    parameter: Floats,
    error: Floats,
    noise: Floats | float = 0.0,
    *,
    fewest: int = 4,
    agreement: float = 0.25,
    confidence: float = 0.95,
) -> Slope:
    """Return the slope of |error| against a parameter over the range where there is one.

    The range is the longest run of at least `fewest` neighbouring points whose errors have one sign
    and exceed the noise, and whose local slopes (between neighbours, log-log) differ by `agreement`
    at most and are not flat (their median is 0.25 or more); of equally long ones that whose local
    slopes differ least. The line is fitted to the range alone. Beyond it, where the line falls, the
    floor begins at the first point that is off the line by a factor of 2, to either side, is not
    above the noise, or has another sign.

    Args:
        parameter: positive, in any order; points without a finite error are omitted.
        error: signed, in any unit.
        noise: known accuracy of the errors, in their unit, >= 0.
        fewest: least number of points of a slope, at least 3.
        agreement: allowed difference of local slopes.
        confidence: of the interval, in (0, 1).

    Raises:
        InputError: an argument is out of range.
    """
    _check(fewest, agreement, confidence)
    parameter, error, noise = np.broadcast_arrays(parameter, error, noise)
    keep = np.isfinite(parameter) & np.isfinite(error) & (parameter > 0)
    order = np.argsort(parameter[keep])
    x, y, level = (values[keep][order] for values in (parameter, error, noise))
    size = np.abs(y)
    clear = size > np.nan_to_num(level)
    if len(np.unique(x)) < len(x):
        return Slope(usable=len(x), reason="several values at one parameter: group by more columns")
    if clear.sum() < fewest:
        return _too_few(size, clear, fewest)
    local = _local_slopes(x, y, clear)
    runs = [
        (first, last)
        for first, last in combinations(range(len(x)), 2)
        if last - first + 1 >= fewest and np.ptp(local[first:last]) <= agreement
    ]
    runs.sort(key=lambda run: (run[1] - run[0], -np.ptp(local[slice(*run)])))
    steep = [run for run in runs if abs(np.median(local[slice(*run)])) >= FLAT]
    if not steep:
        flat = slice(runs[-1][0], runs[-1][1] + 1) if runs else slice(0)
        return _no_range(y, flat, fewest, agreement)
    first, last = steep[-1]
    inside = slice(first, last + 1)
    line = stats.linregress(np.log(x[inside]), np.log(size[inside]))
    slope, deviation = float(line.slope), float(line.stderr)
    half = float(stats.t.ppf((1 + confidence) / 2, last - first - 1)) * deviation
    beyond = np.arange(first)[::-1] if slope > 0 else np.arange(last + 1, len(x))
    follows = _follows(x, y, clear, np.sign(y[first]), slope, float(line.intercept))
    lost = np.flatnonzero(~follows[beyond])
    on_floor = size[beyond[lost[0] :]] if lost.size else np.empty(0)
    return Slope(
        slope=slope,
        standard_error=deviation,
        low=slope - half,
        high=slope + half,
        coefficient=exp(line.intercept) if line.intercept < log(np.finfo(float).max) else nan,
        start=float(x[first]),
        stop=float(x[last]),
        points=last - first + 1,
        usable=len(x),
        spread=float(np.ptp(local[first:last])),
        floor=float(np.median(on_floor)) if on_floor.size else nan,
        floor_points=int(on_floor.size),
    )


def _check(fewest: int, agreement: float, confidence: float) -> None:
    if fewest < 3:
        raise InputError("fewest", fewest, "two points always lie on a line", "give 3 or more")
    require_positive("agreement", agreement)
    if not 0 < confidence < 1:
        raise InputError("confidence", confidence, "outside (0, 1)", "give e.g. 0.95")


def _local_slopes(x: Floats, y: Floats, clear: Bools) -> Floats:
    """Return slopes between neighbours, shape (n - 1,); NaN across a change of sign.

    They are also NaN next to a point that is not clear; NaN agrees with nothing.
    """
    good = clear[1:] & clear[:-1] & (np.sign(y[1:]) == np.sign(y[:-1]))
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(good, np.diff(np.log(np.abs(y))) / np.diff(np.log(x)), nan)


def _follows(
    x: Floats, y: Floats, clear: Bools, sign: float, slope: float, intercept: float
) -> Bools:
    """Return which points are on the line, within a factor."""
    with np.errstate(divide="ignore"):
        off = np.abs(np.log(np.abs(y)) - intercept - slope * np.log(x))
    return np.asarray(clear & (np.sign(y) == sign) & (off <= log(APART)))


def _too_few(size: Floats, clear: Bools, fewest: int) -> Slope:
    known, left = len(size), int(clear.sum())
    if known < fewest:
        return Slope(usable=known, reason=f"{known} points, {fewest} make a slope")
    return Slope(
        usable=known,
        floor=float(np.median(size[~clear])),
        floor_points=known - left,
        reason=f"{left} of {known} errors are above the noise, {fewest} make a slope",
    )


def _no_range(y: Floats, flat: slice, fewest: int, agreement: float) -> Slope:
    on_floor = np.abs(y[flat])
    signs = "" if np.all(y > 0) or np.all(y < 0) else "; the error changes its sign"
    reason = f"no {fewest} neighbours with local slopes within {agreement:g}{signs}"
    if len(on_floor) == len(y):
        reason = "the error does not follow the parameter"
    elif on_floor.size:
        reason = (
            f"only {on_floor.size} neighbours on a floor have local slopes within {agreement:g}"
        )
    return Slope(
        usable=len(y),
        floor=float(np.median(on_floor)) if on_floor.size else nan,
        floor_points=int(on_floor.size),
        reason=reason,
    )


def slopes(
    frame: pd.DataFrame,
    parameter: str,
    error: str,
    by: Sequence[str],
    noise: str | float = 0.0,
    *,
    fewest: int = 4,
    agreement: float = 0.25,
    confidence: float = 0.95,
) -> pd.DataFrame:
    """Return slopes of a column of errors against a column of parameters, one row for each group.

    Args:
        frame: one row for each point.
        parameter, error: columns.
        by: columns whose equal values define a group; groups with fewer than two points are
            omitted, as they were not swept.
        noise: a column, or one value for all; see `fit_slope`, also for the rest.
        fewest, agreement, confidence: see `fit_slope`.

    Returns:
        Columns `by`; ``parameter`` and ``error``, the names of the columns fitted; those of
        `Slope`; ``agreement`` and ``confidence``, the parameters of the fit.

    Raises:
        InputError: there is no such column, or an argument is out of range.
    """
    _check(fewest, agreement, confidence)
    rows = []
    for names, part in groups(frame, by):
        x, y = numbers(part, parameter), numbers(part, error)
        level = numbers(part, noise) if isinstance(noise, str) else noise
        if np.sum(np.isfinite(x) & np.isfinite(y)) < 2:
            continue
        found = fit_slope(x, y, level, fewest=fewest, agreement=agreement, confidence=confidence)
        rule = {"agreement": agreement, "confidence": confidence}
        rows.append({**names, "parameter": parameter, "error": error, **asdict(found), **rule})
    columns = [*by, "parameter", "error", *SLOPE_COLUMNS, "agreement", "confidence"]
    return table(rows, columns)


def other_columns(frame: pd.DataFrame, parameter: str) -> list[str]:
    """Return the columns that distinguish runs, except for a parameter, to group a sweep of it."""
    return [name for name in [*problem_columns(frame), *solver_columns(frame)] if name != parameter]


def regularisation_slopes(frame: pd.DataFrame, parameter: str = "option_r") -> pd.DataFrame:
    """Return slopes of ``alpha* - alpha_reg`` and ``alpha* - lambda`` in r or one penalty (T19).

    Args:
        frame: from `lacore_verification.harness.analysis.with_exact`.
        parameter: ``option_r``, with which the errors increase, or ``option_eta``, ``option_bulk``,
            ``option_normal``, ``option_tangential``, with which they decrease.

    Returns:
        As `slopes`, by all other columns that distinguish runs, two rows for each group (``error``
        is ``error_alpha_reg`` or ``error_lambda``); ``expected``, the slope of T19 at frozen
        reactions: 1 and 2 in r, -1 and -2 in a penalty; and ``frozen``: each solve was a single
        one. After a loop the reactions depend on r, too: the error of lambda has slope 1 in r and
        either sign, unless statics alone give the normal forces.

    Raises:
        InputError: there is no such column.
    """
    require_columns(frame, ["outer_iterations"])
    by = other_columns(frame, parameter)
    most = frame.groupby(by, dropna=False, sort=False)["outer_iterations"].transform("max")
    frame = frame.assign(frozen=most == 1)
    by.append("frozen")
    direction = 1 if parameter == "option_r" else -1
    parts = [
        slopes(frame, parameter, error, by, "alpha_star_noise").assign(expected=order * direction)
        for error, order in (("error_alpha_reg", 1), ("error_lambda", 2))
    ]
    return pd.concat([part for part in parts if len(part)] or parts[:1], ignore_index=True)


def refinement_orders(results: pd.DataFrame) -> pd.DataFrame:
    """Return the order with which the error against the reference falls under refinement.

    Args:
        results: one row for each run on a plane mesh; only those with status ``solved`` count.

    Returns:
        As `slopes`, by all columns that distinguish runs except mesh and its sizes; and ``order``,
        ``order_low``, ``order_high``: of the error in ``h = n_elements**(-1/2)``.

    Raises:
        InputError: there is no such column.
    """
    size, good = "n_elements", results[says(results, "status", SOLVED)]
    by = [name for name in other_columns(results, size) if not name.startswith(("mesh", "size_"))]
    fitted = slopes(good, size, "error", by, BAR, fewest=3, agreement=0.5)
    return fitted.assign(
        order=-2 * fitted["slope"], order_low=-2 * fitted["high"], order_high=-2 * fitted["low"]
    )
