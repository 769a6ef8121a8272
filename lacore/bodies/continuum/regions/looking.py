"""Functions of place in the elements of a mesh: looked at from within each."""

from collections.abc import Callable

import numpy as np
from skfem import Mesh
from skfem.mesh import MeshTri1

from lacore.arrays import Floats, Ints
from lacore.meshes.curved import vertices

_INSIDE = 1e-6  # of the way to its centre: as near to its corners as an element is looked at
_LINEAR = 1e-12  # of the largest value: what is linear, up to round-off
_PARTS = 4  # into which edges are divided for places where functions are looked at


def looked_at(
    values: Callable[[Floats, Ints], Floats], mesh: Mesh, elements: Ints
) -> tuple[Floats, Floats, bool]:
    """A function in elements, as far as its values at places in them say.

    Args:
        values: of the function at places of shape (2, n) in elements (n,), shape (n,).
        mesh: whose elements they are.
        elements: shape (e,).

    Returns:
        Values at the places looked at, shape (e, q), at the vertices of each element, (e, a), and
        whether it is linear in each: of straight triangles only, others are not known to be.
    """
    corner = vertices(mesh)[:, mesh.t[:, elements]]  # (2, a, e)
    straight = isinstance(mesh, MeshTri1)
    shares = _pulled(_places() if straight else np.eye(len(mesh.t)))
    places = np.einsum("pa,xae->xep", shares, corner)
    numbers = np.repeat(elements, len(shares))
    seen = values(places.reshape(2, -1), numbers).reshape(elements.size, -1)
    if not straight:
        return seen, seen, False
    middle = seen[:, :3].mean(axis=1, keepdims=True)
    vertex = middle + (seen[:, :3] - middle) / (1 - _INSIDE)
    beside = np.abs(seen - vertex @ shares.T).max(initial=0.0)
    return seen, vertex, bool(beside <= _LINEAR * np.abs(seen).max(initial=0.0))


def _places() -> Floats:
    """Barycentric coordinates of a lattice, the vertices first, shape (15, 3)."""
    whole = [(i, j, _PARTS - i - j) for i in range(_PARTS + 1) for j in range(_PARTS + 1 - i)]
    inner = [place for place in whole if max(place) < _PARTS]
    return np.concatenate([np.eye(3), np.array(inner) / _PARTS])


def _pulled(shares: Floats) -> Floats:
    """Places of an element as they are looked at: a little nearer to its centre."""
    return np.asarray(shares + _INSIDE * (1 / shares.shape[1] - shares))
