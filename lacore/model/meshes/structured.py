"""Builders of scikit-fem meshes: rectangles, graded meshes, rings.

Any `skfem.MeshTri` with named boundaries can be used as well.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import isfinite, log1p, pi
from typing import Any

import numpy as np
from skfem import MeshQuad, MeshTri

from lacore.model.meshes.polygonal import geometry_of, labelled
from lacore.model.meshes.refinement import with_named_elements
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.errors import InputError, is_number, is_vector, require_range, typed

_STRAIGHT = 1e-9  # by unit vectors: round-off of places


def graded(
    start: float, stop: float, cells: int, grade: tuple[float, float] | None = None
) -> Floats:
    """Return the coordinates of a graded row of cells, (cells + 1,), in the unit of `start`.

    Args:
        start, stop: ends of the row, ``start < stop``.
        cells: number of cells.
        grade: ``(at, ratio)``: cells shrink towards `at`, which becomes a vertex; the largest
            cell is about `ratio` times the smallest. Cell size grows linearly with distance.

    Raises:
        InputError: an empty row, no cells, a point outside the row, a ratio below 1.

    Example:
        >>> la.meshes.graded(0.0, 1.0, 4, grade=(0.0, 4.0)).round(2).tolist()  # small cells at 0
        [0.0, 0.14, 0.33, 0.61, 1.0]
    """
    return _row(start, stop, cells, grade, ("extent", "cells", "grade"))


def along_axis(
    axis: str, ends: tuple[float, float], cells: int, grade: tuple[float, float] | None
) -> Floats:
    """Return the coordinates of an axis ``x``: errors name ``x``, ``nx``, ``grade_x``.

    Raises:
        InputError: see `graded`; `ends` that are not a pair.
    """
    if not is_vector(ends) or len(ends) != 2:
        raise InputError(axis, ends, "not an interval", f"give ({axis}0, {axis}1), two numbers")
    return _row(ends[0], ends[1], cells, grade, (axis, f"n{axis}", f"grade_{axis}"))


def _row(
    start: float,
    stop: float,
    cells: int,
    grade: tuple[float, float] | None,
    fields: tuple[str, str, str],
) -> Floats:
    """Return the coordinates, see `graded`; `fields` are the names of its arguments in errors."""
    _check_row(start, stop, cells, grade, fields)
    if grade is None:
        return np.linspace(start, stop, cells + 1)
    at, ratio = grade
    reach = max(at - start, stop - at)
    growth = ratio - 1

    def one_side(length: float, count: int) -> Floats:
        share = np.linspace(0, 1, count + 1)
        if growth * length < 1e-9 * reach:
            return length * share
        return reach / growth * np.expm1(share * log1p(growth * length / reach))

    def depth(length: float) -> float:
        return log1p(growth * length / reach) if growth * length >= 1e-9 * reach else length / reach

    left, right = at - start, stop - at
    count = round(cells * depth(left) / (depth(left) + depth(right)))
    count = min(max(count, 1 if left > 0 else 0), cells - 1 if right > 0 else cells)
    row = np.concatenate(
        [at - one_side(left, count)[:0:-1], [at], at + one_side(right, cells - count)[1:]]
    )
    row[0], row[-1] = start, stop
    return row


def _check_row(
    start: float,
    stop: float,
    cells: int,
    grade: tuple[float, float] | None,
    fields: tuple[str, str, str],
) -> None:
    """Require an extent, cells, and a place and a ratio of a grade if there is one."""
    extent, count_of, graded_by = fields
    if not (is_number(start) and is_number(stop) and start < stop):
        raise InputError(extent, (start, stop), "not an interval", "give (start, stop), start<stop")
    require_range(extent, (start, stop))
    if not (isinstance(cells, (int, np.integer)) and cells >= 1):
        raise InputError(count_of, cells, "not a positive whole number", "give at least one cell")
    if grade is None:
        return
    if not (isinstance(grade, Sequence | np.ndarray) and len(grade) == 2):
        fix = "give (at, ratio): a place, and the largest cell per smallest"
        raise InputError(graded_by, grade, "not a pair", fix)
    at, ratio = grade
    if not start <= at <= stop:
        raise InputError(
            graded_by, grade, f"the point lies outside [{start}, {stop}]", "move it inside"
        )
    if not (isfinite(ratio) and ratio >= 1):
        raise InputError(
            graded_by, grade, "the ratio of largest to smallest cell is below 1", "give ratio >= 1"
        )
    if start < at < stop and cells < 2:
        raise InputError(
            count_of, cells, f"one cell cannot have a vertex at {at}", "give at least two"
        )


def rectangle(
    x: tuple[float, float],
    y: tuple[float, float],
    nx: int,
    ny: int,
    crossed: bool = True,
    grade_x: tuple[float, float] | None = None,
    grade_y: tuple[float, float] | None = None,
) -> MeshTri:
    """Return a triangle mesh of a rectangle with boundaries `left`, `right`, `bottom`, `top`.

    Args:
        x, y: extents.
        nx, ny: number of cells in each direction.
        crossed: four triangles per cell around its centre (better for limit analysis);
            else two.
        grade_x, grade_y: ``(at, ratio)``, see `graded`.

    Raises:
        InputError: see `graded`.

    Example:
        >>> la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=4, ny=2).nelements  # four triangles a cell
        32
    """
    cells = _cells(x, y, nx, ny, grade_x, grade_y)
    return named_sides(cells.to_meshtri(style="x" if crossed else None))


def quadrilaterals(
    x: tuple[float, float],
    y: tuple[float, float],
    nx: int,
    ny: int,
    grade_x: tuple[float, float] | None = None,
    grade_y: tuple[float, float] | None = None,
) -> MeshQuad:
    """Return the cells of `rectangle`, for the space `q2`, with the same boundaries.

    Example:
        >>> la.meshes.quadrilaterals(x=(0, 2), y=(0, 1), nx=4, ny=2).nelements
        8
    """
    return named_sides(_cells(x, y, nx, ny, grade_x, grade_y))


def named_sides(mesh: Any) -> Any:
    """Return a mesh of a rectangle with its sides named."""
    # Exact coordinates are used, since the default names of scikit-fem use `numpy.isclose` and
    # include facets near the boundary if cells are long and thin or far from the origin.
    left, bottom = mesh.p.min(axis=1)
    right, top = mesh.p.max(axis=1)
    return mesh.with_boundaries(
        {
            "left": lambda middle: middle[0] == left,
            "right": lambda middle: middle[0] == right,
            "bottom": lambda middle: middle[1] == bottom,
            "top": lambda middle: middle[1] == top,
        }
    )


def quarter_ring(
    inner: float,
    outer: float,
    n_radial: int,
    n_angular: int,
    crossed: bool = True,
    grade: float = 1.0,
) -> MeshTri:
    """Return a quarter ring in x, y >= 0 with boundaries `bore`, `outside`, `x_axis`, `y_axis`.

    The circles are polygons with straight edges: a body with this mesh is
    ``geometry="approximated"``.

    Args:
        inner, outer: radii.
        n_radial, n_angular: number of cells along the radius and around the quarter.
        crossed: see `rectangle`.
        grade: ratio of the outermost cell to the innermost.

    Raises:
        InputError: see `graded`; an inner radius that is not positive, or an outer one that is
            smaller.

    Example:
        >>> ring = la.meshes.quarter_ring(inner=1.0, outer=2.0, n_radial=2, n_angular=6)
        >>> sorted(ring.boundaries)
        ['bore', 'outside', 'x_axis', 'y_axis']
    """
    if not inner > 0:
        raise InputError("inner", inner, "not a positive radius", "give inner > 0")
    if not outer > inner:
        raise InputError("outer", outer, "not beyond the inner radius", f"give more than {inner}")
    cells = _cells((inner, outer), (0, pi / 2), n_radial, n_angular, grade_x=(inner, grade))
    r, angle = cells.p
    points = np.stack([r * np.cos(angle), r * np.sin(angle)])
    points[0, angle == pi / 2] = 0.0
    # Cells are crossed after bending: the centre of a flat cell would be beyond the chord.
    bent = replace(cells, doflocs=points).to_meshtri(style="x" if crossed else None)
    flat = rectangle((inner, outer), (0, pi / 2), n_radial, n_angular, crossed, (inner, grade))
    names = {"left": "bore", "right": "outside", "bottom": "x_axis", "top": "y_axis"}
    ring: MeshTri = labelled(
        bent.with_boundaries({names[name]: facets for name, facets in flat.boundaries.items()}),
        "approximated",
    )
    return ring


@typed()
def split(mesh: MeshTri, elements: Sequence[int]) -> MeshTri:
    """Return the mesh with elements split in three at their centroids; all names are kept.

    This is needed for corners filled by one element, where linear stresses cannot follow tractions
    on both sides (`lacore.lower_bound`).

    Example:
        >>> mesh = la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=4, ny=2)
        >>> mesh.nelements, la.meshes.split(mesh, [0]).nelements
        (32, 34)
    """
    chosen = np.unique(np.asarray(elements, dtype=np.int64))
    if chosen.size and not (chosen[0] >= 0 and chosen[-1] < mesh.nelements):
        raise InputError(
            "elements", chosen.tolist(), "not elements of the mesh", f"0 to {mesh.nelements - 1}"
        )
    a, b, c = mesh.t[:, chosen]
    centre = mesh.p.shape[1] + np.arange(chosen.size)
    corners = [np.stack(three) for three in ((a, b, centre), (b, c, centre), (a, c, centre))]
    finer = MeshTri(
        np.concatenate([mesh.p, mesh.p[:, mesh.t[:, chosen]].mean(axis=1)], axis=1),
        np.concatenate([np.delete(mesh.t, chosen, axis=1), *corners], axis=1),
    )
    number = {ends: facet for facet, ends in enumerate(map(tuple, finer.facets.T.tolist()))}
    named: MeshTri = finer.with_boundaries(
        {
            name: np.array([number[tuple(ends)] for ends in mesh.facets[:, facets].T.tolist()])
            for name, facets in (mesh.boundaries or {}).items()
        }
    )
    kept = np.delete(np.arange(mesh.nelements), chosen)
    named = with_named_elements(named, mesh, np.concatenate([kept, np.tile(chosen, 3)]))
    return labelled(named, geometry_of(mesh))


@typed()
def unaligned(mesh: MeshTri, to: tuple[float, float] = (0.7, 0.64)) -> MeshTri:
    """Return the mesh with vertices moved at which four triangles meet along two straight lines.

    At such a vertex, the centre of each crossed cell, gradients of continuous velocities are
    dependent (it is singular: Scott and Vogelius 1985), so that some stresses have no forces.
    Problems of non-associated soil are solved in half as many steps without them. All names are
    kept; upper bounds are slightly higher, as for triangles.

    Args:
        mesh: mesh of straight triangles.
        to: new place in the quadrilateral around the vertex, from its lower left corner, as shares
            of its sides in (0, 1), off its diagonals; on both, vertices are not moved.

    Raises:
        InputError: a place outside, or one that leaves vertices singular; triangles that would be
            inverted.

    Example:
        >>> mesh = la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=4, ny=2)
        >>> la.meshes.unaligned(mesh).nelements == mesh.nelements  # with no lines to slide along
        True
    """
    if (
        not all(is_number(share) and 0 < share < 1 for share in to)
        or min(abs(to[0] - to[1]), abs(to[0] + to[1] - 1)) < _STRAIGHT
    ):
        raise InputError("to", to, "not a place inside, off its diagonals", "give e.g. (0.7, 0.64)")
    vertices, corners = _aligned(mesh)
    (a, b), around = to, mesh.p[:, corners]  # shape (2, 4, v), in order
    shares = np.array([(1 - a) * (1 - b), a * (1 - b), a * b, (1 - a) * b])
    places = mesh.p.copy()
    places[:, vertices] = np.einsum("i,xiv->xv", shares, around)
    moved: MeshTri = replace(mesh, doflocs=places)
    if np.any(_doubled_areas(moved) * _doubled_areas(mesh) <= 0):
        raise InputError(
            "to", to, "triangles of the mesh would be inverted", "a place nearer to (0.5, 0.5)"
        )
    return labelled(moved, geometry_of(mesh))


def _aligned(mesh: MeshTri) -> tuple[Ints, Ints]:
    """Return singular inner vertices, and the four around each from the lower left, (4, v)."""
    touching = np.bincount(mesh.t.ravel(), minlength=mesh.nvertices)
    inside = np.setdiff1d(np.flatnonzero(touching == 4), mesh.boundary_nodes())
    ends = np.concatenate([mesh.facets, mesh.facets[::-1]], axis=1)
    ends = ends[:, np.isin(ends[0], inside)]
    around = ends[1, np.argsort(ends[0], kind="stable")].reshape(-1, 4)
    arms = mesh.p[:, around] - mesh.p[:, inside][:, :, None]  # shape (2, v, 4)
    order = np.argsort(np.arctan2(arms[1], arms[0]), axis=1)  # from -pi on: lower left first
    around = np.take_along_axis(around, order, axis=1)
    arms = np.take_along_axis(arms, order[None], axis=2)
    arms /= np.linalg.norm(arms, axis=0)
    opposite = np.abs(arms[:, :, :2] + arms[:, :, 2:]).max(axis=(0, 2), initial=0.0)
    straight = opposite <= _STRAIGHT
    return inside[straight], around[straight].T


def _doubled_areas(mesh: MeshTri) -> Floats:
    first, second = (mesh.p[:, mesh.t[k]] - mesh.p[:, mesh.t[0]] for k in (1, 2))
    return np.asarray(first[0] * second[1] - first[1] * second[0])


def _cells(
    x: tuple[float, float],
    y: tuple[float, float],
    nx: int,
    ny: int,
    grade_x: tuple[float, float] | None = None,
    grade_y: tuple[float, float] | None = None,
) -> MeshQuad:
    return MeshQuad.init_tensor(along_axis("x", x, nx, grade_x), along_axis("y", y, ny, grade_y))
