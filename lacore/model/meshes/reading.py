"""Meshes from files: triangles, quadrilaterals or tetrahedra, with the names of their groups."""

from __future__ import annotations

from dataclasses import replace
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree
from skfem import Mesh, MeshQuad, MeshTet, MeshTri

from lacore.model.meshes.curved import isoparametric
from lacore.model.meshes.files.cells import FLAT, TRIANGLES, Cells, cells_of
from lacore.model.meshes.files.formats import loaded
from lacore.model.meshes.files.notes import noted
from lacore.model.meshes.polygonal import labelled
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.errors import (
    InputError,
    is_number,
    require_known,
    require_range,
    suggest_all,
    typed,
)
from lacore.reporting.showing import listed
from lacore.reporting.units import METRES

_MADE = {(2, 3): MeshTri, (2, 4): MeshQuad, (3, 4): MeshTet}
_NAMES = {
    2: ("line", "edge", "triangle", "curve in the surface", "surfaces"),
    3: ("triangle", "face", "tetrahedron", "surface in the volume", "volumes"),
}


@typed()
def read(
    path: str | PathLike[str],
    surface: str | None = None,
    merge: float = 1e-9,
    unit: str | None = None,
    elements: str | None = None,
) -> MeshTri | MeshQuad | MeshTet:
    """Read a mesh from a file: .msh of gmsh (2.2, 4.1), .inp of Abaqus, or any format of meshio.

    Tetrahedra are read if there are any; the following rules for lines, surfaces and their
    elements then apply to triangles, volumes and tetrahedra.

    Physical groups of lines (sets of line elements, or surfaces of Abaqus) become named boundaries,
    those of surfaces named subdomains; groups without a name are left out. A set of nodes names the
    edges of the boundary whose ends it contains. Nodes that no element uses are dropped, and so is
    a constant z.

    Quadrilaterals remain if there are no triangles, and are otherwise cut in two. A mesh of second
    order is reduced to its vertices if its edges are straight; a curved one becomes isoparametric
    (`skfem.MeshTri2`, `skfem.MeshQuad2`). For straight edges that replace a curve, a `Body` assumes
    this if the outline looks like it; use ``Body(geometry="exact")`` for an intended polygon,
    ``"approximated"`` for other curves. `print` of a body shows what was assumed.

    Args:
        path: path of the file; the ending determines the format.
        surface: group of the elements to read; None: all of the file.
        merge: nodes closer than this share of the mesh's size are merged; 0 keeps the two sides of
            a crack apart, and other coincident nodes as well.
        unit: unit of the coordinates: "m", "dm", "cm", "mm", "km", "in", "ft", "yd"; None: m, since
            these files state none.
        elements: "triangles" also cuts quadrilaterals in two, and replaces curved edges by chords,
            for strict bounds; None: those of the file.

    Raises:
        InputError: a file that cannot be read, or without elements of these kinds; one that is not
            plane; curved edges of a mixed mesh or of tetrahedra; a line that is not an edge of an
            element; an unknown surface or unit.

    Example:
        >>> la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=4, ny=2).save("rectangle.msh")  # or of gmsh
        >>> float(la.meshes.read("rectangle.msh", unit="ft").p.max())
        0.6096
    """
    _check(merge, unit, elements)
    shown = fspath(path)
    file = loaded(Path(shown))
    dimension = 3 if any(block.dim == 3 and len(block.data) for block in file.cells) else 2
    nodes = np.asarray(file.points, dtype=float) * METRES[unit or "m"]
    points = _places(nodes, file, dimension, shown)
    cells = cells_of(file, points, dimension, elements, shown)
    number, kept = _numbering(points, cells, merge)
    vertices, edges = number[cells.corners], number[cells.edges]
    collapsed = np.flatnonzero(np.any(np.diff(np.sort(vertices, axis=1), axis=1) == 0, axis=1))
    if collapsed.size:
        place = points[cells.corners[collapsed[0]]].mean(axis=0)
        raise InputError(
            "path",
            shown,
            f"a {_NAMES[dimension][2]} at {place} has two vertices in one place",
            "remove it, or give a smaller `merge`",
        )
    # Formats with one group per element repeat those of several groups.
    _, first, copy = np.unique(
        np.sort(vertices, axis=1), axis=0, return_index=True, return_inverse=True
    )
    order = np.argsort(first)
    element = np.argsort(order)[copy.ravel()]
    own = first[order]
    # In the order of memory that scikit-fem would otherwise change with a report.
    corners = vertices[own]
    if (dimension, vertices.shape[1]) == (2, 4):
        corners = _anticlockwise(corners, points[kept])
    arrays = map(np.ascontiguousarray, (points[kept].T, corners.T))
    mesh = _MADE[dimension, vertices.shape[1]](*arrays)
    facets = _facets(mesh, number, cells, points, shown)
    sets, without = _named_by_nodes(mesh, number, file)
    named = mesh.with_boundaries({**sets, **cells.named(dimension - 1, facets)}).with_subdomains(
        cells.named(dimension, element)
    )
    part, vertex = (named, np.arange(len(kept))) if surface is None else _part(named, surface)
    notes = [f"{Path(shown).name}, lengths in {unit or 'm (the file states no unit)'}"]
    notes += [*cells.notes]
    if without:
        notes.append(f"sets of nodes without an edge left out: {listed(without)}")
    curved = cells.curved(points)
    if curved.any():
        middles = (edges.reshape(-1, 2), points[cells.middles].reshape(-1, 2))
        rows = own if surface is None else own[named.subdomains[surface]]
        part = _isoparametric(part, vertex, middles, _centres(cells, points)[rows])
    if cells.by_chords:
        part = labelled(part, "approximated")
    return noted(part, tuple(notes))


def _check(merge: float, unit: str | None, elements: str | None) -> None:
    """Raise `InputError` for values that `read` does not support."""
    if not (is_number(merge) and 0 <= merge < 1):
        raise InputError("merge", merge, "not a share of the size", "give 1e-9, or 0 for none")
    if unit is not None:
        require_known("unit", unit, METRES)
    if elements is not None:
        require_known("elements", elements, (TRIANGLES,))


def _places(nodes: Floats, file: Any, dimension: int, shown: str) -> Floats:
    """Return the coordinates of nodes, (n, 3), or (n, 2) in a plane of constant z."""
    if not np.all(np.isfinite(nodes)):
        raise InputError("path", shown, "has nodes that are not finite", "fix their coordinates")
    require_range(f"path = {shown!r}, coordinates", nodes)
    if nodes.shape[1] > dimension:
        own = [np.ravel(block.data) for block in file.cells if block.dim == dimension]
        number = np.unique(np.concatenate([np.zeros(0, dtype=np.int64), *own])).astype(np.int64)
        used = nodes[number[(number >= 0) & (number < len(nodes))]]
        height = used[:, 2]
        if height.size and np.ptp(height) > FLAT * np.linalg.norm(np.ptp(used, axis=0)):
            raise InputError(
                "path",
                shown,
                f"is not plane: z goes from {height.min():.6g} to {height.max():.6g}",
                "draw the surface in the plane of x and y",
            )
    return nodes[:, :dimension]


def _numbering(points: Floats, cells: Cells, merge: float) -> tuple[Ints, Ints]:
    """Return the vertex of each node (-1: none), and the node of each vertex.

    Vertices keep the order of their first node in an element.
    """
    corners = np.unique(cells.corners)
    used = np.union1d(corners, cells.sides)
    size = float(np.linalg.norm(np.ptp(points[corners], axis=0)))
    cluster: Ints = np.arange(len(points))
    if merge > 0:
        pairs = used[cKDTree(points[used]).query_pairs(merge * size, output_type="ndarray")]
        links = coo_matrix((np.ones(len(pairs)), pairs.T), shape=(len(points),) * 2)
        cluster = np.asarray(connected_components(links, directed=False)[1], dtype=np.int64)
    clusters, first = np.unique(cluster[corners], return_index=True)
    order = np.argsort(first)
    vertex = np.full(len(points), -1)  # vertex of each cluster; none if no element has a node of it
    vertex[clusters[order]] = np.arange(clusters.size)
    return vertex[cluster], corners[first[order]]


def _anticlockwise(vertices: Ints, points: Floats) -> Ints:
    """Return quadrilaterals (n, 4) with their corners in anticlockwise order."""
    across = points[vertices[:, 2:]] - points[vertices[:, :2]]  # both diagonals
    area = across[:, 0, 0] * across[:, 1, 1] - across[:, 0, 1] * across[:, 1, 0]
    return np.where((area < 0)[:, None], vertices[:, [0, 3, 2, 1]], vertices)


def _facets(mesh: Mesh, number: Ints, cells: Cells, points: Floats, shown: str) -> Ints:
    """Return the facet of each side, -1 for those in no group."""
    dimension = cells.dimension
    side, edge, element, within, _ = _NAMES[dimension]
    names = {
        int(row): name
        for (dim, name), rows in cells.groups.items()
        if dim == dimension - 1
        for row in rows
    }
    known = {ends: facet for facet, ends in enumerate(map(tuple, mesh.facets.T.tolist()))}
    facets = np.full(len(cells.sides), -1)
    for row, name in names.items():
        facet = known.get(tuple(sorted(number[cells.sides[row]].tolist())))
        if facet is None:
            first, *others = points[cells.sides[row]]
            where = " and ".join(map(str, others))
            raise InputError(
                "path",
                shown,
                f"a {side} of the group {name!r}, from {first} to {where}, is no {edge}"
                f" of a {element}",
                f"embed its {within}, or take it out of the group",
            )
        facets[row] = facet
    return facets


def _named_by_nodes(mesh: Mesh, number: Ints, file: Any) -> tuple[dict[str, Ints], list[str]]:
    """Return the facets of the boundary by set of nodes, and the sets that contain none."""
    outer = mesh.boundary_facets()
    found, without = {}, []
    for name, nodes in file.point_sets.items():
        inside = np.isin(np.arange(mesh.p.shape[1]), number[np.asarray(nodes, dtype=np.int64)])
        own = outer[inside[mesh.facets[:, outer]].all(axis=0)]
        if own.size:
            found[name] = own
        elif not name.startswith("gmsh:"):
            without.append(name)
    return found, without


def _part(mesh: Mesh, surface: str) -> tuple[Mesh, Ints]:
    """Return the elements of one group, and the vertex in the mesh of each of theirs.

    Groups of sides elsewhere are dropped.
    """
    groups = mesh.subdomains or {}
    kinds = _NAMES[mesh.p.shape[0]][4]
    if surface not in groups:
        fix = suggest_all(surface, groups) if groups else f"give none: the file names no {kinds}"
        raise InputError("surface", surface, f"no such group of {kinds}", fix)
    part, vertex = mesh.restrict(groups[surface], return_mapping=True)
    sides = {name: facets for name, facets in (part.boundaries or {}).items() if facets.size}
    own = (
        type(mesh)(part.p, part.t)
        .with_boundaries(sides)
        .with_subdomains({surface: np.arange(part.nelements)})
    )
    return own, vertex


def _isoparametric(mesh: Mesh, vertex: Ints, middles: tuple[Ints, Floats], centres: Floats) -> Mesh:
    """Return a mesh with its midside nodes where the file has them.

    Args:
        mesh: straight-edged triangles or quadrilaterals.
        vertex: number of each of its vertices in the file.
        middles: ends of edges by these numbers, (e, 2), and their midside nodes, (e, 2), m.
        centres: node in the centre of each element, (n, 2), m.
    """
    ends, places = middles
    curved = isoparametric(mesh)
    count = int(max(ends.max(), vertex.max())) + 1
    keys, first = np.unique(_keys(ends.T, count), return_index=True)
    row = first[np.searchsorted(keys, _keys(vertex[mesh.facets], count))]
    inner = centres.T if isinstance(mesh, MeshQuad) else np.zeros((2, 0))
    nodes = np.concatenate([mesh.p, places[row].T, inner], axis=1)
    return replace(curved, doflocs=np.ascontiguousarray(nodes))


def _keys(ends: Ints, count: int) -> Ints:
    return np.asarray(ends.min(axis=0).astype(np.int64) * count + ends.max(axis=0))


def _centres(cells: Cells, points: Floats) -> Floats:
    """Return the nodes in the centre of elements, (n, 2); those of 8 nodes by their shape."""
    own = points[cells.middles].sum(axis=1) / 2 - points[cells.corners].sum(axis=1) / 4
    return np.where((cells.centres >= 0)[:, None], points[cells.centres], own)
