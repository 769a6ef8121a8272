"""Prepare a problem for a path: curved meshes, names for all boundaries, and contact.

Boundaries are selected once, on the bodies at the beginning. Supports, loads and contact then move
with these boundaries.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from types import MappingProxyType
from typing import Any

import numpy as np
from skfem import Mesh

from lacore.assembly.bonds import ties
from lacore.model.bodies.any_body import PlaneBody, numbered, of_kind
from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.boundaries import vertex_at
from lacore.model.bodies.continuum.dofs import BodyDofs
from lacore.model.bodies.continuum.spaces import SPACES
from lacore.model.bodies.touching import TOUCH
from lacore.model.conditions.loads import Load, PointForce
from lacore.model.contact.interfaces import Interface
from lacore.model.contact.obstacles import Obstacle, RigidObstacle
from lacore.model.meshes.curved import signed_jacobians
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats, Ints
from lacore.paths.configuration import Configuration
from lacore.paths.contact.folding_body import FoldingBody
from lacore.paths.contact.pairs import Pair
from lacore.paths.contact.poses import carried_along, placed, pose, require_single
from lacore.paths.contact.stating import Names, check_once, obstacle_of, pair_of, tool_of
from lacore.paths.parts import check_load, curved_body, of_block
from lacore.paths.tools.carrier import PART, MovedShape, moved_shape
from lacore.paths.tools.contact import driving
from lacore.paths.tools.tool import NO_TOOLS, Tooling
from lacore.reporting import terms
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact
from lacore.reporting.text import Term, text


@dataclass(frozen=True, repr=False)
class ProblemOnPath(Problem):
    """A problem whose bodies may touch others along a path, in contact that its interfaces omit.

    Attributes:
        meets: Edges of the bodies that may touch others, by body.
        drives: Motions of the tools that move together, see `Problem.driven`.
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
    """The problem on one set of meshes.

    Attributes:
        problem: Problem on the first configuration of these meshes. Every `where` is a name, and
            all interfaces are bonds, whose nodes move as one.
        obstacles: Obstacles of the interfaces, whether bodies touch them or may reach them.
        pairs: Pairs of bodies that touch or may touch.
        grips: Nodes of the point forces, in their order among the reference loads and then the
            dead loads; -1 for forces on rigid blocks.
        interfaces: Interfaces of the obstacles, then of the pairs, by names of boundaries.
    """

    problem: Problem
    obstacles: tuple[Obstacle, ...]
    pairs: tuple[Pair, ...]
    grips: tuple[int, ...]
    interfaces: tuple[Interface, ...]

    @cached_property
    def bodies(self) -> dict[str, Body]:
        """The deformable bodies on the first configuration."""
        return of_kind(self.problem.bodies, Body)

    @cached_property
    def rigid(self) -> dict[str, BlockAssembly]:
        """The rigid blocks on the first configuration."""
        return of_kind(self.problem.bodies, BlockAssembly)

    @property
    def drawn(self) -> list[str]:
        """Names of the rigid blocks whose polygons are their outlines, which excludes tools."""
        return [name for name in self.rigid if name not in self.tools]

    @property
    def tools(self) -> list[str]:
        """Names of the tools of an exact shape."""
        return list(dict.fromkeys(own.carrier for own in self.obstacles if own.carrier))

    @cached_property
    def catches(self) -> bool:
        """Whether hardening or contact can stop a collapse under dead loads within a step."""
        regions = [region for body in self.bodies.values() for region in body.regions]
        hardens = any(not region.form.surfaces for region in regions)
        return hardens or bool(self.interfaces)

    @cached_property
    def turns(self) -> dict[str, Floats]:
        """Orientation of the elements, by body: +1 for anticlockwise nodes, else -1."""
        return {
            name: np.sign(signed_jacobians(body.mesh).sum(axis=1))
            for name, body in self.bodies.items()
        }

    @property
    def start(self) -> Configuration:
        """The first configuration, without strain."""
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
        """Return the meshes on a configuration, by body, even if they are invalid."""
        return {
            name: replace(body.mesh, doflocs=configuration.nodes[name])
            for name, body in self.bodies.items()
        }

    def bodies_at(self, configuration: Configuration) -> dict[str, Body]:
        """Return the deformable bodies on a configuration, by name; see `at` for errors."""
        meshes = self.meshes_at(configuration)
        return {name: replace(body, mesh=meshes[name]) for name, body in self.bodies.items()}

    def plane_bodies_at(self, configuration: Configuration) -> dict[str, PlaneBody]:
        """Return all bodies on a configuration, including rigid blocks; see `at` for errors."""
        return {**self.bodies_at(configuration), **self.blocks_at(configuration)}

    def blocks_at(self, configuration: Configuration) -> dict[str, BlockAssembly]:
        """Return the rigid blocks on a configuration, by name."""
        return {name: placed(body, configuration.nodes[name]) for name, body in self.rigid.items()}

    def obstacles_at(self, configuration: Configuration) -> tuple[Obstacle, ...]:
        """Return the obstacles on a configuration, moved with the tools that carry them."""
        shapes = self.shapes_at(configuration)
        return tuple(
            own if own.carrier is None else replace(own, shape=shapes[own.carrier])
            for own in self.obstacles
        )

    def shapes_at(self, configuration: Configuration) -> dict[str, MovedShape]:
        """Return the shapes of the tools on a configuration, by name."""
        places, blocks = configuration.nodes, self.rigid
        return {
            own.carrier: moved_shape(own.shape, blocks[own.carrier].centroid, places[own.carrier])
            for own in self.obstacles
            if own.carrier
        }

    def dofs_at(self, configuration: Configuration) -> dict[str, BodyDofs]:
        """Return the unknowns of the bodies on a configuration, by name; see `at` for errors."""
        return numbered(self.bodies_at(configuration), BodyDofs.at)

    def at(self, configuration: Configuration) -> Problem:
        """Return the problem on a configuration.

        Raises:
            InputError: A mesh is inverted or overlaps there.
        """
        return self.with_bodies(self.plane_bodies_at(configuration), configuration)

    def with_bodies(self, bodies: Mapping[str, PlaneBody], configuration: Configuration) -> Problem:
        """Return the problem with its bodies on a configuration, as `plane_bodies_at` has them."""
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

        driven = driving(self.blocks_at(configuration), self.problem.driven, self.tools)
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
    """Prepare a problem for a path.

    Args:
        problem: Problem with deformable bodies, which get curved elements of an isoparametric
            space, and with single rigid blocks.
        approaching: Additional interfaces, whose sides need not touch yet.
        drives: Motions of the tools that move together, see `Problem.driven`; None without any.
        tools: Tools of an exact shape.
        depth: Largest overlap of two bodies, relative to the size of the larger one.

    Raises:
        InputError: The problem contains frames, three-dimensional bodies, plane stress, several
            blocks in one assembly, bonds of edges that do not match, contact with dilation or
            tension, two obstacles with one face for the same edge, bodies behind an obstacle, or
            bodies that overlap.
    """
    _check_stated(problem, approaching)
    rigid = of_kind(problem.bodies, BlockAssembly) | dict(tools.blocks)
    for name, block in rigid.items():
        require_single(name, block)
    bodies = _deformable(problem, rigid, approaching)
    names = Names({name: dict(body.mesh.boundaries or {}) for name, body in bodies.items()})
    named = partial(_named, rigid=rigid, bodies=bodies, names=names)
    motions = drives or {}
    driven = driving(rigid, motions, tools.shapes)
    reference = [] if driven else list(map(named, problem.reference_loads))
    dead = list(map(named, problem.dead_loads))
    supports = list(map(named, problem.supports))
    facing, meeting = _contacts(problem, approaching, tools)
    obstacles = tuple(obstacle_of(own, bodies, names, tools.shapes) for own in facing)
    every: dict[str, PlaneBody] = {**bodies, **rigid}
    pairs = tuple(pair_of(own, every, names, where, depth) for where, own in meeting.items())
    bonds = [_bond(own, bodies, names) for own in problem.interfaces if _ties(own)]
    for name, body in bodies.items():
        every[name] = replace(body, mesh=body.mesh.with_boundaries(names.known[name]))
    grips = _grips([*reference, *dead], bodies)
    check_once(obstacles, bodies)
    meets = _meets(obstacles, pairs, {name: rigid[name] for name in tools.shapes})
    ready = ProblemOnPath(
        MappingProxyType(every), driven or reference, supports, bonds, dead, meets, motions
    )
    _check_tied(ready)
    return Stage(
        problem=ready,
        obstacles=obstacles,
        pairs=pairs,
        grips=grips,
        interfaces=(
            *map(_of_obstacle, obstacles, facing),
            *(pair.interface for pair in pairs),
        ),
    )


def _check_stated(problem: Problem, approaching: Sequence[Interface]) -> None:
    """Require a list of interfaces, and loads that a path can follow."""
    if not isinstance(approaching, Sequence) or isinstance(approaching, str):
        raise InputError("approaching", approaching, "not a list", "put it in [ ]")
    for index, interface in enumerate(approaching):
        if not isinstance(interface, Interface):
            raise InputError(
                f"approaching[{index}]", interface, "not an interface", "give lacore.Interface"
            )
    for place, load in problem.loads.items():
        check_load(load, place)


def _deformable(
    problem: Problem, rigid: Mapping[str, BlockAssembly], approaching: Sequence[Interface]
) -> dict[str, Body]:
    """Return the bodies with curved elements, those in contact with themselves as such."""
    bodies = {n: curved_body(n, body) for n, body in problem.bodies.items() if n not in rigid}
    folding = {own.slave[0] for own in approaching if own.self_contact}
    return bodies | {n: FoldingBody.of(own) for n, own in bodies.items() if n in folding}


def _named(
    part: Any, rigid: Mapping[str, BlockAssembly], bodies: Mapping[str, Body], names: Names
) -> Any:
    """Return a load or support whose boundary has a name."""
    if part.boundary is None:
        return part
    kind = type(part).__name__
    if part.body in rigid:
        return of_block(part, kind)
    return replace(part, where=names.of(bodies[part.body], part.body, part.where, kind))


def _contacts(
    problem: Problem, approaching: Sequence[Interface], tools: Tooling
) -> tuple[list[Interface], dict[str, Interface]]:
    """Return the interfaces with an obstacle or a tool, and those of two bodies by their fields."""
    fields = {
        **{
            f"Problem.interfaces[{n}]": own
            for n, own in enumerate(problem.interfaces)
            if not _ties(own)
        },
        **{f"approaching[{n}]": own for n, own in enumerate(approaching)},
        **{f"tools: {n}, {own.name}": own for n, own in enumerate(tools.interfaces)},
    }
    facing = {
        where: own
        for where, own in fields.items()
        if own.obstacle is not None or tool_of(own, tools.shapes) is not None
    }
    meeting = {where: own for where, own in fields.items() if where not in facing}
    return list(facing.values()), meeting


def _grips(loads: Sequence[Load], bodies: Mapping[str, Body]) -> tuple[int, ...]:
    """Return the node of each point force, -1 for those on rigid blocks."""
    return tuple(
        vertex_at(bodies[load.body].mesh, load.point, "PointForce.at")
        if load.body in bodies
        else -1
        for load in loads
        if load.point is not None
    )


def _meets(
    obstacles: Sequence[Obstacle], pairs: Sequence[Pair], tools: Mapping[str, BlockAssembly]
) -> dict[str, Ints]:
    """Return the edges of each body that may touch others."""
    parts = [(side.body, side.edges) for pair in pairs for side in pair.sides]
    parts += [(own.body, own.facets) for own in obstacles]
    parts += [(name, np.arange(block.edges.block.size)) for name, block in tools.items()]
    meets: dict[str, Ints] = {}
    for name, edges in parts:
        meets[name] = np.union1d(meets.get(name, edges), edges)
    return meets


def _of_obstacle(obstacle: Obstacle, interface: Interface) -> Interface:
    """Return an interface with an obstacle or a tool whose side is a name."""
    carrier, slave = obstacle.carrier, (obstacle.body, obstacle.where)
    master = (carrier, PART) if carrier else RigidObstacle(shape=obstacle.shape)
    return Interface(slave, master, interface.friction)


def _bond(interface: Interface, bodies: Mapping[str, Body], names: Names) -> Interface:
    """Return a bond whose two sides are names."""
    one, other = (_bonded(bodies, names, name, where) for name, where in interface.sides)
    return Interface((interface.sides[0][0], one), (interface.sides[1][0], other), interface.law)


def _bonded(bodies: Mapping[str, Body], names: Names, name: str, where: Any) -> str:
    """Return the name of the boundary of a bonded side."""
    if name not in bodies:
        raise InputError(
            "Interface.friction",
            "BOND",
            f"along a path only deformable bodies can be bonded, and {name!r} is rigid",
            text("give a friction, {} for one that does not slip", terms.STICK),
        )
    return names.of(bodies[name], name, where, "Interface.slave")


def _ties(interface: Interface) -> bool:
    """Whether an interface bonds two bodies."""
    return interface.bonded and interface.obstacle is None


def _check_tied(problem: Problem) -> None:
    """Require that the edges of bonds match, so that velocities are continuous across them."""
    tied = ties(problem, numbered(of_kind(problem.bodies, Body), BodyDofs.at)).tied
    for index, interface in enumerate(problem.interfaces):
        if not tied[index].all():
            raise InputError(
                f"Problem.interfaces[{index}]",
                interface.name,
                "edges of its two sides do not match, and along a path what is bonded moves as one",
                text("give both sides the same vertices{}", Term(": lacore.matching(problem)", "")),
            )
