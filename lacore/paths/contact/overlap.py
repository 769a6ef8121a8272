"""Overlap of bodies with each other or with obstacles along a path, and edges that touch."""

from collections.abc import Mapping, Sequence

import numpy as np
import shapely

from lacore.model.bodies.any_body import PlaneBody, of_kind
from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.continuum.body import Body
from lacore.numerics.arrays import Floats, Geometries, Ints
from lacore.paths.contact.outlines import Outline
from lacore.paths.contact.pair_stations import facing, outlines
from lacore.paths.contact.pairs import DEEP, Pair

DEEPEST = 0.1  # of the size of the smaller body: how deep overlaps are looked for
_DRAWN = np.linspace(0.0, 1.0, 5)  # of an edge as a polyline

Touching = set[tuple[str, int]]
"""Edges that touch, by body and number."""


def overlap_and_touching(pair: Pair, bodies: Mapping[str, PlaneBody]) -> tuple[float, Touching]:
    """How deep the sides of a pair overlap, m, at least 0, and which edges of both touch."""
    found = facing(pair, outlines(pair, bodies), DEEPEST * pair.size)
    gaps = found.gaps()
    touching = (gaps <= pair.near).any(axis=0)
    edges = {
        (side.body, int(edge))
        for side, own in zip(pair.sides, (found.slave, found.master), strict=True)
        for edge in own.edges[touching]
    }
    return max(0.0, -float(gaps.min(initial=0.0))), edges


def corner_inside(
    pairs: Sequence[Pair], bodies: Mapping[str, PlaneBody]
) -> tuple[Pair, float, Floats] | None:
    """A pair with a corner of one body inside the other, how deep, m, and where; None of none."""
    solids = _solids(bodies)
    for pair in pairs:
        sides = outlines(pair, bodies)
        names = [side.body for side in pair.sides]
        for own, other, name in ((sides[0], sides[1], names[1]), (sides[1], sides[0], names[0])):
            places = np.concatenate([own.curves.start, own.curves.end], axis=1)
            vertex, element = _inside(places, solids[name])
            if pair.self_contact:  # the elements around a vertex are not the other side
                corners = shapely.get_coordinates(solids[name]).reshape(len(solids[name]), -1, 2)
                own_corner = (corners[element] == places.T[vertex, None]).all(axis=2).any(axis=1)
                vertex = vertex[~own_corner]
            depth, place = _deepest(places[:, np.unique(vertex)], other)
            bulge = np.linalg.norm(other.curves.bulge, axis=0).max(initial=0.0)
            if depth > DEEP * pair.size + bulge:
                return pair, depth, place
    return None


def _inside(places: Floats, solid: Geometries) -> Ints:
    """Pairs of a place and an element that contains it, (2, n)."""
    return np.asarray(shapely.STRtree(solid).query(shapely.points(places.T), "intersects"))


def _deepest(inside: Floats, other: Outline) -> tuple[float, Floats]:
    """How deep places inside a body, shape (2, n), are behind a side of it, and the deepest one."""
    if not inside.size:
        return 0.0, np.zeros(2)
    drawn = np.stack([other.curves.at(s).T for s in _DRAWN], axis=1)
    face = shapely.multilinestrings(shapely.linestrings(drawn))
    depths = shapely.distance(shapely.points(inside.T), face)
    worst = int(np.argmax(depths))
    return float(depths[worst]), inside[:, worst]


def _solids(bodies: Mapping[str, PlaneBody]) -> dict[str, Geometries]:
    """Polygons that bodies consist of, by name."""
    found = {}
    for name, body in of_kind(bodies, Body).items():
        corners = body.mesh.p[:, body.mesh.t]  # (2, corners, elements)
        found[name] = np.asarray(shapely.polygons(corners.transpose(2, 1, 0)))
    for name, block in of_kind(bodies, BlockAssembly).items():
        found[name] = np.array([shapely.Polygon(own) for own in block.polygons.values()])
    return found
