"""Sequential limit analysis: limit problems along a path of large deformation (T29-T31)."""

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import asdict, dataclass, field, fields
from os import PathLike
from typing import Any

import numpy as np
import pandas as pd

from lacore.approach import gaps
from lacore.assembly import discretise
from lacore.checkpoint import Checkpoint, Progress, identity
from lacore.control import Control, FootingTravel, Gauge
from lacore.dofs import BodyDofs, number
from lacore.errors import InputError, require_count, require_known, require_positive
from lacore.flow import Moment, flow
from lacore.interfaces import Interface
from lacore.path import Ending, Event, Path, PathStep, Snapshot
from lacore.problem import Problem
from lacore.remeshing import Remesh, carried, restaged
from lacore.result import LimitState
from lacore.schemes import SCHEMES, Here, PathEndError, Scheme, Stride, Walk, require_upright
from lacore.staging import Stage, staged

_END = 1e-9  # of the travel: what is left is round-off
_NEAR = 1e-6  # of the body size: closer to an obstacle, solvers cannot tell from touching
_SAFETY, _CHANGE = 0.9, (0.3, 2.0)  # of the length of adaptive steps
_COLUMNS = [entry.name for entry in fields(PathStep)]


@dataclass(frozen=True)
class AdaptiveSteps:
    """Steps as long as their error allows.

    Attributes:
        tolerance: of the displacement by which the velocity may change within a step, per body
            size; see `PathStep.error`.
        first: length of the first step, of the travel.
        smallest: of a step, of the travel; below it the path ends.
    """

    tolerance: float = 1e-3
    first: float = 0.05
    smallest: float = 1e-4

    def __post_init__(self) -> None:
        for name in ("tolerance", "first", "smallest"):
            require_positive(f"AdaptiveSteps.{name}", getattr(self, name))
        if not self.smallest <= self.first <= 1:
            raise InputError(
                "AdaptiveSteps.first", self.first, "outside [smallest, 1]", "give e.g. 0.05"
            )


def sequential(
    problem: Problem,
    travel: float,
    steps: int | AdaptiveSteps = 20,
    scheme: str = "leapfrog",
    control: Control | None = None,
    *,
    approaching: Sequence[Interface] = (),
    backend: str = "clarabel",
    coupling: str | None = None,
    tolerance: float = 1e-6,
    options: Mapping[str, Any] | None = None,
    keep_every: int = 1,
    checkpoint: str | PathLike[str] | None = None,
    remesh: Remesh | None = None,
    on_step: Callable[[PathStep], None] | None = None,
) -> Path:
    """Follow bodies through large deformation: a limit problem a step (T29).

    Bodies move and harden, loads and footings act on their boundaries as they are, contact opens
    and closes. Yang, Computers & Structures 33 (1989) 1171; Corradi & Panzeri, CMAME 193 (2004).

    Args:
        problem: at the beginning. Its bodies deform, in plane strain or axisymmetric. Elements
            become curved, of the space ``p2-gauss`` (triangles) or ``q2`` (quadrilaterals), so that
            no load factor is a strict bound. `VonMises(hardening=...)` says how they harden.
        travel: how far to go, in units of the control, > 0.
        steps: how many equal ones, or `AdaptiveSteps`.
        scheme: ``leapfrog`` (order 2, one solve a step), ``explicit`` (order 1, does not see
            hardening within a step), ``implicit-midpoint`` (order 2, iterated, keeps areas),
            ``implicit-euler`` (order 1, iterated); T30.
        control: what the travel is of: `FootingTravel` (the default), `PointTravel` or `Time`.
        approaching: interfaces with plane obstacles that bodies do not touch yet, or in part.
        backend, coupling, tolerance, options: of each solve, see `lacore.solve`.
        keep_every: of how many steps one leaves a snapshot; the first and the last one always do.
        checkpoint: a file (npz) that keeps the path after each step. Called again with the same
            arguments, it goes on from there, to the same path bit for bit but for
            `PathStep.seconds`. Each step writes it anew, all snapshots included: `keep_every`
            keeps it small.
        remesh: makes new meshes where the next step would turn an element inside out, from the
            problem on the bodies as they are; see `lacore.remeshing.Remesh`. Equivalent strains
            are transferred (`lacore.transfer`), the velocity before is forgotten. An event says by
            how much volume and load jump. Paths with new meshes have no checkpoint so far.
        on_step: called after each step that is taken now, when it is kept: for progress.

    Raises:
        InputError: bad arguments; bodies and contact that a path does not follow; a checkpoint
            that is damaged, cannot be written, or is of another path: it stays as it is.
        CapabilityError: the backend is missing, or takes no hardening.
    """
    require_positive("travel", travel)
    require_known("scheme", scheme, SCHEMES)
    if not isinstance(problem, Problem):
        raise InputError("problem", problem, "not a problem", "give a lacore.Problem")
    if not isinstance(steps, AdaptiveSteps):
        require_count("steps", steps)
    require_count("keep_every", keep_every)
    if remesh is not None and checkpoint is not None:
        raise InputError(
            "checkpoint", str(checkpoint), "does not keep new meshes so far", "leave one out"
        )
    stage = staged(problem, approaching)
    control = control or FootingTravel()
    gauge = control.gauge(stage.problem)
    settings = {
        "backend": backend,
        "coupling": coupling,
        "tolerance": tolerance,
        "options": options or {},
    }
    walk, pace = Walk(stage, gauge, settings), _Pace(steps, travel)
    log = _Log(stage, gauge, keep_every)
    with ExitStack() as opened:
        kept, progress = None, None
        if checkpoint is not None:
            said = {
                "travel": travel,
                "steps": steps,
                "scheme": scheme,
                "control": control,
                "keep_every": keep_every,
            }
            kept = opened.enter_context(Checkpoint(checkpoint, identity(stage, settings, said)))
            progress = kept.load()
        if progress is None:
            here = Here(0, 0.0, stage.start, None, None, discretise(stage.problem).natural.velocity)
            log.begin(here)
        else:
            here = progress.here
            pace.resume(progress.step)
            log.resume(progress)
        try:
            while (distance := pace.distance(here.travel)) > 0:
                try:
                    here = _step(walk, SCHEMES[scheme], here, distance, pace, log)
                except PathEndError as stop:
                    fresh = bool(log.later) and log.later[-1][0] == here.step + 1
                    if remesh is None or fresh or stop.ending is not Ending.INVERSION:
                        raise
                    log.inversion(here, stop)
                    moved = carried(control, walk.stage, here.configuration)
                    walk, here = _remeshed(walk, here, distance, remesh, moved, log)
                    control = moved
                    continue
                if kept is not None:
                    kept.save(log.progress(here, pace.next))
                if on_step is not None:
                    on_step(log.rows[-1])
        except PathEndError as stop:
            if stop.ending is Ending.INVERSION:
                log.inversion(here, stop)
            return log.path(stop.ending, str(stop), settings)
    return log.path(Ending.REACHED, Ending.REACHED.value, settings)


def _step(
    walk: Walk, scheme: Scheme, here: Here, distance: float, pace: "_Pace", log: "_Log"
) -> Here:
    """The next place, after as many attempts as the pace asks for."""
    begin = time.perf_counter()
    walk.solves = 0
    stride = scheme(walk, here, distance)
    while not pace.accepts(stride.error):
        distance = pace.shorter(distance, stride.error)
        stride = scheme(walk, here, distance)
    pace.learn(distance, stride.error)
    moves = {name: stride.duration * v for name, v in stride.flow.velocity.items()}
    there = Here(
        step=here.step + 1,
        travel=here.travel + distance,
        configuration=here.configuration.moved(moves, stride.strained),
        velocity=stride.flow.velocity,
        strain_rate=stride.flow.strain_rate,
        speed=stride.speed,
        growth=1.0 if here.velocity is None else stride.speed / here.speed,
    )
    jacobian = require_upright(walk.stage, there.configuration)
    volume = _volume(walk.stage, there)
    log.step(here, there, stride, jacobian, volume, walk.solves, time.perf_counter() - begin)
    return there


def _remeshed(
    walk: Walk, here: Here, distance: float, remesh: Remesh, control: Control, log: "_Log"
) -> tuple[Walk, Here]:
    """The same place on new meshes.

    Raises:
        PathEndError: they cannot be taken.
    """
    old = walk.stage
    meshes = remesh(old.at(here.configuration))
    try:
        stage, configuration = restaged(old, here.configuration, meshes)
        gauge = control.gauge(stage.problem)
    except InputError as wrong:
        raise PathEndError(Ending.NOT_REMESHED, str(wrong)) from wrong
    there = Here(here.step, here.travel, configuration, None, None, here.speed)
    after = Walk(stage, gauge, walk.settings)
    loads = [
        _load(own, Moment(at, at, distance / here.speed, 0.0))
        for own, at in ((walk, here.configuration), (after, configuration))
    ]
    volumes = [_volume(old, here), _volume(stage, there)]
    jumps = [now / before - 1 for before, now in (volumes, loads)]
    counts = ", ".join(f"{name} has {mesh.nelements} elements" for name, mesh in meshes.items())
    what = f"{counts}; volume jumps by {jumps[0]:+.2e}, load by {jumps[1]:+.2e} of itself"
    log.enter(stage, gauge, here.step + 1)
    log.event("remeshed", here.step + 1, here.travel, what)
    return after, there


def _load(walk: Walk, moment: Moment) -> float:
    """At a moment; NaN where there is none."""
    try:
        return walk.flow(moment)[0].load_factor
    except PathEndError:
        return float("nan")


def _volume(stage: Stage, there: Here) -> float:
    """Of all bodies, m^3.

    Raises:
        PathEndError: they are no bodies any more: elements overlap.
    """
    try:
        numbered = number(stage.bodies_at(there.configuration))
    except InputError as wrong:
        raise PathEndError(Ending.OVERLAP, f"{wrong}; {Ending.OVERLAP.value}") from wrong
    return sum(float(dofs.weights.sum()) for dofs in numbered.values())


@dataclass
class _Pace:
    """Lengths of steps: equal, or as the error allows; `next` is that of the next one."""

    steps: int | AdaptiveSteps
    travel: float
    next: float = 0.0

    def __post_init__(self) -> None:
        first = self.steps.first if isinstance(self.steps, AdaptiveSteps) else 1 / self.steps
        self.next = self.travel * first

    def resume(self, step: float) -> None:
        """Go on with a step of this length."""
        self.next = step

    def distance(self, done: float) -> float:
        """Of the next step; 0 at the end."""
        left = self.travel - done
        return 0.0 if left <= _END * self.travel else min(self.next, left)

    def accepts(self, error: float) -> bool:
        """Whether a step with this error is taken; the first one has none."""
        return not isinstance(self.steps, AdaptiveSteps) or not error > self.steps.tolerance

    def shorter(self, distance: float, error: float) -> float:
        """Another attempt.

        Raises:
            PathEndError: it would be too short.
        """
        shorter = distance * self._factor(error)
        assert isinstance(self.steps, AdaptiveSteps)
        if shorter < self.steps.smallest * self.travel:
            message = f"{Ending.STEP_TOO_SMALL.value} (error {error:.3g})"
            raise PathEndError(Ending.STEP_TOO_SMALL, message)
        return shorter

    def learn(self, distance: float, error: float) -> None:
        """Set the next step by the error of the last: the error goes with its square."""
        if isinstance(self.steps, AdaptiveSteps) and np.isfinite(error):
            self.next = distance * self._factor(error)

    def _factor(self, error: float) -> float:
        assert isinstance(self.steps, AdaptiveSteps)
        ratio = np.sqrt(self.steps.tolerance / max(error, 1e-300))
        return float(np.clip(_SAFETY * ratio, *_CHANGE))


@dataclass
class _Log:
    """What a path leaves behind, as it comes."""

    stage: Stage
    gauge: Gauge
    keep_every: int
    rows: list[PathStep] = field(default_factory=list)
    events: list[Event] = field(default_factory=list)
    snapshots: list[Snapshot] = field(default_factory=list)
    moment: Moment | None = None
    last: LimitState | None = None
    later: list[tuple[int, Stage]] = field(default_factory=list)
    now: Stage = field(init=False)
    dofs: dict[str, BodyDofs] = field(init=False)

    def __post_init__(self) -> None:
        self.now = self.stage
        self.dofs = number(self.stage.bodies)

    def enter(self, stage: Stage, gauge: Gauge, step: int) -> None:
        """New meshes, from a step on."""
        self.now, self.gauge, self.dofs = stage, gauge, number(stage.bodies)
        self.later.append((step, stage))

    def begin(self, here: Here) -> None:
        """The bodies at the beginning."""
        still = {name: np.zeros_like(nodes) for name, nodes in here.configuration.nodes.items()}
        rigid = {name: np.zeros_like(own) for name, own in here.configuration.strain.items()}
        self.snapshots.append(Snapshot(0, 0.0, here.configuration, still, rigid))

    def resume(self, progress: Progress) -> None:
        """Go on from a path so far."""
        self.rows, self.events = list(progress.rows), list(progress.events)
        self.snapshots, self.moment = list(progress.snapshots), progress.moment

    def progress(self, here: Here, step: float) -> Progress:
        """The path so far, to be resumed with a step of this length."""
        assert self.moment is not None
        return Progress(here, step, self.rows, self.events, self.snapshots, self.moment)

    def event(self, kind: str, step: int, travel: float, what: str) -> None:
        """Something happened."""
        self.events.append(Event(kind, step, travel, what))

    def inversion(self, here: Here, stop: PathEndError) -> None:
        """The next step would turn an element inside out."""
        element = str(stop).partition(":")[0]
        self.event("inversion predicted", here.step + 1, here.travel, element)

    def step(
        self,
        here: Here,
        there: Here,
        stride: Stride,
        jacobian: float,
        volume: float,
        solves: int,
        seconds: float,
    ) -> None:
        """A step was taken."""
        load, state = stride.load.load_factor, stride.load.state
        assert state.point is not None
        assert state.certificate is not None
        d, u = state.discretisation, state.point.velocity
        contact = d.full.contact
        slip = np.sum(state.point.tangential_reaction * contact.slip(u), axis=1)
        control, dead = self.gauge(d, u), float(d.full.dead_load @ u)
        friction = -float(contact.weights @ slip)
        row = PathStep(
            step=there.step,
            travel=stride.at,
            load_factor=load,
            force=load / control,
            plastic=load + dead - friction,
            friction=friction,
            dead=dead,
            max_strain=max(float(v.max()) for v in there.configuration.strain.values()),
            min_jacobian=jacobian,
            volume=volume,
            error=stride.error,
            solves=solves,
            gap=state.certificate.gap,
            end=there.travel,
            seconds=seconds,
        )
        self.rows.append(row)
        self.last, self.moment = state, stride.load.moment
        if self.snapshots[-1].step % self.keep_every:
            self.snapshots.pop()  # it was the last
        moving = stride.flow
        self.snapshots.append(
            Snapshot(
                there.step, there.travel, there.configuration, moving.velocity, moving.strain_rate
            )
        )
        self._contacts(here, there)
        self._peak()

    def _contacts(self, here: Here, there: Here) -> None:
        """Points that came to an obstacle in the last step, and points that left one."""
        for obstacle in self.now.obstacles:
            dofs = self.dofs[obstacle.body]
            near = _NEAR * obstacle.size
            before, after = (
                gaps(obstacle, own.configuration.nodes[obstacle.body], dofs) <= near
                for own in (here, there)
            )
            for kind, count in (
                ("contact closed", int(np.sum(after & ~before))),
                ("contact opened", int(np.sum(before & ~after))),
            ):
                if count:
                    what = f"{obstacle.name}: {count} of {after.size} points"
                    self.event(kind, there.step, there.travel, what)

    def _peak(self) -> None:
        """The load passed a maximum: that of the parabola through the last three loads."""
        if len(self.rows) < 3:
            return
        x = np.array([row.travel for row in self.rows[-3:]])
        y = np.array([row.load_factor for row in self.rows[-3:]])
        if y[1] > y[0] and y[1] >= y[2]:
            curve = np.polynomial.Polynomial.fit(x, y, 2)
            top = float(np.real(curve.deriv().roots()[0]))
            what = f"load factor {float(curve(top)):.9g}"
            self.event("peak load", self.rows[-2].step, top, what)

    def path(self, ending: Ending, message: str, settings: Mapping[str, Any]) -> Path:
        """The end; settings are those of each solve."""
        if self.last is None and self.moment is not None:  # of a path that was all kept
            self.last = flow(self.stage, self.moment, settings).state
        return Path(
            status=ending,
            message=f"{ending.label}: {message}",
            history=pd.DataFrame([asdict(row) for row in self.rows], columns=_COLUMNS),
            events=pd.DataFrame(
                [asdict(event) for event in self.events], columns=[f.name for f in fields(Event)]
            ),
            snapshots=tuple(self.snapshots),
            last=self.last,
            stage=self.stage,
            later=tuple(self.later),
        )
