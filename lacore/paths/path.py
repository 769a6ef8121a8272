"""Result of a path: its history, its events, and the bodies after every step."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from numbers import Integral
from os import PathLike
from pathlib import Path as File
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from lacore.limit.state import LimitState
from lacore.model.problem.problem import Problem
from lacore.paths.ending import Ending
from lacore.paths.flow import Snapshot, stage_of, state_of
from lacore.paths.stage import Stage
from lacore.paths.steady import Steady, SteadyState, steady_state
from lacore.reporting import views
from lacore.reporting.errors import InputError
from lacore.reporting.findings import Finding
from lacore.reporting.showing import Compact, Facts, Picture, counted, listed
from lacore.reporting.status import Reported

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False)
class PathStep(Compact):
    """One step, as a row of the history.

    Attributes:
        step: 1, 2, ...
        travel: where the load is that of the bodies: at the beginning of an explicit step, in the
            middle of a leapfrog step, at the end of an implicit one.
        load_factor: alpha there, on the boundary as it is there.
        force: power of the reference load per speed of the control: what a testing machine reads.
        plastic, friction, dead: powers at ``F0.u = 1``; load_factor = plastic + friction - dead.
        max_strain: largest equivalent strain at the end of the step.
        min_jacobian: least Bernstein coefficient of an element at the end of the step, per mean
            (T31); what is not above 0 may be inverted.
        volume: of all bodies at the end of the step, m^3 (m^2 of unit thickness).
        overlap: how deep bodies overlap each other or obstacles at the end of the step, m.
        error: displacement by which the velocity changed against the step before, half of it, per
            body size.
        solves: limit problems with all their inner solves.
        gap: of the certificate of the load.
        end: travel at the end of the step.
        seconds: of the step, wall clock.
    """

    step: int
    travel: float
    load_factor: float
    force: float
    plastic: float
    friction: float
    dead: float
    max_strain: float
    min_jacobian: float
    volume: float
    overlap: float
    error: float
    solves: int
    gap: float
    end: float
    seconds: float

    def __str__(self) -> str:
        """A line of progress."""
        solves = "solve" if self.solves == 1 else "solves"
        return (
            f"step {self.step}: load factor {self.load_factor:.6g} at travel {self.travel:.6g},"
            f" strains to {self.max_strain:.3g}, {self.solves} {solves} in {self.seconds:.1f} s"
        )


@dataclass(frozen=True, repr=False)
class Event(Compact):
    """Something that happened on the way.

    Attributes:
        kind: ``contact closed``, ``contact opened``, ``peak load`` (of the load factor, on a mesh),
            ``peak force`` (of a footing, whose face changes), ``inversion predicted``,
            ``remeshed``; ``velocity not unique`` (another has nearly the same load, and bodies
            begin to drift), ``velocity selected`` or ``velocity not selected`` (by a `LeastNorm`).
        step: in which it happened.
        travel: where, as closely as the steps show.
        what: interface, load factor or element, in words.
    """

    kind: str
    step: int
    travel: float
    what: str


@dataclass(frozen=True, repr=False)
class Path(Reported):
    """A path of large deformation.

    Attributes:
        status: Whether the requested travel is reached, and if not, why.
        findings: Further findings; `message` is their text.
        history: One row per step. ``travel`` and ``load_factor`` refer to the configuration of the
            load (at the beginning of an explicit step, in the middle of a leapfrog step, at the end
            of an implicit one). ``force`` is the power of the reference load per speed of the
            control, which a testing machine would measure. See `PathStep` for the other columns.
        events: One row per event: ``kind``, ``step``, ``travel`` and the description ``what``.
        snapshots: Bodies at the beginning and at the end of the steps to keep.
        last: Limit state of the last step; None without any step.
        stage: Problem that was prepared for the path, on the first meshes.
        later: Stages on new meshes, each with the first step on them.
        settings: Settings of each solve, see `lacore.solve`.
        unit: Unit of the travel: ``m``, ``s`` for `Time`, or empty.
    """

    status: Ending
    findings: tuple[Finding, ...]
    history: pd.DataFrame
    events: pd.DataFrame
    snapshots: tuple[Snapshot, ...]
    last: LimitState | None
    stage: Stage
    later: tuple[tuple[int, Stage], ...] = ()
    settings: Mapping[str, Any] = field(default_factory=dict)
    unit: str = ""

    def facts(self) -> Facts:
        """Return the travel, the loads and the events of the path."""
        rows = self.history
        steps, told = counted(len(rows), "step"), {"status": self.message}
        title = f"Path: {steps} to travel {self.snapshots[-1].travel:.7g}"
        if len(rows):
            loads = rows["load_factor"]
            title += f", load factor {loads.iloc[0]:.7g} to {loads.iloc[-1]:.7g}"
            told["residual"] = f"gap of a load at most {rows['gap'].to_numpy().max():.1e}"
            told["strain"] = (
                f"at most {rows['max_strain'].iloc[-1]:.4g}, volume"
                f" {rows['volume'].iloc[-1]:.7g} after {rows['volume'].iloc[0]:.7g}"
            )
            told["solved by"] = (
                f"{self.settings.get('backend', 'unknown')}:"
                f" {counted(int(rows['solves'].sum()), 'solve')} in {rows['seconds'].sum():.3g} s"
            )
        kinds = listed(list(dict.fromkeys(self.events["kind"]))) if len(self.events) else "none"
        told["events"] = f"{len(self.events)}: {kinds}" if len(self.events) else kinds
        return Facts(title, told)

    def picture(self) -> Picture:
        """As `plot` draws it."""
        return Picture(self.plot())

    def __str__(self) -> str:
        """How far it has come, and why it ends there."""
        taken = len(self.history)
        steps = "1 step" if taken == 1 else f"{taken} steps"
        return f"path of {steps} to travel {self.snapshots[-1].travel:.6g}, {self.message}"

    def stage_of(self, snapshot: Snapshot) -> Stage:
        """The stage that has the meshes of a snapshot."""
        return stage_of(snapshot, self.stage, self.later)

    def snapshot(self, step: int) -> Snapshot:
        """The bodies at the end of a step; counted from the end of `snapshots` where negative.

        Raises:
            InputError: that step was not kept, or not taken.
        """
        if not isinstance(step, Integral) or isinstance(step, bool):
            raise InputError("step", step, "not the number of a step", "give a whole number")
        kept = {own.step: own for own in self.snapshots}
        if -len(self.snapshots) <= step < 0:
            return self.snapshots[step]
        if step not in kept:
            given = ", ".join(map(str, kept))
            raise InputError("step", step, "has no snapshot", f"give one of {given}")
        return kept[step]

    def state(self, step: int = -1) -> LimitState:
        """The limit state of a step: mechanism, stresses, reactions and certificate of its load.

        It is solved again, unless it is that of the last step: states are large, and a path has
        many. It stands where its load does, see `PathStep.travel`. Its load factor is that of the
        limit problem as it was solved; the history has it for the duration that the step turned
        out to have, to first order. So is its velocity; where a `LeastNorm` selects another one,
        that has moved the bodies, and is in the snapshot.

        Raises:
            InputError: see `snapshot`; the beginning has no state.
        """
        snapshot = self.snapshot(step)
        if snapshot.moment is None:
            raise InputError("step", step, "is the beginning, without a state", "give 1 or more")
        if self.last is not None and snapshot.step == self.snapshots[-1].step:
            return self.last
        return state_of(snapshot, self.stage, self.later, self.settings)

    def tool_forces(self, step: int = -1) -> pd.DataFrame:
        """Return the force [N/m] and moment [N] of contact on each rigid block in a step.

        The table has one row per block: ``body``, ``f_x``, ``f_y`` and the anticlockwise ``moment``
        about the centroid, or about the reference point of a `Tool`. They belong to the limit
        problem as it was solved, see `state`.

        Raises:
            InputError: See `state`.
        """
        return _block_forces(self.state(step))

    def steady(self, criterion: Steady | None = None) -> SteadyState:
        """Judge whether load and flow have become stationary, by default as `Steady()` does."""
        criterion = Steady() if criterion is None else criterion
        return steady_state(self.history, self.snapshots, self.stage_of, self.unit, criterion)

    def problem(self, step: int = -1) -> Problem:
        """The problem on the bodies of a `snapshot`: the last by default.

        Without obstacles, and of bodies that are as strong as at the beginning: it is for new
        meshes, pictures and measures of the shape. What they bear by then is `state`.

        Raises:
            InputError: see `snapshot`.
        """
        snapshot = self.snapshot(step)
        return self.stage_of(snapshot).at(snapshot.configuration)

    def to_vtu(self, folder: str | PathLike[str]) -> File:
        """Files for ParaView: see `lacore.files.vtu.write_path`."""
        return views.files(self, folder)

    def plot(self) -> Figure:
        """The bodies at the end, and the load: see `lacore.pictures.path.plot_path`."""
        return views.picture(self)

    def plot_force(self) -> Figure:
        """The force over the travel: see `lacore.pictures.path.plot_force`."""
        return views.curve(self)

    def animate(self, file: str | PathLike[str], fps: float = 8.0, dpi: float = 90.0) -> None:
        """Write a GIF or MP4, see `lacore.pictures.animation.animate_path`."""
        views.animation(self, file, fps, dpi)


def _block_forces(state: LimitState) -> pd.DataFrame:
    """Return the resultants of contact on rigid blocks, one row per block.

    The columns are ``body``, ``f_x`` and ``f_y`` [N/m], and the anticlockwise ``moment`` [N] about
    the centroid, or about the reference point of a `Tool`.
    """
    d, point, rows = state.discretisation, state.point, []
    assert point is not None
    contact = d.full.contact
    across = contact.weights * point.normal_reaction
    along = contact.weights[:, None] * point.tangential_reaction
    force = contact.normal.T @ across + contact.tangential.T @ along.ravel()
    for name, dofs in d.assemblies.items():
        f_x, f_y, turning = np.asarray(force)[dofs.offset : dofs.offset + dofs.count]
        moment = turning * dofs.body.radius[0]
        rows.append({"body": name, "f_x": f_x, "f_y": f_y, "moment": moment})
    return pd.DataFrame(rows, columns=["body", "f_x", "f_y", "moment"])
