"""Polyhedra for tests: boxes, prisms, Voronoi cells of a box."""

from itertools import pairwise

import numpy as np
from scipy.spatial import Voronoi
from scipy.spatial.transform import Rotation

import lacore as la

BOX = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


def corners(low, high):
    (a, b, c), (d, e, f) = low, high
    ground = [(a, b), (d, b), (d, e), (a, e)]
    return np.array([(x, y, z) for z in (c, f) for x, y in ground], dtype=float)


def box(low, high):
    return la.Polyhedron(corners(low, high), BOX)


def prism(outline, height):
    """A prism over a polygon in z = 0."""
    k = len(outline)
    points = [(x, y, z) for z in (0, height) for x, y in outline]
    sides = [(i, (i + 1) % k, k + (i + 1) % k, k + i) for i in range(k)]
    return la.Polyhedron(points, [range(k)[::-1], range(k, 2 * k), *sides])


L_SHAPE = ((0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2))


def triangulated(block, turn=0):
    """The same block with faces cut into fans of triangles."""
    cut = []
    for face in block.faces:
        k = turn % len(face)
        first, *rest = (*face[k:], *face[:k])
        cut += [(first, a, b) for a, b in pairwise(rest)]
    return la.Polyhedron(block.vertices, cut)


def moved(block, turn=None, shift=(0, 0, 0), scale=1.0):
    own = Rotation.identity() if turn is None else turn
    return la.Polyhedron(scale * own.apply(block.vertices) + shift, block.faces)


def voronoi(number, seed):
    """Cells of random points of the unit cube, by name, and the facets that they share, by pair."""
    points = np.random.default_rng(seed).random((number, 3))
    mirrored = [
        np.where(np.arange(3) == axis, 2 * side - points, points)
        for axis in range(3)
        for side in (0, 1)
    ]
    cells = Voronoi(np.concatenate([points, *mirrored]))
    faces = {cell: [] for cell in range(number)}
    shared = {}
    for pair, ridge in zip(cells.ridge_points, cells.ridge_vertices, strict=True):
        for cell in pair[pair < number]:
            faces[int(cell)].append(ridge)
        if max(pair) < number:
            shared[tuple(sorted(map(str, pair)))] = cells.vertices[ridge]
    blocks = {}
    for cell, own in faces.items():
        used = np.unique(np.concatenate(own))
        numbered = [np.searchsorted(used, face).tolist() for face in own]
        blocks[str(cell)] = la.Polyhedron(cells.vertices[used], numbered)
    return blocks, shared
