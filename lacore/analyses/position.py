"""`worst_position`: the position of a moving load with the smallest load factor."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import inf, nan
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from lacore.analyses.along import PROBLEM_AT, Along, read_range, solved_by
from lacore.limit.state import LimitState
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats
from lacore.reporting import views
from lacore.reporting.errors import InputError, require_count, require_positive, typed
from lacore.reporting.findings import Finding
from lacore.reporting.kinds import Kind
from lacore.reporting.showing import Facts, Picture, listed
from lacore.reporting.status import Result

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_LEAST = 3  # number of positions that a minimum needs
_MINIMA = 3  # number of the lowest minima of the scan that are refined


@dataclass(frozen=True, repr=False)
class WorstPosition(Result):
    """Position with the smallest load factor that was found.

    The load factor there is certified. It is not proven that there is no smaller one at other
    positions: `spacing` is the distance of the computed positions.

    Attributes:
        position: position of the load; NaN if none is certified.
        load_factor: load factor there: -inf if the dead loads alone collapse the structure, inf if
            every position is locked; NaN if none is certified.
        state: state there; None if none is certified, or supports take the load everywhere.
        spacing: spacing of the positions of the scan.
        table: one row per computed position, in order; see `Critical.table`.
        solve_time: s, wall clock.
    """

    position: float
    load_factor: float
    state: LimitState | None
    spacing: float
    table: pd.DataFrame
    solve_time: float

    @property
    def failed(self) -> tuple[float, ...]:
        """Positions without a certified load factor."""
        return tuple(self.table["parameter"][self.table["load_factor"].isna()])

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Findings on what is certified, and what is not."""
        if np.isnan(self.load_factor):
            return (Finding(Kind.NO_POSITION),)
        values = {"count": len(self.table), "spacing": self.spacing}
        lowest = Finding(Kind.LOWEST_POSITION, values=values)
        if not self.failed:
            return (lowest,)
        places = listed([f"{place:.6g}" for place in self.failed])
        return lowest, Finding(Kind.NOT_CERTIFIED_AT, values={"places": places})

    def facts(self) -> Facts:
        """Return the position, and what is proven, for printing."""
        told = {"status": self.message}
        if self.state is not None and self.state.certificate is not None:
            told["residual"] = self.state.certificate.summary
        told["solved by"] = solved_by(self.table, self.solve_time)
        title = f"WorstPosition: {self.position:.7g}, load factor {self.load_factor:.7g}"
        return Facts(title, told)

    def picture(self) -> Picture:
        """Return load factors by position."""
        return Picture(self.plot())

    def plot(self) -> Figure:
        """Plot load factors: see `lacore.pictures.analyses.plot_worst_position`."""
        return views.picture(self)


@typed(problem_at=PROBLEM_AT)
def worst_position(
    problem_at: Callable[[float], Problem],
    within: tuple[float, float],
    *,
    scan: int = 25,
    tolerance: float = 1e-3,
    backend: str = "auto",
    coupling: str | None = None,
    options: Mapping[str, Any] | None = None,
    on_value: Callable[[float, float], None] | None = None,
) -> WorstPosition:
    """Search for the position of a moving load, or other parameter, with the smallest load factor.

    Equally spaced positions are computed first, then the lowest minima among them are refined by
    bounded minimisation between their neighbours.

    Args:
        problem_at: function that returns the problem with the load at a position.
        within: range of positions, (low, high).
        scan: number of positions that are computed first, at least 3.
        tolerance: tolerance of a minimum, by the range of positions.
        backend, coupling, options: see `lacore.solve`.
        on_value: called with each position and its load factor, for progress.

    Raises:
        InputError: an invalid range, too few positions; an invalid problem, with its position;
            anything that `solve` rejects.
        CapabilityError: the backend is missing, or does not support a problem.

    Example:
        >>> found = la.worst_position(la.examples.beam, within=(0.5, 3.5), scan=7)
        >>> round(found.position, 2), round(found.load_factor, 2)  # 8 M/L at its middle
        (2.0, 2.0)
    """
    # imported here because it takes 0.3 s to load; most solves do not need it
    from scipy.optimize import minimize_scalar

    begin = time.perf_counter()
    low, high = read_range(within)
    require_positive("tolerance", tolerance)
    require_count("scan", scan)
    if scan < _LEAST:
        raise InputError("scan", scan, "too few positions for a minimum", f"give {_LEAST} or more")
    given = {"backend": backend, "coupling": coupling, "options": options}
    along = Along(problem_at, given, on_value=on_value)
    places = np.linspace(low, high, scan)
    values = np.array(along.ask(places.tolist()))

    def size(place: float) -> float:
        value = along.ask([place])[0]
        return float(np.nan_to_num(value, nan=_above(values), posinf=_above(values)))

    if not np.any(values == -inf):
        for number in _minima(values):
            near = places[max(number - 1, 0)], places[min(number + 1, scan - 1)]
            minimize_scalar(
                size,
                bounds=near,
                method="bounded",
                options={"xatol": tolerance * (high - low)},
            )
    table = along.table
    least = table.dropna(subset="load_factor")
    place, value = nan, nan
    if len(least):
        row = int(np.argmin(least["load_factor"]))
        place, value = (float(least[name].iloc[row]) for name in ("parameter", "load_factor"))
    return WorstPosition(
        position=place,
        load_factor=value,
        state=along.state_if(place) if len(least) else None,
        spacing=float(places[1] - places[0]),
        table=table,
        solve_time=time.perf_counter() - begin,
    )


def _minima(values: Floats) -> list[int]:
    """Return the lowest places without a lower neighbour; places without a number count as high."""
    known = np.where(np.isnan(values), inf, values)
    padded = np.concatenate([[inf], known, [inf]])
    lowest = (known <= padded[:-2]) & (known <= padded[2:]) & np.isfinite(known)
    places = np.flatnonzero(lowest)
    return [int(place) for place in places[np.argsort(known[places], kind="stable")][:_MINIMA]]


def _above(values: Floats) -> float:
    """Return a value above any load factor of the scan."""
    finite = values[np.isfinite(values)]
    return float(finite.max() + np.ptp(finite) + 1.0) if finite.size else 1.0
