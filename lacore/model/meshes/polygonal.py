"""Test whether straight edges replace a curved outline, by a label or the shape of a mesh."""

from typing import Any

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from lacore.model.meshes.curved import is_curved
from lacore.numerics.arrays import Bools, Ints

_LABEL = "_lacore_geometry"
_STRAIGHT = 4.5e-5  # rad: edges on one line, up to coordinates of nine digits
_SMALL = np.radians(61.0)  # An intended corner turns by more, if there are several in a row.
_IN_A_ROW = 3  # The crest of a dam has two.


def labelled(mesh: Any, geometry: str) -> Any:
    """Return a mesh with a label on its outline, see `Body.geometry`.

    The label is lost if scikit-fem makes another mesh of it; the shape can still be tested.
    """
    object.__setattr__(mesh, _LABEL, geometry)
    return mesh


def label_of(mesh: Any) -> str | None:
    """Return the label of the outline of a mesh; None without one."""
    label: str | None = getattr(mesh, _LABEL, None)
    return label


def geometry_of(mesh: Any) -> str:
    """``exact`` or ``approximated``, by the label of a mesh or else by the shape of its outline."""
    polygon = not is_curved(mesh) and looks_curved(mesh)
    return label_of(mesh) or ("approximated" if polygon else "exact")


def looks_curved(mesh: Any) -> bool:
    """Return whether the outline of a straight-edged mesh looks like a polygon in place of an arc.

    It turns by small angles to the same side at three corners in a row; sides may be divided into
    several edges. An intended polygon can look the same (an octagon), and an arc of three chords
    does not.
    """
    following, turn = _turns(mesh)
    straight = np.abs(turn) <= _STRAIGHT
    count = turn.size
    edges = np.flatnonzero(straight)
    graph = coo_matrix((np.ones(edges.size), (edges, following[edges])), shape=(count, count))
    side = connected_components(graph, directed=False)[1]
    last = np.full(count, -1)  # for each side the edge that ends at its corner
    corners = np.flatnonzero(~straight)
    last[side[corners]] = corners
    after = last[side[following]]
    return any(_in_a_row(corners, after, small) for small in _small(turn))


def _small(turn: Any) -> tuple[Bools, Bools]:
    angle = np.abs(turn)
    small = (angle > _STRAIGHT) & (angle < _SMALL)
    return small & (turn > 0), small & (turn < 0)


def _in_a_row(corners: Ints, after: Ints, small: Bools) -> bool:
    here, row = corners, small[corners]
    for _ in range(_IN_A_ROW - 1):
        here = after[here]
        row &= small[here]
    return bool(row.any())


def _turns(mesh: Any) -> tuple[Ints, Any]:
    """Return the next boundary edge of each, with the body on the left, and the angle to it."""
    facets = mesh.boundary_facets()
    places, ends = mesh.p, np.asarray(mesh.facets[:, facets], dtype=np.int64)
    inside = places[:, mesh.t[:, mesh.f2t[0, facets]]].mean(axis=1)
    along, away = places[:, ends[1]] - places[:, ends[0]], inside - places[:, ends[0]]
    turned = along[0] * away[1] - along[1] * away[0] < 0
    ends[:, turned] = ends[::-1, turned]
    along[:, turned] *= -1
    order = np.argsort(ends[0], kind="stable")
    following = order[np.searchsorted(ends[0], ends[1], sorter=order).clip(max=order.size - 1)]
    next_ = along[:, following]
    cross = along[0] * next_[1] - along[1] * next_[0]
    return following, np.arctan2(cross, np.sum(along * next_, axis=0))
