"""Where the two sides of an interface touch: geometry only, no unknowns."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from lacore.arrays import Floats, Ints
from lacore.blocks import BlockAssembly
from lacore.bodies import Body
from lacore.boundaries import Where, boundary_facets, facet_geometry, where_name
from lacore.errors import InputError
from lacore.interfaces import Interface, RigidObstacle
from lacore.touching import Edges, near_misses, touching

_TOUCH = 1e-9  # of the body size: coordinates written in double precision agree to this


@dataclass(frozen=True)
class Segments:
    """Straight parts along which one edge of the slave touches one of the master.

    Attributes:
        slave, master: facets of a continuum or outline edges of an assembly, shape (k,); an
            obstacle has the edges -1.
        start, end: shape (2, k).
        normal: unit vectors from the master into the slave, shape (2, k).
    """

    slave: Ints
    master: Ints
    start: Floats
    end: Floats
    normal: Floats


def boundary_edges(body: Body | BlockAssembly, where: Where, field: str) -> tuple[Ints, Edges]:
    """Numbers and geometry of a part of the boundary of a body."""
    if isinstance(body, BlockAssembly):
        edges = body.outline(where, field)
        every = body.edges
        return edges, Edges(every.start[:, edges], every.end[:, edges], every.normal[:, edges])
    facets = boundary_facets(body, where, field)
    return facets, Edges(*facet_geometry(body, facets))


def tolerance(body: Body | BlockAssembly) -> float:
    """Distance up to which coordinates count as one, m."""
    if isinstance(body, BlockAssembly):
        assert body.tolerance is not None  # since it was built
        return body.tolerance
    return _TOUCH * body.size


def interface_segments(
    interface: Interface, bodies: Mapping[str, Body | BlockAssembly], field: str
) -> Segments:
    """The segments of an interface.

    Raises:
        InputError: the two sides do not touch, or touch up to a small gap only.
    """
    slave = bodies[interface.slave[0]]
    numbers, edges = boundary_edges(slave, interface.slave[1], f"{field}.slave")
    if isinstance(interface.master, RigidObstacle):
        _check_obstacle(edges, interface, slave, field)
        nothing = np.full(numbers.size, -1)
        return Segments(numbers, nothing, edges.start, edges.end, -edges.normal)
    master = bodies[interface.master[0]]
    others, facing = boundary_edges(master, interface.master[1], f"{field}.master")
    allowed = max(tolerance(slave), tolerance(master))
    shared = touching(edges, facing, allowed)
    for gap in near_misses(edges, facing, allowed).gap[:1]:
        raise InputError(
            field,
            interface.name,
            f"its two sides are {gap:.3g} m apart",
            "move one body so that they touch",
        )
    if not shared.first.size:
        raise InputError(
            field,
            interface.name,
            f"does not touch {interface.master[0]}.{where_name(interface.master[1])}",
            "give two boundaries that lie on each other",
        )
    return Segments(
        slave=numbers[shared.first],
        master=others[shared.second],
        start=shared.start,
        end=shared.end,
        normal=-edges.normal[:, shared.first],
    )


def _check_obstacle(
    edges: Edges, interface: Interface, body: Body | BlockAssembly, field: str
) -> None:
    obstacle = interface.master
    assert isinstance(obstacle, RigidObstacle)
    if obstacle.point is None or obstacle.normal is None:
        return
    normal = np.array(obstacle.normal) / np.linalg.norm(obstacle.normal)
    point = np.reshape(obstacle.point, (2, 1))
    gap = np.concatenate([normal @ (x - point) for x in (edges.start, edges.end)])
    worst = gap[np.argmax(np.abs(gap))]
    if abs(worst) > tolerance(body):
        raise InputError(
            field,
            interface.name,
            f"does not touch its obstacle: a vertex lies {abs(worst):.3g} m "
            f"{'above' if worst > 0 else 'inside'} it",
            "move the body or RigidObstacle.point so that the two coincide",
        )
    if np.any(normal @ edges.normal > 0):
        raise InputError(
            field,
            obstacle.normal,
            "the obstacle's normal points out of the body",
            "give the normal from the obstacle into the body",
        )
