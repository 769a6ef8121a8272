"""Local refinement of tetrahedra, with names kept."""

from typing import Any

import numpy as np
from skfem import MeshTet

from lacore.model.meshes.solid.shape import ENDS
from lacore.numerics.arrays import Bools, Ints

_NONE = -1


def bisected_tetrahedra(mesh: MeshTet, elements: Ints) -> tuple[MeshTet, Ints]:
    """Return the mesh with elements divided across their longest edge, and the parents of all.

    Neighbours are divided, too, so that no node hangs: if an edge of an element is cut, its longest
    one is as well, and cuts are made in turn, the longest first. The two elements at a face agree
    on the order of its edges, and so on its parts. Boundaries and elements keep their names.

    Source: Rivara & Levin, A 3-D refinement algorithm suitable for adaptive and multi-grid
        techniques, Comm. Appl. Num. Meth. 8, 1992.
    """
    ends = np.sort(mesh.edges.astype(np.int64), axis=0)
    length = np.sum((mesh.p[:, ends[1]] - mesh.p[:, ends[0]]) ** 2, axis=0)
    rank = np.empty(length.size, dtype=np.int64)
    rank[np.argsort(length, kind="stable")] = np.arange(length.size)
    longest = mesh.t2e[np.argmax(rank[mesh.t2e], axis=0), np.arange(mesh.nelements)]
    cut = np.zeros(length.size, dtype=bool)
    cut[longest[elements]] = True
    while np.any(open_ := cut[mesh.t2e].any(axis=0) & ~cut[longest]):
        cut[longest[open_]] = True
    edges = np.flatnonzero(cut)
    middle = mesh.p.shape[1] + np.arange(edges.size)
    places = np.concatenate([mesh.p, mesh.p[:, ends[:, edges]].mean(axis=1)], axis=1)
    corners, parents = _parts(mesh.t.astype(np.int64), ends[:, edges], rank[edges], middle)
    finer = MeshTet(*map(np.ascontiguousarray, (places, corners)))
    origin = np.concatenate([np.tile(np.arange(mesh.p.shape[1]), (2, 1)), ends[:, edges]], axis=1)
    return _named(finer, mesh, parents, origin), parents


def _parts(t: Ints, ends: Ints, rank: Ints, middle: Ints) -> tuple[Ints, Ints]:
    """Return tetrahedra and their parents, with ranked edges cut at vertices `middle`."""
    count = int(max(t.max(), middle.max(initial=0))) + 1
    key = ends[0] * count + ends[1]
    order = np.argsort(key)
    known = key[order]
    parents = np.arange(t.shape[1])
    done: list[Ints] = []
    owners: list[Ints] = []
    while t.size:
        own = np.sort(t[ENDS], axis=0)  # shape (ends, edges, elements)
        wanted = own[0] * count + own[1]
        at = np.searchsorted(known, wanted).clip(max=max(known.size - 1, 0))
        found = known[at] == wanted if known.size else np.zeros(wanted.shape, dtype=bool)
        height = np.where(found, rank[order[at]] if known.size else _NONE, _NONE)
        edge = np.argmax(height, axis=0)
        whole = height.max(axis=0) < 0
        done.append(t[:, whole])
        owners.append(parents[whole])
        t, parents = t[:, ~whole], parents[~whole]
        every = np.arange(t.shape[1])
        first, last = ENDS[:, edge[~whole]]
        new = middle[order[at[edge[~whole], np.flatnonzero(~whole)]]]
        halves = [t.copy(), t.copy()]
        halves[0][last, every] = new
        halves[1][first, every] = new
        t, parents = np.concatenate(halves, axis=1), np.concatenate([parents, parents])
    return np.concatenate(done, axis=1), np.concatenate(owners)


def _named(finer: MeshTet, mesh: MeshTet, parents: Ints, origin: Ints) -> Any:
    """Return the mesh with the names of a coarser one.

    Args:
        finer, mesh: the finer and the coarser mesh.
        parents: parents of the elements.
        origin: ends of the edges that vertices halve, (2, n).
    """
    named = finer
    if mesh.boundaries:
        facets = finer.boundary_facets()
        from_ = np.sort(origin[:, finer.facets[:, facets]].reshape(6, -1), axis=0)
        first = np.concatenate([np.ones((1, facets.size), dtype=bool), from_[1:] != from_[:-1]])
        # The corners of a part of a face lie on its edges, and identify all three of its corners.
        corners = from_.T[first.T].reshape(-1, 3)
        known = {tuple(own): number for number, own in enumerate(mesh.facets.T.tolist())}
        parent = np.array([known[tuple(own)] for own in corners.tolist()], dtype=np.int64)
        names = {}
        for name, own in mesh.boundaries.items():
            inside: Bools = np.isin(parent, np.asarray(own, dtype=np.int64))
            names[name] = facets[inside]
        named = named.with_boundaries(names)
    if mesh.subdomains:
        named = named.with_subdomains(
            {
                name: np.flatnonzero(np.isin(parents, np.asarray(own, dtype=np.int64)))
                for name, own in mesh.subdomains.items()
            }
        )
    return named
