"""Contact of two bodies along a path: control values of their jump where they face each other.

They are searched on the configuration at which the step is solved, whose normals count; the
distances are those of the same material points where the step begins. So ``gap + dt u_n >= 0``
holds at the end of the step, and errors of a step do not add up.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix, vstack
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from lacore.model.bodies.any_body import Dofs, PlaneBody
from lacore.model.contact.laws import laws_of
from lacore.numerics.arrays import Bools, Floats, Ints, Sparse
from lacore.paths.contact.meeting import SHARES, SLIVER, Meeting, meeting
from lacore.paths.contact.outlines import Outline, outline
from lacore.paths.contact.pairs import DEEP, Pair
from lacore.paths.contact.stations import Station

_THIN = 0.25  # of the shortest edge: sides of one body that overlap more enclose a part of it
_SMOOTH = np.cos(np.radians(15.0))  # edges that turn less against each other stand for one curve
# Gauss rule on (0, 1): exact up to degree 5, and where the length of a curved edge is smooth.
_PLACES, _WEIGHTS = (np.polynomial.legendre.leggauss(3)[0] + 1) / 2, np.array([5, 8, 5]) / 18


def outlines(pair: Pair, bodies: Mapping[str, PlaneBody]) -> tuple[Outline, Outline]:
    """Slave and master at one configuration."""
    return outline(pair.slave, bodies), outline(pair.master, bodies)


def facing(pair: Pair, sides: tuple[Outline, Outline], depth: float) -> Meeting:
    """The segments on which the sides of a pair face each other, see `meeting`.

    Args:
        pair: two sides; of one body, sides that overlap much have a part of the body in between.
        sides: their outlines.
        depth: see `meeting`.
    """
    if not pair.self_contact:
        return meeting(*sides, depth)
    shortest = min(float(own.lengths.min()) for own in sides)
    return meeting(*sides, min(depth, _THIN * shortest))


def pair_station(
    pair: Pair,
    dofs: Mapping[str, Dofs],
    begin: Mapping[str, PlaneBody],
    now: Mapping[str, PlaneBody],
    n: int,
) -> Station:
    """Contact points of a pair for n unknowns.

    Args:
        pair: two sides.
        dofs: of all bodies where the step is solved.
        begin: the bodies where the step begins.
        now: those where it is solved.
        n: unknowns.
    """
    first, here = outlines(pair, begin), outlines(pair, now)
    moved = [np.abs(b.curves.middle - a.curves.middle) for a, b in zip(first, here, strict=True)]
    depth = pair.near + 3 * max(float(own.max(initial=0.0)) for own in moved)
    depth = max(depth, DEEP * pair.size)  # at the end of a step nothing moves, and sides overlap
    found = facing(pair, here, depth)
    own = [dofs[side.body] for side in pair.sides]
    values = _control_values(found, found.on(*first, here), own, n)
    point = _points(values)
    total = np.bincount(point, values.weights)
    count, columns = total.size, np.arange(point.size)
    mean = csr_matrix((values.weights / total[point], (point, columns)), (count, point.size))
    normal = np.asarray(mean @ values.normals.T)
    gaps = np.asarray(mean @ values.gaps)
    gaps[np.abs(gaps) <= pair.near] = 0.0
    law = laws_of(pair.interface, min(one.strength for one in own), count)
    _, some = np.unique(point, return_index=True)
    edges = (found.slave.edges, found.master.edges)
    moving = [one.moving(one.parts(part)) for one, part in zip(own, edges, strict=True)]
    return Station(
        name=pair.name,
        bodies=(pair.slave.body, pair.master.body),
        places=np.asarray(mean @ values.places.T),
        normals=np.asarray(normal / np.linalg.norm(normal, axis=1, keepdims=True)),
        weights=total.astype(np.float64),
        gaps=gaps,
        laws=law,
        away=np.asarray(gaps > 0),
        x=csr_matrix(mean @ values.x),
        y=csr_matrix(mean @ values.y),
        moving=np.tile(np.stack(moving, axis=1), (len(SHARES), 1))[some],
    )


class _Values(NamedTuple):
    """Control values of k segments, those of starts, ends and middles one after the other.

    Attributes:
        places, normals: (2, 3 k).
        gaps: distances where the step begins, m, (3 k,).
        weights: (3 k,).
        middle: whether it is that of a middle, (3 k,).
        reach: within which ends are at one place: slivers are shorter, segments longer, m, (3 k,).
        x, y: rows of the jump, (3 k, n).
    """

    places: Floats
    normals: Floats
    gaps: Floats
    weights: Floats
    middle: Bools
    reach: Floats
    x: Sparse
    y: Sparse


def _control_values(found: Meeting, before: Meeting, dofs: list[Dofs], n: int) -> _Values:
    sides = list(zip(dofs, (found.slave.edges, found.master.edges), strict=True))
    jumps: list[list[Sparse]] = [[], []]
    for share in SHARES:
        one, other = (
            own.velocity_rows(own.parts(edges), places, n)
            for (own, edges), places in zip(sides, found.places(share), strict=True)
        )
        for axis in (0, 1):
            jumps[axis].append(csr_matrix(one[axis] - other[axis]))
    x, y = (csr_matrix(vstack([a, b, m * 2.0 - (a + b) * 0.5], format="csr")) for a, b, m in jumps)
    shortest = np.minimum(found.slave.lengths, found.master.lengths)
    return _Values(
        places=np.concatenate([sum(found.places(share)) / 2 for share in SHARES], axis=1),
        normals=np.concatenate([found.normal(share) for share in SHARES], axis=1),
        gaps=before.gaps().ravel(),
        weights=_lengths(found, sides).ravel(),
        middle=np.repeat([False, False, True], found.count),
        reach=np.tile(SLIVER * shortest, len(SHARES)),
        x=x,
        y=y,
    )


def _lengths(found: Meeting, sides: list[tuple[Dofs, Ints]]) -> Floats:
    """Integrals of the Bernstein functions of start, end and middle, mean of both sides, (3, k)."""
    weights = np.zeros((3, found.count))
    for s, share in zip(_PLACES, _WEIGHTS, strict=True):
        functions = [(1 - s) ** 2, s**2, 2 * s * (1 - s)]
        for (dofs, _), own, at, (a, b) in zip(
            sides,
            (found.slave, found.master),
            found.parameters(float(s)),
            found.ends,
            strict=True,
        ):
            length = np.linalg.norm(own.curves.tangent(at) * (b - a), axis=0)
            weights += share / 2 * np.outer(functions, length * dofs.thickness(own.at(at)))
    return weights


def _points(values: _Values) -> Ints:
    """The contact point of each control value, (3 k,).

    Ends of segments at one place are one point if their normals are nearly the same: those of edges
    that stand for one curve, on both sides of a vertex or of a sliver. Points stand for the means
    of their values, so that it does not matter which side is the slave.
    """
    ends = np.flatnonzero(~values.middle)
    tree = cKDTree(values.places[:, ends].T)
    near = np.array(list(tree.query_pairs(values.reach.max(initial=0.0))), dtype=np.int64)
    one, other = ends[near.reshape(-1, 2).T]
    apart = np.linalg.norm(values.places[:, one] - values.places[:, other], axis=0)
    same = apart <= np.minimum(values.reach[one], values.reach[other])
    same &= np.sum(values.normals[:, one] * values.normals[:, other], axis=0) > _SMOOTH
    one, other = one[same], other[same]
    size = values.middle.size
    graph = csr_matrix((np.ones(one.size), (one, other)), (size, size))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)
