"""Functions of place in the elements of a mesh: looked at from within each."""

from collections.abc import Callable
from itertools import product

import numpy as np
from skfem import Mesh
from skfem.mesh import MeshTet1, MeshTri1

from lacore.model.meshes.curved import vertices
from lacore.numerics.arrays import Floats, Ints

_INSIDE = 1e-6  # of the way to its centre: as near to its corners as an element is looked at
_LINEAR = 1e-12  # of the largest value: what is linear, up to round-off
_PARTS = 4  # into which edges are divided for places where functions are looked at


def looked_at(
    values: Callable[[Floats, Ints], Floats], mesh: Mesh, elements: Ints
) -> tuple[Floats, Floats, bool]:
    """A function in elements, as far as its values at places in them say.

    Args:
        values: of the function at places of shape (d, n) in elements (n,), shape (n,).
        mesh: whose elements they are.
        elements: shape (e,).

    Returns:
        Values at the places looked at, shape (e, q), at the vertices of each element, (e, a), and
        whether it is linear in each: of straight simplices only, others are not known to be.
    """
    corner = vertices(mesh)[:, mesh.t[:, elements]]  # (d, a, e)
    straight, count = isinstance(mesh, MeshTri1 | MeshTet1), len(mesh.t)
    shares = _pulled(_places(count) if straight else np.eye(count))
    places = np.einsum("pa,xae->xep", shares, corner)
    numbers = np.repeat(elements, len(shares))
    seen = values(places.reshape(len(places), -1), numbers).reshape(elements.size, -1)
    if not straight:
        return seen, seen, False
    middle = seen[:, :count].mean(axis=1, keepdims=True)
    vertex = middle + (seen[:, :count] - middle) / (1 - _INSIDE)
    beside = np.abs(seen - vertex @ shares.T).max(initial=0.0)
    return seen, vertex, bool(beside <= _LINEAR * np.abs(seen).max(initial=0.0))


def _places(corners: int) -> Floats:
    """Barycentric coordinates of a lattice, the vertices first, shape (15 or 35, corners)."""
    some = product(range(_PARTS + 1), repeat=corners - 1)
    inner = [(*own, _PARTS - sum(own)) for own in some if 0 <= _PARTS - sum(own) < _PARTS]
    inner = [place for place in inner if max(place) < _PARTS]
    return np.concatenate([np.eye(corners), np.array(inner) / _PARTS])


def _pulled(shares: Floats) -> Floats:
    """Places of an element as they are looked at: a little nearer to its centre."""
    return np.asarray(shares + _INSIDE * (1 / shares.shape[1] - shares))
