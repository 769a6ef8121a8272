"""Test whether flat faces replace a curved surface, by a label or the shape of a mesh."""

from typing import Any

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from lacore.model.meshes.polygonal import geometry_of, label_of
from lacore.numerics.arrays import Floats, Ints

_PLANE = 4.5e-5  # rad: faces in one plane, up to coordinates of nine digits
_SMALL = np.radians(61.0)  # An intended edge turns by more, if there are several in a row.
_IN_A_ROW = 4  # plane sides, with three edges between them


def outline_of(mesh: Any) -> str:
    """Return ``exact`` or ``approximated`` for a plane or three-dimensional mesh."""
    return {2: geometry_of, 3: solid_geometry_of}[mesh.p.shape[0]](mesh)


def solid_geometry_of(mesh: Any) -> str:
    """``exact`` or ``approximated``, by the label of a mesh or else by the shape of its surface."""
    return label_of(mesh) or ("approximated" if looks_round(mesh) else "exact")


def looks_round(mesh: Any) -> bool:
    """Return whether the surface of tetrahedra looks like flat faces in place of a curved one.

    At least four plane sides follow one another by small angles to the same side. An intended
    polyhedron can look the same (an octagonal prism).
    """
    facets, (one, other), turn = _dihedrals(mesh)
    side = _parts(np.abs(turn) <= _PLANE, one, other, facets.size)
    small = (np.abs(turn) > _PLANE) & (np.abs(turn) < _SMALL)
    for sense in (turn > 0, turn < 0):
        bent = small & sense
        row = _parts(bent, side[one], side[other], facets.size)
        ends = np.unique(np.concatenate([side[one[bent]], side[other[bent]]]))
        if np.bincount(row[ends], minlength=1).max(initial=0) >= _IN_A_ROW:
            return True
    return False


def _parts(linked: Any, one: Ints, other: Ints, count: int) -> Ints:
    graph = coo_matrix((np.ones(int(linked.sum())), (one[linked], other[linked])), (count, count))
    return np.asarray(connected_components(graph, directed=False)[1])


def _dihedrals(mesh: Any) -> tuple[Ints, tuple[Ints, Ints], Floats]:
    """Return boundary faces, pairs that share an edge, and the angle between them, rad.

    It is positive where the body is convex.
    """
    facets = mesh.boundary_facets()
    corner = mesh.facets[:, facets].astype(np.int64)
    a, b, c = mesh.p[:, corner].transpose(1, 2, 0)
    normal = np.cross(b - a, c - a)
    inside = mesh.p[:, mesh.t[:, mesh.f2t[0, facets]]].mean(axis=1).T
    normal *= np.sign(np.sum(normal * (a - inside), axis=1))[:, None]
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    ends = np.sort(np.concatenate([corner[[0, 1]], corner[[1, 2]], corner[[0, 2]]], axis=1), axis=0)
    owner = np.tile(np.arange(facets.size), 3)
    key = ends[0] * mesh.p.shape[1] + ends[1]
    order = np.argsort(key, kind="stable")
    same = np.flatnonzero(key[order][1:] == key[order][:-1])
    one, other = owner[order[same]], owner[order[same + 1]]
    middle = mesh.p[:, corner].mean(axis=1).T
    angle = np.arccos(np.clip(np.sum(normal[one] * normal[other], axis=1), -1.0, 1.0))
    bulges = np.sum(normal[one] * (middle[other] - middle[one]), axis=1) < 0
    return facets, (one, other), np.where(bulges, angle, -angle)
