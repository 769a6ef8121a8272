"""Meshes of several adjacent quadrangles: slopes, walls with openings, layers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree
from skfem import MeshTri

from lacore.model.meshes.checks import check_hanging
from lacore.model.meshes.polygonal import labelled
from lacore.model.meshes.structured import rectangle
from lacore.numerics.arrays import Floats
from lacore.reporting.errors import InputError, is_plane_vector, require_place
from lacore.reporting.showing import Compact

_SAME = 1e-9  # by the size: difference of the bilinear maps of a side from its two patches
Grade = tuple[float, float]


@dataclass(frozen=True, repr=False)
class Patch(Compact):
    """Quadrangle divided into cells.

    Attributes:
        corners: four corners, anticlockwise, convex, m.
        nx: number of cells along the first side, between the first two corners, and the third.
        ny: number of cells along the other two sides.
        grade_x, grade_y: ``(at, ratio)`` see `lacore.model.meshes.graded`, with `at` as a share of
            the side from the first corner.
        name: name of its elements as a subdomain; may be empty.

    Raises:
        InputError: corners that are not a convex quadrangle, anticlockwise.

    Example:
        >>> skew = la.meshes.Patch([(0, 0), (2, 0), (3, 1), (1, 1)], nx=4, ny=2)
        >>> la.meshes.patches([skew]).nelements
        32
    """

    corners: Sequence[tuple[float, float]]
    nx: int
    ny: int
    grade_x: Grade | None = None
    grade_y: Grade | None = None
    name: str = ""

    def __post_init__(self) -> None:
        given = self.corners
        if len(given) != 4 or not all(map(is_plane_vector, given)):
            raise InputError("Patch.corners", given, "not four points", "give four (x, y)")
        require_place("Patch.corners", given)
        points = np.array(given, dtype=float)
        along = np.roll(points, -1, axis=0) - points
        after = np.roll(along, -1, axis=0)
        turn = along[:, 0] * after[:, 1] - along[:, 1] * after[:, 0]
        if not np.all(turn > 0):
            raise InputError(
                "Patch.corners",
                given,
                "no convex quadrangle, or clockwise",
                "give its corners anticlockwise, each once",
            )

    def mesh(self, crossed: bool) -> MeshTri:
        """Return its triangles."""
        cells = rectangle((0.0, 1.0), (0.0, 1.0), self.nx, self.ny, crossed, self.grade_x,
                          self.grade_y)  # fmt: skip
        s, t = cells.p
        shares = np.stack([(1 - s) * (1 - t), s * (1 - t), s * t, (1 - s) * t])
        return MeshTri(np.ascontiguousarray(np.transpose(self.corners) @ shares), cells.t)


def patches(parts: Sequence[Patch], crossed: bool = True) -> MeshTri:
    """Return a triangle mesh of quadrangles that share whole sides with equal cells.

    Boundaries `left`, `right`, `bottom`, `top` are the edges on the sides of the bounding box, if
    there are any; subdomains have the names of the parts. A `Body` takes the outline as exact,
    unless it is given ``geometry="approximated"``.

    Args:
        parts: quadrangles in any order.
        crossed: see `lacore.model.meshes.rectangle`.

    Raises:
        InputError: no part, or sides that touch with other cells. The body rejects other
            mismatches.

    Example:
        >>> left = la.meshes.Patch([(0, 0), (1, 0), (1, 1), (0, 1)], nx=2, ny=2)
        >>> right = la.meshes.Patch([(1, 0), (2, 0), (2, 1), (1, 1)], nx=2, ny=2)
        >>> la.meshes.patches([left, right]).nelements
        32
    """
    listed = isinstance(parts, Sequence) and len(parts) > 0
    if not listed or not all(isinstance(part, Patch) for part in parts):
        why = "no list of patches" if parts else "there is none"
        raise InputError("parts", parts or None, why, "give [lacore.model.meshes.Patch(...), ...]")
    own = [part.mesh(crossed) for part in parts]
    points = np.concatenate([mesh.p for mesh in own], axis=1)
    first = np.cumsum([0, *(mesh.nvertices for mesh in own)])
    triangles = np.concatenate([m.t + at for m, at in zip(own, first[:-1], strict=True)], axis=1)
    size = float(np.linalg.norm(np.ptp(points, axis=1)))
    pairs = cKDTree(points.T).query_pairs(_SAME * size, output_type="ndarray")
    links = coo_matrix((np.ones(len(pairs)), pairs.T), shape=(points.shape[1],) * 2)
    number = connected_components(links, directed=False)[1]
    _, kept = np.unique(number, return_index=True)
    glued = MeshTri(np.ascontiguousarray(points[:, kept]), np.ascontiguousarray(number[triangles]))
    try:
        check_hanging(glued, "parts")
    except InputError as error:
        fix = "let parts share whole sides, with as many cells (nx, ny) on both, graded alike"
        raise InputError("parts", None, error.reason, fix) from error
    counts = np.cumsum([0, *(mesh.nelements for mesh in own)])
    names: dict[str, list[Floats]] = {}
    for part, begin, end in zip(parts, counts[:-1], counts[1:], strict=True):
        if part.name:
            names.setdefault(part.name, []).append(np.arange(begin, end))
    found: MeshTri = glued.with_boundaries(_sides(glued, _SAME * size)).with_subdomains(
        {name: np.concatenate(elements) for name, elements in names.items()}
    )
    return labelled(found, "exact")


def _sides(mesh: MeshTri, near: float) -> dict[str, Floats]:
    facets = mesh.boundary_facets()
    ends = mesh.p[:, mesh.facets[:, facets]]
    low, high = mesh.p.min(axis=1), mesh.p.max(axis=1)
    sides = {"left": (0, low), "right": (0, high), "bottom": (1, low), "top": (1, high)}
    on = {
        name: facets[np.all(np.abs(ends[axis] - corner[axis]) <= near, axis=0)]
        for name, (axis, corner) in sides.items()
    }
    return {name: own for name, own in on.items() if own.size}
