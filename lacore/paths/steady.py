"""Whether load and flow of a path have become stationary (T36)."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any
from warnings import warn

import numpy as np
import pandas as pd

from lacore.numerics.arrays import Floats
from lacore.paths.flow import Snapshot
from lacore.paths.renewal.transfer import at_places
from lacore.paths.stage import Stage
from lacore.reporting.errors import InputError, require_positive
from lacore.reporting.findings import Finding, Severity
from lacore.reporting.kinds import Kind
from lacore.reporting.showing import Compact, Facts
from lacore.reporting.status import Result
from lacore.reporting.text import Quantity

_PARTS = 3  # of a window, whose means are compared
_LEAST = 2 * _PARTS  # steps of a window
_INSIDE = 1e-6  # of the body size: distance of a place that still belongs to a body


@dataclass(frozen=True, repr=False)
class Steady(Compact):
    """When the load and the flow of a path count as stationary (T36).

    Load: the force is averaged over three equal parts of a window, the last part of the travel. The
    largest difference of these means, relative to the mean over the window, is the drift; it must
    be at most `tolerance`. A load that approaches its limit exponentially differs from it by less
    than the drift at the end of the window, if this is longer than the distance in which the
    difference decreases by a factor e. A window has at least six steps, and begins after the first
    step.

    Flow: the velocities at the beginning and at the end of the window, each divided by its norm,
    may differ by at most `flow` in the mean over the places that the bodies occupy at both moments.

    Attributes:
        tolerance: of the drift, relative to the mean load.
        window: length of the window, in units of the travel; None: a third of the travel so far.
        flow: largest difference of the velocities, relative to their norm.

    Example:
        >>> until = la.Steady(tolerance=0.02)  # as `until` of `lacore.sequential`
    """

    tolerance: float = 0.01
    window: float | None = None
    flow: float = 0.1

    def __post_init__(self) -> None:
        for name in ("tolerance", "flow"):
            require_positive(f"Steady.{name}", getattr(self, name))
        if self.window is not None:
            require_positive("Steady.window", self.window)
        if self.tolerance >= 1:
            raise InputError(
                "Steady.tolerance",
                self.tolerance,
                "as large as the load itself",
                "give a ratio such as 0.01",
            )


@dataclass(frozen=True, repr=False)
class SteadyState(Result):
    """Whether a path has become steady, see `Steady`.

    Attributes:
        reached: whether load and flow are stationary at the end of the path.
        step: first step since which the load is stationary; None if it is not.
        force: mean of `PathStep.force` since then, or over the window; NaN without a window.
        drift: of the load over the window, relative to its mean; NaN without a window.
        flow: difference of the velocities; NaN if it is unknown.
        findings: The reason.
    """

    reached: bool
    step: int | None
    force: float
    drift: float
    flow: float
    findings: tuple[Finding, ...]

    @property
    def finding(self) -> Finding:
        """The only finding, by the name of this attribute until 0.4."""
        warn("SteadyState.finding is now findings", DeprecationWarning, stacklevel=2)
        return self.findings[0]

    def facts(self) -> Facts:
        """Return the reason, and the mean force."""
        title = "SteadyState: reached" if self.reached else "SteadyState: not reached"
        return Facts(title, {"reason": self.message, "force": f"mean {self.force:.7g}"})

    def __str__(self) -> str:
        return self.message


StageOf = Callable[[Snapshot], Stage]


def steady_state(
    history: pd.DataFrame,
    snapshots: Sequence[Snapshot],
    stage_of: StageOf,
    unit: str,
    criterion: Steady,
) -> SteadyState:
    """Judge the end of a path; see `lacore.paths.path.Path` for its parts."""
    travel, force = (history[name].to_numpy(dtype=float) for name in ("travel", "force"))
    if travel.size <= _LEAST:
        return _not_reached(Kind.FEW_STEPS, least=_LEAST, steps=travel.size)
    so_far = float(history["end"].iloc[-1])
    window = so_far / 3 if criterion.window is None else criterion.window
    first = int(np.searchsorted(travel, so_far - window))
    if first < 1 or travel.size - first < _LEAST:
        return _not_reached(
            Kind.WINDOW_NOT_USABLE,
            window=_length(unit, window),
            covered=travel.size - max(first, 0),
            steps=travel.size,
            least=_LEAST,
        )
    drift, mean = drift_of(force[first:]), float(np.mean(force[first:]))
    change = _flow_change(snapshots, stage_of, travel[first])
    stationary = bool(drift <= criterion.tolerance)  # not so if it is NaN
    flows = bool(change <= criterion.flow)
    since = None
    if stationary:
        starts = range(1, first + 1)
        begin = next(own for own in starts if drift_of(force[own:]) <= criterion.tolerance)
        since, mean = int(history["step"].iloc[begin]), float(np.mean(force[begin:]))
    values = {"drift": drift, "window": _length(unit, window), "change": change}
    values |= {"tolerance": criterion.tolerance, "flow": criterion.flow}
    loads, reached = Finding(Kind.LOAD_DRIFTS, values=values), stationary and flows
    finding = Finding(Kind.NOT_STEADY, (), {"loads": loads}, Severity.REASON)
    if reached:
        finding = Finding(Kind.STEADY, (), {"step": since, "loads": loads}, Severity.REASON)
    return SteadyState(reached, since, mean, drift, change, (finding,))


def _length(unit: str, travel: float) -> Quantity | float:
    """Return a travel with its unit; of a control that turns tools or scales loads, the number."""
    return Quantity(travel, "m", ".4g") if unit == "m" else travel


def drift_of(loads: Floats) -> float:
    """Largest difference of the means of three parts, relative to the mean; NaN if unknown."""
    if not np.isfinite(loads).all():
        return float("nan")
    means = np.array([float(np.mean(part)) for part in np.array_split(loads, _PARTS)])
    mean = abs(float(np.mean(loads)))
    return float(np.ptp(means)) / mean if mean > 0 else float("nan")


def _not_reached(kind: Kind, **values: Any) -> SteadyState:
    nan = float("nan")
    finding = Finding(kind, (), values, Severity.REASON)
    return SteadyState(False, None, nan, nan, nan, (finding,))


def _flow_change(snapshots: Sequence[Snapshot], stage_of: StageOf, travel: float) -> float:
    """How much velocities differ from those at a travel; NaN where none were kept, or no place."""
    moving = [own for own in snapshots if own.moment is not None]
    earlier = [own for own in moving if own.travel <= travel]
    if not earlier:
        return float("nan")
    before, now = earlier[-1], moving[-1]
    weights, velocities = [], []
    for name, dofs in stage_of(now).dofs_at(now.configuration).items():
        places = np.asarray(dofs.basis.global_coordinates()).reshape(2, -1)
        then, apart = _velocity(stage_of, before, name, places)
        since, _ = _velocity(stage_of, now, name, places)
        inside = apart <= _INSIDE * dofs.body.size
        weights.append(dofs.weights.ravel()[inside])
        velocities.append(np.stack([then, since])[:, :, inside])
    weight, velocity = np.concatenate(weights), np.concatenate(velocities, axis=2)
    norms = np.sqrt(np.sum(weight * velocity**2, axis=(1, 2)))
    if not (norms > 0).all():
        return float("nan")
    one, other = velocity / norms[:, None, None]
    return float(np.sqrt(np.sum(weight * (one - other) ** 2)))


def _velocity(stage_of: StageOf, at: Snapshot, name: str, places: Floats) -> tuple[Floats, Floats]:
    """Of a body at places, shape (2, n), and their distances from it."""
    mesh = stage_of(at).meshes_at(at.configuration)[name]
    return at_places(mesh, at.velocity[name], places)
