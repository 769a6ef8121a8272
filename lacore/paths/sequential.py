"""Sequential limit analysis: limit problems along a path of large deformation (T29-T31)."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from os import PathLike
from typing import Any

from lacore.contact.interfaces import Interface
from lacore.coupling.kinds import COUPLINGS
from lacore.errors import InputError, require_count, require_known, require_positive, typed
from lacore.limit.engines import engine_for
from lacore.paths import drift
from lacore.paths.attempts import whole_or_to_fold
from lacore.paths.contact.folding import FOLDED
from lacore.paths.contact.overlap import corner_inside
from lacore.paths.control import Control, FootingTravel, ToolTravel, driven_by, gauge_of, unit_of
from lacore.paths.ending import Ending
from lacore.paths.flow import Moment, discretised
from lacore.paths.hooks.calling import Caller, GivenHook, known_hooks
from lacore.paths.hooks.hook import AFTER_REMESHING, AFTER_STEP, BEFORE_REMESHING, BEFORE_STEP
from lacore.paths.logbook import Log
from lacore.paths.pace import AdaptiveSteps, Pace
from lacore.paths.path import Path, PathStep
from lacore.paths.renewal.mesher import Remeshing
from lacore.paths.renewal.remeshing import (
    NewMeshes,
    Remesh,
    again,
    carried,
    described,
    distorted,
    new_meshes,
    restaged,
    transfer_text,
)
from lacore.paths.schemes import SCHEMES, Here, PathEndError, Scheme, Stride, Walk, refused
from lacore.paths.selection import LeastNorm, require_selection
from lacore.paths.stage import Stage, staged
from lacore.paths.steady import Steady
from lacore.paths.stored.checkpoint import Checkpoint, identity
from lacore.paths.tools.overlap import require_apart
from lacore.paths.tools.tool import Tool, require_own_travel, tooling
from lacore.problem.problem import Problem
from lacore.reporting.findings import Finding, Severity
from lacore.reporting.kinds import Kind
from lacore.reporting.text import Quantity, text


@typed()
def sequential(
    problem: Problem,
    travel: float,
    steps: int | AdaptiveSteps = 20,
    scheme: str = "leapfrog",
    control: Control | None = None,
    *,
    approaching: Sequence[Interface] = (),
    selection: LeastNorm | None = None,
    backend: str = "clarabel",
    coupling: str | None = None,
    tolerance: float | None = None,
    options: Mapping[str, Any] | None = None,
    keep_every: int = 1,
    checkpoint: str | PathLike[str] | None = None,
    remesh: Remesh | None = None,
    until: Steady | None = None,
    hooks: Sequence[GivenHook] = (),
    tools: Mapping[str, Tool] | None = None,
    on_step: Callable[[PathStep], None] | None = None,
) -> Path:
    """Follow bodies through large deformation: a limit problem a step (T29).

    Bodies move and harden, loads and footings act on their boundaries as they are, contact opens
    and closes. Yang, Computers & Structures 33 (1989) 1171; Corradi & Panzeri, CMAME 193 (2004).

    Args:
        problem: at the beginning. Its bodies deform, in plane strain or axisymmetric, or are single
            rigid blocks. Bodies touch each other by interfaces of any law that neither dilates nor
            carries tension; where they do is searched in each step. Elements become curved, of the
            space ``p2-gauss`` (triangles) or ``q2`` (quadrilaterals), so that no load factor is a
            strict bound. `VonMises(hardening=...)` says how they harden; criteria whose strength
            depends on pressure do not, and grow as their flow dilates.
        travel: how far to go, in units of the control, > 0.
        steps: how many equal ones, or `AdaptiveSteps`.
        scheme: ``leapfrog`` (order 2, one solve a step), ``explicit`` (order 1, does not see
            hardening within a step), ``implicit-midpoint`` (order 2, iterated, keeps areas),
            ``implicit-euler`` (order 1, iterated); T30.
        control: what the travel is of: `FootingTravel` (the default), `PointTravel`, `ToolTravel`
            of rigid blocks with given velocities, or `Time`; by default that of `tools` that move.
        approaching: interfaces with obstacles, planes or shapes, of two bodies, or of two parts of
            the boundary of a body that folds, that do not touch yet, or in part. How a corner that
            two interfaces share splits its reaction between them has no meaning.
        selection: `LeastNorm` moves the bodies by the most regular of all velocities of nearly the
            same load, at the cost of one or two more solves each time. By default hardening
            decides alone, until an event ``velocity not unique`` reports that this is not enough
            (T32): from this step on, `LeastNorm` with its default decides.
        backend, coupling, tolerance, options: of each solve, see `lacore.solve`. Of soils whose
            flow is not associated each load is certified, and one of several, maybe: look for the
            others by `lacore.soil_range(path.problem(step))`, where nothing touches obstacles.
        keep_every: of how many steps one leaves a snapshot; the first and the last one always do.
        checkpoint: a file (npz) that keeps the path after each step. Called again with the same
            arguments, it goes on from there, to the same path bit for bit but for
            `PathStep.seconds`. Each step writes it anew, all snapshots included: `keep_every`
            keeps it small.
        remesh: `Remeshing` makes new meshes when elements are distorted. A function makes them if
            the next step would invert an element, from the problem on the current shape, see
            `lacore.paths.renewal.remeshing.Remesh`; a checkpoint knows it by its name. Equivalent
            strains are transferred (`lacore.paths.renewal.transfer`), the previous velocity is
            discarded. An event reports the jumps in volume and load, and the errors of the
            transfer.
        until: `Steady` ends the path with the status `STEADY` when load and flow have become
            stationary, before the travel is reached.
        hooks: functions that are called after each step, or a `Hook` for other moments, such as
            ``lacore.hooks.progress()``. If one raises an exception, the path ends with the status
            `STOPPED` and keeps all finished steps.
        tools: rigid tools by name, each a `Tool`. Those that move drive the path, in place of
            reference loads.
        on_step: called with the `PathStep` after each step; its exceptions are passed on. Use
            `hooks` instead.

    Raises:
        InputError: bad arguments; bodies, contact and friction that a path does not follow; a
            checkpoint that is damaged, cannot be written, or is of another path: it stays as it is.
        CapabilityError: the backend is missing, or takes no hardening.

    Example:
        >>> ring = la.meshes.quadrilaterals(x=(1, 2), y=(0, 0.25), nx=2, ny=1)
        >>> steel = la.VonMises(shear_strength=1.0)
        >>> tube = la.Problem(
        ...     bodies={"tube": la.Body(ring, steel, kinematics="axisymmetric", space="q2")},
        ...     supports=[la.Fix("tube", "bottom", "y"), la.Fix("tube", "top", "y")],
        ...     reference_loads=[la.Pressure("tube", "left")],
        ... )
        >>> wall = la.PointTravel("tube", at=(1, 0), direction=(1, 0))
        >>> path = la.sequential(tube, travel=0.2, steps=2, control=wall)
        >>> path.history.load_factor.round(2).tolist()  # 2 k ln(b/a) of the tube that it has become
        [1.31, 1.18]
    """
    require_positive("travel", travel)
    require_known("scheme", scheme, SCHEMES)
    if not isinstance(steps, AdaptiveSteps):
        require_count("steps", steps)
    require_count("keep_every", keep_every)
    if tolerance is not None:
        require_positive("tolerance", tolerance)
    engine, _, _ = engine_for(backend, coupling, options or {})
    require_selection(selection, engine)
    if coupling is not None and COUPLINGS[coupling].dilates:
        raise InputError(
            "coupling",
            coupling,
            "sliding would lift bodies off, and each other step would be without friction",
            "take 'certified'",
        )
    given_hooks = known_hooks(hooks)
    tooled = tooling(problem, tools or {})
    if tooled.moves and isinstance(control, ToolTravel):
        require_own_travel(control, tooled)
    if control is None:
        control = tooled.travel if tooled.moves else FootingTravel()
    drives = tooled.drives or driven_by(control, problem)
    stage = staged(problem, approaching, drives, tooled)
    require_apart(stage.obstacles, stage.bodies)
    if isinstance(remesh, Remeshing):
        remesh.check(stage.problem)
    gauge = gauge_of(control, stage.problem)
    settings = {
        "backend": backend,
        "coupling": coupling,
        "tolerance": tolerance,
        "options": options or {},
    }
    walk, pace = Walk(stage, gauge, settings, selection), Pace(steps, travel)
    log = Log(stage, gauge, keep_every, unit_of(control))
    with ExitStack() as opened:
        kept, progress = None, None
        if checkpoint is not None:
            said = {
                "travel": travel,
                "steps": steps,
                "scheme": scheme,
                "control": control,
                "selection": selection,
                "keep_every": keep_every,
                "remesh": described(remesh),
                "until": until,
            }
            kept = opened.enter_context(Checkpoint(checkpoint, identity(stage, settings, said)))
            progress = kept.load(stage.start)
        if progress is None:
            first = discretised(stage, Moment(stage.start, stage.start, 1.0, 0.0))
            here = Here(0, 0.0, stage.start, None, None, first.natural.velocity)
            log.begin(here)
        else:
            here = progress.here
            pace.resume(progress.step)
            log.resume(progress)
            for made in progress.made:
                stage, control = again(walk.stage, control, made)
                walk = Walk(stage, control.gauge(stage.problem), settings, selection)
                log.enter(stage, walk.gauge, made)
        walk.selection = drift.selection_after(log.events, selection)
        call = Caller(given_hooks, log, settings, here)
        walk.solving = call.solving
        try:
            while (distance := pace.distance(here.travel)) > 0:
                if until is not None and (found := _steady(log, until, settings)) is not None:
                    return call.end(found)
                fresh = bool(log.later) and log.later[-1][0] == here.step + 1
                poor = [] if fresh else distorted(remesh, walk.stage, here.configuration)
                try:
                    if not poor:
                        call(BEFORE_STEP, here)
                        here = _step(walk, SCHEMES[scheme], here, distance, pace, log)
                    renewed = bool(poor)
                except PathEndError as stop:
                    if remesh is None or fresh or stop.ending is not Ending.INVERSION:
                        raise
                    log.inversion(here, stop)
                    renewed = True
                if renewed and remesh is not None:
                    moved = carried(control, walk.stage, here.configuration)
                    call(BEFORE_REMESHING, here)
                    walk, here = _remeshed(walk, here, distance, remesh, poor, moved, log)
                    control = moved
                    call(AFTER_REMESHING, here)
                    continue
                if kept is not None:
                    kept.save(log.progress(here, pace.next))
                call(AFTER_STEP, here)
                if on_step is not None:
                    on_step(log.rows[-1])
        except PathEndError as stop:
            if stop.ending is Ending.INVERSION:
                log.inversion(here, stop)
            return call.end(log.path(stop.ending, stop.findings, settings))
    return call.end(log.path(drift.ending(log.events), (), settings))


def _steady(log: Log, until: Steady, settings: Mapping[str, Any]) -> Path | None:
    """The path so far, if it has become steady."""
    found = log.path(Ending.RUNNING, (), settings).steady(until)
    why = replace(found.finding, severity=Severity.REASON)
    return log.path(Ending.STEADY, (why,), settings) if found.reached else None


def _step(walk: Walk, scheme: Scheme, here: Here, distance: float, pace: Pace, log: Log) -> Here:
    """The next place, after as many attempts as the pace asks for."""
    begin = time.perf_counter()
    for event in log.events:
        if event.kind == FOLDED and event.step == here.step:
            folded = Finding(Kind.EVENT, (), {"what": event.what}, Severity.DETAIL)
            raise PathEndError(Ending.FOLDED, folded)
    # Reactions of the step before are too far off, its slip is where to look for them.
    walk.solves, walk.pressed, walk.before = 0, None, here.velocity
    walk.require_safe(here, distance)
    stride, there, jacobian, fold = whole_or_to_fold(walk, scheme, here, distance, pace)
    if _begins_to_drift(walk, stride, there, there.travel - here.travel, log):
        walk.selection = LeastNorm()
        return _step(walk, scheme, here, distance, pace, log)
    distance = there.travel - here.travel
    pace.learn(distance, stride.error)
    volume = _volume(walk.stage, there)
    _require_apart(walk.stage, there)
    log.step(here, there, stride, jacobian, volume, walk.solves, time.perf_counter() - begin)
    if fold is not None:
        log.event(FOLDED, there.step, here.travel + fold.share * distance, text("{}", fold.finding))
    return there


def _begins_to_drift(walk: Walk, stride: Stride, there: Here, distance: float, log: Log) -> bool:
    """Whether bodies begin to drift; an event once per path, or where no velocity is selected."""
    selects, kinds = walk.selection is not None, {event.kind for event in log.events}
    if selects and stride.flow.selected is None:
        what = "the solver finds no admissible one: the velocity as solved is taken"
        log.event(drift.LOST, there.step, there.travel, what)
        return False
    if {drift.DRIFTS, drift.SELECTED} & kinds:
        return False
    looked = selects or drift.due(log.rows, stride.error, distance)
    if looked and (said := drift.described(stride.flow)):
        kind = drift.SELECTED if selects else drift.DRIFTS
        log.event(kind, there.step, there.travel, said)
        if not selects and (late := drift.too_late(log.last)):
            log.event(drift.LATE, there.step, there.travel, late)
        return not selects
    return False


def _remeshed(
    walk: Walk,
    here: Here,
    distance: float,
    remesh: Remesh,
    poor: Sequence[str],
    control: Control,
    log: Log,
) -> tuple[Walk, Here]:
    """The same place on new meshes, those of `poor` bodies, or of all where none is.

    Raises:
        PathEndError: they cannot be taken.
    """
    old = walk.stage
    try:
        meshes = new_meshes(remesh, old, here.configuration, poor, control)
    except Exception as error:  # of others: what was found so far must not be lost with it
        values = {"error": text("{}: {}", type(error).__name__, getattr(error, "text", error))}
        failed = Finding(Kind.REMESHING_FAILED, (), values, Severity.REASON)
        raise PathEndError(Ending.NOT_REMESHED, failed) from error
    try:
        stage, configuration = restaged(old, here.configuration, meshes)
        gauge = control.gauge(stage.problem)
    except InputError as wrong:
        why = replace(refused(wrong), severity=Severity.REASON)
        raise PathEndError(Ending.NOT_REMESHED, why) from wrong
    there = Here(here.step, here.travel, configuration, None, None, here.speed)
    after = Walk(stage, gauge, walk.settings, walk.selection, solving=walk.solving)
    loads = [
        _load(own, Moment(at, at, distance / here.speed, 0.0))
        for own, at in ((walk, here.configuration), (after, configuration))
    ]
    volumes = [_volume(old, here), _volume(stage, there)]
    jumps = [now / before - 1 for before, now in (volumes, loads)]
    counts = ", ".join(f"{name} has {mesh.nelements} elements" for name, mesh in meshes.items())
    strains = transfer_text(old, here.configuration, stage, configuration, list(meshes))
    what = (
        f"{counts}; volume jumps by {jumps[0]:+.2e}, load by {jumps[1]:+.2e} (relative); {strains}"
    )
    log.enter(stage, gauge, NewMeshes(here.step + 1, here.configuration.nodes, dict(meshes)))
    log.event("remeshed", here.step + 1, here.travel, what)
    return after, there


def _load(walk: Walk, moment: Moment) -> float:
    """At a moment; NaN where there is none."""
    try:
        return walk.flow(moment)[0].load_factor
    except PathEndError as stop:
        if stop.ending is Ending.STOPPED:
            raise
        return float("nan")


def _require_apart(stage: Stage, there: Here) -> None:
    """Raise `PathEndError` where a corner of one body is inside another."""
    if not stage.pairs:
        return
    bodies = stage.plane_bodies_at(there.configuration)
    if (found := corner_inside(stage.pairs, bodies)) is not None:
        pair, depth, (x, y) = found
        place = Quantity((float(x), float(y)), "m", ".4g")
        values = {"depth": Quantity(float(depth), "m", ".3g"), "place": place}
        inside = Finding(Kind.CORNER_INSIDE, (pair.name,), values, Severity.DETAIL)
        raise PathEndError(Ending.PENETRATION, inside)


def _volume(stage: Stage, there: Here) -> float:
    """Of all bodies, m^3.

    Raises:
        PathEndError: they are no bodies any more: elements overlap.
    """
    try:
        now = stage.dofs_at(there.configuration)
    except InputError as wrong:
        raise PathEndError(Ending.OVERLAP, refused(wrong)) from wrong
    return sum(float(dofs.weights.sum()) for dofs in now.values())
