"""Failures found by checks."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from math import nan
from typing import Any

import numpy as np

BAR = 1e-5
"""Ten times the tolerance of certificates, as these sum and scale in other ways."""


@dataclass(frozen=True)
class Wrong:
    """A failure.

    Attributes:
        check: its name; a smaller problem has the same failure if it fails the same check.
        text: description with numbers.
    """

    check: str
    text: str

    def __str__(self) -> str:
        return f"{self.check}: {self.text}"


@dataclass(frozen=True)
class Judgement:
    """Result of the checks of a problem and its solution.

    Attributes:
        status, load_factor, rigor, message: of the solution.
        has_load: whether there is a load factor; None if unknown.
        lower, upper: bounds that were found without the solution; NaN without.
        wrong: None without a failure.
    """

    status: str
    load_factor: float
    rigor: str
    message: str
    has_load: bool | None
    lower: float = nan
    upper: float = nan
    wrong: Wrong | None = None


def beyond(check: str, what: str, values: Any, scale: Any, bar: float = BAR) -> Iterator[Wrong]:
    """Yield a failure if a value is not below its scale times the bar; NaN is not."""
    values, scale = (
        part.ravel()
        for part in np.broadcast_arrays(
            np.asarray(values, dtype=float), np.asarray(scale, dtype=float)
        )
    )
    if not values.size:
        return
    allowed = bar * scale
    bad = ~(values <= allowed)
    if bad.any():
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.where(scale > 0, values / scale, np.inf)
        worst = int(np.flatnonzero(bad)[np.argmax(np.nan_to_num(share[bad], nan=np.inf))])
        yield Wrong(check, f"{what} {values[worst]:.3g} of {scale[worst]:.3g} (place {worst})")


def first(found: Iterable[Wrong]) -> Wrong | None:
    """Return the first failure."""
    return next(iter(found), None)
