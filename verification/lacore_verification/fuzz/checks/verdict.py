"""What a check says of an answer: nothing, or what is wrong."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from math import nan
from typing import Any

import numpy as np

BAR = 1e-5
"""Ten times what certificates let through: they sum, and scale, in other ways."""


@dataclass(frozen=True)
class Wrong:
    """One thing that is wrong.

    Attributes:
        check: its name; a smaller problem is the same find if it fails the same check.
        text: what it is, with numbers.
    """

    check: str
    text: str

    def __str__(self) -> str:
        return f"{self.check}: {self.text}"


@dataclass(frozen=True)
class Judgement:
    """What is known of a problem and of its answer.

    Attributes:
        status, load_factor, rigor, message: of the answer.
        has_load: whether there is a load factor; None where nobody knows.
        lower, upper: bounds that were found without the answer; NaN without.
        wrong: None where nothing is.
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
    """Wrong where a value is not below its scale times the bar; NaN is not below anything."""
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
    """The first thing that is wrong."""
    return next(iter(found), None)
