"""Sequential limit analysis: limit problems along a path of large deformation (T29-T31)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from os import PathLike
from typing import Any

from lacore.coupling.kinds import COUPLINGS
from lacore.limit.backend_choice import backend_for
from lacore.model.contact.interfaces import Interface
from lacore.model.problem.problem import Problem
from lacore.paths import drift
from lacore.paths.control import (
    Control,
    FootingTravel,
    Gauge,
    ToolTravel,
    driven_by,
    gauge_of,
    unit_of,
)
from lacore.paths.flow import Moment, discretised
from lacore.paths.hooks.calling import Caller, GivenHook, known_hooks
from lacore.paths.logbook import Log
from lacore.paths.pace import AdaptiveSteps, Pace
from lacore.paths.path import Path, PathStep
from lacore.paths.renewal.mesher import Remeshing
from lacore.paths.renewal.remeshing import Remesh, again, described
from lacore.paths.schemes import SCHEMES, Here, StepSolver
from lacore.paths.selection import LeastNorm, require_selection
from lacore.paths.stage import Stage, staged
from lacore.paths.steady import Steady
from lacore.paths.stepping import Plan, follow
from lacore.paths.stored.checkpoint import Checkpoint, identity
from lacore.paths.stored.progress import Progress
from lacore.paths.tools.overlap import require_apart
from lacore.paths.tools.tool import Tool, Tooling, require_own_travel, tooling
from lacore.reporting.errors import (
    InputError,
    require_count,
    require_known,
    require_positive,
    typed,
)


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
    """Follow bodies through large deformation, with one limit problem per step (T29).

    Bodies move and harden, loads and footings act on the deformed boundaries, and contact opens
    and closes. Yang, Computers & Structures 33 (1989) 1171; Corradi & Panzeri, CMAME 193 (2004).

    Args:
        problem: Problem at the beginning. Its bodies are deformable, in plane strain or
            axisymmetric, or single rigid blocks. Bodies touch each other by interfaces with any law
            without dilation and tension; contact is searched in each step. Elements become curved,
            of the space ``p2-gauss`` (triangles) or ``q2`` (quadrilaterals), so that no load factor
            is a strict bound. `VonMises(hardening=...)` defines hardening. Criteria whose strength
            depends on pressure do not harden, and their volume grows with dilation.
        travel: Travel in units of the control, > 0.
        steps: Number of equal steps, or `AdaptiveSteps`.
        scheme: ``leapfrog`` (order 2, one solve per step), ``explicit`` (order 1, without hardening
            within a step), ``implicit-midpoint`` (order 2, iterated, preserves areas) or
            ``implicit-euler`` (order 1, iterated); T30.
        control: Quantity that the travel measures: `FootingTravel` (the default), `PointTravel`,
            `ToolTravel` of rigid blocks with given velocities, or `Time`. With moving `tools` the
            default is their travel.
        approaching: Interfaces that do not touch yet, or only in part: with obstacles, planes or
            shapes, of two bodies, or of two parts of the boundary of a body that folds. If two
            interfaces share a corner, the split of its reaction between them is arbitrary.
        selection: `LeastNorm` moves the bodies by the most regular of all velocities of nearly the
            same load, with one or two additional solves each time. By default only hardening
            selects a velocity, until an event ``velocity not unique`` reports that this is not
            enough (T32). From this step on, `LeastNorm` with its default is used.
        backend, coupling, tolerance, options: Settings of each solve, see `lacore.solve`. For soils
            with non-associated flow each load is certified, but others may exist;
            `lacore.soil_range(path.problem(step))` searches for them if nothing touches obstacles.
        keep_every: Interval of the snapshots to keep, in steps; the first and the last are kept.
        checkpoint: File (npz) that keeps the path after each step. A call with the same arguments
            continues from there, with identical results except for `PathStep.seconds`. Each step
            rewrites the file with all snapshots; `keep_every` reduces its size.
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
        InputError: An argument is invalid, bodies, contact or friction are not supported along a
            path, or a checkpoint is damaged, cannot be written or belongs to another path. The file
            is not changed.
        CapabilityError: The backend is missing, or does not support hardening.

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
    _check(travel, steps, scheme, keep_every, tolerance)
    engine, _, _ = backend_for(backend, coupling, options or {})
    _check_coupling(coupling)
    require_selection(selection, engine)
    given_hooks = known_hooks(hooks)
    tooled = tooling(problem, tools or {})
    control = _control(control, tooled)
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
    pace, log = Pace(steps, travel), Log(stage, gauge, keep_every, unit_of(control))
    with ExitStack() as opened:
        save, progress = _unsaved, None
        if checkpoint is not None:
            kept = opened.enter_context(Checkpoint(checkpoint, identity(stage, settings, said)))
            save, progress = kept.save, kept.load(stage.start)
        if progress is None:
            first = discretised(stage, Moment(stage.start, stage.start, 1.0, 0.0))
            here = Here(0, 0.0, stage.start, None, None, first.natural.velocity)
            log.begin(here)
        else:
            here = progress.here
            pace.resume(progress.step)
            stage, gauge, control = _resumed(progress, stage, gauge, control, log)
        call = Caller(given_hooks, log, settings, here)
        selects = drift.selection_after(log.events, selection)
        solver = StepSolver(stage, gauge, settings, selects, call.solving)
        plan = Plan(SCHEMES[scheme], remesh, until, save, on_step or (lambda row: None))
        return call.end(*follow(solver, control, here, plan, pace, log, call))


def _check(
    travel: float,
    steps: int | AdaptiveSteps,
    scheme: str,
    keep_every: int,
    tolerance: float | None,
) -> None:
    """Check what needs no problem."""
    require_positive("travel", travel)
    require_known("scheme", scheme, SCHEMES)
    if not isinstance(steps, AdaptiveSteps):
        require_count("steps", steps)
    require_count("keep_every", keep_every)
    if tolerance is not None:
        require_positive("tolerance", tolerance)


def _check_coupling(coupling: str | None) -> None:
    """Check a coupling that there is."""
    if coupling is not None and COUPLINGS[coupling].dilates:
        raise InputError(
            "coupling",
            coupling,
            "sliding would lift bodies off, and each other step would be without friction",
            "take 'certified'",
        )


def _control(control: Control | None, tooled: Tooling) -> Control:
    """Return the control of a path: by default that of its tools, or of the footing."""
    if tooled.moves and isinstance(control, ToolTravel):
        require_own_travel(control, tooled)
    if control is not None:
        return control
    return tooled.travel if tooled.moves else FootingTravel()


def _resumed(
    progress: Progress, stage: Stage, gauge: Gauge, control: Control, log: Log
) -> tuple[Stage, Gauge, Control]:
    """Return the stage, gauge and control of a path so far, on its last meshes."""
    log.resume(progress)
    for made in progress.made:
        stage, control = again(stage, control, made)
        gauge = control.gauge(stage.problem)
        log.enter(stage, gauge, made)
    return stage, gauge, control


def _unsaved(progress: Progress) -> None:
    """Keep nothing."""
