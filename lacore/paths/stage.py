"""A problem made ready for a path: curved meshes, names for all boundaries, plane obstacles.

Boundaries are selected once, where the bodies are at the beginning; whatever stands or presses
there goes with them.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, singledispatch
from types import MappingProxyType
from typing import Any

import numpy as np
from skfem import Mesh

from lacore.arrays import Floats, Ints
from lacore.assembly.bonds import ties
from lacore.bodies.any_body import numbered, of_kind
from lacore.bodies.continuum.body import Body
from lacore.bodies.continuum.boundaries import boundary_facets, facet_geometry, vertex_at
from lacore.bodies.continuum.dofs import BodyDofs
from lacore.bodies.continuum.regions.following import moving_along
from lacore.bodies.continuum.spaces import SPACES, VelocitySpace, isoparametric
from lacore.bodies.touching import TOUCH
from lacore.conditions.body_forces import BodyForce
from lacore.conditions.loads import Load, PointForce
from lacore.conditions.water import PorePressure, StandingWater
from lacore.conditions.where import Where
from lacore.contact.interfaces import Interface
from lacore.contact.obstacles import Obstacle, Plane, RigidObstacle
from lacore.errors import InputError
from lacore.meshes.curved import signed_jacobians
from lacore.paths.configuration import Configuration
from lacore.problem.problem import Problem
from lacore.showing import Compact

_STRAIGHT = 1e-9  # sine between edges of one plane


@dataclass(frozen=True, repr=False)
class Stage(Compact):
    """What does not change along a path.

    Attributes:
        problem: the first configuration; every `where` is a name, and all interfaces are bonds, of
            nodes that move as one.
        obstacles: of the interfaces, those that touch and those that bodies may come to.
        grips: nodes of the point forces, in their order among all reference, then dead loads.
        interfaces: those of the obstacles, planes all of them, by names of boundaries.
    """

    problem: Problem
    obstacles: tuple[Obstacle, ...]
    grips: tuple[int, ...]
    interfaces: tuple[Interface, ...]

    @property
    def bodies(self) -> dict[str, Body]:
        """The bodies where they are at the beginning."""
        return of_kind(self.problem.bodies, Body)

    @cached_property
    def catches(self) -> bool:
        """Whether a step can stop what dead loads alone collapse: by hardening, or at obstacles."""
        regions = [region for body in self.bodies.values() for region in body.regions]
        hardens = any(not region.form.surfaces for region in regions)
        return hardens or bool(self.obstacles)

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
        return Configuration(
            nodes={name: body.mesh.doflocs for name, body in self.bodies.items()},
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

    def dofs_at(self, configuration: Configuration) -> dict[str, BodyDofs]:
        """The unknowns of the bodies on a configuration, by name; see `at` for errors."""
        return numbered(self.bodies_at(configuration), BodyDofs.at)

    def at(self, configuration: Configuration) -> Problem:
        """The problem on a configuration.

        Raises:
            InputError: a mesh that is inverted or overlaps there.
        """
        bodies = self.bodies_at(configuration)
        grips = iter(self.grips)

        def gripped(load: Load) -> Load:
            if not isinstance(load, PointForce):
                return load
            x, y = configuration.nodes[load.body][:, next(grips)].tolist()
            return replace(load, at=(x, y))

        return replace(
            self.problem,
            bodies=bodies,
            reference_loads=[gripped(load) for load in self.problem.reference_loads],
            dead_loads=[gripped(load) for load in self.problem.dead_loads],
        )


@singledispatch
def _check_load(load: Load, field: str) -> None:
    """Refuse loads that do not go along with bodies as these deform."""


@_check_load.register(PorePressure)
@_check_load.register(StandingWater)
def _no_water(load: PorePressure | StandingWater, field: str) -> None:
    raise InputError(
        field,
        load.told,
        "water at rest has its surface where it is, and the vertices of a body that flows far leave"
        " it",
        "leave it out, or give Pressure along the boundary; `solve` takes it in the shape that is"
        " given",
    )


@_check_load.register(BodyForce)
def _uniform(load: BodyForce, field: str) -> None:
    if not load.uniform:
        raise InputError(
            field,
            load.told,
            "varies by place or by element, and the body moves and gets other meshes",
            "give a number for each region: BodyForce(body, (x, y), where=region)",
        )


def staged(problem: Problem, approaching: Sequence[Interface]) -> Stage:
    """A problem made ready for a path.

    Args:
        problem: its bodies deform; they get curved elements, of an isoparametric space.
        approaching: more interfaces with planes, which the bodies need not touch yet.

    Raises:
        InputError: bodies that do not deform, plane stress, contact of bodies that are not bonded
            edge by edge, obstacles that are no planes or dilate or are the same for one edge,
            bodies that begin behind one.
    """
    if not isinstance(approaching, Sequence) or isinstance(approaching, str):
        raise InputError("approaching", approaching, "not a list", "put it in [ ]")
    for index, interface in enumerate(approaching):
        if not isinstance(interface, Interface):
            raise InputError(
                f"approaching[{index}]", interface, "not an interface", "give lacore.Interface"
            )
    for field, load in problem.loads.items():
        _check_load(load, field)
    bodies = {name: _curved(name, body) for name, body in problem.bodies.items()}
    names = _Names({name: dict(body.mesh.boundaries or {}) for name, body in bodies.items()})

    def renamed(part: Any) -> Any:
        if part.boundary is None:
            return part
        kind = type(part).__name__
        return replace(part, where=names.of(bodies[part.body], part.body, part.where, kind))

    reference = [renamed(load) for load in problem.reference_loads]
    dead = [renamed(load) for load in problem.dead_loads]
    supports = [renamed(support) for support in problem.supports]
    bonds = [own for own in problem.interfaces if _ties(own)]
    interfaces = [*(own for own in problem.interfaces if not _ties(own)), *approaching]
    obstacles = tuple(_obstacle(interface, bodies, names) for interface in interfaces)
    sides = [
        [
            (name, names.of(bodies[name], name, where, "Interface.slave"))
            for name, where in own.sides
        ]
        for own in bonds
    ]
    for name, body in bodies.items():
        mesh = body.mesh.with_boundaries(names.known[name])
        bodies[name] = replace(body, mesh=mesh)
    grips = [
        vertex_at(bodies[load.body], load.point, "PointForce.at")
        for load in (*reference, *dead)
        if load.point is not None
    ]
    _check_once(obstacles, bodies)
    bonded = [
        Interface(one, other, own.law) for own, (one, other) in zip(bonds, sides, strict=True)
    ]
    ready = Problem(MappingProxyType(bodies), reference, supports, bonded, dead)
    _check_tied(ready)
    return Stage(
        problem=ready,
        obstacles=obstacles,
        grips=tuple(grips),
        interfaces=tuple(
            Interface(
                (own.body, own.where),
                RigidObstacle(shape=own.shape),
                interface.friction,
            )
            for own, interface in zip(obstacles, interfaces, strict=True)
        ),
    )


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
                "give both sides the same vertices: lacore.matching(problem)",
            )


def _check_once(obstacles: Sequence[Obstacle], bodies: Mapping[str, Body]) -> None:
    """No part of a boundary comes to one face twice, under two laws of friction."""
    for place, own in enumerate(obstacles):
        for other in obstacles[:place]:
            if own.body != other.body or not np.intersect1d(own.facets, other.facets).size:
                continue
            if not _same(own, other, bodies[own.body].mesh):
                continue
            raise InputError(
                "approaching",
                own.name,
                f"shares boundary edges and the plane with interface {other.name!r}",
                "give each part of a boundary one interface with a plane",
            )


def _same(own: Obstacle, other: Obstacle, mesh: Mesh) -> bool:
    """Whether two obstacles are one and the same face, seen from what they share."""
    places = mesh.p[:, np.unique(mesh.facets[:, np.intersect1d(own.facets, other.facets)])]
    first, second = own.shape.normal(places), other.shape.normal(places)
    turned = np.abs(first[0] * second[1] - first[1] * second[0]).max() > _STRAIGHT
    opposed = np.sum(first * second, axis=0).min() < 0
    apart = np.abs(own.shape.distance(places) - other.shape.distance(places)).max() > own.touch
    return not (turned or opposed or apart)


@dataclass
class _Names:
    """Boundaries by body and name; parts without one get one."""

    known: dict[str, dict[str, Ints]]

    def of(self, body: Body, owner: str, where: Where, kind: str) -> str:
        if isinstance(where, str):
            return where
        facets = boundary_facets(body, where, f"{kind}.where")
        name = f"part {len(self.known[owner])}"
        self.known[owner][name] = facets
        return name


def _curved(name: str, body: object) -> Body:
    if not isinstance(body, Body):
        raise InputError(
            f"Problem.bodies[{name!r}]",
            type(body).__name__,
            "a path follows bodies that deform",
            "give a lacore.Body; rigid tools are a RigidFooting or a RigidObstacle",
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


def _obstacle(interface: Interface, bodies: Mapping[str, Body], names: "_Names") -> Obstacle:
    name, where = interface.slave
    if name not in bodies:
        raise InputError("Interface.slave", name, "no such body", f"give one of {sorted(bodies)}")
    if interface.obstacle is None:
        raise InputError(
            "Interface.master",
            interface.name,
            "along a path bodies touch plane obstacles, and each other where they are bonded",
            "give a lacore.RigidObstacle(point=..., normal=...), or lacore.BOND",
        )
    if interface.bonded:
        raise InputError(
            "Interface.friction",
            interface.law,
            "along a path no obstacle is bonded: they are come to, and left",
            "hold the boundary by a Fix",
        )
    if interface.law.terms().tension > 0:
        raise InputError(
            "Interface.friction",
            interface.law,
            "what sticks in tension along a path is not followed: where it has opened it would hold"
            " what comes back",
            "leave the tension out",
        )
    if interface.law.terms().dilatancy > 0:
        raise InputError(
            "Interface.friction",
            interface.law,
            "sliding would lift the body off, and each other step would be without friction",
            "take lacore.Coulomb(mu), which slides along the obstacle",
        )
    body = bodies[name]
    facets = boundary_facets(body, where, "Interface.slave")
    found = Obstacle(
        name=interface.name,
        body=name,
        where=names.of(body, name, where, "Interface.slave"),
        facets=facets,
        shape=interface.face or _plane_along(interface, body, facets),
        law=interface.law.terms(),
        size=body.size,
    )
    mesh = body.mesh
    nodes = np.unique([*mesh.facets[:, facets].ravel(), *(mesh.nvertices + facets)])
    deepest = float(found.shape.distance(mesh.doflocs[:, nodes]).min())
    if deepest < -found.touch:
        raise InputError(
            "Interface.slave",
            interface.name,
            f"begins {-deepest:.3g} m behind its obstacle",
            "move the body or RigidObstacle.point, or turn RigidObstacle.normal around",
        )
    return found


def _plane_along(interface: Interface, body: Body, facets: Ints) -> Plane:
    """The plane of a straight boundary: an obstacle without one has the shape of the body."""
    start, _, outward = facet_geometry(body, facets)
    normal = -outward[:, 0]
    bent = np.abs(normal[0] * outward[1] - normal[1] * outward[0]).max() > _STRAIGHT
    places = body.mesh.doflocs[:, body.mesh.nvertices + facets]
    off = np.abs(normal @ (places - start[:, :1])).max() > TOUCH * body.size
    if bent or off:
        raise InputError(
            "Interface.master",
            interface.name,
            "the obstacle has the shape of a boundary that is not straight",
            "give RigidObstacle(point=(x, y), normal=(nx, ny)), or an interface for each plane",
        )
    return Plane.through(start[:, 0], normal)
