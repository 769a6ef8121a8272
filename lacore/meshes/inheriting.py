"""What elements of a mesh pass on to those of another one of the same domain."""

import numpy as np
import shapely
from skfem import MeshTri

from lacore.arrays import Floats, Ints
from lacore.errors import InputError

_INSIDE = 1e-4  # of the way to its centre: corners that lie on edges of the other mesh lie within


def inherited(coarse: MeshTri, finer: MeshTri, values: Floats | Ints, field: str) -> Floats | Ints:
    """Values of the elements of a mesh in those of another one, shape (elements, ...).

    Args:
        coarse: straight-edged triangles.
        finer: of the same domain, each element within one of `coarse`, or within several of the
            same values.
        values: of the elements of `coarse`, shape (elements, ...).
        field: for messages.

    Raises:
        InputError: an element of `finer` that lies in elements of different values.
    """
    corner = coarse.p[:, coarse.t]  # (2, 3, elements)
    tree = shapely.STRtree(shapely.polygons(corner.transpose(2, 1, 0)))
    own = finer.p[:, finer.t]
    middle = own.mean(axis=1)
    parents = _parents(tree, middle)
    found = values[parents]
    for end in own.transpose(1, 0, 2):
        beside = values[_parents(tree, end + _INSIDE * (middle - end))]
        other = np.flatnonzero((beside != found).reshape(len(found), -1).any(axis=1))
        if other.size:
            x, y = middle[:, other[0]]
            raise InputError(
                field,
                None,
                f"an element near ({x:.6g}, {y:.6g}) lies in parts of the problem's mesh"
                " that differ",
                "let edges of both meshes follow the regions",
            )
    return found


def _parents(tree: shapely.STRtree, places: Floats) -> Ints:
    return np.asarray(tree.nearest(shapely.points(places.T)), dtype=np.int64)
