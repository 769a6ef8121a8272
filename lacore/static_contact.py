"""Contact rows of equilibrium elements (T26b): tractions at the ends of facets."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix

from lacore.arrays import Bools, Floats, Ints, Sparse
from lacore.boundaries import facet_geometry
from lacore.contact_geometry import interface_segments
from lacore.contact_points import ContactPoints
from lacore.equilibrium import EquilibriumDofs
from lacore.errors import InputError
from lacore.interfaces import Interface, RigidObstacle
from lacore.program import ContactRows

_SAME_PLACE = 1e-9  # of the body size
_UNATTAINABLE = 100.0  # times the shear strength: no admissible stress reaches it


@dataclass(frozen=True)
class _Station:
    """Contact points of one interface: two a facet."""

    position: Floats
    normal: Floats
    weights: Floats
    sides: tuple[tuple[float, Ints], ...]  # sign and node of the velocities that make the jump
    terms: Floats  # coefficient, limit, dilatancy

    @property
    def moving(self) -> Ints:
        """See `ContactPoints`: each facet has nodes of its own."""
        slave, *master = (nodes for _, nodes in self.sides)
        return np.stack([slave, master[0] if master else np.full_like(slave, -1)], axis=1)


def traction_rows(
    interfaces: Sequence[Interface], bodies: Mapping[str, EquilibriumDofs], n: int
) -> tuple[ContactRows, ContactPoints]:
    """Tractions at the ends of facets: linear between, they obey the convex law there too."""
    stations = [
        _station(interface, bodies, f"Problem.interfaces[{index}]")
        for index, interface in enumerate(interfaces)
    ]
    position = np.concatenate([np.zeros((0, 2)), *(s.position for s in stations)])
    normal = np.concatenate([np.zeros((0, 2)), *(s.normal for s in stations)])
    count = [s.weights.size for s in stations]
    terms = np.concatenate(
        [
            np.zeros((0, 3)),
            *(np.tile(s.terms, (k, 1)) for s, k in zip(stations, count, strict=True)),
        ]
    )

    def along(direction: Floats) -> Sparse:
        rows, columns, values, first = [], [], [], 0
        for station in stations:
            own = first + np.arange(station.weights.size)
            for sign, nodes in station.sides:
                for axis in (0, 1):
                    rows.append(own)
                    columns.append(2 * nodes + axis)
                    values.append(sign * direction[own, axis])
            first += own.size
        empty = np.zeros(0)
        entries = np.concatenate([empty, *values])
        places = (
            np.concatenate([empty, *rows]).astype(np.int64),
            np.concatenate([empty, *columns]).astype(np.int64),
        )
        matrix = csr_matrix(coo_matrix((entries, places), shape=(direction.shape[0], n)))
        matrix.eliminate_zeros()
        return matrix

    rows = ContactRows(
        normal=along(normal),
        tangential=along(np.stack([-normal[:, 1], normal[:, 0]], axis=1)),
        tangent_dim=1,
        weights=np.concatenate([np.zeros(0), *(s.weights for s in stations)]),
        coefficient=terms[:, 0],
        limit=terms[:, 1],
        dilatancy=terms[:, 2],
        interface=np.repeat(np.arange(len(stations)), np.array(count, dtype=np.int64)),
    )
    none = np.zeros((0, 2), dtype=np.int64)
    moving = np.concatenate([none, *(s.moving for s in stations)])
    return rows, ContactPoints(position, normal, moving, tuple(i.name for i in interfaces))


def _station(interface: Interface, bodies: Mapping[str, EquilibriumDofs], field: str) -> _Station:
    geometry = {name: dofs.body for name, dofs in bodies.items()}
    segments = interface_segments(interface, geometry, field)
    slave = bodies[interface.slave[0]]
    start, end, outward = facet_geometry(slave.body, segments.slave)
    touching = [slave]
    sides: list[tuple[float, Ints]] = [(1.0, slave.facet_nodes(segments.slave).ravel())]
    if not isinstance(interface.master, RigidObstacle):
        master = bodies[interface.master[0]]
        touching.append(master)
        nodes = _matched(master, interface, segments.master, start, end, field)
        sides.append((-1.0, nodes))
    strength = min(dofs.body.criterion.k for dofs in touching)
    law = interface.law.terms()
    limit = law.limit if law.limit <= _UNATTAINABLE * strength else inf
    return _Station(
        position=np.concatenate([start, end], axis=1).T,
        normal=-np.tile(outward.T, (2, 1)),
        weights=np.tile(np.linalg.norm(end - start, axis=0) / 2, 2),
        sides=tuple(sides),
        terms=np.array([law.coefficient, limit, law.dilatancy]),
    )


def _matched(
    master: EquilibriumDofs,
    interface: Interface,
    facets: Ints,
    start: Floats,
    end: Floats,
    field: str,
) -> Ints:
    """Nodes of the master at the starts, then at the ends of the slave's facets, shape (2 k,).

    Raises:
        InputError: facets of both sides that are not the same.
    """
    a, b, _ = facet_geometry(master.body, facets)
    near = _SAME_PLACE * master.body.size

    def same(p: Floats, q: Floats) -> Bools:
        return np.asarray(np.linalg.norm(p - q, axis=0) <= near)

    straight, turned = same(start, a) & same(end, b), same(start, b) & same(end, a)
    if not np.all(straight | turned):
        raise InputError(
            field,
            interface.name,
            "the meshes of its two sides do not match, and tractions that are linear on both would"
            " have to be linear on the whole",
            "give both sides the same vertices",
        )
    nodes = master.facet_nodes(facets)
    return np.asarray(np.where(straight, nodes, nodes[::-1])).ravel()
