"""Schemes of a path: where a step is solved, and how it moves the bodies (T30)."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from lacore.limit.state import LimitState
from lacore.model.bodies.touching import TOUCH
from lacore.numerics.anderson import Anderson
from lacore.numerics.arrays import Floats
from lacore.paths.configuration import Configuration
from lacore.paths.contact.folding import Fold, first_fold
from lacore.paths.control import Gauge
from lacore.paths.ending import Ending, PathEndError, refused
from lacore.paths.flow import Flow, Moment, WarmStart, flow
from lacore.paths.renewal.inversion import require_upright
from lacore.paths.selection import LeastNorm, least_norm
from lacore.paths.stage import Stage
from lacore.paths.tools.overlap import contacts
from lacore.reporting.errors import InputError
from lacore.reporting.findings import Finding, Severity
from lacore.reporting.kinds import Kind
from lacore.reporting.status import Status

_CLOSE = 1e-10  # of the body size: displacements of an implicit step that count as the same
_NOISE = 1e-5  # of the body size: noise of displacements whose velocities are barely determined
_PATIENCE = 4  # iterations without progress of an implicit step
_ITERATIONS = 60  # of an implicit step
_SAME_DURATION = 0.2  # relative: closer guesses change the load only at second order
_CLOSING_DURATION = 0.01  # the same if distances close: bodies may overlap by this share of them
_GUESSES = 4  # of the duration of a step
_BEFORE, _BEFORE_FIRST = 0.25, 0.5  # of the rate before in that of the first half of a step
_LOCKED = 1e4  # of a yield stress over the whole body: larger than the load of any flow
_STILL = 1e-9  # of the largest velocity: a slower control counts as stationary

Fields = Mapping[str, Floats]


class FoldedError(PathEndError):
    """A body touches itself before the configuration at which a step is solved, or ends.

    Attributes:
        fold: Place of the contact, and the share of the motion at which it occurs.
        warm: Warm start of the next attempt at the step.
    """

    def __init__(self, fold: Fold, warm: WarmStart) -> None:
        self.fold, self.warm = fold, warm
        super().__init__(Ending.FOLDED, fold.finding)


@dataclass(frozen=True)
class Here:
    """State between two steps.

    Attributes:
        step: Number of the last step; 0 at the beginning.
        travel: Travel so far.
        configuration: Configuration of the bodies.
        velocity, strain_rate: Fields of the last step, by body; None at the beginning.
        speed: Speed of the control in the last step; a guess at the beginning.
        growth: Ratio of the speeds of the last step and the step before.
    """

    step: int
    travel: float
    configuration: Configuration
    velocity: Fields | None
    strain_rate: Fields | None
    speed: float
    growth: float = 1.0


@dataclass(frozen=True)
class Stride:
    """Solution of a step, before the bodies move.

    Attributes:
        flow: Flow whose velocity moves the bodies.
        load: Flow whose load is reported, for the travel `at`.
        duration: Duration, s.
        strained: Increments of strain by body.
        speed: Speed of the control.
        error: See `PathStep.error`.
        warm: Warm start of another attempt.
    """

    flow: Flow
    load: Flow
    at: float
    duration: float
    strained: Fields
    speed: float
    error: float
    warm: WarmStart


Solved = tuple[Flow, float, WarmStart]
"""A flow, the speed of the control, and the warm start of the next solve."""


@dataclass(frozen=True)
class StepSolver:
    """How the next steps are solved.

    It is replaced when bodies get new meshes, and when velocities are selected from a step on.

    Attributes:
        stage: Problem on the present meshes.
        gauge: Function that returns the speed of the control.
        settings: Settings of each solve.
        selection: How velocities are selected; None takes them as solved.
        solving: Function that is called before each solve of a step, with None, and after it, with
            its state.
    """

    stage: Stage
    gauge: Gauge
    settings: Mapping[str, Any]
    selection: LeastNorm | None = None
    solving: Callable[[Stage, Moment, LimitState | None], None] = lambda *given: None

    @property
    def size(self) -> float:
        """Size of the largest body, m."""
        return max(body.size for body in self.stage.bodies.values())

    def flow(self, moment: Moment, warm: WarmStart) -> Solved:
        """Solve the limit problem of a moment.

        Raises:
            PathEndError: There is no certified answer, a mesh is invalid, or the control is
                stationary.
        """
        require_upright(self.stage, moment.begin, moment.at, moment.share)
        _require_unfolded(self.stage, moment.begin, moment.at, warm)
        try:
            self.solving(self.stage, moment, None)
            found = flow(self.stage, moment, self.settings, warm)
        except InputError as wrong:
            ending = Ending.OVERLAP if wrong.field == "Body.mesh" else Ending.NOT_SOLVED
            raise PathEndError(ending, refused(wrong)) from wrong
        state = found.state
        self.solving(self.stage, moment, state)
        natural = state.discretisation.natural.load_factor * _gain(self.stage, moment.at)
        if state.status is Status.LOCKED or found.load_factor > _LOCKED * natural:
            obstacles, bodies = self.stage.obstacles_at(moment.at), self.stage.bodies_at(moment.at)
            pressing = tuple(contacts(obstacles, bodies, TOUCH * self.size))
            load = Finding(Kind.LOAD_FACTOR, values={"load_factor": found.load_factor})
            where = [Finding(Kind.CONTACTS, pressing, {}, Severity.DETAIL)] if pressing else []
            raise PathEndError(Ending.LOCKED, *where, load)
        if state.status is Status.FREE and self.stage.tools:
            tools = Finding(Kind.TOOLS, tuple(self.stage.tools), {}, Severity.DETAIL)
            raise PathEndError(Ending.NO_CONTACT, tools)
        if state.status is not Status.SOLVED or state.point is None:
            way_out = [] if state.status is Status.UNSAFE else [Finding(Kind.OTHER_SHAPES)]
            why = state.unanswered(state.backend, Severity.REASON)
            raise PathEndError(Ending.NOT_SOLVED, why, *way_out)
        warm = warm.after(state)
        if self.selection is not None:
            selected = least_norm(state, self.selection.within)
            warm = replace(warm, solves=warm.solves + (0 if selected is None else selected.solves))
            found = replace(found, selected=selected)
        speed = self.gauge(state.discretisation, found.motion)
        if speed <= _STILL * float(np.abs(found.motion).max()):
            slow = Finding(Kind.SPEED, values={"speed": float(speed)})
            raise PathEndError(Ending.STANDSTILL, slow)
        return found, speed, warm

    def require_safe(self, here: Here, distance: float) -> int:
        """Require that dead loads alone do not collapse the bodies with their present strength.

        Hardening within the step would stop such a collapse, in a jump that no step size resolves.
        Without hardening or contact the step itself is unsafe, and this check is not needed.

        Returns:
            Number of inner solves.

        Raises:
            PathEndError: The dead loads collapse the bodies.
        """
        if not (self.stage.problem.dead_loads and self.stage.catches):
            return 0
        now = Moment(here.configuration, here.configuration, distance / here.speed, 0.0)
        state = flow(self.stage, now, self.settings).state
        if state.status is Status.UNSAFE:
            why = state.unanswered(state.backend, Severity.REASON)
            raise PathEndError(Ending.NOT_SOLVED, why)
        return state.outer_iterations

    def timed(
        self, here: Here, at: Configuration, distance: float, share: float, warm: WarmStart
    ) -> Solved:
        """Solve a step that covers a distance, starting from a guess of the speed."""
        speed = here.speed * min(max(here.growth, 0.5), 2.0)
        found, own, warm = self.flow(Moment(here.configuration, at, distance / speed, share), warm)
        for _ in range(_GUESSES):
            program = found.state.discretisation.program
            same = _SAME_DURATION if program.contact.closing is None else _CLOSING_DURATION
            if program.homogeneous or abs(speed / own - 1) <= same:
                break
            speed = own
            moment = Moment(here.configuration, at, distance / speed, share)
            found, own, warm = self.flow(moment, warm)
        return found, own, warm


def _gain(stage: Stage, at: Configuration) -> float:
    """Return the largest hardening of the bodies after a step, which strains them by at most 1."""
    gains = [1.0]
    for name, body in stage.bodies.items():
        for region in body.regions:
            if (law := region.criterion.law) is not None:
                strain = float(at.strain[name][region.elements].max())
                weak, strong = law.stress(np.array([0.0, 1.0 + strain]))
                gains.append(float(strong / weak))
    return max(gains)


Scheme = Callable[[StepSolver, Here, float, WarmStart], Stride]
"""Returns the stride over a distance of the control from a state."""


def explicit(solver: StepSolver, here: Here, distance: float, warm: WarmStart) -> Stride:
    """Solve at the start of the step, without hardening within the step."""
    solved = solver.timed(here, here.configuration, distance, 0.0, warm)
    return _stride(solver, here, solved, distance, here.travel)


def leapfrog(solver: StepSolver, here: Here, distance: float, warm: WarmStart) -> Stride:
    """Solve half a step ahead, at the place that the velocity of the step before leads to.

    The strain there follows from the strain rate a quarter of a step ahead. That rate is
    interpolated between the rate before (in the middle of the last step, or at the beginning of the
    path) and the rate that is solved for.
    """
    before = _BEFORE if here.velocity is not None else _BEFORE_FIRST
    here, warm = _started(solver, here, distance, warm)
    assert here.velocity is not None
    assert here.strain_rate is not None
    ahead = distance / here.speed / 2
    middle = here.configuration.moved(
        _scaled(here.velocity, ahead), _scaled(here.strain_rate, ahead)
    )
    still, strained = _scaled(here.velocity, 0.0), _scaled(here.strain_rate, before * ahead)
    known = replace(here, configuration=here.configuration.moved(still, strained))
    solved = solver.timed(known, middle, distance, (1 - before) / 2, warm)
    stride = _stride(solver, here, solved, distance, here.travel + distance / 2)
    return replace(stride, load=stride.flow.lasting(stride.duration))


def implicit_midpoint(solver: StepSolver, here: Here, distance: float, warm: WarmStart) -> Stride:
    """Solve half way to the end, which is found by iteration; report the load at the end."""
    here, warm = _started(solver, here, distance, warm)
    found, speed, warm = _iterated(solver, here, distance, 0.5, warm)
    duration = distance / speed
    strained = found.hencky_strain(duration)
    if not all(np.all(np.isfinite(values)) for values in strained.values()):
        strained_off = Finding(Kind.STRAIN_TOO_LARGE, severity=Severity.REASON)
        raise PathEndError(Ending.NOT_ITERATED, strained_off)
    end = here.configuration.moved(_scaled(found.velocity, duration), strained)
    require_upright(solver.stage, here.configuration, end)
    _require_unfolded(solver.stage, here.configuration, end, warm)
    load, _, warm = solver.flow(Moment(end, end, duration, 0.0), warm)
    error = _change(solver, here, found, distance, speed)
    return Stride(found, load, here.travel + distance, duration, strained, speed, error, warm)


def implicit_euler(solver: StepSolver, here: Here, distance: float, warm: WarmStart) -> Stride:
    """Solve at the end, which is found by iteration."""
    here, warm = _started(solver, here, distance, warm)
    solved = _iterated(solver, here, distance, 1.0, warm)
    return _stride(solver, here, solved, distance, here.travel + distance)


def _stride(solver: StepSolver, here: Here, solved: Solved, distance: float, at: float) -> Stride:
    """Return a step whose flow moves the bodies and is its load, for the travel `at`."""
    found, speed, warm = solved
    duration = distance / speed
    strained = _scaled(found.strain_rate, duration)
    error = _change(solver, here, found, distance, speed)
    return Stride(found, found, at, duration, strained, speed, error, warm)


SCHEMES: Mapping[str, Scheme] = {
    "leapfrog": leapfrog,
    "explicit": explicit,
    "implicit-midpoint": implicit_midpoint,
    "implicit-euler": implicit_euler,
}


def _require_unfolded(
    stage: Stage, before: Configuration, after: Configuration, warm: WarmStart
) -> None:
    """Raise `FoldedError` if a body touches itself during a motion."""
    if before is not after:
        fold = first_fold(stage.meshes_at(before), stage.meshes_at(after), stage.pairs)
        if fold is not None:
            raise FoldedError(fold, warm)


def _started(
    solver: StepSolver, here: Here, distance: float, warm: WarmStart
) -> tuple[Here, WarmStart]:
    """Return a state with a velocity, which is solved for at the beginning of a path."""
    if here.velocity is not None:
        return here, warm
    found, speed, warm = solver.timed(here, here.configuration, distance, 0.5, warm)
    moving = found.velocity, found.strain_rate, speed
    return Here(here.step, here.travel, here.configuration, *moving), warm


def _iterated(
    solver: StepSolver, here: Here, distance: float, share: float, warm: WarmStart
) -> Solved:
    """Solve at a share of the step that results from the solution itself, by iteration.

    Raises:
        PathEndError: The iteration does not converge.
    """
    assert here.velocity is not None
    assert here.strain_rate is not None
    size, mixing, begin = solver.size, Anderson(5, 1.0), here.configuration
    names = list(begin.nodes)
    shapes = [begin.nodes[name].shape for name in names]
    shapes += [begin.strain[name].shape for name in names]
    ends = np.cumsum([0, *(int(np.prod(shape)) for shape in shapes)])

    def packed(velocity: Fields, strain_rate: Fields, duration: float) -> Floats:
        moves = [velocity[name] for name in names]
        return np.concatenate(
            [(share * duration * part).ravel() for part in moves]
            + [(share * duration * size * strain_rate[name]).ravel() for name in names]
        )

    def unpacked(values: Floats) -> Configuration:
        parts = [
            values[a:b].reshape(shape)
            for a, b, shape in zip(ends[:-1], ends[1:], shapes, strict=True)
        ]
        moves = dict(zip(names, parts[: len(names)], strict=True))
        strains = {n: p / size for n, p in zip(names, parts[len(names) :], strict=True)}
        return begin.moved(moves, strains)

    speed, changes, closest = here.speed, [np.inf], None
    values = packed(here.velocity, here.strain_rate, distance / speed)
    for _ in range(_ITERATIONS):
        moment = Moment(begin, unpacked(values), distance / speed, share)
        found, speed, warm = solver.flow(moment, warm)
        image = packed(found.velocity, found.strain_rate, distance / speed)
        changes.append(float(np.abs(image - values).max()) / size)
        if closest is None or changes[-1] <= min(changes):
            closest = found, speed
        stalled = len(changes) > _PATIENCE and min(changes[-_PATIENCE:]) > min(changes)
        if changes[-1] <= _CLOSE or (stalled and min(changes) <= _NOISE):
            return *closest, warm
        values = mixing.step(values, image)
    raise PathEndError(Ending.NOT_ITERATED)


def _scaled(fields: Fields, factor: float) -> dict[str, Floats]:
    return {name: factor * values for name, values in fields.items()}


def _change(solver: StepSolver, here: Here, found: Flow, distance: float, speed: float) -> float:
    """Return half the displacement between this step and one at the last velocity, per size."""
    if here.velocity is None:
        return float("nan")
    changes = [
        float(np.abs(values / speed - here.velocity[name] / here.speed).max())
        for name, values in found.velocity.items()
    ]
    return distance * max(changes) / 2 / solver.size
