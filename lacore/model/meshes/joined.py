"""Several meshes as one, joined along matching edges: refined together, and split again."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components
from skfem import MeshTri

from lacore.model.meshes.refinement import facets_between
from lacore.numerics.arrays import Ints
from lacore.reporting.showing import Compact

# separator between the name of a mesh and that of a part of it, which no name contains
_OF = "\x1f"


@dataclass(frozen=True, repr=False)
class Glued(Compact):
    """Vertices that two meshes share.

    Attributes:
        first, second: names of the meshes.
        vertices: vertices of the first and of the second, shape (2, k).
    """

    first: str
    second: str
    vertices: Ints


@dataclass(frozen=True, repr=False)
class Joined(Compact):
    """Meshes as one.

    Attributes:
        mesh: all elements, mesh by mesh; parts of meshes by name.
        vertices: numbers of the vertices of each mesh.
    """

    mesh: MeshTri
    vertices: Mapping[str, Ints]


def joined(meshes: Mapping[str, MeshTri], glue: Sequence[Glued]) -> Joined:
    """Return the meshes as one; a single one is returned unchanged."""
    if len(meshes) == 1:
        ((name, mesh),) = meshes.items()
        return Joined(mesh, {name: np.arange(mesh.p.shape[1])})
    counts = [mesh.p.shape[1] for mesh in meshes.values()]
    start = dict(zip(meshes, np.cumsum([0, *counts[:-1]]).tolist(), strict=True))
    pairs = [np.zeros((2, 0), dtype=np.int64)]
    behind = [np.reshape([start[own.first], start[own.second]], (2, 1)) for own in glue]
    pairs += [own.vertices + at for own, at in zip(glue, behind, strict=True)]
    one, other = np.concatenate(pairs, axis=1)
    total = sum(counts)
    graph = csr_matrix((np.ones(one.size), (one, other)), shape=(total, total))
    _, group = connected_components(graph, directed=False)
    _, leader, number = np.unique(group, return_index=True, return_inverse=True)
    order = np.argsort(leader, kind="stable")  # vertices in the order of their first use
    place = np.empty(order.size, dtype=np.int64)
    place[order] = np.arange(order.size)
    number = place[number.ravel()]
    vertices = {
        name: number[start[name] : start[name] + count]
        for name, count in zip(meshes, counts, strict=True)
    }
    points = np.concatenate([mesh.p for mesh in meshes.values()], axis=1)[:, leader[order]]
    triangles = [vertices[name][mesh.t] for name, mesh in meshes.items()]
    whole = MeshTri(
        np.ascontiguousarray(points), np.ascontiguousarray(np.concatenate(triangles, axis=1))
    )
    names: dict[str, Ints] = {}
    elements: dict[str, Ints] = {}
    first = 0
    for name, mesh in meshes.items():
        for part, facets in (mesh.boundaries or {}).items():
            ends = vertices[name][mesh.facets[:, np.asarray(facets, dtype=np.int64)]]
            names[f"{name}{_OF}{part}"] = facets_between(whole, ends)
        elements[name] = first + np.arange(mesh.nelements)
        for part, own in (mesh.subdomains or {}).items():
            elements[f"{name}{_OF}{part}"] = first + np.asarray(own, dtype=np.int64)
        first += mesh.nelements
    return Joined(whole.with_boundaries(names).with_subdomains(elements), vertices)


def parted(mesh: MeshTri, names: Sequence[str]) -> dict[str, MeshTri]:
    """Return the joined meshes by name, from the refined whole."""
    if len(names) == 1:
        return {names[0]: mesh}
    return {name: _part(mesh, name) for name in names}


def elements_of(mesh: MeshTri, name: str, single: bool) -> Ints:
    """Return the numbers of the elements of one of the joined meshes."""
    if single:
        return np.arange(mesh.nelements)
    assert mesh.subdomains is not None
    return np.sort(np.asarray(mesh.subdomains[name], dtype=np.int64))


def _part(mesh: MeshTri, name: str) -> MeshTri:
    own = elements_of(mesh, name, single=False)
    vertices = np.unique(mesh.t[:, own])
    number = np.full(mesh.p.shape[1], -1, dtype=np.int64)
    number[vertices] = np.arange(vertices.size)
    part = MeshTri(
        np.ascontiguousarray(mesh.p[:, vertices]), np.ascontiguousarray(number[mesh.t[:, own]])
    )
    mine = f"{name}{_OF}"
    names = {
        known.removeprefix(mine): facets_between(
            part, number[mesh.facets[:, np.asarray(facets, dtype=np.int64)]]
        )
        for known, facets in (mesh.boundaries or {}).items()
        if known.startswith(mine)
    }
    places = np.full(mesh.nelements, -1, dtype=np.int64)
    places[own] = np.arange(own.size)
    elements = {
        known.removeprefix(mine): places[np.asarray(inside, dtype=np.int64)]
        for known, inside in (mesh.subdomains or {}).items()
        if known.startswith(mine)
    }
    part = part.with_boundaries(names) if names else part
    return part.with_subdomains(elements) if elements else part
