"""Take the steps of a path one after the other, and make new meshes when they are needed."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from lacore.paths import drift
from lacore.paths.contact.folding import FOLDED, Fold, first_fold
from lacore.paths.contact.overlap import corner_inside
from lacore.paths.control import Control
from lacore.paths.ending import Ending, PathEndError, refused
from lacore.paths.flow import Moment, WarmStart
from lacore.paths.hooks.calling import Caller
from lacore.paths.hooks.hook import AFTER_REMESHING, AFTER_STEP, BEFORE_REMESHING, BEFORE_STEP
from lacore.paths.logbook import Log
from lacore.paths.pace import Pace
from lacore.paths.path import PathStep
from lacore.paths.renewal.inversion import require_upright
from lacore.paths.renewal.remeshing import (
    NewMeshes,
    Remesh,
    control_on_new_mesh,
    distorted,
    new_meshes,
    restaged,
    transfer_text,
)
from lacore.paths.schemes import FoldedError, Here, Scheme, StepSolver, Stride
from lacore.paths.selection import LeastNorm
from lacore.paths.stage import Stage
from lacore.paths.steady import Steady
from lacore.paths.stored.progress import Progress
from lacore.reporting.errors import InputError
from lacore.reporting.findings import Finding, Severity
from lacore.reporting.kinds import Kind
from lacore.reporting.text import Quantity, text

_AHEAD = 1e-5  # of a step, by which it ends before a body touches itself, so the mesh stays valid
_SHORTEST = 1e-9  # of a step: shorter parts of it are not tried


@dataclass(frozen=True)
class Plan:
    """How a path is followed; see `lacore.sequential` for the other fields.

    Attributes:
        scheme: Scheme of each step.
        save: Function that is called after each step with the path so far.
    """

    scheme: Scheme
    remesh: Remesh | None
    until: Steady | None
    save: Callable[[Progress], None]
    on_step: Callable[[PathStep], None]


def follow(
    solver: StepSolver, control: Control, here: Here, plan: Plan, pace: Pace, log: Log, call: Caller
) -> tuple[Ending, tuple[Finding, ...]]:
    """Take all steps of a path; return why it ends, and the findings about the end."""
    try:
        while (distance := pace.distance(here.travel)) > 0:
            if steady := _steady(plan.until, call):
                return Ending.STEADY, steady
            remesh = None if log.remeshed_before(here.step + 1) else plan.remesh
            poor = distorted(remesh, solver.stage, here.configuration)
            taken = None
            if not poor:
                call(BEFORE_STEP, here)
                taken = _taken(solver, plan.scheme, here, distance, pace, log, remesh)
            if taken is None and remesh is not None:
                moved = control_on_new_mesh(control, solver.stage, here.configuration)
                call(BEFORE_REMESHING, here)
                solver, here = _remeshed(solver, here, distance, remesh, poor, moved, log)
                control = moved
                call(AFTER_REMESHING, here)
            elif taken is not None:
                solver, here = taken
                plan.save(log.progress(here, pace.next))
                call(AFTER_STEP, here)
                plan.on_step(log.rows[-1])
    except PathEndError as stop:
        return stop.ending, stop.findings
    return drift.ending(log.events), ()


def _steady(until: Steady | None, call: Caller) -> tuple[Finding, ...]:
    """Return why the path so far counts as steady; empty where it does not."""
    if until is None:
        return ()
    found = call.so_far().steady(until)
    return found.findings if found.reached else ()


def _taken(
    solver: StepSolver,
    scheme: Scheme,
    here: Here,
    distance: float,
    pace: Pace,
    log: Log,
    remesh: Remesh | None,
) -> tuple[StepSolver, Here] | None:
    """Take a step; return None if it would invert an element and new meshes may follow."""
    try:
        return _step(solver, scheme, here, distance, pace, log)
    except PathEndError as stop:
        inverted = stop.ending is Ending.INVERSION
        if inverted:
            log.inversion(here, stop)
        if remesh is None or not inverted:
            raise
        return None


def _step(
    solver: StepSolver, scheme: Scheme, here: Here, distance: float, pace: Pace, log: Log
) -> tuple[StepSolver, Here]:
    """Take a step, with as many attempts as the pace requires.

    If bodies begin to drift, the step is repeated with a selected velocity.

    Returns:
        The solver of the next step, and the state after this one.
    """
    begin = time.perf_counter()
    for event in log.events:
        if event.kind == FOLDED and event.step == here.step:
            folded = Finding(Kind.EVENT, (), {"what": event.what}, Severity.DETAIL)
            raise PathEndError(Ending.FOLDED, folded)
    warm = WarmStart(here.velocity, solves=solver.require_safe(here, distance))
    stride, there, jacobian, fold = _whole_or_to_fold(solver, scheme, here, distance, pace, warm)
    if _report_drift(solver, stride, there, there.travel - here.travel, log):
        return _step(replace(solver, selection=LeastNorm()), scheme, here, distance, pace, log)
    distance = there.travel - here.travel
    pace.learn(distance, stride.error)
    volume = _volume(solver.stage, there)
    _require_apart(solver.stage, there)
    log.step(here, there, stride, jacobian, volume, time.perf_counter() - begin)
    if fold is not None:
        log.event(FOLDED, there.step, here.travel + fold.share * distance, text("{}", fold.finding))
    return solver, there


def _whole_or_to_fold(
    solver: StepSolver, scheme: Scheme, here: Here, distance: float, pace: Pace, warm: WarmStart
) -> tuple[Stride, Here, float, Fold | None]:
    """Return the step that the pace accepts, the state after it, and the fold that ends it.

    Inverted elements are checked before folds, because new meshes may follow. The third value is
    the least Jacobian, see `require_upright`.

    Args:
        solver: Solver of the step.
        scheme: Scheme of the path.
        here: State before the step.
        distance: Distance of the first attempt.
        pace: Pace of the path.
        warm: Warm start of the first attempt; each attempt returns that of the next one.

    Raises:
        PathEndError: The path ends before the step.
    """
    shortest = _SHORTEST * distance
    while True:
        try:
            stride = scheme(solver, here, distance, warm)
            warm = stride.warm
            if not pace.accepts(stride.error):
                distance = pace.shorter(distance, stride.error)
                continue
        except FoldedError as stop:
            if distance < shortest:
                raise
            warm = stop.warm
            distance *= stop.fold.share / (1 + _AHEAD / 2)
            continue
        moves = {name: stride.duration * v for name, v in stride.flow.velocity.items()}
        configuration = here.configuration.moved(moves, stride.strained)
        there = Here(
            step=here.step + 1,
            travel=here.travel + distance,
            configuration=configuration,
            velocity=stride.flow.velocity,
            strain_rate=stride.flow.strain_rate,
            speed=stride.speed,
            growth=1.0 if here.velocity is None else stride.speed / here.speed,
        )
        jacobian = require_upright(solver.stage, here.configuration, configuration)
        further = {name: (1 + _AHEAD) * moved for name, moved in moves.items()}
        beyond = here.configuration.moved(further, stride.strained)
        stage = solver.stage
        before, after = stage.meshes_at(here.configuration), stage.meshes_at(beyond)
        fold = first_fold(before, after, stage.pairs)
        if fold is not None:
            fold = replace(fold, share=(1 + _AHEAD) * fold.share)
        if fold is None or fold.share > 1 or distance < shortest:
            return stride, there, jacobian, fold
        distance *= fold.share / (1 + _AHEAD / 2)


def _report_drift(
    solver: StepSolver, stride: Stride, there: Here, distance: float, log: Log
) -> bool:
    """Record a drift of the bodies as an event; return whether to repeat the step.

    A drift is recorded once per path, and whenever no velocity can be selected.
    """
    selects, kinds = solver.selection is not None, {event.kind for event in log.events}
    if selects and stride.flow.selected is None:
        what = "the solver finds no admissible one: the velocity as solved is taken"
        log.event(drift.LOST, there.step, there.travel, what)
        return False
    if {drift.DRIFTS, drift.SELECTED} & kinds:
        return False
    checked = selects or drift.due(log.rows, stride.error, distance)
    if checked and (description := drift.described(stride.flow)):
        kind = drift.SELECTED if selects else drift.DRIFTS
        log.event(kind, there.step, there.travel, description)
        if not selects and (late := drift.too_late(log.last)):
            log.event(drift.LATE, there.step, there.travel, late)
        return not selects
    return False


def _remeshed(
    solver: StepSolver,
    here: Here,
    distance: float,
    remesh: Remesh,
    poor: Sequence[str],
    control: Control,
    log: Log,
) -> tuple[StepSolver, Here]:
    """Return the solver and the state on new meshes of the `poor` bodies, or of all if none is.

    Raises:
        PathEndError: The new meshes cannot be used.
    """
    old = solver.stage
    try:
        meshes = new_meshes(remesh, old, here.configuration, poor, control)
    except Exception as error:  # of users' code: the path so far must not be lost with it
        values = {"error": text("{}: {}", type(error).__name__, getattr(error, "text", error))}
        failed = Finding(Kind.REMESHING_FAILED, (), values, Severity.REASON)
        raise PathEndError(Ending.NOT_REMESHED, failed) from error
    try:
        stage, configuration = restaged(old, here.configuration, meshes)
        gauge = control.gauge(stage.problem)
    except InputError as wrong:
        raise PathEndError(Ending.NOT_REMESHED, refused(wrong, Severity.REASON)) from wrong
    there = Here(here.step, here.travel, configuration, None, None, here.speed)
    after = replace(solver, stage=stage, gauge=gauge)
    loads = [
        _load(own, Moment(at.configuration, at.configuration, distance / here.speed, 0.0), at)
        for own, at in ((solver, here), (after, there))
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


def _load(solver: StepSolver, moment: Moment, at: Here) -> float:
    """Return the load factor at a moment; NaN without a certified one."""
    try:
        return solver.flow(moment, WarmStart(at.velocity))[0].load_factor
    except PathEndError as stop:
        if stop.ending is Ending.STOPPED:
            raise
        return float("nan")


def _require_apart(stage: Stage, there: Here) -> None:
    """Raise `PathEndError` if a corner of one body is inside another one."""
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
    """Return the volume of all bodies, m^3.

    Raises:
        PathEndError: Elements overlap.
    """
    try:
        now = stage.dofs_at(there.configuration)
    except InputError as wrong:
        raise PathEndError(Ending.OVERLAP, refused(wrong)) from wrong
    return sum(float(dofs.weights.sum()) for dofs in now.values())
