"""Meshes whose edges follow layers, with elements named by layer."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from skfem import MeshQuad, MeshTri

from lacore.model.meshes.structured import along_axis, graded, named_sides
from lacore.reporting.errors import InputError, is_number, require_count, typed


@typed(layers="give {name: (from, to)}")
def layered(
    x: tuple[float, float],
    layers: Mapping[str, tuple[float, float]],
    nx: int,
    ny: int,
    crossed: bool = True,
    grade_x: tuple[float, float] | None = None,
) -> MeshTri:
    """Return a triangle mesh of level layers, which are its regions (``mesh.subdomains``).

    Args:
        x: extent.
        layers: extent in y by name: ``{"fill": (-1, 0), "clay": (-4, -1)}``, in any order, without
            gaps.
        nx: number of cells in x.
        ny: number of cells in the total height; each layer has its share, at least one.
        crossed, grade_x: see `lacore.model.meshes.rectangle`; its names of boundaries.

    Raises:
        InputError: layers that are not intervals, overlap, or leave gaps; see `graded`.

    Example:
        >>> ground = la.meshes.layered((0, 4), {"clay": (-2, -1), "sand": (-1, 0)}, nx=8, ny=4)
        >>> sorted(ground.subdomains)
        ['clay', 'sand']
    """
    if not layers:
        raise InputError("layers", dict(layers), "no layer", "give {name: (from, to)}")
    for name, extent in layers.items():
        good = len(extent) == 2 and all(map(is_number, extent)) and extent[0] < extent[1]
        if not good:
            raise InputError(
                f"layers[{name!r}]", extent, "not an interval", "give (from, to) in m, from < to"
            )
    order = sorted(layers, key=lambda name: layers[name][0])
    ends = [layers[name] for name in order]
    for below, above, name in zip(ends, ends[1:], order[1:], strict=False):
        if below[1] != above[0]:
            raise InputError(
                f"layers[{name!r}]",
                above,
                f"does not begin at {below[1]!r}, where the layer below ends",
                "let each begin where the one below ends",
            )
    require_count("ny", ny)
    height = ends[-1][1] - ends[0][0]
    rows = [graded(low, top, max(1, round(ny * (top - low) / height))) for low, top in ends]
    levels = np.concatenate([rows[0][:1], *(row[1:] for row in rows)])
    cells = MeshQuad.init_tensor(along_axis("x", x, nx, grade_x), levels)
    mesh: MeshTri = named_sides(cells.to_meshtri(style="x" if crossed else None))
    middle = mesh.p[1, mesh.t].mean(axis=0)
    return mesh.with_subdomains(
        {
            name: np.flatnonzero((middle > layers[name][0]) & (middle < layers[name][1]))
            for name in layers
        }
    )
