"""Sequential limit analysis: limit problems along a path of large deformation (T29-T31)."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from os import PathLike
from typing import Any

from lacore.contact.interfaces import Interface
from lacore.errors import InputError, require_count, require_known, require_positive, typed
from lacore.limit.engines import engine_for
from lacore.paths import drift
from lacore.paths.contact.overlap import corner_inside
from lacore.paths.control import Control, FootingTravel, driven_by, gauge_of, unit_of
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
from lacore.paths.schemes import SCHEMES, Here, PathEndError, Scheme, Stride, Walk, require_upright
from lacore.paths.selection import LeastNorm, require_selection
from lacore.paths.stage import Stage, staged
from lacore.paths.stored.checkpoint import Checkpoint, identity
from lacore.paths.tools.tool import Tool, tooling
from lacore.problem.problem import Problem


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
<<<HEAD
===
    tooled = tooling(problem, tools or {})
    if control is None:
        control = tooled.travel if tooled.moves else FootingTravel()
    drives = tooled.drives or driven_by(control, problem)
    if not isinstance(approaching, str):
        approaching = [*approaching, *tooled.interfaces]
    stage = staged(problem, approaching, drives, tooled.blocks)
>>>
