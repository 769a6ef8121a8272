"""Whether bodies drift along a path: the velocity of a step is one of many (T32)."""

from collections.abc import Sequence

from lacore.limit.state import LimitState
from lacore.paths.ending import Ending
from lacore.paths.flow import Flow
from lacore.paths.path import Event, PathStep
from lacore.paths.selection import LeastNorm, Selected, least_norm
from lacore.reporting.findings import Finding, Severity
from lacore.reporting.kinds import Kind

DRIFTS, SELECTED, LOST = "velocity not unique", "velocity selected", "velocity not selected"
"""Kinds of events: the solver took one of many; the regular one was taken; none could be found."""
LATE = "velocity not unique before"
"""Kind of an event: the velocity of the step before was one of many, too, and moved the bodies."""
_EVERY = 8  # steps between two looks where nothing happens
_SUDDEN = 2.0  # growth of the change of the velocity, from step to step, that calls for a look
_APART = 0.01  # width below which velocities count as the same
# Least flatness of a choice. The paths of the catalogue have 7 at most where velocities differ at
# all, rings in plane strain 35 to 4000 when they begin to drift.
_FLAT = 15.0
_LATE = 1e-3  # width from which the velocity of the step before has left its mark on the shape
_SAME = 0.1  # of the power: velocities that cost more are no choice at any width


def due(rows: Sequence[PathStep], error: float, distance: float) -> bool:
    """Whether to look at the next step, of a `PathStep.error` and a distance of the control.

    The first one, now and then another, and where the velocity changes more suddenly than before:
    one that drifts overshoots in each step by more than in the last.
    """
    if len(rows) % _EVERY == 0:
        return True
    begin = rows[-2].end if len(rows) > 1 else 0.0
    before = rows[-1].error / (rows[-1].end - begin)
    return not error / distance <= _SUDDEN * before  # errors of first steps are NaN


def described(flow: Flow) -> str:
    """How far the regular velocity of a step is from the one as solved; empty where it is that one.

    It takes one solve where none was selected; the viscosity of regularised backends leaves no
    choice.
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
    """How far the velocity of the step before a drift was from the regular one; empty if hardly."""
    other = None if before is None else least_norm(before, _SAME, tries=1)
    if other is None or other.width <= _LATE:
        return ""
    return f"strain rates of a more regular one differed by {other.width:.2g} of their norm already"


def warnings(events: Sequence[Event]) -> tuple[Finding, ...]:
    """Return what the end of a path has to report of drifts; empty where it has not drifted."""
    steps = [event.step for event in events if event.kind == DRIFTS]
    if not steps:
        return ()
    return (Finding(Kind.VELOCITY_NOT_UNIQUE, (), {"step": steps[0]}, Severity.WARNING),)


def selection_after(events: Sequence[Event], selection: LeastNorm | None) -> LeastNorm | None:
    """Return the selection of a path after events: the default one where its bodies drift."""
    drifts = any(event.kind == DRIFTS for event in events)
    return LeastNorm() if selection is None and drifts else selection


def ending(events: Sequence[Event]) -> Ending:
    """Return the ending of a path whose travel is reached."""
    kinds = {event.kind for event in events}
    return Ending.DRIFTED if LATE in kinds or {DRIFTS, LOST} <= kinds else Ending.REACHED


def is_choice(other: Selected) -> bool:
    """Whether a velocity is another one, for next to nothing of its load."""
    return other.width > _APART and other.width**2 > 2 * _FLAT * other.excess
