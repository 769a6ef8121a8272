"""Mesh helpers on scikit-fem: rectangles, crossed and graded, and a quarter ring.

Any `skfem.MeshTri` with named boundaries serves as well.
"""

from collections.abc import Sequence
from dataclasses import replace
from math import isfinite, log1p, pi
from typing import Any

import numpy as np
from skfem import MeshQuad, MeshTri

from lacore.arrays import Floats
from lacore.errors import InputError


def graded(
    start: float, stop: float, cells: int, grade: tuple[float, float] | None = None
) -> Floats:
    """Coordinates of a graded row of cells, shape (cells + 1,), in the unit of `start`.

    Args:
        start, stop: ends of the row, ``start < stop``.
        cells: number of cells.
        grade: ``(at, ratio)``: cells shrink towards `at`, which becomes a vertex; the largest
            cell is about `ratio` times the smallest. Cell size grows linearly with distance.

    Raises:
        InputError: an empty row, no cells, a point outside the row, a ratio below 1.
    """
    if not (isfinite(start) and isfinite(stop) and start < stop):
        raise InputError(
            "extent", (start, stop), "not an interval", "give (start, stop), start<stop"
        )
    if not (isinstance(cells, (int, np.integer)) and cells >= 1):
        raise InputError("cells", cells, "not a positive whole number", "give at least one cell")
    if grade is None:
        return np.linspace(start, stop, cells + 1)
    at, ratio = grade
    if not start <= at <= stop:
        raise InputError(
            "grade", grade, f"the point lies outside [{start}, {stop}]", "move it inside"
        )
    if not (isfinite(ratio) and ratio >= 1):
        raise InputError(
            "grade", grade, "the ratio of largest to smallest cell is below 1", "give ratio >= 1"
        )
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
    if left > 0 and right > 0 and cells < 2:
        raise InputError(
            "cells", cells, f"one cell cannot have a vertex at {at}", "give at least two"
        )
    row = np.concatenate(
        [at - one_side(left, count)[:0:-1], [at], at + one_side(right, cells - count)[1:]]
    )
    row[0], row[-1] = start, stop
    return row


def rectangle(
    x: tuple[float, float],
    y: tuple[float, float],
    nx: int,
    ny: int,
    crossed: bool = True,
    grade_x: tuple[float, float] | None = None,
    grade_y: tuple[float, float] | None = None,
) -> MeshTri:
    """Triangle mesh of a rectangle with boundaries `left`, `right`, `bottom`, `top`.

    Args:
        x, y: extents.
        nx, ny: cells in each direction.
        crossed: four triangles a cell around its centre (the better choice for limit analysis);
            else two.
        grade_x, grade_y: ``(at, ratio)``, see `graded`.

    Raises:
        InputError: see `graded`.
    """
    cells = _cells(x, y, nx, ny, grade_x, grade_y)
    return _named(cells.to_meshtri(style="x" if crossed else None))


def quadrilaterals(
    x: tuple[float, float],
    y: tuple[float, float],
    nx: int,
    ny: int,
    grade_x: tuple[float, float] | None = None,
    grade_y: tuple[float, float] | None = None,
) -> MeshQuad:
    """The cells of `rectangle` themselves, for the space `q2`, with the same boundaries."""
    return _named(_cells(x, y, nx, ny, grade_x, grade_y))


def _named(mesh: Any) -> Any:
    """A mesh of a rectangle with its sides named."""
    # By exact coordinates: the default names of scikit-fem go by `numpy.isclose` and take in facets
    # beside the boundary where cells are long and thin or far from the origin.
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
    """Quarter ring in x, y >= 0 with boundaries `bore`, `outside`, `x_axis`, `y_axis`.

    The circles are polygons with straight edges: set ``Body(geometry="approximated")``.

    Args:
        inner, outer: radii.
        n_radial, n_angular: cells along the radius and around the quarter.
        crossed: see `rectangle`.
        grade: ratio of the outermost cell to the innermost.

    Raises:
        InputError: see `graded`; an inner radius that is not positive.
    """
    if not inner > 0:
        raise InputError("inner", inner, "not a positive radius", "give inner > 0")
    cells = _cells((inner, outer), (0, pi / 2), n_radial, n_angular, grade_x=(inner, grade))
    r, angle = cells.p
    points = np.stack([r * np.cos(angle), r * np.sin(angle)])
    points[0, angle == pi / 2] = 0.0
    # Crossed when bent: the centre of a flat cell would land beyond the chord of a thin one.
    bent = replace(cells, doflocs=points).to_meshtri(style="x" if crossed else None)
    flat = rectangle((inner, outer), (0, pi / 2), n_radial, n_angular, crossed, (inner, grade))
    names = {"left": "bore", "right": "outside", "bottom": "x_axis", "top": "y_axis"}
    return bent.with_boundaries(
        {names[name]: facets for name, facets in flat.boundaries.items()},
    )


def split(mesh: MeshTri, elements: Sequence[int]) -> MeshTri:
    """The mesh with elements split in three about their centroids; boundaries keep their names.

    For corners that one element fills, where linear stresses cannot follow tractions on both sides
    (`lacore.lower_bound`).
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
    return finer.with_boundaries(
        {
            name: np.array([number[tuple(ends)] for ends in mesh.facets[:, facets].T.tolist()])
            for name, facets in (mesh.boundaries or {}).items()
        }
    )


def _cells(
    x: tuple[float, float],
    y: tuple[float, float],
    nx: int,
    ny: int,
    grade_x: tuple[float, float] | None = None,
    grade_y: tuple[float, float] | None = None,
) -> MeshQuad:
    return MeshQuad.init_tensor(graded(x[0], x[1], nx, grade_x), graded(y[0], y[1], ny, grade_y))
