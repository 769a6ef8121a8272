"""Three-dimensional blocks from files: assemblies of compas, surfaces of OBJ, PLY and STL."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from lacore.model.bodies.blocks.drawings.compas import SUPPORT, meshes_of
from lacore.model.bodies.blocks.drawings.reading import json_of
from lacore.model.bodies.blocks.joints import JointFriction
from lacore.model.bodies.blocks3d.block_assembly import BlockAssembly3D
from lacore.model.bodies.blocks3d.builders.repair import Mesh, repaired
from lacore.model.bodies.blocks3d.crushing import Crushing
from lacore.model.bodies.blocks3d.polyhedron import Polyhedron
from lacore.model.materials.friction import Friction
from lacore.model.meshes.files.formats import loaded
from lacore.model.meshes.files.notes import noted
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.errors import InputError, require_known, require_positive, typed
from lacore.reporting.units import METRES

_SNAP = 1e-5  # by the size of the file: a tenth of a millimetre on ten metres
_SURFACES = (".obj", ".ply", ".stl")


@typed()
def read(
    path: str | PathLike[str],
    friction: float | Friction,
    tolerance: float | None = None,
    joint_friction: JointFriction | None = None,
    unit: str = "m",
    crushing: float | Crushing | None = None,
) -> BlockAssembly3D:
    """Read blocks from an assembly of compas (JSON), or closed surfaces of OBJ, PLY or STL.

    Blocks of compas are named after the nodes of their graph, supports ``support KEY``. A file of
    surfaces is divided into closed ones, "1", "2", ... in the order of the file, each contiguous in
    it; polygons in one plane make one face, and those that collapse to a line are dropped. Warped
    faces are cut into triangles, a block that is there twice is read once, and an open plane
    surface with all other blocks on one side is fixed ground, extended to a slab ``support NAME``.
    `print` of the assembly shows what was changed.

    Args:
        path: path of the file: .json, .obj, .ply or .stl.
        friction: law of all joints; `joint_friction` for single pairs.
        crushing: their strength in compression, Pa, if finite.
        tolerance: m; 1e-5 of the overall size if None. Closer vertices of surfaces are merged;
            blocks may have gaps or overlaps by as much.
        unit: unit of the file: "m", "dm", "cm", "mm", "km", "in", "ft", "yd".

    Raises:
        InputError: a file that cannot be read; anything that `Polyhedron` and `BlockAssembly3D`
            reject, with
            the name of the block.

    Example:
        >>> corners = [f"v {x} {y} {z}" for x in (0, 1) for y in (0, 1) for z in (0, 1)]
        >>> faces = ["f 1 2 4 3", "f 5 7 8 6", "f 1 5 6 2", "f 3 4 8 7", "f 1 3 7 5", "f 2 6 8 4"]
        >>> with open("cube.obj", "w") as file:
        ...     for line in corners + faces:
        ...         print(line, file=file)
        >>> la.masonry3d.read("cube.obj", friction=0.6).names
        ('1',)
    """
    shown = fspath(path)
    require_known("unit", unit, METRES)
    if tolerance is not None:
        require_positive("tolerance", tolerance)
    if not Path(shown).is_file():
        raise InputError("path", shown, "no such file", "give the path of a file")
    ending = Path(shown).suffix.lower()
    if ending not in (".json", *_SURFACES):
        fix = f"give a .json of compas, or one of {', '.join(_SURFACES)}"
        raise InputError("path", shown, "a format that is not known", fix)
    if ending == ".json":
        meshes = {
            f"support {key}" if layer == SUPPORT else key: mesh
            for key, layer, mesh in meshes_of(shown, json_of(shown))
        }
        allowed = tolerance or _SNAP * METRES[unit] * _size(
            [points for points, _ in meshes.values()]
        )
    else:
        with np.errstate(over="ignore"):  # meshio first interprets text of STL as a number.
            points, faces = _polygons(shown, loaded(Path(shown)))
        allowed = tolerance or _SNAP * METRES[unit] * _size([points])
        found = _apart(*_merged(points, faces, allowed / METRES[unit]))
        meshes = {str(number): mesh for number, mesh in enumerate(found, start=1)}
    scaled = {name: (points * METRES[unit], faces) for name, (points, faces) in meshes.items()}
    sound, notes = repaired(scaled, allowed)
    blocks = {name: _block(shown, name, mesh, allowed) for name, mesh in sound.items()}
    assembly = BlockAssembly3D(blocks, friction, joint_friction, allowed, crushing)
    noted(assembly, (f"{Path(shown).name}, lengths in {unit}", *notes))
    return assembly


def _block(path: str, name: str, mesh: Mesh, tolerance: float) -> Polyhedron:
    try:
        return Polyhedron(*mesh, tolerance)
    except InputError as error:
        why = f"block {name!r}, {error.field}: {error.reason}"
        raise InputError("path", path, why, error.fix) from error


def _size(points: Sequence[Floats]) -> float:
    return float(np.linalg.norm(np.ptp(np.concatenate(points), axis=0)))


def _polygons(path: str, file: Any) -> Mesh:
    """Return the vertices and polygons of a surface from meshio."""
    cells = [block for block in file.cells if block.dim == 2]
    points = np.asarray(file.points, dtype=np.float64)
    faces = [[int(n) for n in polygon] for block in cells for polygon in block.data]
    if not faces or points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
        why = "holds no polygons with vertices (x, y, z)"
        raise InputError("path", path, why, "write closed surfaces into it")
    if not all(0 <= n < len(points) for polygon in faces for n in polygon):
        raise InputError("path", path, "polygons have vertices that it lacks", "write it anew")
    return points, faces


def _merged(points: Floats, faces: list[list[int]], tolerance: float) -> Mesh:
    """Return the mesh with close vertices merged and collapsed polygons dropped."""
    near = cKDTree(points).query_pairs(tolerance, output_type="ndarray")
    number = len(points)
    graph = coo_matrix((np.ones(len(near)), tuple(near.T)), shape=(number, number))
    _, label = connected_components(graph, directed=False)
    _, first = np.unique(label, return_index=True)
    kept = []
    for polygon in faces:
        own = [int(label[n]) for n in polygon]
        own = [n for k, n in enumerate(own) if n != own[k - 1]]
        if len(set(own)) > 2:
            kept.append(own)
    return points[first], kept


def _apart(points: Floats, faces: list[list[int]]) -> list[Mesh]:
    """Return the closed surfaces of a file.

    Where blocks touch along an edge, more than two polygons meet: those that follow each other in
    the file belong together.
    """
    start = np.concatenate(faces) if faces else np.zeros(0, dtype=np.int64)
    counts = np.array([len(polygon) for polygon in faces], dtype=np.int64)
    owner = np.repeat(np.arange(counts.size), counts)
    end = np.concatenate([np.roll(polygon, -1) for polygon in faces])
    key = np.minimum(start, end) * len(points) + np.maximum(start, end)
    order = np.lexsort((owner, key))
    turn = _place_in_run(key[order])
    second = np.flatnonzero(turn % 2 == 1)
    one, other = owner[order[second - 1]], owner[order[second]]
    graph = coo_matrix((np.ones(one.size), (one, other)), shape=(counts.size, counts.size))
    _, part = connected_components(graph, directed=False)
    found: dict[int, list[list[int]]] = {}
    for polygon, label in zip(faces, part.tolist(), strict=True):
        found.setdefault(label, []).append(polygon)
    meshes = []
    for own in found.values():
        used = np.unique(np.concatenate(own))
        meshes.append((points[used], [np.searchsorted(used, polygon).tolist() for polygon in own]))
    return meshes


def _place_in_run(ascending: Ints) -> Ints:
    """Return 0, 1, 2, ... in each run of equal values."""
    begin = np.flatnonzero(np.diff(ascending, prepend=-1))
    run = np.cumsum(np.diff(ascending, prepend=-1) != 0) - 1
    return np.asarray(np.arange(ascending.size) - begin[run])
