"""Contact rows of equilibrium elements (T26b): tractions at the ends of facets.

Tractions are linear along a facet of a deformable body. It may touch an obstacle, the same facet of
another body, or rigid blocks, which receive the resultants on their part of it. Between rigid
blocks alone, the points of a joint are sufficient for statics.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix, vstack

from lacore.bounds.constants import MISSING, SAME_PLACE
from lacore.bounds.equilibrium import EquilibriumDofs
from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.blocks.dofs import RigidDofs
from lacore.model.bodies.continuum.boundaries import facet_geometry
from lacore.model.contact.interfaces import Interface
from lacore.model.contact.laws import laws_of
from lacore.model.contact.rows import ContactPoints, Station, interface_station, joined
from lacore.model.contact.segments import Segments
from lacore.numerics.arrays import Bools, Floats, Ints, Sparse
from lacore.program.kinematic import ContactRows
from lacore.reporting.errors import InputError

# Gauss rule on (0, 1), exact up to degree 3: a shape function times the velocity of a block.
_PLACES = (1 + np.array([-1, 1]) / np.sqrt(3)) / 2


def traction_rows(
    interfaces: Sequence[Interface],
    segments: Sequence[Segments],
    bodies: Mapping[str, EquilibriumDofs],
    rigid: Mapping[str, RigidDofs[BlockAssembly]],
    n: int,
) -> tuple[ContactRows, ContactPoints]:
    """Return the tractions at the ends of facets, linear between, so the convex law holds there."""
    stations = []
    for index, (interface, own) in enumerate(zip(interfaces, segments, strict=True)):
        if interface.bonded:
            continue
        if all(name in rigid for name, _ in interface.sides):
            stations.append(interface_station(interface, own, index, rigid, n))
        else:
            stations.append(traction_station(interface, own, index, bodies, rigid, n))
    return joined(stations, interfaces, rigid, n)


def traction_station(
    interface: Interface,
    segments: Segments,
    index: int,
    bodies: Mapping[str, EquilibriumDofs],
    rigid: Mapping[str, RigidDofs[BlockAssembly]],
    n: int,
) -> Station:
    """Return two points per facet of the deformable side, that of the slave if both are."""
    field = f"Problem.interfaces[{index}]"
    names = [name for name, _ in interface.sides]
    sides = list(zip(names, segments.edges, strict=False))
    turned = names[0] in rigid
    (name, touched), *others = sides[::-1] if turned else sides
    carrier = bodies[name]
    strength = min(bodies[name].strength for name in names if name in bodies)
    facets, facet = np.unique(touched, return_inverse=True)
    start, end, outward = facet_geometry(carrier.body.mesh, facets)
    nodes = carrier.facet_nodes(facets).ravel()
    x, y = selected(nodes, n)
    moving = np.stack([nodes, np.full_like(nodes, -1)])
    for name, edges in others:
        if name in rigid:
            other = rigid[name]
            parts = _Parts.of(start, end, facet, segments)
            allowed = MISSING * max(carrier.body.allowed, other.body.allowed)
            _check_covered(parts, interface, allowed, field)
            blocks = other.parts(edges)[parts.order]
            facing, moving[1] = parts.means(other, blocks, n), np.tile(blocks[parts.first], 2)
        else:
            whole = start[:, facet], end[:, facet]
            moving[1] = _matched(bodies[name], interface, edges, whole, field)
            facing_x, facing_y = selected(moving[1], n)
            facing = facing_x, facing_y
        x, y = csr_matrix(x - facing[0]), csr_matrix(y - facing[1])
    sign = -1.0 if turned else 1.0
    return Station(
        position=np.concatenate([start, end], axis=1).T,
        normal=-sign * np.tile(outward.T, (2, 1)),
        moving=(moving[::-1] if turned else moving).T,
        weights=np.tile(np.linalg.norm(end - start, axis=0) / 2, 2),
        interface=np.full(nodes.size, index),
        laws=laws_of(interface, strength, nodes.size),
        axes=(csr_matrix(sign * x), csr_matrix(sign * y)),
    )


def selected(nodes: Ints, n: int, dimension: int = 2) -> tuple[Sparse, ...]:
    """Return the rows of u_x, u_y (and u_z) of nodes of multipliers, each of shape (nodes, n)."""
    one, start = np.ones(nodes.size), np.arange(nodes.size + 1)
    return tuple(
        csr_matrix((one, dimension * nodes + axis, start), shape=(nodes.size, n))
        for axis in range(dimension)
    )


@dataclass(frozen=True)
class _Parts:
    """Segments as parts of f facets: by facet, and along each from 0 to 1.

    Attributes:
        order: numbers of the segments, shape (k,).
        facet: facet of each segment, ascending, shape (k,).
        first: place in `order` of the first one of each facet, shape (f,).
        low, high: their ends as shares of the facet, shape (k,).
        start, along: start and direction of the facets, shape (2, f).
    """

    order: Ints
    facet: Ints
    first: Ints
    low: Floats
    high: Floats
    start: Floats
    along: Floats

    @classmethod
    def of(cls, start: Floats, end: Floats, facet: Ints, segments: Segments) -> "_Parts":
        """Return the segments on the facets from `start` to `end`, by the facet number of each."""
        along = end - start
        shares = [
            np.sum((place - start[:, facet]) * along[:, facet], axis=0)
            / np.sum(along**2, axis=0)[facet]
            for place in (segments.start, segments.end)
        ]
        low, high = np.sort(shares, axis=0)
        order = np.lexsort((low, facet))
        _, first = np.unique(facet[order], return_index=True)
        return cls(order, facet[order], first, low[order], high[order], start, along)

    @property
    def holes(self) -> tuple[Ints, Floats, Floats]:
        """Uncovered parts: facets, begin and end as shares, shape (k + f,) each."""
        begin = np.append(0.0, self.high[:-1])
        begin[self.first] = 0.0
        last = self._last
        return (
            np.append(self.facet, self.facet[last]),
            np.append(begin, self.high[last]),
            np.append(self.low, np.ones(last.size)),
        )

    @property
    def _last(self) -> Ints:
        return np.append(self.first[1:], self.facet.size) - 1

    def means(self, dofs: RigidDofs[BlockAssembly], blocks: Ints, n: int) -> tuple[Sparse, Sparse]:
        """Return the rows of ``2/L int N_i u ds`` of blocks over the facets, starts first.

        (2 f, n).

        They give the power of tractions, linear along the facet, on rigid motions, so blocks and
        body receive the same resultants and moments. Uncovered parts are left out.
        """
        low = self.low.copy()
        low[self.first] = 0.0
        high = np.append(low[1:], 1.0)
        high[self._last] = 1.0
        count, segment = self.first.size, np.arange(blocks.size)
        total = [[csr_matrix((count, n)) for _ in range(2)] for _ in range(2)]  # axes, ends
        for place in _PLACES:
            share = low + place * (high - low)
            points = self.start[:, self.facet] + share * self.along[:, self.facet]
            rows = dofs.velocity_rows(blocks, points, n)
            for end, shape in enumerate((1 - share, share)):
                entries = (shape * (high - low), (self.facet, segment))
                weights = csr_matrix(entries, shape=(count, blocks.size))
                for axis in (0, 1):
                    total[axis][end] = csr_matrix(total[axis][end] + weights @ rows[axis])
        x, y = (csr_matrix(vstack(ends, format="csr")) for ends in total)
        return x, y


def _check_covered(parts: _Parts, interface: Interface, allowed: float, field: str) -> None:
    """Raise `InputError` where blocks touch only a part of a facet.

    Tractions that are linear along the facet and zero on the uncovered part would be zero.
    """
    facet, begin, end = parts.holes
    length = np.linalg.norm(parts.along, axis=0)[facet]
    for hole in np.flatnonzero((end - begin) * length > allowed)[:1]:
        share = begin[hole] if begin[hole] * length[hole] > allowed else end[hole]
        place = parts.start[:, facet[hole]] + share * parts.along[:, facet[hole]]
        raise InputError(
            field,
            interface.name,
            f"contact with rigid blocks ends at {place}, inside an edge of an element: tractions"
            " that are linear along all of the edge would be zero",
            "put a vertex of the mesh there",
        )


def _matched(
    master: EquilibriumDofs,
    interface: Interface,
    facets: Ints,
    slaves: tuple[Floats, Floats],
    field: str,
) -> Ints:
    """Return the nodes of the master at the starts, then at the ends of the slave's facets, (2 k,).

    Raises:
        InputError: facets of the two sides differ.
    """
    (start, end), (a, b, _) = slaves, facet_geometry(master.body.mesh, facets)
    near = SAME_PLACE * master.body.size

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
