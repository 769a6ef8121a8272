"""A problem made ready for a path: curved meshes, names for all boundaries, contact.

Boundaries are selected once, where the bodies are at the beginning; whatever stands or presses
there goes with them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np
from skfem import Mesh

from lacore.arrays import Floats, Ints
from lacore.assembly.bonds import ties
from lacore.bodies.any_body import PlaneBody, numbered, of_kind
from lacore.bodies.blocks.block_assembly import BlockAssembly
from lacore.bodies.continuum.body import Body
from lacore.bodies.continuum.boundaries import vertex_at
from lacore.bodies.continuum.dofs import BodyDofs
from lacore.bodies.continuum.regions.following import moving_along
from lacore.bodies.continuum.spaces import SPACES, VelocitySpace, isoparametric
from lacore.bodies.touching import TOUCH
from lacore.conditions.loads import Load, PointForce
from lacore.contact.interfaces import Interface
from lacore.contact.obstacles import Obstacle, RigidObstacle
from lacore.errors import InputError
from lacore.meshes.curved import signed_jacobians
from lacore.paths.configuration import Configuration
from lacore.paths.contact.folding_body import FoldingBody
from lacore.paths.contact.pairs import Pair
from lacore.paths.contact.poses import carried_along, placed, pose, require_single
from lacore.paths.contact.stating import Names, check_once, obstacle_of, pair_of, tool_of
from lacore.paths.loads import check_load, of_block
from lacore.paths.tools.carrier import PART, MovedShape, moved_shape
from lacore.paths.tools.contact import driving
from lacore.paths.tools.tool import NO_TOOLS, Tooling
from lacore.problem.problem import Problem
from lacore.reporting import terms
from lacore.reporting.text import Term, text
from lacore.showing import Compact


@dataclass(frozen=True, repr=False)
class ProblemOnPath(Problem):
    """A problem whose bodies may meet others along a path, in contact that it does not state.

    Attributes:
        meets: edges of the bodies that may touch others, by body.
        drives: motions of the tools that move together, see `Problem.driven`.
    """

    meets: Mapping[str, Ints] = field(default_factory=dict)
    drives: Mapping[str, Floats] = field(default_factory=dict)

    @property
    def met(self) -> Mapping[str, Ints]:
        """See `Problem.met`."""
        return self.meets

    @property
    def driven(self) -> Mapping[str, Floats]:
        """See `Problem.driven`."""
        return self.drives


@dataclass(frozen=True, repr=False)
class Stage(Compact):
    """What does not change along a path.

    Attributes:
        problem: the first configuration; every `where` is a name, and all interfaces are bonds, of
            nodes that move as one.
        obstacles: of the interfaces, those that touch and those that bodies may come to.
        pairs: of bodies that touch, or may come to do so.
        grips: nodes of the point forces, in their order among all reference, then dead loads; -1 of
            those on rigid blocks.
        interfaces: those of the obstacles, then of the pairs, by names of boundaries.
    """

    problem: Problem
    obstacles: tuple[Obstacle, ...]
    pairs: tuple[Pair, ...]
    grips: tuple[int, ...]
    interfaces: tuple[Interface, ...]

    @property
    def bodies(self) -> dict[str, Body]:
        """The deformable bodies where they are at the beginning."""
        return of_kind(self.problem.bodies, Body)

    @property
    def rigid(self) -> dict[str, BlockAssembly]:
        """The rigid blocks where they are at the beginning."""
        return of_kind(self.problem.bodies, BlockAssembly)

    @property
    def drawn(self) -> list[str]:
        """Names of the rigid blocks whose polygons are their outlines: not those of tools."""
        return [name for name in self.rigid if name not in self.tools]

    @property
    def tools(self) -> list[str]:
        """Names of the tools of an exact shape."""
        return list(dict.fromkeys(own.carrier for own in self.obstacles if own.carrier))

    @cached_property
    def catches(self) -> bool:
        """Whether a step can stop what dead loads alone collapse: by hardening, or by contact."""
        regions = [region for body in self.bodies.values() for region in body.regions]
        hardens = any(not region.form.surfaces for region in regions)
        return hardens or bool(self.interfaces)

    @cached_property
    def turns(self) -> dict[str, Floats]:
        """+1 of elements that turn anticlockwise at the beginning, else -1, by body."""
        return {
            name: np.sign(signed_jacobians(body.mesh).sum(axis=1))
            for name, body in self.bodies.items()
        }

    @property
    def start(self) -> Configuration:
        """The first configuration: nothing has strained."""
        shapes = {
            name: (body.mesh.nelements, SPACES[body.space].points.shape[1])
            for name, body in self.bodies.items()
        }
        shapes |= dict.fromkeys(self.rigid, (1, 1))
        nodes = {name: body.mesh.doflocs for name, body in self.bodies.items()}
        return Configuration(
            nodes=nodes | {name: pose(body) for name, body in self.rigid.items()},
            strain={name: np.zeros(shape) for name, shape in shapes.items()},
        )

    def meshes_at(self, configuration: Configuration) -> dict[str, Mesh]:
        """The meshes on a configuration, by body, whatever they look like."""
        return {
            name: replace(body.mesh, doflocs=configuration.nodes[name])
            for name, body in self.bodies.items()
        }

    def bodies_at(self, configuration: Configuration) -> dict[str, Body]:
        """The bodies on a configuration, by name; see `at` for errors."""
        meshes = self.meshes_at(configuration)
        return {name: replace(body, mesh=meshes[name]) for name, body in self.bodies.items()}

    def plane_bodies_at(self, configuration: Configuration) -> dict[str, PlaneBody]:
        """All bodies on a configuration, rigid blocks too; see `at` for errors."""
        return {**self.bodies_at(configuration), **self.blocks_at(configuration)}

    def blocks_at(self, configuration: Configuration) -> dict[str, BlockAssembly]:
        """The rigid blocks on a configuration, by name."""
        return {name: placed(body, configuration.nodes[name]) for name, body in self.rigid.items()}

    def obstacles_at(self, configuration: Configuration) -> tuple[Obstacle, ...]:
        """The obstacles on a configuration: those that tools carry have moved."""
        shapes = self.shapes_at(configuration)
        return tuple(
            own if own.carrier is None else replace(own, shape=shapes[own.carrier])
            for own in self.obstacles
        )

    def shapes_at(self, configuration: Configuration) -> dict[str, MovedShape]:
        """The shapes of the tools on a configuration, by name."""
        places, blocks = configuration.nodes, self.rigid
        return {
            own.carrier: moved_shape(own.shape, blocks[own.carrier].centroid, places[own.carrier])
            for own in self.obstacles
            if own.carrier
        }

    def dofs_at(self, configuration: Configuration) -> dict[str, BodyDofs]:
        """The unknowns of the bodies on a configuration, by name; see `at` for errors."""
        return numbered(self.bodies_at(configuration), BodyDofs.at)

    def at(self, configuration: Configuration) -> Problem:
        """The problem on a configuration.

        Raises:
            InputError: a mesh that is inverted or overlaps there.
        """
        bodies = self.plane_bodies_at(configuration)
        grips = iter(self.grips)

        def gripped(load: Load) -> Load:
            if not isinstance(load, PointForce) or load.point is None:
                return load
            nodes, grip = configuration.nodes[load.body], next(grips)
            if grip < 0:
                point = np.reshape(load.point, (2, 1))
                place = carried_along(self.rigid[load.body], nodes, point)[:, 0]
            else:
                place = nodes[:, grip]
            x, y = place.tolist()
            return replace(load, at=(x, y))

        motions = self.problem.driven
        driven = driving(
            self.blocks_at(configuration), {n: motions[n] for n in self.tools if n in motions}
        )
        reference: Sequence[Load] = driven or [
            gripped(load) for load in self.problem.reference_loads
        ]
        return replace(
            self.problem,
            bodies=bodies,
            reference_loads=reference,
            dead_loads=[gripped(load) for load in self.problem.dead_loads],
        )


def staged(
    problem: Problem,
    approaching: Sequence[Interface],
    drives: Mapping[str, Floats] | None = None,
    tools: Tooling = NO_TOOLS,
    depth: float = TOUCH,
) -> Stage:
    """A problem made ready for a path.

    Args:
        problem: bodies that deform, which get curved elements, of an isoparametric space, and
            single rigid blocks.
        approaching: more interfaces, whose sides need not touch yet.
        drives: motions of the tools that move together, see `Problem.driven`; None of none.
        tools: of an exact shape.
        depth: up to which bodies may overlap, of the size of the larger one.

    Raises:
        InputError: frames, bodies in space, plane stress, several blocks in one assembly, bonds of
            edges that do not match, contact that dilates or holds in tension, two obstacles of one
            face for one edge, bodies that begin behind an obstacle or in each other.
    """
    if not isinstance(approaching, Sequence) or isinstance(approaching, str):
        raise InputError("approaching", approaching, "not a list", "put it in [ ]")
    for index, interface in enumerate(approaching):
        if not isinstance(interface, Interface):
            raise InputError(
                f"approaching[{index}]", interface, "not an interface", "give lacore.Interface"
            )
    for place, load in problem.loads.items():
        check_load(load, place)
    rigid = of_kind(problem.bodies, BlockAssembly) | dict(tools.blocks)
    for name, block in rigid.items():
        require_single(name, block)
    bodies = {n: _curved(n, body) for n, body in problem.bodies.items() if n not in rigid}
    for own in approaching:
        if own.self_contact and (name := own.slave[0]) in bodies:
            bodies[name] = FoldingBody.of(bodies[name])
    names = Names({name: dict(body.mesh.boundaries or {}) for name, body in bodies.items()})

    def renamed(part: Any) -> Any:
        if part.boundary is None:
            return part
        kind = type(part).__name__
        if part.body in rigid:
            return of_block(part, kind)
        return replace(part, where=names.of(bodies[part.body], part.body, part.where, kind))

    motions = drives or {}
    driven = driving(rigid, {n: own for n, own in motions.items() if n in tools.shapes})
    reference = [] if driven else [renamed(load) for load in problem.reference_loads]
    dead = [renamed(load) for load in problem.dead_loads]
    supports = [renamed(support) for support in problem.supports]
    bonds = [own for own in problem.interfaces if _ties(own)]
    fields = {
        f"Problem.interfaces[{index}]": own
        for index, own in enumerate(problem.interfaces)
        if not _ties(own)
    } | {f"approaching[{index}]": own for index, own in enumerate(approaching)}
    fields |= {f"tools: {index}, {own.name}": own for index, own in enumerate(tools.interfaces)}
    facing = [
        own
        for own in fields.values()
        if own.obstacle is not None or tool_of(own, tools.shapes) is not None
    ]
    obstacles = tuple(obstacle_of(interface, bodies, names, tools.shapes) for interface in facing)
    pairs = tuple(
        pair_of(interface, {**bodies, **rigid}, names, where, depth)
        for where, interface in fields.items()
        if interface not in facing
    )
    sides = [
        [(name, _bonded(bodies, names, name, where)) for name, where in own.sides] for own in bonds
    ]
    for name, body in bodies.items():
        mesh = body.mesh.with_boundaries(names.known[name])
        bodies[name] = replace(body, mesh=mesh)
    grips = [
        -1 if load.body in rigid else vertex_at(bodies[load.body], load.point, "PointForce.at")
        for load in (*reference, *dead)
        if load.point is not None
    ]
    check_once(obstacles, bodies)
    bonded = [
        Interface(one, other, own.law) for own, (one, other) in zip(bonds, sides, strict=True)
    ]
    parts = [(side.body, side.edges) for pair in pairs for side in pair.sides]
    parts += [(own.body, own.facets) for own in obstacles]
    parts += [(name, np.arange(rigid[name].edges.block.size)) for name in tools.shapes]
    meets: dict[str, Ints] = {}
    for name, edges in parts:
        meets[name] = np.union1d(meets.get(name, edges), edges)
    every: dict[str, PlaneBody] = {**bodies, **rigid}
    ready = ProblemOnPath(
        MappingProxyType(every), driven or reference, supports, bonded, dead, meets, motions
    )
    _check_tied(ready)
    return Stage(
        problem=ready,
        obstacles=obstacles,
        pairs=pairs,
        grips=tuple(grips),
        interfaces=(
            *(
                Interface(
                    (own.body, own.where),
                    (own.carrier, PART) if own.carrier else RigidObstacle(shape=own.shape),
                    one.friction,
                )
                for own, one in zip(obstacles, facing, strict=True)
            ),
            *(pair.interface for pair in pairs),
        ),
    )


def _bonded(bodies: Mapping[str, Body], names: Names, name: str, where: Any) -> str:
    """The boundary of a side that is bonded."""
    if name not in bodies:
        raise InputError(
            "Interface.friction",
            "BOND",
            f"along a path bodies that deform are bonded, and {name!r} is rigid",
            text("give a friction, {} for one that does not slip", terms.STICK),
        )
    return names.of(bodies[name], name, where, "Interface.slave")


def _ties(interface: Interface) -> bool:
    return interface.bonded and interface.obstacle is None


def _check_tied(problem: Problem) -> None:
    """Bonds of edges that match, so that no velocity jumps, and nothing parts as bodies deform."""
    tied = ties(problem, numbered(of_kind(problem.bodies, Body), BodyDofs.at)).tied
    for index, interface in enumerate(problem.interfaces):
        if not tied[index].all():
            raise InputError(
                f"Problem.interfaces[{index}]",
                interface.name,
                "edges of its two sides do not match, and along a path what is bonded moves as one",
                text("give both sides the same vertices{}", Term(": lacore.matching(problem)", "")),
            )


def _curved(name: str, body: object) -> Body:
    if not isinstance(body, Body):
        raise InputError(
            f"Problem.bodies[{name!r}]",
            type(body).__name__,
            "a path follows deformable bodies and single rigid blocks in the plane",
            text("give a {} or a {}", terms.CONTINUUM, terms.RIGID_BLOCK),
        )
    if body.kinematics not in ("plane_strain", "axisymmetric"):
        raise InputError(
            f"Problem.bodies[{name!r}].kinematics",
            body.kinematics,
            "no path follows tetrahedra, or a thickness that changes from point to point",
            "take 'plane_strain' or 'axisymmetric'",
        )
    for region in body.regions:
        if region.criterion.law is not None and region.form.surfaces:
            part = f"[{region.name!r}]" if region.name else ""
            raise InputError(
                f"Problem.bodies[{name!r}].criterion{part}.law",
                region.criterion.law,
                "strength that depends on pressure does not harden along a path",
                "let it be None",
            )
    space = isoparametric(body.mesh, body.space)
    return moving_along(replace(body, mesh=_quadratic(body.mesh, space), space=space.name))


def _quadratic(mesh: Mesh, space: VelocitySpace) -> Mesh:
    assert space.curved is not None  # it is isoparametric
    if isinstance(mesh, space.curved):
        return mesh
    curved = space.curved.from_mesh(mesh)
    assert np.array_equal(curved.facets, mesh.facets)
    curved = curved.with_boundaries({n: np.asarray(f) for n, f in (mesh.boundaries or {}).items()})
    regions = {n: np.asarray(own) for n, own in (mesh.subdomains or {}).items()}
    return curved.with_subdomains(regions) if regions else curved
