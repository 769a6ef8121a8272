"""Pictures of brackets: the gap on the refined mesh."""

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec
from mpl_toolkits.mplot3d.axes3d import Axes3D
from skfem import MeshTet, MeshTri

from lacore.bounds.bracket.bracket import Bracket
from lacore.bounds.bracket.marking import lower_shares
from lacore.bounds.bracket.whole import mesh_of
from lacore.model.meshes.solid.faces import face_corners
from lacore.numerics.arrays import Floats
from lacore.pictures.axis import colour_bar, label_lengths
from lacore.pictures.space.drawing import space
from lacore.pictures.space.surface import fill_faces
from lacore.reporting.units import Units

_SI = Units()
_PAGE = 9.0  # inches
_DECADES = 3.0  # decades of shares in the colour scale
_WIDE = 0.7  # height over width below which pictures are stacked
_LINES = 2000  # number of elements above which the lines of the mesh are thinner


def plot_bracket(bracket: Bracket, units: Units = _SI) -> Figure:
    """Plot the shares of elements in the gap (T26) on the mesh of the upper bound.

    A second picture has the shares by which the mesh of the lower bound was refined (T26d), divided
    by their sum. Lengths are in `units`.
    """
    above, below = bracket.upper_bound.discretisation, bracket.lower_bound
    return plot_shares(
        bracket.heading,
        mesh_of(above.problem),
        np.concatenate(list(bracket.gaps().elements.values())),
        mesh_of(below.model.problem),
        np.concatenate([lower_shares(below, name) for name in below.model.continua]),
        units,
    )


def plot_shares(
    title: str,
    above: MeshTri | MeshTet,
    gap: Floats,
    below: MeshTri | MeshTet,
    varying: Floats,
    units: Units = _SI,
) -> Figure:
    """Plot given meshes and shares.

    Args:
        title: see `lacore.bounds.bracket.bracket.heading`.
        above: mesh of the upper bound.
        gap: shares of its elements in the gap.
        below: mesh of the lower bound.
        varying: shares by which it was refined.
        units: units of lengths.
    """
    extent = np.ptp(above.p, axis=1)
    aspect = float(extent[1] / extent[0])
    rows, columns = (2, 1) if aspect < _WIDE else (1, 2)
    size = (_PAGE, min(rows * (_PAGE / columns * aspect * 0.88 + 0.4) + 0.5, 1.4 * _PAGE))
    figure = Figure(figsize=size, layout="constrained")
    figure.set_facecolor("white")
    figure.suptitle(title, fontsize=11, x=0.01, ha="left")
    cells = figure.add_gridspec(rows, columns)
    for place, (mesh, shares, title) in enumerate(
        (
            (above, gap, "upper bound: contributions of the elements to the gap [%]"),
            (below, varying, "lower bound: refinement indicator of the elements [%]"),
        )
    ):
        drawn = _draw if len(extent) == 2 else _draw_in_space
        axes = drawn(figure, cells[place], mesh, shares, units)
        axes.set_title(f"{title}, {mesh.nelements} elements", fontsize=9, loc="left")
    return figure


def parts(shares: Floats) -> tuple[Floats, LogNorm]:
    """Return the shares in per cent, limited to the colour scale, and that scale."""
    part = 100 * np.maximum(shares, 0.0) / max(float(np.maximum(shares, 0.0).sum()), 1e-300)
    peak = max(float(part.max()), 1e-12)
    low = float(np.clip(part.min(), peak * 10**-_DECADES, peak / 2))
    return np.maximum(part, low), LogNorm(low, peak)


def _draw_in_space(
    figure: Figure, cell: SubplotSpec, mesh: MeshTet, shares: Floats, units: Units
) -> Axes3D:
    """Draw tetrahedra with the values of the elements behind the visible faces."""
    part, norm = parts(shares)
    axes = space(figure, cell, mesh.p.min(axis=1), mesh.p.max(axis=1), units)
    scale = ScalarMappable(norm, matplotlib.colormaps["YlOrRd"])
    facets = mesh.boundary_facets()
    colours = scale.to_rgba(part[mesh.f2t[0, facets]])[:, :3]
    fill_faces(axes, mesh, face_corners(mesh, facets), colours)
    colour_bar(scale, axes, shrink=0.6)
    return axes


def _draw(figure: Figure, cell: SubplotSpec, mesh: MeshTri, shares: Floats, units: Units) -> Axes:
    part, norm = parts(shares)
    axes = figure.add_subplot(cell)
    picture = PolyCollection(
        list(mesh.p[:, mesh.t].transpose(2, 1, 0)),
        array=part,
        norm=norm,
        cmap=matplotlib.colormaps["YlOrRd"],
        edgecolors=(0, 0, 0, 0.45),
        linewidths=0.3 if mesh.nelements < _LINES else 0.15,
    )
    axes.add_collection(picture)
    axes.autoscale_view()
    axes.set_aspect("equal")
    axes.tick_params(labelsize=8)
    label_lengths(axes, "xy", units)
    colour_bar(picture, axes)
    return axes
