"""Detect whether bodies drift along a path, because the velocity of a step is not unique (T32)."""

from collections.abc import Sequence

from lacore.limit.state import LimitState
from lacore.paths.ending import Ending
from lacore.paths.flow import Flow
from lacore.paths.path import Event, PathStep
from lacore.paths.selection import LeastNorm, Selected, least_norm
from lacore.reporting.findings import Finding, Severity
from lacore.reporting.kinds import Kind

DRIFTS, SELECTED, LOST = "velocity not unique", "velocity selected", "velocity not selected"
"""Kinds of events: the velocity is not unique; a regular one is used; none can be found."""
LATE = "velocity not unique before"
"""Kind of an event: the velocity of the step before was not unique, and moved the bodies."""
_EVERY = 8  # steps between two checks without any other reason
_SUDDEN = 2.0  # growth of the change of the velocity per step that requires a check
_APART = 0.01  # width below which velocities count as the same
# Flatness from which another velocity is equivalent. It is at most 7 in the catalogue if velocities
# differ at all, and 35 to 4000 for rings in plane strain when they begin to drift.
_FLAT = 15.0
_LATE = 1e-3  # width from which the velocity of the step before has influenced the shape
_SAME = 0.1  # of the power: velocities that dissipate more are not equivalent


def due(rows: Sequence[PathStep], error: float, distance: float) -> bool:
    """Whether to check the next step, given its `PathStep.error` and distance of the control.

    The first step and every eighth are checked, and those in which the velocity changes more than
    before: a drifting velocity overshoots by more in each step.
    """
    if len(rows) % _EVERY == 0:
        return True
    begin = rows[-2].end if len(rows) > 1 else 0.0
    before = rows[-1].error / (rows[-1].end - begin)
    return not error / distance <= _SUDDEN * before  # errors of first steps are NaN


def described(flow: Flow) -> str:
    """Describe how the regular velocity of a step differs; return empty text if it does not.

    This needs one solve if no velocity was selected. The viscosity of regularised backends makes
    the velocity unique.
    """
    if flow.state.regularised is not None:
        return ""
    other = flow.selected or least_norm(flow.state, _SAME, tries=1)
    if other is None or not is_choice(other):
        return ""
    return (
        f"strain rates of a more regular one differ by {other.width:.2g} of their norm, its load by"
        f" {max(other.excess, 0.0):.1g} of the power"
    )


def too_late(before: LimitState | None) -> str:
    """Describe how far the velocity before a drift was from the regular one; may be empty."""
    other = None if before is None else least_norm(before, _SAME, tries=1)
    if other is None or other.width <= _LATE:
        return ""
    return f"strain rates of a more regular one differed by {other.width:.2g} of their norm already"


def warnings(events: Sequence[Event]) -> tuple[Finding, ...]:
    """Return the findings about drifts for the end of a path; empty without any."""
    steps = [event.step for event in events if event.kind == DRIFTS]
    if not steps:
        return ()
    return (Finding(Kind.VELOCITY_NOT_UNIQUE, (), {"step": steps[0]}, Severity.WARNING),)


def selection_after(events: Sequence[Event], selection: LeastNorm | None) -> LeastNorm | None:
    """Return the selection of a path after events: the default one if its bodies drift."""
    drifts = any(event.kind == DRIFTS for event in events)
    return LeastNorm() if selection is None and drifts else selection


def ending(events: Sequence[Event]) -> Ending:
    """Return the ending of a path whose travel is reached."""
    kinds = {event.kind for event in events}
    return Ending.DRIFTED if LATE in kinds or {DRIFTS, LOST} <= kinds else Ending.REACHED


def is_choice(other: Selected) -> bool:
    """Whether a velocity differs from that of the state at almost the same load."""
    return other.width > _APART and other.width**2 > 2 * _FLAT * other.excess
