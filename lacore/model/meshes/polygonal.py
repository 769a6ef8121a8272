"""Whether straight edges replace a curved outline: what a mesh says of it, or its shape shows."""

from typing import Any

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from lacore.model.meshes.curved import is_curved
from lacore.numerics.arrays import Bools, Ints

_LABEL = "_lacore_geometry"
_STRAIGHT = 4.5e-5  # rad: edges on one line, up to coordinates of nine digits
_SMALL = np.radians(61.0)  # a corner that is meant turns by more, if there are several in a row
_IN_A_ROW = 3  # the crest of a dam has two


def labelled(mesh: Any, geometry: str) -> Any:
    """A mesh whose maker knows what its outline is, see `Body.geometry`.

    The label is lost where scikit-fem makes another mesh of it; its shape still tells.
    """
    object.__setattr__(mesh, _LABEL, geometry)
    return mesh


def label_of(mesh: Any) -> str | None:
    """What the maker of a mesh says that its outline is; None where nobody does."""
    label: str | None = getattr(mesh, _LABEL, None)
    return label


def geometry_of(mesh: Any) -> str:
    """``exact`` or ``approximated``, by the label of a mesh or else by the shape of its outline."""
    polygon = not is_curved(mesh) and looks_curved(mesh)
    return label_of(mesh) or ("approximated" if polygon else "exact")


def looks_curved(mesh: Any) -> bool:
    """Whether the outline of a mesh of straight edges looks like a polygon in place of an arc.

    It turns by small angles to the same side at three corners in a row; sides may be cut into
    several edges. A polygon that is meant can look the same (an octagon), and an arc of three
    chords does not.
    """
    following, turn = _turns(mesh)
    straight = np.abs(turn) <= _STRAIGHT
    count = turn.size
    edges = np.flatnonzero(straight)
    graph = coo_matrix((np.ones(edges.size), (edges, following[edges])), shape=(count, count))
    side = connected_components(graph, directed=False)[1]
    last = np.full(count, -1)  # of each side the edge that ends at its corner
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
    """Of the boundary edges the one that follows each, body on the left, and the angle to it."""
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
