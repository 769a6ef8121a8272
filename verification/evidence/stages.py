"""The last meshes of a path and where its tools are, as arrays, and back."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from skfem import Mesh, MeshQuad2, MeshTri2

import lacore as la
from lacore.paths.contact.poses import placed
from lacore.paths.control import driven_by
from lacore.paths.stage import Stage, staged
from lacore.paths.tools.carrier import moved_shape
from lacore.paths.tools.tool import Tooling, tooling
from verification.case.following import Following

_KINDS = {3: MeshTri2, 4: MeshQuad2}  # by the number of corners of an element


def packed_stage(stage: Stage) -> dict[str, Any]:
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
    """Make a problem ready for its path, on the meshes that were packed, if there are any.

    Args:
        stated: how it is followed; its interfaces name boundaries.
        problem: where the path begins.
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
    """Tools at the poses that were packed, if there are any."""
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
