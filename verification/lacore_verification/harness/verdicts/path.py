"""Verdicts on paths: their end, their last load, their worst load, their volume."""

from collections.abc import Iterator
from dataclasses import replace
from math import inf, isnan, nan

import numpy as np

from lacore.numerics.arrays import Floats
from lacore_verification.case import SOLVER, Band, Reference
from lacore_verification.case.following import Following
from lacore_verification.harness.verdicts.allowed import allowed_values, cannot_judge
from lacore_verification.harness.verdicts.limit_state import STRONG
from lacore_verification.harness.verdicts.words import FAIL, NO_REFERENCE, NO_RESULT, PASS
from lacore_verification.runs.row import Row


def exact_loads(stated: Following, travel: Floats) -> Floats:
    """Return exact loads at travels; NaN where they are not known."""
    if stated.exact is None:
        return np.full(travel.shape, nan)
    return np.array([stated.exact(float(at)) for at in travel])


def judge_path(
    row: Row, stated: Following, reference: Reference, band: Band, insist: bool = True
) -> tuple[str, str]:
    """Return the verdict on a path, with its reason: its end, its last and worst load, its volume.

    Loads of regularised backends may also differ by their energy C (T19), to either side: their
    bodies have strained slightly more or less. They keep volumes within their penalties. Required
    values that are NaN are wrong. Without a reference a path that is right passes nothing.
    """
    if why := cannot_judge(reference, band):
        return FAIL, why
    if stated.ending is not None and row.ending != stated.ending.label:
        wanted = f"not '{stated.ending.label}' as it must"
        return FAIL if insist else NO_RESULT, f"the path ends {wanted}: {row.message}"
    regularised = not isnan(row.energy)
    if regularised:
        more = max(row.energy, 0.0) / (abs(row.load_factor) or nan)
        if not more <= STRONG:
            why = f"regularisation too strong to judge: C is {100 * more:.3g} % of the last load"
            return FAIL if insist else NO_RESULT, why
        band = replace(band, below=band.below + more, above=band.above + more)
    checks = list(_checks(row, stated, reference, band))
    if wrong := [text for right, text in checks if not right]:
        return FAIL, "; ".join(wrong)
    found = [row.ending, *(text for _, text in checks)]
    if reference.unknown:
        return NO_REFERENCE, "; ".join([*found, "there is no last load to compare with"])
    return PASS, "; ".join(found)


def _checks(
    row: Row, stated: Following, reference: Reference, band: Band
) -> Iterator[tuple[bool, str]]:
    """Yield whether each requirement on a path holds, and its numbers."""
    allowed, largest = allowed_values(reference, band), max(band.below, band.above)
    regularised = not isnan(row.energy)
    if not reference.unknown:
        inside = allowed.holds(row.load_factor)
        yield inside, f"last load {row.load_factor:.7g} {'in' if inside else 'not in'} {allowed}"
    if stated.exact is not None:
        text = f"largest error on the way {row.path_error:.3g}, {largest:.3g} allowed"
        yield 0 <= row.path_error <= largest, text
    if stated.volume != inf and not regularised:
        text = f"volume changes by {row.volume_change:.2g} a step, {stated.volume:g} allowed"
        yield 0 <= row.volume_change <= stated.volume, text
    if stated.reading is not None:
        read = stated.reading
        text = f"{read.name} {row.reading:.4g}, [{read.low:.4g}, {read.high:.4g}] allowed"
        yield read.low <= row.reading <= read.high, text
    if stated.bounded:
        slack = SOLVER * row.upper + (max(row.energy, 0.0) if regularised else 0.0)
        text = f"begins at {row.start:.5g}, bounds are [{row.lower:.5g}, {row.upper:.5g}]"
        yield -inf < row.lower - slack <= row.start <= row.upper + slack < inf, text


def largest_error(loads: Floats, exact: Floats) -> float:
    """Return the largest relative error over known exact loads.

    NaN without any, or for a NaN load.
    """
    known = ~np.isnan(exact)
    loads, exact = loads[known], exact[known]
    with np.errstate(divide="ignore", invalid="ignore"):
        errors = np.where(loads == exact, 0.0, np.abs(loads / exact - 1))
    return worst(errors)


def worst(values: Floats) -> float:
    """Return the largest value; NaN if one is, or there is none."""
    return float(values.max()) if values.size else nan
