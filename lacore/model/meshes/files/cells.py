"""Elements of mesh files: their corners and midside nodes, groups, and division into triangles."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from lacore.numerics.arrays import Bools, Floats, Ints
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact, counted

FLAT = 1e-9  # by a length: deviation from a plane or line in files with 16 digits
TRIANGLES = "triangles"
# Corners and midside nodes of the elements of each dimension; a node in the centre is the last.
_KINDS: Mapping[int, Mapping[str, tuple[int, int]]] = {
    2: {"triangle": (3, 0), "triangle6": (3, 3), "quad": (4, 0), "quad8": (4, 4), "quad9": (4, 4)},
    3: {"tetra": (4, 0), "tetra10": (4, 6)},
}
_SIDES = {2: ("line", "line3"), 3: ("triangle", "triangle6")}
# Ends of edges, in the order in which midside nodes follow the corners.
_EDGES: Mapping[tuple[int, int], tuple[tuple[int, int], ...]] = {
    (2, 3): ((0, 1), (1, 2), (2, 0)),
    (2, 4): ((0, 1), (1, 2), (2, 3), (3, 0)),
    (3, 4): ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
}
_FIRST_ORDER = "save a mesh of first order (of gmsh: Mesh.ElementOrder = 1)"


@dataclass(frozen=True, eq=False, repr=False)
class Cells(Compact):
    """Elements of a file that have one shape.

    Attributes:
        dimension: 2 or 3.
        corners: nodes at the corners, (n, k).
        middles: midside nodes, (n, number of edges), or (n, 0) of first order.
        centres: node in the centre of quadrilaterals, (n,); -1 without one.
        sides: nodes at the corners of sides, (s, dimension).
        groups: rows of sides or elements, by dimension and name.
        notes: what was changed.
        by_chords: whether chords replace curved edges.
    """

    dimension: int
    corners: Ints
    middles: Ints
    centres: Ints
    sides: Ints
    groups: Mapping[tuple[int, str], Ints]
    notes: tuple[str, ...] = ()
    by_chords: bool = False

    def named(self, dimension: int, numbers: Ints) -> dict[str, Ints]:
        """Return the numbers of sides or elements in each group of a dimension, by its name."""
        return {
            name: np.unique(numbers[rows])
            for (own, name), rows in self.groups.items()
            if own == dimension
        }

    @property
    def edges(self) -> Ints:
        """Nodes at the ends of the edges of all elements, (n, edges, 2)."""
        return self.corners[:, np.array(_EDGES[self.dimension, self.corners.shape[1]])]

    def curved(self, points: Floats) -> Bools:
        """Return whether the midside nodes are off the straight line of their edge, (n, edges)."""
        if not self.middles.size:
            return np.zeros(self.middles.shape, dtype=bool)
        start, end = np.moveaxis(points[self.edges], 2, 0)
        at, along = points[self.middles] - start, end - start
        squares = np.sum(along**2, axis=2)
        share = np.sum(at * along, axis=2) / np.where(squares > 0, squares, 1.0)
        off = np.linalg.norm(at - share[:, :, None] * along, axis=2)
        return np.asarray(off > FLAT * np.sqrt(squares))


def cells_of(file: Any, points: Floats, dimension: int, wanted: str | None, shown: str) -> Cells:
    """Return the elements of a file of meshio.

    Args:
        file: the file.
        points: coordinates of its nodes, (n, dimension), m.
        dimension: 2 or 3.
        wanted: "triangles" divides quadrilaterals, and replaces curved edges by their chords.
        shown: path for messages.

    Raises:
        InputError: other kinds of elements, elements of two orders, or curved edges that cannot
            be kept.
    """
    kinds = _KINDS[dimension]
    parts: list[tuple[int, int, Ints]] = []
    sides: list[Ints] = [np.empty((0, dimension), dtype=np.int64)]
    groups: dict[tuple[int, str], list[Ints]] = {}
    count = {dimension - 1: 0, dimension: 0}
    for number, block in enumerate(file.cells):
        nodes = np.asarray(block.data, dtype=np.int64)
        if block.dim not in count or not nodes.size:
            continue
        if block.type not in (*kinds, *_SIDES[dimension]):
            plane = {2: "plane triangles and quadrilaterals only", 3: "tetrahedra only"}[dimension]
            what = f"holds elements of the kind {block.type!r}"
            raise InputError("path", shown, what, f"{_FIRST_ORDER}, of {plane}")
        if nodes.min() < 0 or nodes.max() >= len(file.points):
            raise InputError("path", shown, "elements have nodes that it lacks", "write it anew")
        for name, rows in _groups(file, number, block.dim):
            groups.setdefault((block.dim, name), []).append(rows + count[block.dim])
        count[block.dim] += len(nodes)
        if block.dim == dimension:
            parts.append((*kinds[block.type], nodes))
        else:
            sides.append(nodes[:, :dimension])
    if not parts:
        raise InputError("path", shown, "holds no triangles", "mesh the surfaces, and save them")
    if len({bool(middles) for _, middles, _ in parts}) > 1:
        raise InputError("path", shown, "holds elements of two orders", _FIRST_ORDER)
    own = {key: np.unique(np.concatenate(rows)) for key, rows in groups.items()}
    every = np.concatenate(sides)
    blocks = [_block(dimension, part, every) for part in parts]
    return _unified(blocks, own, points, wanted, shown)


def _block(dimension: int, part: tuple[int, int, Ints], sides: Ints) -> Cells:
    corners, middles, nodes = part
    last = corners + middles
    centres = nodes[:, last] if nodes.shape[1] > last else np.full(len(nodes), -1)
    return Cells(dimension, nodes[:, :corners], nodes[:, corners:last], centres, sides, {})


def _unified(
    blocks: list[Cells],
    groups: Mapping[tuple[int, str], Ints],
    points: Floats,
    wanted: str | None,
    shown: str,
) -> Cells:
    """Return elements of one shape: those of the file, or triangles."""
    dimension = blocks[0].dimension
    collapsed = [_repeated(own) if own.corners.shape[1] == 4 else None for own in blocks]
    mixed = len({own.corners.shape[1] for own in blocks}) > 1
    mixed |= dimension == 2 and any(own is not None and own.any() for own in collapsed)
    curved = [own.curved(points) for own in blocks]
    bent = sum(int(own.sum()) for own in curved)
    if bent and (dimension == 3 or (mixed and wanted is None)):
        raise _curved(blocks, curved, points, shown)
    if dimension == 2 and (mixed or wanted == TRIANGLES):
        return _divided(blocks, groups, points, bent)
    return replace(
        blocks[0],
        corners=np.concatenate([own.corners for own in blocks]),
        middles=np.concatenate([own.middles for own in blocks]),
        centres=np.concatenate([own.centres for own in blocks]),
        groups=groups,
    )


def _divided(
    blocks: list[Cells], groups: Mapping[tuple[int, str], Ints], points: Floats, bent: int
) -> Cells:
    """Return the triangles of plane elements, of which `bent` sides are curved."""
    first = np.cumsum([0, *(len(own.corners) for own in blocks)])
    found = [_triangles(own.corners, points) for own in blocks]
    corners = np.concatenate([own for own, _ in found])
    owner = np.concatenate([own + begin for (_, own), begin in zip(found, first, strict=False)])
    quads = sum(len(own.corners) for own in blocks if own.corners.shape[1] == 4)
    notes = [f"{counted(quads, 'quadrilateral')} divided into triangles"] if quads else []
    if bent:
        notes.append(f"{counted(bent, 'curved side')} of elements replaced by chords")
    return replace(
        blocks[0],
        corners=corners,
        middles=np.empty((len(corners), 0), dtype=np.int64),
        centres=np.full(len(corners), -1),
        groups={
            key: np.flatnonzero(np.isin(owner, rows)) if key[0] == 2 else rows
            for key, rows in groups.items()
        },
        notes=tuple(notes),
        by_chords=bent > 0,
    )


def _repeated(own: Cells) -> Bools:
    """Return which quadrilaterals have a corner twice: triangles of some programs."""
    return np.asarray(np.any(own.corners == np.roll(own.corners, 1, axis=1), axis=1))


def _triangles(corners: Ints, points: Floats) -> tuple[Ints, Ints]:
    """Return the triangles of elements, (t, 3), and the element of each.

    A quadrilateral is cut along the diagonal that leaves the better of the two worst triangles.
    """
    every = np.arange(len(corners))
    if corners.shape[1] == 3:
        return corners, every
    ways = np.array([[(0, 1, 2), (0, 2, 3)], [(1, 2, 3), (1, 3, 0)]])
    parts = corners[:, ways]  # (n, way, part, corner)
    place = points[parts]
    one, two = place[..., 1, :] - place[..., 0, :], place[..., 2, :] - place[..., 0, :]
    area = one[..., 0] * two[..., 1] - one[..., 1] * two[..., 0]
    area *= np.sign(area.sum(axis=2, keepdims=True))
    squares = np.sum(one**2 + two**2 + (one - two) ** 2, axis=-1)
    shape = area / np.where(squares > 0, squares, 1.0)
    best = np.argmax(shape.min(axis=2) > shape.min(axis=2)[:, :1], axis=1)
    triangles = parts[every, best].reshape(-1, 3)
    owner = np.repeat(every, 2)
    whole = np.all(np.diff(np.sort(triangles, axis=1), axis=1) > 0, axis=1)
    return triangles[whole], owner[whole]


def _curved(blocks: list[Cells], curved: list[Bools], points: Floats, shown: str) -> InputError:
    """Return the error for curved edges that cannot be kept."""
    block = next(n for n, own in enumerate(curved) if own.any())
    start, end = points[blocks[block].edges[curved[block]][0]]
    if blocks[0].dimension == 3:
        fix = f"{_FIRST_ORDER}, and say Body(geometry='approximated')"
        return InputError("path", shown, f"has a curved edge, from {start} to {end}", fix)
    why = f"has a curved edge, from {start} to {end}, and both triangles and quadrilaterals"
    return InputError("path", shown, why, "give elements='triangles', which takes the chords")


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
