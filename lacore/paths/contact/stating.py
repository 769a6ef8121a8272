"""Interfaces of a path as they are given: obstacles, pairs of bodies, and what is refused."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from skfem import Mesh

from lacore.model.bodies.any_body import PlaneBody, of_kind
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.boundaries import boundary_facets, facet_geometry
from lacore.model.bodies.touching import TOUCH
from lacore.model.conditions.where import Where
from lacore.model.contact.interfaces import Interface
from lacore.model.contact.obstacles import Obstacle, Plane, Shape
from lacore.numerics.arrays import Ints
from lacore.paths.contact.meeting import SHARES
from lacore.paths.contact.overlap import DEEPEST, corner_inside
from lacore.paths.contact.pair_stations import facing, outlines
from lacore.paths.contact.pairs import Pair, Side, misfit
from lacore.paths.tools.overlap import overlapping
from lacore.reporting import terms
from lacore.reporting.errors import InputError
from lacore.reporting.text import Quantity, Term, text

_STRAIGHT = 1e-9  # sine between edges of one plane


@dataclass
class Names:
    """Boundaries by body and name; parts without one get one."""

    known: dict[str, dict[str, Ints]]

    def of(self, body: Body, owner: str, where: Where, kind: str) -> str:
        """The name of a part of a body, a new one where it has none."""
        if isinstance(where, str):
            return where
        facets = boundary_facets(body.mesh, where, f"{kind}.where")
        name = f"part {len(self.known[owner])}"
        self.known[owner][name] = facets
        return name


def check_law(interface: Interface) -> None:
    """Raise `InputError` for a law that a path does not follow."""
    if interface.bonded:
        raise InputError(
            "Interface.friction",
            interface.law,
            "an interface that may open and close along a path is not bonded",
            text(
                "hold the boundary by a {}, or bond bodies edge by edge in {}",
                terms.SUPPORT,
                Term("Problem.interfaces", "interfaces"),
            ),
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
            text("take {}, which slides along the surface", terms.COULOMB),
        )


def obstacle_of(
    interface: Interface,
    bodies: Mapping[str, Body],
    names: Names,
    tools: Mapping[str, Shape],
) -> Obstacle:
    """Return the obstacle of an interface, with the part of a body that may touch it.

    Args:
        interface: Interface of a body and an obstacle or a tool.
        bodies: Deformable bodies.
        names: Names of their boundaries.
        tools: Shapes of the tools.

    Raises:
        InputError: The body is unknown, the law is not supported along a path, or the body is
            behind its obstacle.
    """
    name, where = interface.slave
    if name not in bodies:
        raise InputError(
            "Interface.slave",
            name,
            "no deformable body, and along a path no other touches an obstacle",
            text("give one of {}, or hold the rigid block by a {}", sorted(bodies), terms.SUPPORT),
        )
    check_law(interface)
    body = bodies[name]
    facets = boundary_facets(body.mesh, where, "Interface.slave")
    tool = tool_of(interface, tools)
    found = Obstacle(
        name=interface.name,
        body=name,
        where=names.of(body, name, where, "Interface.slave"),
        facets=facets,
        shape=_shape(interface, body, facets) if tool is None else tools[tool],
        law=interface.law.terms(),
        size=body.size,
        carrier=tool,
    )
    mesh = body.mesh
    nodes = np.unique([*mesh.facets[:, facets].ravel(), *(mesh.nvertices + facets)])
    distance = found.shape.distance(mesh.doflocs[:, nodes])
    worst = int(np.argmin(distance))
    if distance[worst] < -found.touch:
        if tool is not None:
            x, y = mesh.doflocs[:, nodes[worst]].tolist()
            raise overlapping(tool, f"body {name!r}", -float(distance[worst]), (x, y))
        raise InputError(
            "Interface.slave",
            interface.name,
            text("begins {} behind its obstacle", Quantity(-distance[worst], "m", ".3g")),
            text(
                "move the body or {}, or turn {} around",
                terms.POINT_OF_PLANE,
                terms.NORMAL_OF_PLANE,
            ),
        )
    return found


def tool_of(interface: Interface, tools: Mapping[str, Shape]) -> str | None:
    """The tool that an interface has as its master; None of none."""
    name = interface.sides[-1][0]
    return name if name in tools else None


def _shape(interface: Interface, body: Body, facets: Ints) -> Shape:
    return interface.face or _plane_along(interface, body, facets)


def _plane_along(interface: Interface, body: Body, facets: Ints) -> Plane:
    """The plane of a straight boundary: an obstacle without one has the shape of the body."""
    start, _, outward = facet_geometry(body.mesh, facets)
    normal = -outward[:, 0]
    bent = np.abs(normal[0] * outward[1] - normal[1] * outward[0]).max() > _STRAIGHT
    places = body.mesh.doflocs[:, body.mesh.nvertices + facets]
    off = np.abs(normal @ (places - start[:, :1])).max() > TOUCH * body.size
    if bent or off:
        raise InputError(
            "Interface.master",
            interface.name,
            "the obstacle has the shape of a boundary that is not straight",
            text("give {}, or an interface for each plane", terms.PLANE),
        )
    return Plane.through(start[:, 0], normal)


def pair_of(
    interface: Interface,
    bodies: Mapping[str, PlaneBody],
    names: Names,
    field: str,
    depth: float = TOUCH,
) -> Pair:
    """Return the pair of two bodies that may touch.

    Args:
        interface: Interface of two bodies, or of two parts of one.
        bodies: All bodies.
        names: Names of the boundaries of deformable bodies.
        field: Field of the interface, for errors.
        depth: Largest overlap of the sides, relative to the size of the larger body.

    Raises:
        InputError: A body or boundary is unknown, the law is not supported along a path, or the
            bodies overlap at the beginning of the path.
    """
    check_law(interface)
    deforming = of_kind(bodies, Body)
    sides: list[Side] = []
    given: list[tuple[str, Where]] = []
    for which, (name, where) in zip(("slave", "master"), interface.sides, strict=True):
        if name not in bodies:
            raise InputError(
                f"Interface.{which}", name, "no such body", f"give one of {sorted(bodies)}"
            )
        side = Side.of(name, bodies[name], where, f"{field}.{which}")
        if name in deforming:
            given.append((name, names.of(deforming[name], name, where, f"Interface.{which}")))
        else:
            given.append((name, where))
        sides.append(side)
    one, other = sides
    if interface.self_contact:
        _check_parts(one, other, field, bodies)
    pair = Pair(
        interface=Interface(given[0], given[1], interface.law),
        slave=one,
        master=other,
        size=min(bodies[side.body].size for side in (one, other)),
        misfit=max(misfit(bodies[side.body], side.edges) for side in (one, other)),
    )
    found = facing(pair, outlines(pair, bodies), DEEPEST * pair.size)
    gaps = found.gaps()
    allowed = max(pair.near, *(depth * bodies[side.body].size for side in pair.sides))
    if gaps.min(initial=0.0) < -allowed:
        deepest = np.unravel_index(int(np.argmin(gaps)), gaps.shape)
        x, y = found.places(SHARES[deepest[0]])[0][:, deepest[1]].tolist()
        raise InputError(
            field,
            interface.name,
            text(
                "its two sides overlap by {} near {}",
                Quantity(-gaps.min(), "m", ".3g"),
                Quantity((x, y), "m", ".4g"),
            ),
            "move one of the bodies so that they touch or are apart",
        )
    if (inside := corner_inside([pair], bodies)) is not None:
        _, depth, (x, y) = inside
        raise InputError(
            field,
            interface.name,
            text(
                "a corner of one body is {} inside the other near {}",
                Quantity(depth, "m", ".3g"),
                Quantity((x, y), "m", ".4g"),
            ),
            "move one of the bodies so that they touch or are apart",
        )
    return pair


def _check_parts(one: Side, other: Side, field: str, bodies: Mapping[str, PlaneBody]) -> None:
    """Raise `InputError` for parts of one body that cannot be in contact."""
    if not bodies[one.body].deforms:
        raise InputError(
            f"{field}.master", one.body, "a rigid block does not touch itself", "give another body"
        )
    if shared := np.intersect1d(one.edges, other.edges).size:
        raise InputError(
            f"{field}.master",
            one.body,
            f"both parts of its boundary contain the same {shared} edges",
            "give the two parts that meet as boundaries without common edges",
        )


def check_once(obstacles: Sequence[Obstacle], bodies: Mapping[str, Body]) -> None:
    """Require that no part of a boundary can touch one face under two laws of friction."""
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
