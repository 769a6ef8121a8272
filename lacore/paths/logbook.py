"""Record of a path while it is followed: rows, events and snapshots."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields
from typing import Any

import numpy as np
import pandas as pd

from lacore.limit.state import LimitState
from lacore.model.bodies.any_body import numbered
from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.conditions.footings import footings
from lacore.paths import drift
from lacore.paths.contact.approach import gaps
from lacore.paths.contact.overlap import overlap_and_touching
from lacore.paths.control import Gauge
from lacore.paths.ending import Ending, PathEndError
from lacore.paths.flow import Snapshot, state_of
from lacore.paths.path import Event, Path, PathStep
from lacore.paths.renewal.remeshing import NewMeshes
from lacore.paths.schemes import Here, Stride
from lacore.paths.stage import Stage
from lacore.paths.stored.progress import Progress
from lacore.reporting.findings import Finding
from lacore.reporting.text import text

_RISES = 1e-6  # of a load: smaller changes are noise of solvers
_COLUMNS = [entry.name for entry in fields(PathStep)]


@dataclass
class Log:
    """Record of a path while it is followed.

    Attributes:
        stage: Problem on the first meshes.
        gauge: Speed of the control on the present meshes.
        keep_every: Interval of the snapshots to keep, in steps.
        unit: Unit of the travel.
        rows: Rows of the history, one per step.
        events: Events so far.
        snapshots: Snapshots to keep, and that of the last step.
        last: State of the last step; None before the first one.
        later: Stages on new meshes, each with the first step on them.
        made: The new meshes, as checkpoints keep them.
        now: Problem on the present meshes.
        dofs: Unknowns of the deformable bodies on the present meshes.
    """

    stage: Stage
    gauge: Gauge
    keep_every: int
    unit: str = ""
    rows: list[PathStep] = field(default_factory=list)
    events: list[Event] = field(default_factory=list)
    snapshots: list[Snapshot] = field(default_factory=list)
    last: LimitState | None = None
    later: list[tuple[int, Stage]] = field(default_factory=list)
    made: list[NewMeshes] = field(default_factory=list)
    now: Stage = field(init=False)
    dofs: dict[str, BodyDofs] = field(init=False)

    def __post_init__(self) -> None:
        self.now = self.stage
        self.dofs = numbered(self.stage.bodies, BodyDofs.at)

    def enter(self, stage: Stage, gauge: Gauge, made: NewMeshes) -> None:
        """Record new meshes."""
        self.now, self.gauge, self.dofs = stage, gauge, numbered(stage.bodies, BodyDofs.at)
        self.later.append((made.step, stage))
        self.made.append(made)

    def remeshed_before(self, step: int) -> bool:
        """Whether the last new meshes were made immediately before a step."""
        return bool(self.later) and self.later[-1][0] == step

    def begin(self, here: Here) -> None:
        """Record the bodies at the beginning."""
        still = {name: np.zeros_like(nodes) for name, nodes in here.configuration.nodes.items()}
        rigid = {name: np.zeros_like(own) for name, own in here.configuration.strain.items()}
        self.snapshots.append(Snapshot(0, 0.0, here.configuration, still, rigid))

    def resume(self, progress: Progress) -> None:
        """Continue the record of a path so far."""
        self.rows, self.events = list(progress.rows), list(progress.events)
        self.snapshots = list(progress.snapshots)

    def progress(self, here: Here, step: float) -> Progress:
        """Return the path so far, to be resumed with a step of the given length."""
        return Progress(here, step, self.rows, self.events, self.snapshots, self.made)

    def event(self, kind: str, step: int, travel: float, what: str) -> None:
        """Record an event."""
        self.events.append(Event(kind, step, travel, what))

    def inversion(self, here: Here, stop: PathEndError) -> None:
        """Record that the next step would invert an element."""
        self.event("inversion predicted", here.step + 1, here.travel, text("{}", *stop.findings))

    def step(
        self,
        here: Here,
        there: Here,
        stride: Stride,
        jacobian: float,
        volume: float,
        seconds: float,
    ) -> None:
        """Record a step."""
        load, state = stride.load.load_factor, stride.load.state
        assert state.point is not None
        assert state.certificate is not None
        d, u = state.discretisation, stride.load.motion
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
            overlap=self._contacts(here, there),
            error=stride.error,
            solves=stride.warm.solves,
            gap=state.certificate.gap,
            end=there.travel,
            seconds=seconds,
        )
        self.rows.append(row)
        self.last = state
        if self.snapshots[-1].step % self.keep_every:
            self.snapshots.pop()  # it was kept only as that of the last step
        moving = stride.flow
        self.snapshots.append(
            Snapshot(
                step=there.step,
                travel=there.travel,
                configuration=there.configuration,
                velocity=moving.velocity,
                strain_rate=moving.strain_rate,
                moment=stride.load.moment,
                duration=stride.load.duration,
            )
        )
        self._peak("peak load", "load_factor")
        # The load factor of a footing is a pressure, and its area changes along the path.
        if footings(self.now.problem.reference_loads):
            self._peak("peak force", "force")

    def _contacts(self, here: Here, there: Here) -> float:
        """Record contact that closes or opens in a step; return the overlap of bodies after it."""
        return max(self._obstacles(here, there), self._pairs(here, there))

    def _pairs(self, here: Here, there: Here) -> float:
        """Record edges of two bodies that touch or separate in a step; return the overlap."""
        if not self.now.pairs:
            return 0.0
        before, after = (self.now.plane_bodies_at(own.configuration) for own in (here, there))
        deepest = 0.0
        for pair in self.now.pairs:
            _, touched = overlap_and_touching(pair, before)
            depth, touching = overlap_and_touching(pair, after)
            deepest = max(deepest, depth)
            count = sum(side.edges.size for side in pair.sides)
            for kind, edges in (
                ("contact closed", touching - touched),
                ("contact opened", touched - touching),
            ):
                if edges:
                    what = text("{}: {} of {} edges", pair.name, len(edges), count)
                    self.event(kind, there.step, there.travel, what)
        return deepest

    def _obstacles(self, here: Here, there: Here) -> float:
        """Record points that reach or leave an obstacle in a step; return the overlap."""
        deepest = 0.0
        places = [own.configuration for own in (here, there)]
        for faces in zip(*map(self.now.obstacles_at, places), strict=True):
            obstacle, dofs = faces[0], self.dofs[faces[0].body]
            distances = [
                gaps(face, own.nodes[face.body], dofs)
                for face, own in zip(faces, places, strict=True)
            ]
            deepest = max(deepest, -float(distances[1].min()))
            before, after = (own <= obstacle.near for own in distances)
            for kind, count in (
                ("contact closed", int(np.sum(after & ~before))),
                ("contact opened", int(np.sum(before & ~after))),
            ):
                if count:
                    what = text("{}: {} of {} points", obstacle.name, count, after.size)
                    self.event(kind, there.step, there.travel, what)
        return deepest

    @property
    def on_these_meshes(self) -> list[PathStep]:
        """Steps since the last new meshes.

        The load jumps from mesh to mesh, so a peak is not detected within two steps of new meshes.
        """
        first = self.made[-1].step if self.made else 0
        return [row for row in self.rows if row.step >= first]

    def _peak(self, kind: str, column: str) -> None:
        found = peak(self.on_these_meshes, column)
        if found is not None:
            step, travel, value = found
            self.event(kind, step, travel, f"{column.replace('_', ' ')} {value:.9g}")

    def path(
        self, ending: Ending, findings: tuple[Finding, ...], settings: Mapping[str, Any]
    ) -> Path:
        """Return the path at its end; `settings` are those of each solve."""
        if self.last is None and self.rows:  # all steps were read from a checkpoint
            snapshot = self.snapshots[-1]
            self.last = state_of(snapshot, self.stage, self.later, settings)
        return Path(
            status=ending,
            findings=(*findings, *drift.warnings(self.events)),
            history=pd.DataFrame([asdict(row) for row in self.rows], columns=_COLUMNS),
            events=_table(self.events),
            snapshots=tuple(self.snapshots),
            last=self.last,
            stage=self.stage,
            later=tuple(self.later),
            settings=settings,
            unit=self.unit,
        )


def peak(rows: Sequence[PathStep], column: str) -> tuple[int, float, float] | None:
    """Return step, travel and value of a maximum passed in the last step; None without one.

    The maximum is that of the polynomial through the last three or four steps.
    """
    last = rows[-4:]
    if len(last) < 3:
        return None
    x = np.array([row.travel for row in last])
    y = np.array([getattr(row, column) for row in last])
    before, high, after = y[-3:]
    rises = high - min(before, after) > _RISES * abs(high)
    if not (high > before and high >= after and rises):
        return None
    curve = np.polynomial.Polynomial.fit(x, y, len(last) - 1)
    flat = curve.deriv().roots()
    between = np.real(flat[np.isreal(flat)])
    between = between[(between > x[-3]) & (between < x[-1])]
    top = float(between[np.argmax(curve(between))])
    return last[-2].step, top, float(curve(top))


def _table(events: Sequence[Event]) -> pd.DataFrame:
    """Return a table of events; texts of what happened keep their quantities, as objects."""
    table = pd.DataFrame(map(asdict, events), columns=[entry.name for entry in fields(Event)])
    return table.assign(what=pd.Series([event.what for event in events], dtype=object))
