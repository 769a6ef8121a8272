"""Local refinement of triangles and tetrahedra, with names and shapes kept."""

from typing import TypeVar

import numpy as np
from skfem import MeshTet, MeshTri

from lacore.model.meshes.solid.bisection import bisected_tetrahedra
from lacore.numerics.arrays import Bools, Floats, Ints

_THETA = 0.2  # share of Doerfler marking per step; 0.1 to 0.3 differ little
_BEYOND = 1.02  # by the requested number of elements: more are too many


Simplices = TypeVar("Simplices", MeshTri, MeshTet)


def grown(mesh: Simplices, shares: Floats, growth: float, most: int) -> Simplices | None:
    """Return the mesh refined to about `growth` times as many elements, at most `most`.

    It is refined several times in a row by the expected shares: where velocities jump, an error
    falls with the size of elements. A solve thus pays for more than one refinement. The last time
    only the required number of elements is divided.

    Args:
        mesh: straight triangles, or tetrahedra.
        shares: shares of an error, shape (elements,).
        growth: above 1.
        most: limit of elements.

    Returns:
        The mesh, or None if it would have less than a tenth more.
    """
    finer, left = mesh, np.maximum(shares, 0.0)
    asked = min(growth * mesh.nelements, most)
    while finer.nelements < asked / _BEYOND:
        marked = doerfler(left, _THETA)
        next_, parents = divided(finer, marked)
        if next_.nelements > _BEYOND * asked:
            part = (asked - finer.nelements) / (next_.nelements - finer.nelements)
            largest = np.argsort(-left[marked], kind="stable")
            fewer = largest[: max(int(part * marked.size), 1)]
            next_, parents = divided(finer, marked[fewer])
        if next_.nelements > most:
            break
        parts = np.bincount(parents, minlength=finer.nelements)[parents]
        # An area of 1/parts has the size 1/sqrt(parts); a volume of 1/parts the size 1/cbrt(parts).
        finer, left = next_, left[parents] / parts ** (1 + 1 / len(mesh.p))
    return finer if 10 * finer.nelements >= 11 * mesh.nelements else None


def divided(mesh: Simplices, elements: Ints) -> tuple[Simplices, Ints]:
    """Return the mesh with elements divided, and the parents of all."""
    return bisected_tetrahedra(mesh, elements) if len(mesh.p) == 3 else bisected(mesh, elements)


def bisected(mesh: MeshTri, elements: Ints) -> tuple[MeshTri, Ints]:
    """Return the mesh with elements divided across their longest edge, and the parents of all.

    Neighbours are divided, too, so that no node hangs, across their longest edge first; angles
    remain above half of the smallest one. Boundaries and elements keep their names.

    Source: Rivara, Algorithms for refining triangular grids suitable for adaptive and multigrid
        techniques, IJNME 20, 1984; where all three edges are divided, into four similar triangles.
    """
    corners = _longest_first(mesh)
    facets = _facets_across(mesh, corners)
    cut = np.zeros(mesh.nfacets, dtype=bool)
    cut[facets[0, elements]] = True
    while np.any(open_ := cut[facets].any(axis=0) & ~cut[facets[0]]):
        cut[facets[0, open_]] = True
    middle = np.full(mesh.nfacets, -1, dtype=np.int64)
    middle[cut] = mesh.p.shape[1] + np.arange(int(cut.sum()))
    places = mesh.p[:, mesh.facets[:, cut]].mean(axis=1)
    triangles, parents = _parts(corners, middle[facets])
    finer = MeshTri(np.concatenate([mesh.p, places], axis=1), triangles)
    if mesh.boundaries:
        names = {}
        for name, own in mesh.boundaries.items():
            numbers = np.asarray(own, dtype=np.int64)
            whole, halved = numbers[~cut[numbers]], numbers[cut[numbers]]
            ends = [mesh.facets[:, whole]]
            ends += [np.stack([end, middle[halved]]) for end in mesh.facets[:, halved]]
            names[name] = facets_between(finer, np.concatenate(ends, axis=1))
        finer = finer.with_boundaries(names)
    return with_named_elements(finer, mesh, parents), parents


def with_named_elements(finer: MeshTri, mesh: MeshTri, parents: Ints) -> MeshTri:
    """Return the finer mesh with the named elements of a mesh, by their parents."""
    if not mesh.subdomains:
        return finer
    named: MeshTri = finer.with_subdomains(
        {
            name: np.flatnonzero(np.isin(parents, np.asarray(own, dtype=np.int64)))
            for name, own in mesh.subdomains.items()
        }
    )
    return named


def facets_between(mesh: MeshTri, ends: Ints) -> Ints:
    """Return the numbers of the facets between vertices, shape (2, n), ascending."""
    count = mesh.p.shape[1]
    known = _keys(mesh.facets, count)
    order = np.argsort(known)
    return np.sort(order[np.searchsorted(known, _keys(ends, count), sorter=order)])


def _keys(ends: Ints, count: int) -> Ints:
    low, high = np.sort(np.asarray(ends, dtype=np.int64), axis=0)
    return np.asarray(low * count + high)


def _longest_first(mesh: MeshTri) -> Ints:
    """Return the vertices of elements, with the ends of the longest edge first.

    Both sides choose the same of equal edges.
    """
    along = mesh.p[:, mesh.facets[1]] - mesh.p[:, mesh.facets[0]]
    rank = np.empty(mesh.nfacets, dtype=np.int64)
    rank[np.argsort(np.sum(along**2, axis=0), kind="stable")] = np.arange(mesh.nfacets)
    longest = np.argmax(rank[mesh.t2f], axis=0)  # local edge j joins vertices j and j + 1, or 2, 0
    first = np.array([0, 1, 2])[longest]
    return np.asarray(
        np.take_along_axis(mesh.t.astype(np.int64), (first + np.arange(3)[:, None]) % 3, axis=0)
    )


def _facets_across(mesh: MeshTri, corners: Ints) -> Ints:
    """Return the facets between vertices (0, 1), (1, 2) and (2, 0) of `corners`.

    The shape is (3, elements).
    """
    first = np.argmax(mesh.t == corners[0], axis=0)
    return np.asarray(np.take_along_axis(mesh.t2f, (first + np.arange(3)[:, None]) % 3, axis=0))


def _parts(corners: Ints, middles: Ints) -> tuple[Ints, Ints]:
    """Return triangles and their parents, from the middles of edges (0, 1), (1, 2), (2, 0).

    A middle of -1 means that the edge is not divided.
    """
    a, b, c = corners
    ab, bc, ca = middles
    one, two, three = middles >= 0
    whole: list[tuple[Bools, list[tuple[Ints, Ints, Ints]]]] = [
        (~one, [(a, b, c)]),
        (one & ~two & ~three, [(a, ab, c), (ab, b, c)]),
        (one & two & ~three, [(a, ab, c), (ab, b, bc), (ab, bc, c)]),
        (one & ~two & three, [(a, ab, ca), (ca, ab, c), (ab, b, c)]),
        (one & two & three, [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]),
    ]
    triangles, parents = [], []
    for which, parts in whole:
        for part in parts:
            triangles.append(np.stack(part)[:, which])
            parents.append(np.flatnonzero(which))
    # in the order of memory that scikit-fem requires
    return np.ascontiguousarray(np.concatenate(triangles, axis=1)), np.concatenate(parents)


def doerfler(shares: Floats, theta: float) -> Ints:
    """Return the fewest elements that hold the part `theta` of all shares, ascending.

    Shares below 0 count as 0; if none is positive, all elements are returned.

    Source: Doerfler, A convergent adaptive algorithm for Poisson's equation, SINUM 33, 1996.
    """
    positive = np.maximum(shares, 0.0)
    order = np.argsort(-positive, kind="stable")
    held = np.cumsum(positive[order])
    if not held[-1] > 0:
        return np.arange(shares.size)
    return np.sort(order[: int(np.searchsorted(held, theta * held[-1])) + 1])
