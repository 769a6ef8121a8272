"""A path so far, and the checks of one that is read from a disk.

The fields are checked one by one and together, so that a path only continues from consistent data.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields

import numpy as np

from lacore.numerics.arrays import Floats
from lacore.paths.configuration import Configuration
from lacore.paths.flow import Snapshot
from lacore.paths.path import Event, PathStep
from lacore.paths.renewal.remeshing import NewMeshes
from lacore.paths.schemes import Here
from lacore.reporting.errors import is_number

_SUMMED = 1e-9  # relative: round-off of powers that add up to a load, with digits in hand
_UNKNOWN = ("error", "gap")  # of a row: may be NaN, where a step had none before
_WHOLE = ("step", "solves")


@dataclass(frozen=True)
class Progress:
    """A path so far.

    Attributes:
        here: State after the last step.
        step: Length of the next step, in units of the control.
        rows, events, snapshots: Record of the path, see `lacore.paths.logbook.Log`.
        made: New meshes so far.
    """

    here: Here
    step: float
    rows: Sequence[PathStep]
    events: Sequence[Event]
    snapshots: Sequence[Snapshot]
    made: Sequence[NewMeshes] = ()


class WrongFieldError(ValueError):
    """A field of a path that no path has left; the message names it."""

    def __init__(self, field: str, why: str) -> None:
        super().__init__(f"field {field!r} {why}")


def require_sound(progress: Progress, start: Configuration) -> None:
    """Check a path that was read.

    Args:
        progress: as it was read.
        start: where the path begins.

    Raises:
        WrongFieldError: it is none, or its parts contradict each other.
    """
    here = progress.here
    _whole("here.step", here.step, 1)
    for name in ("travel", "speed"):
        _positive(f"here.{name}", getattr(here, name))
    _number("here.growth", here.growth)
    _positive("step", progress.step)
    _check_rows(progress)
    _check_events(progress)
    _check_made(progress, start)
    _check_snapshots(progress, start)


def _check_rows(progress: Progress) -> None:
    rows, here = progress.rows, progress.here
    if len(rows) != here.step:
        raise WrongFieldError("row", f"has {len(rows)} steps, and the path {here.step}")
    before = 0.0
    for number, row in enumerate(rows, start=1):
        for entry in fields(PathStep):
            value = getattr(row, entry.name)
            name = f"row {number}, {entry.name}"
            if entry.name in _WHOLE:
                _whole(name, value, 1)
            elif not (entry.name in _UNKNOWN and value != value):
                _number(name, value)
        if row.step != number:
            raise WrongFieldError(f"row {number}, step", f"is {row.step}")
        if not before <= row.travel <= row.end or not before < row.end:
            raise WrongFieldError(f"row {number}, end", "does not follow on the step before")
        before = row.end
        power = (row.plastic, row.friction, -row.dead)
        size = max(map(abs, (row.load_factor, *power)))
        if abs(sum(power) - row.load_factor) > _SUMMED * size:
            raise WrongFieldError(f"row {number}, load_factor", "is not the sum of its powers")
        for name in ("volume", "min_jacobian"):
            _positive(f"row {number}, {name}", getattr(row, name))
        if min(row.seconds, row.max_strain, row.overlap) < 0 or row.error < 0:
            raise WrongFieldError(f"row {number}", "has a negative size")
    if here.travel != rows[-1].end:
        raise WrongFieldError("here.travel", "is not the end of the last step")


def _check_events(progress: Progress) -> None:
    for number, event in enumerate(progress.events):
        name = f"event {number}"
        for field in ("kind", "what"):
            if not isinstance(getattr(event, field), str):
                raise WrongFieldError(f"{name}, {field}", "is no text")
        _whole(f"{name}, step", event.step, 0, progress.here.step + 1)
        _number(f"{name}, travel", event.travel)
        if not 0 <= event.travel <= progress.here.travel:
            raise WrongFieldError(f"{name}, travel", "is beyond the path")


def _check_made(progress: Progress, start: Configuration) -> None:
    for number, own in enumerate(progress.made):
        name = f"new meshes {number}"
        _whole(f"{name}, step", own.step, 1, progress.here.step)
        _check_fields(f"{name}, nodes", own.nodes, start.nodes)
        for body, mesh in own.meshes.items():
            if body not in start.nodes:
                raise WrongFieldError(f"{name}, meshes", f"has a body {body!r} that the path lacks")
            _finite(f"{name}, mesh of {body!r}", mesh.doflocs)


def _check_snapshots(progress: Progress, start: Configuration) -> None:
    here, kept = progress.here, progress.snapshots
    if len(kept) < 2:
        raise WrongFieldError("snapshots", "have not both a beginning and an end")
    first, last = kept[0], kept[-1]
    steps = [own.step for own in kept]
    for number, own in enumerate(kept):
        name = f"snapshot {number}"
        _whole(f"{name}, step", own.step, 0, here.step)
        for field in ("travel", "duration"):
            _number(f"{name}, {field}", getattr(own, field))
        _check_configuration(name, own.configuration, start)
        _check_like(f"{name}, velocity", own.velocity, own.configuration.nodes)
        _check_like(f"{name}, strain_rate", own.strain_rate, own.configuration.strain)
        ends = 0.0 if own.step == 0 else progress.rows[own.step - 1].end
        if own.travel != ends:
            raise WrongFieldError(f"{name}, travel", "is not the end of its step")
        if (own.moment is None) != (number == 0):
            raise WrongFieldError(f"{name}, moment", "stands where there is none, or is missing")
        if own.moment is not None:
            for part in ("begin", "at"):
                _check_configuration(f"{name}, {part}", getattr(own.moment, part), start)
            _positive(f"{name}, moment", own.moment.duration)
            _positive(f"{name}, duration", own.duration)
            _number(f"{name}, share", own.moment.share)
            if not 0 <= own.moment.share <= 1:
                raise WrongFieldError(f"{name}, share", "is outside [0, 1]")
            _check_friction(f"{name}, normal_reaction", own.moment.friction_start.normal_reaction)
            _check_friction(f"{name}, slip", own.moment.friction_start.slip)
            _check_strain(name, own, progress.rows[own.step - 1])
    if steps != sorted(set(steps)) or steps[0] != 0 or last.step != here.step:
        raise WrongFieldError("snapshots", "are not those of steps in their order")
    _require_equal("snapshot 0", first.configuration, start)
    _require_equal("here", here.configuration, last.configuration)
    for field in ("velocity", "strain_rate"):
        found, known = getattr(here, field), getattr(last, field)
        if not _equal(found, known):
            raise WrongFieldError(f"here.{field}", "is not that of the last snapshot")
        if any(np.any(values) for values in getattr(first, field).values()):
            raise WrongFieldError(f"snapshot 0, {field}", "is not zero at the beginning")


def _check_friction(name: str, values: Floats | None) -> None:
    """Of how many points, only the limit problem knows, which refuses others."""
    if values is None:
        return
    _finite(name, values)
    if values.ndim != 1 or values.min(initial=0.0) < 0:
        raise WrongFieldError(name, "is no list of reactions or slip rates")


def _check_strain(name: str, own: Snapshot, row: PathStep) -> None:
    largest = max(float(values.max()) for values in own.configuration.strain.values())
    if largest != row.max_strain:
        raise WrongFieldError(f"{name}, strain", "has another maximum than its row")


def _check_configuration(name: str, own: Configuration, start: Configuration) -> None:
    _check_fields(f"{name}, nodes", own.nodes, start.nodes)
    _check_fields(f"{name}, strain", own.strain, start.strain)
    if any(values.min(initial=0.0) < 0 for values in own.strain.values()):
        raise WrongFieldError(f"{name}, strain", "is negative somewhere")


def _check_fields(name: str, own: Mapping[str, Floats], known: Mapping[str, Floats]) -> None:
    """As many rows as at the beginning; new meshes have other numbers of nodes and elements."""
    if list(own) != list(known):
        raise WrongFieldError(name, "is not of the bodies of this path")
    for body, values in own.items():
        _finite(f"{name} of {body!r}", values)
        axis = 0 if name.endswith("nodes") else 1
        if values.ndim != 2 or values.shape[axis] != known[body].shape[axis]:
            raise WrongFieldError(f"{name} of {body!r}", f"has the shape {values.shape}")


def _check_like(name: str, own: Mapping[str, Floats], known: Mapping[str, Floats]) -> None:
    for body, values in own.items():
        _finite(f"{name} of {body!r}", values)
        if values.shape != known[body].shape:
            raise WrongFieldError(f"{name} of {body!r}", f"has the shape {values.shape}")


def _require_equal(name: str, own: Configuration, known: Configuration) -> None:
    for field in ("nodes", "strain"):
        if not _equal(getattr(own, field), getattr(known, field)):
            raise WrongFieldError(f"{name}, {field}", "is not where the path was")


def _equal(own: Mapping[str, Floats] | None, known: Mapping[str, Floats]) -> bool:
    if own is None or list(own) != list(known):
        return False
    pairs = [(own[name], known[name]) for name in known]
    return all(one.dtype == other.dtype and np.array_equal(one, other) for one, other in pairs)


def _finite(name: str, values: Floats) -> None:
    if values.dtype != np.float64 or not np.isfinite(values).all():
        raise WrongFieldError(name, "holds something else than finite numbers")


def _number(name: str, value: object) -> None:
    if not is_number(value):
        raise WrongFieldError(name, "is no finite number")


def _positive(name: str, value: object) -> None:
    if not (is_number(value) and isinstance(value, int | float) and value > 0):
        raise WrongFieldError(name, "is no positive number")


def _whole(name: str, value: object, least: int, most: float = float("inf")) -> None:
    whole = isinstance(value, int) and not isinstance(value, bool)
    if not (whole and isinstance(value, int) and least <= value <= most):
        raise WrongFieldError(name, "is not the number of a step")
