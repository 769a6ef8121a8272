"""Evaluation of functions of place within each element of a mesh."""

from collections.abc import Callable
from itertools import product

import numpy as np
from skfem import Mesh
from skfem.mesh import MeshTet1, MeshTri1

from lacore.model.meshes.curved import vertices
from lacore.numerics.arrays import Floats, Ints

_INSIDE = 1e-6  # share of the way to its centre: distance of places from the corners of an element
_LINEAR = 1e-12  # relative error of a function that counts as linear
_PARTS = 4  # number of parts of edges, which determines the places of evaluation


def looked_at(
    values: Callable[[Floats, Ints], Floats], mesh: Mesh, elements: Ints
) -> tuple[Floats, Floats, bool]:
    """Return a function in elements, as far as values at places show it.

    Args:
        values: function at places of shape (d, n) in elements (n,), shape (n,).
        mesh: mesh of the elements.
        elements: shape (e,).

    Returns:
        Values at the places, shape (e, q), at the vertices of each element, (e, a), and whether it
        is linear in each: only for straight simplices, as it is unknown for others.
    """
    corner = vertices(mesh)[:, mesh.t[:, elements]]  # shape (d, a, e)
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
    """Return the barycentric coordinates of a lattice, the vertices first.

    The shape is (15 or 35, corners).
    """
    some = product(range(_PARTS + 1), repeat=corners - 1)
    inner = [(*own, _PARTS - sum(own)) for own in some if 0 <= _PARTS - sum(own) < _PARTS]
    inner = [place for place in inner if max(place) < _PARTS]
    return np.concatenate([np.eye(corners), np.array(inner) / _PARTS])


def _pulled(shares: Floats) -> Floats:
    """Return the places of evaluation of an element: a little closer to its centre."""
    return np.asarray(shares + _INSIDE * (1 / shares.shape[1] - shares))
