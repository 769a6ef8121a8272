"""Water in the pores of a continuum and on its boundary, as values at vertices (T64)."""

from dataclasses import replace
from functools import singledispatch
from typing import Any, TypeVar

import numpy as np
from skfem import Mesh

from lacore.model.bodies.continuum.boundaries import allowed, size_of
from lacore.model.conditions.loads import Load
from lacore.model.conditions.water import PorePressure, StandingWater, WaterTable
from lacore.model.meshes.curved import vertices
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.errors import InputError
from lacore.reporting.showing import counted

Wet = TypeVar("Wet", PorePressure, StandingWater)
_SNAP = 1e-4  # by the size: a table closer to vertices lies on them, 1 mm on ten metres


@singledispatch
def in_pores(load: Load, mesh: Mesh, field: str) -> Floats:
    """Return the pore pressure at the vertices of a mesh, Pa, (vertices,); 0 for other loads.

    Raises:
        InputError: suction, NaN, values of another mesh, or a water table that passes through
            elements; it names the `field` of the load.
    """
    return np.zeros(mesh.nvertices)


@in_pores.register(PorePressure)
def _of_pores(load: PorePressure, mesh: Mesh, field: str) -> Floats:
    load = _aligned(load, mesh)
    _require_linear(load.pressure, mesh, mesh.t, f"{field}.pressure")
    return load.at(vertices(mesh), field)


def on_facets(load: StandingWater, mesh: Mesh, facets: Ints, field: str) -> Floats:
    """Return the pressure at the vertices on facets, 0 at the others, Pa, shape (vertices,).

    Raises:
        InputError: see `in_pores`.
    """
    places = vertices(mesh)
    load = _aligned(load, mesh)
    _require_linear(load.pressure, mesh, mesh.facets[:, facets], f"{field}.pressure")
    ends = np.unique(mesh.facets[:, facets])
    values = np.zeros(places.shape[1])
    values[ends] = load.at(places[:, ends], field)
    return values


def snapped(pressure: Any, mesh: Mesh) -> Any:
    """Return a water table at the height of the vertices that it nearly meets, or what is given."""
    if not isinstance(pressure, WaterTable):
        return pressure
    heights = vertices(mesh)[1]
    nearest = float(heights[np.argmin(np.abs(heights - pressure.height))])
    close = allowed(mesh) < abs(nearest - pressure.height) <= _SNAP * size_of(mesh)
    return replace(pressure, height=nearest) if close else pressure


def _aligned(load: Wet, mesh: Mesh) -> Wet:
    pressure = snapped(load.pressure, mesh)
    return load if pressure is load.pressure else replace(load, pressure=pressure)


@singledispatch
def _require_linear(pressure: object, mesh: Mesh, corners: Ints, field: str) -> None:
    """Raise `InputError` for a pressure known not to be linear between corners (k, parts)."""


@_require_linear.register(WaterTable)
def _of_table(pressure: WaterTable, mesh: Mesh, corners: Ints, field: str) -> None:
    heights = vertices(mesh)[1, corners]
    cut = _cut(heights, pressure.height, allowed(mesh))
    if not cut:
        return
    rows = [y for y in np.unique(heights).tolist() if not _cut(heights, y, allowed(mesh))]
    nearest = sorted(sorted(rows, key=lambda y: abs(y - pressure.height))[:2])
    raise InputError(
        field,
        pressure.height,
        f"the water table passes through {counted(cut, 'element')}, in which the pressure would"
        " have to be linear",
        "put vertices of the mesh all along it, or it along such a row:"
        f" y = {' and '.join(f'{y:.6g}' for y in nearest)} are near",
    )


def _cut(heights: Floats, level: float, allowed: float) -> int:
    """Return the number of parts that a level intersects, by their corner heights, (k, parts)."""
    low, high = heights.min(axis=0), heights.max(axis=0)
    return int(np.sum((low < level - allowed) & (high > level + allowed)))
