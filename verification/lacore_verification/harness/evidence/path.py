"""Serialisation of the last step of a path, so that its load can be proven again.

It needs the configuration on which that step was solved; the path is not repeated.
"""

import io
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from skfem import Mesh, MeshQuad2, MeshTri2

import lacore as la
from lacore.numerics.arrays import Floats
from lacore.paths.configuration import Configuration
from lacore.paths.contact.poses import placed
from lacore.paths.control import driven_by, gauge_of
from lacore.paths.flow import Moment, Snapshot, flow_of, limit_problem
from lacore.paths.stage import Stage, staged
from lacore.paths.tools.carrier import moved_shape
from lacore.paths.tools.tool import Tooling, tooling
from lacore_verification.case.following import Following
from lacore_verification.harness.evidence.limit_state import (
    Proof,
    packed,
    recheck,
    restored_on,
    unpacked,
)
from lacore_verification.runs.outcome import Evidence
from lacore_verification.runs.row import Row
from lacore_verification.runs.run import Run

_KINDS = {3: MeshTri2, 4: MeshQuad2}  # Keys are the number of corners of an element.

_PLACES = ("begin", "at")
_FIELDS = ("nodes", "strain")


def packed_step(
    state: la.LimitState, snapshot: Snapshot, later: Sequence[tuple[int, Stage]] = ()
) -> bytes:
    """Return the state of a step, and its limit problem; empty without a state.

    Args:
        state: of the last step.
        snapshot: after it.
        later: stages on new meshes, see `Path.later`.
    """
    moment = snapshot.moment
    if state.point is None or moment is None:
        return b""
    arrays: dict[str, Floats] = {
        f"{place}/{field}/{name}": values
        for place in _PLACES
        for field in _FIELDS
        for name, values in getattr(getattr(moment, place), field).items()
    }
    if later:
        arrays |= _packed_stage(later[-1][1])
    times = np.array([moment.duration, moment.share, snapshot.duration])
    return packed(state.point, times=times, **arrays)


def recheck_step(run: Run, row: Row, evidence: Evidence) -> Proof:
    """Return residuals of the stored state of a path, recomputed from the problem of its last step.

    Raises:
        ValueError: there is no state, or it is not one of this path.
    """
    stated = run.case.following_of(run.variant)
    stage = _stage(run, stated, evidence.arrays)
    moment, duration = _unpacked(evidence.arrays, list(stage.start.nodes))
    discretisation = limit_problem(stage, moment)
    point = unpacked(evidence.arrays)
    state = restored_on(discretisation, run, row, evidence)
    # The load factor of the row is that of the whole step.
    state = replace(state, load_factor=point.load_factor)
    load = flow_of(state, moment).lasting(duration).load_factor
    if stated.load == "force":
        load /= gauge_of(stated.control, stage.problem)(discretisation, point.velocity)
    return replace(recheck(discretisation, row, evidence), load_factor=load)


def last_shape(run: Run, evidence: Evidence) -> tuple[Stage, Configuration]:
    """Restore the bodies where the load of the last step of a path acts.

    Raises:
        ValueError: There is no state.
    """
    stage = _stage(run, run.case.following_of(run.variant), evidence.arrays)
    moment, _ = _unpacked(evidence.arrays, list(stage.start.nodes))
    return stage, moment.at


def _stage(run: Run, stated: Following, data: bytes) -> Stage:
    """Return the problem of a run, prepared for its path, on the meshes of its last step."""
    return restored_stage(stated, run.problem(), _arrays(data))


def _arrays(data: bytes) -> dict[str, Any]:
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            return dict(archive)
    except Exception as error:  # zip and value errors mean that the bytes have another format.
        raise ValueError(f"no step: {error}") from error


def _unpacked(data: bytes, bodies: list[str]) -> tuple[Moment, float]:
    """Return the moment of a step, and the duration of its load."""
    arrays = _arrays(data)
    try:
        begin, at = (
            Configuration(
                *({name: arrays[f"{place}/{field}/{name}"] for name in bodies} for field in _FIELDS)
            )
            for place in _PLACES
        )
        own, share, duration = map(float, arrays["times"])
    # zip, struct, key and value errors mean that the bytes have another format.
    except Exception as error:
        raise ValueError(f"no step: {error}") from error
    return Moment(begin, at, own, share), duration


def _packed_stage(stage: Stage) -> dict[str, Any]:
    """Pack the meshes of the deformable bodies of a stage, and the poses of its tools."""
    arrays: dict[str, Any] = {}
    for name, body in stage.bodies.items():
        arrays[f"mesh/{name}/nodes"] = body.mesh.doflocs
        arrays[f"mesh/{name}/cells"] = body.mesh.t
        for part, facets in (body.mesh.boundaries or {}).items():
            arrays[f"mesh/{name}/part/{part}"] = np.asarray(facets)
    for name, shape in stage.shapes_at(stage.start).items():
        arrays[f"tool/{name}"] = np.array([*stage.rigid[name].centroid[:, 0], shape.turn])
    return arrays


def restored_stage(stated: Following, problem: la.Problem, arrays: Mapping[str, Any]) -> Stage:
    """Return a problem prepared for its path, on the packed meshes if there are any.

    Args:
        stated: how it is followed; its interfaces name boundaries.
        problem: initial problem of the path.
        arrays: of the last step, see `packed_stage`.
    """
    problem = stated.problem(problem)
    tools = tooling(problem, stated.tools)
    drives = tools.drives or driven_by(stated.control, problem)
    bodies = dict(problem.bodies)
    for name, body in problem.bodies.items():
        if f"mesh/{name}/cells" in arrays:
            assert isinstance(body, la.Body)
            bodies[name] = replace(body, mesh=_mesh(f"mesh/{name}", arrays))
    return staged(
        replace(problem, bodies=bodies), stated.approaching, drives, _moved(tools, arrays)
    )


def _moved(tools: Tooling, arrays: Mapping[str, Any]) -> Tooling:
    """Return the tools at the packed poses, if there are any."""
    shapes, blocks = dict(tools.shapes), dict(tools.blocks)
    for name, block in tools.blocks.items():
        at = arrays.get(f"tool/{name}")
        if at is not None:
            shapes[name] = moved_shape(shapes[name], block.centroid, at[:, None])
            blocks[name] = placed(block, at[:, None])
    return replace(tools, shapes=shapes, blocks=blocks)


def _mesh(key: str, arrays: Mapping[str, Any]) -> Mesh:
    cells, first = arrays[f"{key}/cells"], f"{key}/part/"
    parts = {
        name.removeprefix(first): part for name, part in arrays.items() if name.startswith(first)
    }
    return _KINDS[len(cells)](arrays[f"{key}/nodes"], cells).with_boundaries(parts)
