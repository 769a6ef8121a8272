"""Meshes of triangles or tetrahedra from files, with the names of physical groups."""

from __future__ import annotations

from collections.abc import Iterator
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree
from skfem import MeshTet, MeshTri

from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.errors import InputError, is_number, require_range, suggest_all, typed

_FLAT = 1e-9  # by a length: deviation from a plane or line in files with 16 digits
_CORNERS = {"line": 2, "line3": 2, "triangle": 3, "triangle6": 3, "tetra": 4, "tetra10": 4}
_MADE = {2: MeshTri, 3: MeshTet}
# Ends of edges, in the order in which midside nodes follow the vertices.
_EDGES = {
    2: ((0, 1), (1, 2), (2, 0)),
    3: ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
}
_NAMES = {
    2: ("line", "edge", "triangle", "curve in the surface", "surfaces"),
    3: ("triangle", "face", "tetrahedron", "surface in the volume", "volumes"),
}
_FIRST_ORDER = "save a mesh of first order (of gmsh: Mesh.ElementOrder = 1)"


@typed()
def read(
    path: str | PathLike[str], surface: str | None = None, merge: float = 1e-9
) -> MeshTri | MeshTet:
    """Read a mesh from a file: .msh of gmsh, version 2.2 or 4.1, or any format of meshio.

    Tetrahedra are read if there are any; the following rules for lines, triangles and surfaces then
    apply to triangles, tetrahedra and volumes.

    Physical groups of lines (sets of line elements) become named boundaries, those of surfaces
    named subdomains; groups without a name are left out. Nodes that no triangle uses are dropped,
    and so is a constant z. A mesh of second order is reduced to its vertices if its edges are
    straight, and rejected if one is curved. For a mesh of first order this is unknown: if its
    outline looks like a polygon in place of a curve, a `Body` assumes so; use
    ``Body(geometry="exact")`` for an intended polygon, ``"approximated"`` for other curves.

    Args:
        path: path of the file; the ending determines the format.
        surface: group of the triangles to read; None: all of the file.
        merge: nodes closer than this share of the mesh's size are merged; 0 keeps the two sides of
            a crack apart, and other coincident nodes as well.

    Raises:
        InputError: a file that cannot be read, without triangles or with other elements of surfaces
            and volumes, that is not plane or has curved edges; a line that is not an edge of a
            triangle; an unknown surface.

    Example:
        >>> la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=4, ny=2).save("rectangle.msh")  # or of gmsh
        >>> la.meshes.read("rectangle.msh").nelements
        32
    """
    if not (is_number(merge) and 0 <= merge < 1):
        raise InputError("merge", merge, "not a share of the size", "give 1e-9, or 0 for none")
    file = loaded(Path(fspath(path)))
    shown = fspath(path)
    dimension = 3 if any(block.dim == 3 and len(block.data) for block in file.cells) else 2
    sides, whole, groups = _cells(file, dimension, shown)
    points = _places(np.asarray(file.points, dtype=float), whole, dimension, shown)
    _check_straight(points, whole, dimension, shown)
    elements = whole[:, : dimension + 1]
    number, kept = _numbering(points, elements, sides, merge)
    vertices = number[elements]
    collapsed = np.flatnonzero(np.any(np.diff(np.sort(vertices, axis=1), axis=1) == 0, axis=1))
    if collapsed.size:
        place = points[elements[collapsed[0]]].mean(axis=0)
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
    # In the order of memory that scikit-fem would otherwise change with a report.
    arrays = map(np.ascontiguousarray, (points[kept].T, vertices[first[order]].T))
    mesh = _MADE[dimension](*arrays)
    facets = _facets(mesh, number, sides, points, groups, shown)
    named = mesh.with_boundaries(
        {
            name: np.unique(facets[rows])
            for (dim, name), rows in groups.items()
            if dim == dimension - 1
        }
    ).with_subdomains(
        {name: np.unique(element[rows]) for (dim, name), rows in groups.items() if dim == dimension}
    )
    return named if surface is None else _restricted(named, surface)


def loaded(path: Path) -> Any:
    """Return the file as read by meshio."""
    import meshio  # imported here because it imports the readers of forty formats

    if not path.is_file():
        raise InputError("path", str(path), "no such file", "give the path of a mesh file")
    with path.open("rb") as start:
        if start.readline().strip() == b"$MeshFormat" and start.readline().startswith(b"4.0"):
            raise InputError(
                "path", str(path), "version 4.0 of gmsh's format", "write version 4.1 or 2.2"
            )
    formats = meshio.extension_to_filetypes.get(path.suffix.lower(), [])
    if not formats:
        raise InputError(
            "path", str(path), "a format that is not known", "give a .msh file, or one of meshio's"
        )
    why = ""
    for name in sorted(formats, key=lambda name: name != "gmsh"):
        try:
            return getattr(meshio, name).read(path)
        except Exception as error:  # Readers fail on broken files with any kind of exception.
            why = why or f"{type(error).__name__} {error}".strip()
    raise InputError(
        "path",
        str(path),
        f"cannot be read ({why})",
        "write it anew (of gmsh: version 4.1 or 2.2, without Mesh.SaveAll)",
    )


def _cells(file: Any, dimension: int, shown: str) -> tuple[Ints, Ints, dict[tuple[int, str], Ints]]:
    """Return the nodes of sides (n, d) and of elements (n, all), and group rows by (dim, name)."""
    found: dict[int, list[Ints]] = {dimension - 1: [], dimension: []}
    groups: dict[tuple[int, str], list[Ints]] = {}
    plane = ", of plane triangles only (without recombination)" if dimension == 2 else ""
    for number, block in enumerate(file.cells):
        nodes = np.asarray(block.data, dtype=np.int64)
        if block.dim not in found or not nodes.size:
            continue
        if block.type not in _CORNERS:
            raise InputError(
                "path",
                shown,
                f"holds elements of the kind {block.type!r}",
                f"{_FIRST_ORDER}{plane or ', of tetrahedra only'}",
            )
        if nodes.min() < 0 or nodes.max() >= len(file.points):
            raise InputError("path", shown, "elements have nodes that it lacks", "write it anew")
        before = sum(map(len, found[block.dim]))
        found[block.dim].append(nodes if block.dim == dimension else nodes[:, :dimension])
        for name, rows in _groups(file, number, block.dim):
            groups.setdefault((block.dim, name), []).append(rows + before)
    if not found[dimension]:
        raise InputError("path", shown, "holds no triangles", "mesh the surfaces, and save them")
    kinds = {nodes.shape[1] for nodes in found[dimension]}
    if len(kinds) > 1:
        name = {2: "triangles", 3: "tetrahedra"}[dimension]
        raise InputError("path", shown, f"holds {name} of two orders", _FIRST_ORDER)
    none = np.empty((0, dimension), dtype=np.int64)
    return (
        np.concatenate([none, *found[dimension - 1]]),
        np.concatenate(found[dimension]),
        {key: np.unique(np.concatenate(rows)) for key, rows in groups.items()},
    )


def _groups(file: Any, block: int, dim: int) -> Iterator[tuple[str, Ints]]:
    """Yield the groups with elements of a block: name, rows of the block."""
    for name, sets in file.cell_sets.items():
        rows = sets[block]
        if not name.startswith("gmsh:") and rows is not None and len(rows):
            yield name, np.asarray(rows, dtype=np.int64)
    if "gmsh:physical" in file.cell_data:
        names = {tuple(map(int, tag)): name for name, tag in file.field_data.items()}
        tags = np.asarray(file.cell_data["gmsh:physical"][block])
        for tag in np.unique(tags[tags > 0]).tolist():
            # Groups without a name are incomplete in the reader where they overlap others.
            if (tag, dim) in names:
                yield names[tag, dim], np.flatnonzero(tags == tag)


def _places(points: Floats, elements: Ints, dimension: int, shown: str) -> Floats:
    """Return the coordinates of nodes, (n, 3), or (n, 2) in a plane of constant z."""
    if not np.all(np.isfinite(points)):
        raise InputError("path", shown, "has nodes that are not finite", "fix their coordinates")
    require_range(f"path = {shown!r}, coordinates", points)
    used = points[np.unique(elements)]
    if points.shape[1] > dimension:
        height = used[:, 2]
        if np.ptp(height) > _FLAT * np.linalg.norm(np.ptp(used, axis=0)):
            raise InputError(
                "path",
                shown,
                f"is not plane: z goes from {height.min():.6g} to {height.max():.6g}",
                "draw the surface in the plane of x and y",
            )
    return points[:, :dimension]


def _check_straight(points: Floats, elements: Ints, dimension: int, shown: str) -> None:
    """Reject midside nodes off the straight edge between the vertices."""
    midside = range(dimension + 1, elements.shape[1])
    for (one, other), middle in zip(_EDGES[dimension], midside, strict=False):
        start, end = points[elements[:, one]], points[elements[:, other]]
        at, along = points[elements[:, middle]] - start, end - start
        squares = np.sum(along**2, axis=1)
        share = np.sum(at * along, axis=1) / np.where(squares > 0, squares, 1.0)
        off = np.linalg.norm(at - share[:, None] * along, axis=1)
        curved = np.flatnonzero(off > _FLAT * np.sqrt(squares))
        if curved.size:
            first = curved[0]
            raise InputError(
                "path",
                shown,
                f"has a curved edge, from {start[first]} to {end[first]}",
                f"{_FIRST_ORDER}, and say Body(geometry='approximated')",
            )


def _numbering(points: Floats, elements: Ints, sides: Ints, merge: float) -> tuple[Ints, Ints]:
    """Return the vertex of each node (-1: none), and the node of each vertex.

    Vertices keep the order of their first node in an element.
    """
    corners = np.unique(elements)
    used = np.union1d(corners, sides)
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


def _facets(
    mesh: MeshTri | MeshTet,
    number: Ints,
    sides: Ints,
    points: Floats,
    groups: dict[tuple[int, str], Ints],
    shown: str,
) -> Ints:
    """Return the facet of each side, -1 for those in no group."""
    dimension = mesh.p.shape[0]
    side, edge, element, within, _ = _NAMES[dimension]
    names = {
        int(row): name
        for (dim, name), rows in groups.items()
        if dim == dimension - 1
        for row in rows
    }
    known = {ends: facet for facet, ends in enumerate(map(tuple, mesh.facets.T.tolist()))}
    facets = np.full(len(sides), -1)
    for row, name in names.items():
        facet = known.get(tuple(sorted(number[sides[row]].tolist())))
        if facet is None:
            first, *others = points[sides[row]]
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


def _restricted(mesh: MeshTri | MeshTet, surface: str) -> MeshTri | MeshTet:
    """Return the elements of one group; groups of sides elsewhere are dropped."""
    groups = mesh.subdomains or {}
    kinds = _NAMES[mesh.p.shape[0]][4]
    if surface not in groups:
        fix = suggest_all(surface, groups) if groups else f"give none: the file names no {kinds}"
        raise InputError("surface", surface, f"no such group of {kinds}", fix)
    part = mesh.restrict(groups[surface])
    sides = {name: facets for name, facets in (part.boundaries or {}).items() if facets.size}
    return (
        type(mesh)(part.p, part.t)
        .with_boundaries(sides)
        .with_subdomains({surface: np.arange(part.nelements)})
    )
