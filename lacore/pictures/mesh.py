"""Pictures of meshes: their edges and the names of boundaries, or a value in each element."""

from collections.abc import Iterator, Mapping

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Colormap
from matplotlib.figure import Figure
from skfem import Mesh

from lacore.bounds.gap_identity import GapIdentity
from lacore.bounds.lower import LowerBound
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.regions.gathering import by_body, gathered
from lacore.model.bodies.continuum.regions.region import Region
from lacore.model.meshes.curved import edge_lines, outlines
from lacore.numerics.arrays import Floats
from lacore.pictures.axis import colour_bar, draw_axis, label_coordinates
from lacore.pictures.space.surface import surface_by_name, surface_by_value

_SHADES = ("#efe3c8", "#d9c4a3", "#c9d3c0", "#c2cdd6", "#e3c9bd", "#d8d2e0", "#b8a98f", "#dfe0b9")

_PAGE, _TALLEST, _LOWEST = 6.0, 5.0, 1.6  # inches: the bodies alone
_LINES = 2000  # number of elements above which the lines of the mesh are thinner
_FEW = 10  # number of boundaries with a colour
STRENGTH_USED = "utilisation: largest stress of the element / strength"


def plot_body(body: Body) -> Figure:
    """Plot its elements by regions, and its named boundaries."""
    if body.dimension == 3:
        return surface_by_name(body)
    figure, axes = _page({"body": body})
    corners = outlines(body.mesh)
    for region, colour in shaded(body):
        faces = PolyCollection(list(corners[region.elements]), facecolors=colour)
        _draw_edges(faces, body.mesh)
        if region.name:
            faces.set_label(f"{region.name}: {region.criterion.label}")
        axes.add_collection(faces)
    colours = matplotlib.colormaps["tab10"]
    for index, (name, facets) in enumerate(list((body.mesh.boundaries or {}).items())[:_FEW]):
        lines = edge_lines(body.mesh, np.asarray(facets, dtype=np.int64))
        axes.add_collection(
            LineCollection(lines, colors=[colours(index)], linewidths=2.5, label=str(name))
        )
    if axes.get_legend_handles_labels()[0]:
        figure.legend(loc="outside upper left", ncols=5, frameon=False, fontsize=8)
    return figure


def plot_strength(bound: LowerBound) -> Figure:
    """Plot the utilisation of the strength by the stresses of a lower bound, in each element.

    Raises:
        ValueError: there is no state, or nothing that yields.
    """
    used = strength_used(bound)
    bodies = {name: dofs.body for name, dofs in bound.model.continua.items()}
    title = f"lower bound {bound.load_factor:.6g}"
    return _coloured(bodies, used, title, STRENGTH_USED, matplotlib.colormaps["viridis"], 1.0)


def strength_used(bound: LowerBound) -> dict[str, Floats]:
    """Return the largest stress in each element, by its strength, for each body, (elements,).

    Raises:
        ValueError: there is no state, or nothing that yields.
    """
    if bound.point is None or not bound.model.continua:
        raise ValueError("there are no stresses to show")
    point, groups = bound.point, bound.model.full.groups
    corners = bound.model.problem.dimension + 1
    uses = [
        group.uses(stress, mean).reshape(-1, corners).max(axis=1)
        for group, stress, mean in zip(groups, point.stress, point.mean_stress, strict=True)
    ]
    return {
        name: gathered(dofs.body, own) for name, dofs, own in by_body(bound.model.continua, uses)
    }


def plot_gap(identity: GapIdentity) -> Figure:
    """Plot the shares of the elements in the gap between two bounds.

    Raises:
        ValueError: there are no elements.
    """
    if not identity.bodies:
        raise ValueError("there are no elements to show")
    total = max(identity.total, np.finfo(float).tiny)
    shares = {name: 100 * np.maximum(own, 0.0) / total for name, own in identity.elements.items()}
    title = f"gap between upper bound {identity.upper:.6g} and lower bound {identity.lower:.6g}"
    label = "contribution of the element to the gap [%]"
    return _coloured(identity.bodies, shares, title, label, matplotlib.colormaps["YlOrRd"])


def _coloured(
    bodies: Mapping[str, Body],
    values: Mapping[str, Floats],
    title: str,
    label: str,
    colours: Colormap,
    top: float | None = None,
) -> Figure:
    largest = max(float(own.max()) for own in values.values()) if top is None else top
    if any(body.dimension == 3 for body in bodies.values()):
        return surface_by_value(bodies, values, title, label, colours, largest)
    figure, axes = _page(bodies)
    for name, body in bodies.items():
        faces = PolyCollection(list(outlines(body.mesh)), array=values[name], cmap=colours)
        _draw_edges(faces, body.mesh)
        faces.set_clim(0.0, largest if largest > 0 else 1.0)
        axes.add_collection(faces)
    colour_bar(faces, axes, label)
    axes.set_title(title, fontsize=9, loc="left")
    return figure


def _draw_edges(faces: PolyCollection, mesh: Mesh) -> None:
    faces.set_edgecolor((0, 0, 0, 0.45))
    faces.set_linewidth(0.4 if mesh.nelements < _LINES else 0.15)


def _page(bodies: Mapping[str, Body]) -> tuple[Figure, Axes]:
    places = np.concatenate([body.mesh.p for body in bodies.values()], axis=1)
    extent = np.ptp(places, axis=1)
    scale = min(_PAGE / extent[0], _TALLEST / extent[1])
    height = max(scale * extent[1], _LOWEST)
    figure = Figure(figsize=(_PAGE + 0.8, height + 0.9), layout="constrained")
    figure.set_facecolor("white")
    axes = figure.add_subplot()
    axes.set_aspect("equal")
    margin = 0.02 * extent.max()
    axes.set_xlim(places[0].min() - margin, places[0].max() + margin)
    axes.set_ylim(places[1].min() - margin, places[1].max() + margin)
    axes.tick_params(labelsize=8)
    axes.locator_params(nbins=7)
    draw_axis(axes, bodies.values())
    label_coordinates(axes, bodies.values())
    return figure, axes


def shaded(body: Body, before: int = 0) -> Iterator[tuple[Region, str]]:
    """Yield the regions of a body with one colour each, which repeat after eight.

    Args:
        body: body with any number of regions.
        before: number of regions of other bodies in the picture, which have the first colours.
    """
    for number, region in enumerate(body.regions, before):
        yield region, _SHADES[number % len(_SHADES)]
