"""Triangle meshes from files, with the names of physical groups."""

from collections.abc import Iterator
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree
from skfem import MeshTri

from lacore.arrays import Floats, Ints
from lacore.errors import InputError, is_number, require_range, suggest_all

_FLAT = 1e-9  # of a length: what counts as plane or straight in files with 16 digits
_CORNERS = {"line": 2, "line3": 2, "triangle": 3, "triangle6": 3}
_FIRST_ORDER = "save a mesh of first order (of gmsh: Mesh.ElementOrder = 1)"


def read(path: str | PathLike[str], surface: str | None = None, merge: float = 1e-9) -> MeshTri:
    """Triangle mesh from a file: .msh of gmsh, version 2.2 or 4.1, and whatever meshio reads.

    Physical groups of lines (sets of line elements) become named boundaries, those of surfaces
    named subdomains; groups without a name are left out. Nodes that no triangle uses are dropped,
    and so is a z that is constant. A mesh of second order is reduced to its vertices where its
    edges are straight, and refused where one is curved. Of a mesh of first order nobody can tell:
    where its outline looks like a polygon in place of a curve, a `Body` takes it for one; say
    ``Body(geometry="exact")`` of a polygon that is meant, ``"approximated"`` of other curves.

    Args:
        path: of the file; the ending says the format.
        surface: the group whose triangles to take; None: all of the file.
        merge: nodes nearer than this share of the mesh's size are one node; 0 keeps the two sides
            of a crack apart, and coincident nodes with them.

    Raises:
        InputError: a file that cannot be read, that holds no triangles or other elements of
            surfaces and volumes, that is not plane or has curved edges; a line that is no edge of
            a triangle; an unknown surface.
    """
    if not (is_number(merge) and 0 <= merge < 1):
        raise InputError("merge", merge, "not a share of the size", "give 1e-9, or 0 for none")
    file = loaded(Path(fspath(path)))
    shown = fspath(path)
    lines, triangles, groups = _cells(file, shown)
    points = _plane(np.asarray(file.points, dtype=float), triangles, shown)
    _check_straight(points, triangles, shown)
    number, kept = _numbering(points, triangles[:, :3], lines, merge)
    vertices = number[triangles[:, :3]]
    collapsed = np.flatnonzero(np.any(vertices == np.roll(vertices, 1, axis=1), axis=1))
    if collapsed.size:
        place = points[triangles[collapsed[0], :3]].mean(axis=0)
        raise InputError(
            "path",
            shown,
            f"a triangle at {place} has two vertices in one place",
            "remove it, or give a smaller `merge`",
        )
    # Formats that know one group an element write those of several groups as often.
    _, first, copy = np.unique(
        np.sort(vertices, axis=1), axis=0, return_index=True, return_inverse=True
    )
    order = np.argsort(first)
    element = np.argsort(order)[copy.ravel()]
    # In the order of memory that scikit-fem would report to change.
    mesh = MeshTri(*map(np.ascontiguousarray, (points[kept].T, vertices[first[order]].T)))
    facets = _facets(mesh, number, lines, points, groups, shown)
    named = mesh.with_boundaries(
        {name: np.unique(facets[rows]) for (dim, name), rows in groups.items() if dim == 1}
    ).with_subdomains(
        {name: np.unique(element[rows]) for (dim, name), rows in groups.items() if dim == 2}
    )
    return named if surface is None else _restricted(named, surface)


def loaded(path: Path) -> Any:
    """The file as meshio reads it."""
    import meshio  # here: it imports the readers of forty formats

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
        except Exception as error:  # readers fail on broken files in every way there is
            why = why or f"{type(error).__name__} {error}".strip()
    raise InputError(
        "path",
        str(path),
        f"cannot be read ({why})",
        "write it anew (of gmsh: version 4.1 or 2.2, without Mesh.SaveAll)",
    )


def _cells(file: Any, shown: str) -> tuple[Ints, Ints, dict[tuple[int, str], Ints]]:
    """Nodes of lines (n, 2) and of triangles (n, 3 or 6), and rows of groups by (dim, name)."""
    found: dict[int, list[Ints]] = {1: [], 2: []}
    groups: dict[tuple[int, str], list[Ints]] = {}
    for number, block in enumerate(file.cells):
        nodes = np.asarray(block.data, dtype=np.int64)
        if block.dim < 1 or not nodes.size:
            continue
        if block.type not in _CORNERS:
            raise InputError(
                "path",
                shown,
                f"holds elements of the kind {block.type!r}",
                f"{_FIRST_ORDER}, of plane triangles only (without recombination)",
            )
        if nodes.min() < 0 or nodes.max() >= len(file.points):
            raise InputError("path", shown, "elements have nodes that it lacks", "write it anew")
        before = sum(map(len, found[block.dim]))
        found[block.dim].append(nodes[:, :2] if block.dim == 1 else nodes)
        for name, rows in _groups(file, number, block.dim):
            groups.setdefault((block.dim, name), []).append(rows + before)
    if not found[2]:
        raise InputError("path", shown, "holds no triangles", "mesh the surfaces, and save them")
    if len({nodes.shape[1] for nodes in found[2]}) > 1:
        raise InputError("path", shown, "holds triangles of two orders", _FIRST_ORDER)
    lines = np.concatenate([np.empty((0, 2), dtype=np.int64), *found[1]])
    return (
        lines,
        np.concatenate(found[2]),
        {key: np.unique(np.concatenate(rows)) for key, rows in groups.items()},
    )


def _groups(file: Any, block: int, dim: int) -> Iterator[tuple[str, Ints]]:
    """Groups with elements of a block: name, rows of the block."""
    for name, sets in file.cell_sets.items():
        rows = sets[block]
        if not name.startswith("gmsh:") and rows is not None and len(rows):
            yield name, np.asarray(rows, dtype=np.int64)
    if "gmsh:physical" in file.cell_data:
        names = {tuple(map(int, tag)): name for name, tag in file.field_data.items()}
        tags = np.asarray(file.cell_data["gmsh:physical"][block])
        for tag in np.unique(tags[tags > 0]).tolist():
            # Of groups without a name the reader has a part only, where they overlap others.
            if (tag, dim) in names:
                yield names[tag, dim], np.flatnonzero(tags == tag)


def _plane(points: Floats, triangles: Ints, shown: str) -> Floats:
    """Coordinates (n, 2) of nodes in a plane of constant z."""
    if not np.all(np.isfinite(points)):
        raise InputError("path", shown, "has nodes that are not finite", "mend their coordinates")
    require_range(f"path = {shown!r}, coordinates", points)
    used = points[np.unique(triangles)]
    if points.shape[1] == 3:
        height = used[:, 2]
        if np.ptp(height) > _FLAT * np.linalg.norm(np.ptp(used, axis=0)):
            raise InputError(
                "path",
                shown,
                f"is not plane: z goes from {height.min():.6g} to {height.max():.6g}",
                "draw the surface in the plane of x and y",
            )
    return points[:, :2]


def _check_straight(points: Floats, triangles: Ints, shown: str) -> None:
    """Midside nodes, where there are any, must lie on the straight edge between the vertices."""
    for corner, middle in enumerate(range(3, triangles.shape[1])):
        start, end = points[triangles[:, corner]], points[triangles[:, (corner + 1) % 3]]
        at, along = points[triangles[:, middle]] - start, end - start
        off = np.abs(at[:, 0] * along[:, 1] - at[:, 1] * along[:, 0])
        squares = np.sum(along**2, axis=1)
        curved = np.flatnonzero(off > _FLAT * squares)
        if curved.size:
            first = curved[0]
            raise InputError(
                "path",
                shown,
                f"has a curved edge, from {start[first]} to {end[first]}",
                f"{_FIRST_ORDER}, and say Body(geometry='approximated')",
            )


def _numbering(points: Floats, triangles: Ints, lines: Ints, merge: float) -> tuple[Ints, Ints]:
    """Number of the vertex that each node is (-1: none), and the node that each vertex is.

    Vertices keep the order of the first node of a triangle that they are made of.
    """
    corners = np.unique(triangles)
    used = np.union1d(corners, lines)
    size = float(np.linalg.norm(np.ptp(points[corners], axis=0)))
    cluster: Ints = np.arange(len(points))
    if merge > 0:
        pairs = used[cKDTree(points[used]).query_pairs(merge * size, output_type="ndarray")]
        links = coo_matrix((np.ones(len(pairs)), pairs.T), shape=(len(points),) * 2)
        cluster = np.asarray(connected_components(links, directed=False)[1], dtype=np.int64)
    clusters, first = np.unique(cluster[corners], return_index=True)
    order = np.argsort(first)
    vertex = np.full(len(points), -1)  # of each cluster; none where no triangle has a node of it
    vertex[clusters[order]] = np.arange(clusters.size)
    return vertex[cluster], corners[first[order]]


def _facets(
    mesh: MeshTri,
    number: Ints,
    lines: Ints,
    points: Floats,
    groups: dict[tuple[int, str], Ints],
    shown: str,
) -> Ints:
    """Facet of each line, -1 of those in no group."""
    names = {int(row): name for (dim, name), rows in groups.items() if dim == 1 for row in rows}
    known = {ends: facet for facet, ends in enumerate(map(tuple, mesh.facets.T.tolist()))}
    facets = np.full(len(lines), -1)
    for row, name in names.items():
        facet = known.get(tuple(sorted(number[lines[row]].tolist())))
        if facet is None:
            start, end = points[lines[row]]
            raise InputError(
                "path",
                shown,
                f"a line of the group {name!r}, from {start} to {end}, is no edge of a triangle",
                "embed its curve in the surface, or take it out of the group",
            )
        facets[row] = facet
    return facets


def _restricted(mesh: MeshTri, surface: str) -> MeshTri:
    """The triangles of one group; groups of lines elsewhere are forgotten."""
    groups = mesh.subdomains or {}
    if surface not in groups:
        mend = suggest_all(surface, groups) if groups else "give none: the file names no surfaces"
        raise InputError("surface", surface, "no such group of surfaces", mend)
    part = mesh.restrict(groups[surface])
    lines = {name: facets for name, facets in (part.boundaries or {}).items() if facets.size}
    return (
        MeshTri(part.p, part.t)
        .with_boundaries(lines)
        .with_subdomains({surface: np.arange(part.nelements)})
    )
