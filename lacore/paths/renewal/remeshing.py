"""Make new meshes for the bodies of a path, which continues on them (T31)."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from skfem import Mesh, MeshQuad, MeshTri

from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.boundaries import vertex_at
from lacore.model.bodies.continuum.spaces import isoparametric
from lacore.model.contact.obstacles import Obstacle
from lacore.model.meshes.curved import is_curved
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats
from lacore.paths.configuration import Configuration
from lacore.paths.contact.pairs import DEEP
from lacore.paths.control import Control, PointTravel
from lacore.paths.renewal.mesher import Point, Remeshing
from lacore.paths.renewal.transfer import transfer_errors, transferred
from lacore.paths.stage import Stage, staged
from lacore.paths.tools.tool import Tooling
from lacore.reporting.errors import InputError, require_known

Remesh = Callable[[Problem], Mapping[str, Mesh]]
"""New meshes by body, of bodies where they are now; those without one keep theirs.

A new mesh has the boundary names of the one before, and vertices where point forces act and where
the control point is.
"""


@dataclass(frozen=True)
class NewMeshes:
    """What a stage is made anew from.

    Attributes:
        step: the first that is taken on them.
        nodes: where the bodies were, on the meshes before, shape (2, nodes) by body.
        meshes: new ones by body.
    """

    step: int
    nodes: Mapping[str, Floats]
    meshes: Mapping[str, Mesh]


def distorted(remesh: Remesh | None, stage: Stage, configuration: Configuration) -> list[str]:
    """Names of the bodies that need new meshes before the next step, see `Remeshing`."""
    if not isinstance(remesh, Remeshing):
        return []
    before = {name: body.mesh for name, body in stage.bodies.items()}
    return remesh.distorted(before, stage.meshes_at(configuration))


def new_meshes(
    remesh: Remesh,
    stage: Stage,
    configuration: Configuration,
    bodies: Sequence[str],
    control: Control,
) -> Mapping[str, Mesh]:
    """New meshes by a function, or automatic ones; of all bodies where `bodies` is empty.

    Args:
        remesh: of the path.
        stage, configuration: where the bodies are.
        bodies: names of those that need new meshes.
        control: of the path, with its point where it is now.
    """
    now = stage.at(configuration)
    if not isinstance(remesh, Remeshing):
        return remesh(now)
    keep = _contact_ends(stage, configuration)
    if isinstance(control, PointTravel):
        keep.setdefault(control.body, []).append(control.at)
    return remesh(now, bodies, keep)


def _contact_ends(stage: Stage, configuration: Configuration) -> dict[str, list[Point]]:
    """Vertices at the ends of the contact with obstacles, by body.

    An edge between vertices on both sides of such an end would leave the obstacle or cut into it.
    """
    ends: dict[str, list[Point]] = {}
    dofs = stage.dofs_at(configuration)
    for obstacle in stage.obstacles_at(configuration):
        own = dofs[obstacle.body]
        start, middle, end = own.facet_nodes(obstacle.facets)
        near = np.abs(obstacle.shape.distance(own.nodes)) <= obstacle.near
        control = 2 * own.nodes[:, middle] - (own.nodes[:, start] + own.nodes[:, end]) / 2
        whole = near[start] & near[end] & (obstacle.shape.distance(control) <= obstacle.near)
        apart = np.union1d(start[~whole], end[~whole])
        places = own.nodes[:, apart[near[apart]]].T.tolist()
        ends.setdefault(obstacle.body, []).extend((x, y) for x, y in places)
    return ends


def restaged(
    stage: Stage, configuration: Configuration, meshes: Mapping[str, Mesh]
) -> tuple[Stage, Configuration]:
    """The stage on new meshes, and the configuration there: strains are transferred.

    Raises:
        InputError: meshes of no body, without names that the old ones have, or that no body can
            have; vertices that are missing; bodies that begin behind an obstacle.
    """
    if not isinstance(meshes, Mapping) or not meshes:
        raise InputError("remesh", meshes, "returned no meshes", "return {'body': mesh}")
    now = stage.at(configuration)
    deforming = of_kind(now.bodies, Body)
    bodies = dict(now.bodies)
    for name, mesh in meshes.items():
        require_known("remesh", name, deforming)
        bodies[name] = _on(name, deforming[name], mesh, stage.obstacles_at(configuration))
    tools = Tooling(stage.shapes_at(configuration))
    renewed = replace(now, bodies=bodies)
    # Other vertices on curved sides that touch make them overlap; the next step closes that.
    new = staged(renewed, stage.interfaces, stage.problem.driven, tools, DEEP)
    start = new.start
    before, after = stage.dofs_at(configuration), new.dofs_at(start)
    strain = {
        name: transferred(before[name], own, after[name]) if name in meshes else own
        for name, own in configuration.strain.items()
    }
    return new, Configuration(start.nodes, strain)


def _on(name: str, body: Body, mesh: Mesh, obstacles: tuple[Obstacle, ...]) -> Body:
    """A body on a new mesh."""
    if not isinstance(mesh, MeshTri | MeshQuad):
        raise InputError(
            "remesh", type(mesh).__name__, f"not a mesh of {name!r}", "return skfem meshes"
        )
    if not all(region.form.uniform for region in body.regions):
        raise InputError(
            "remesh",
            name,
            "its criterion has a strength of each element, and knows those of the old mesh",
            "leave remesh out, or take a criterion that is the same everywhere",
        )
    missing = sorted(set(body.mesh.boundaries or {}) - set(mesh.boundaries or {}))
    if missing:
        raise InputError(
            "remesh",
            missing,
            f"names of boundaries that the new mesh of {name!r} lacks",
            "name them by mesh.with_boundaries",
        )
    places = mesh.doflocs.copy()
    for obstacle in obstacles:
        if obstacle.body == name:
            edges = np.asarray(mesh.boundaries[obstacle.where], dtype=np.int64)
            nodes = np.unique(mesh.facets[:, edges])
            distance = obstacle.shape.distance(places[:, nodes])
            near = np.abs(distance) <= obstacle.near
            normal = obstacle.shape.normal(places[:, nodes])
            places[:, nodes[near]] -= (normal * distance)[:, near]
            if is_curved(mesh):
                middle = mesh.nvertices + edges
                chord = places[:, mesh.facets[:, edges]].mean(axis=1)
                control = 2 * places[:, middle] - chord
                depth = -obstacle.shape.distance(control)
                normal = obstacle.shape.normal(control)
                touching = (depth > 0) & (depth <= obstacle.near)
                places[:, middle[touching]] += (normal * depth / 2)[:, touching]
                behind = depth > obstacle.near  # it would bulge into the obstacle
                places[:, middle[behind]] = chord[:, behind]
    space = isoparametric(mesh, body.space)
    return replace(body, mesh=replace(mesh, doflocs=places), space=space.name)


def transfer_text(
    old: Stage, before: Configuration, new: Stage, after: Configuration, names: Sequence[str]
) -> str:
    """What the transfer of strains has changed, for an event: the worst of the bodies."""
    was, now = old.dofs_at(before), new.dofs_at(after)
    errors = [
        transfer_errors(was[name], before.strain[name], now[name], after.strain[name])
        for name in names
    ]
    jump = max((own for own, _ in errors), key=abs)
    apart = max(own for _, own in errors)
    integral = f"integral of strain jumps by {jump:+.2e} (relative)"
    return f"{integral}, strains differ by up to {apart:.2e}"


def control_on_new_mesh(control: Control, stage: Stage, configuration: Configuration) -> Control:
    """Return a control for new meshes, whose point is at its present place."""
    if not isinstance(control, PointTravel):
        return control
    node = vertex_at(stage.bodies[control.body].mesh, control.at, "PointTravel.at")
    x, y = configuration.nodes[control.body][:, node].tolist()
    return replace(control, at=(x, y))


def again(stage: Stage, control: Control, made: NewMeshes) -> tuple[Stage, Control]:
    """Return the stage and the control on new meshes of an earlier run."""
    at = Configuration(made.nodes, stage.start.strain)
    return restaged(stage, at, made.meshes)[0], control_on_new_mesh(control, stage, at)


def described(remesh: Remesh | None) -> object:
    """Return data that identify a way of remeshing in a checkpoint; a function has its name."""
    if isinstance(remesh, Remeshing) and remesh.mesher is not None:
        return [remesh.quality, described(remesh.mesher)]
    if remesh is None or isinstance(remesh, Remeshing):
        return remesh
    name = getattr(remesh, "__qualname__", type(remesh).__qualname__)
    module: str = getattr(remesh, "__module__", type(remesh).__module__)
    return f"{module.replace('lacore.model.', 'lacore.')}.{name}"  # as in checkpoints of 0.4
