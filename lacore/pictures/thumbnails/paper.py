"""What thumbnails are drawn on: a figure of a given size that its contents fill."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from lacore.arrays import Floats

Size = tuple[float, float]
"""Width and height of a figure, inches."""
SIZE: Size = (4.6, 3.2)
"""Twice the 230 x 160 pixels of a thumbnail on a page, at `DPI`."""
DPI = 100
"""Pixels per inch of `SIZE`: lines of one point are then 0.7 pixels wide on the page."""
_MARGIN = 0.04  # on each side, of the size of the contents
_POINTS = 72.0  # per inch
_THIN = 0.4  # points: edges of faces


def paper(size: Size) -> Axes:
    """Create a white figure of a size, covered by axes without a frame."""
    figure = Figure(figsize=size)
    figure.set_facecolor("white")
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    return axes


def scale_of(size: Size, extent: Floats) -> float:
    """Find the scale at which contents of an extent (m) fill a size, points per metre."""
    return float(_POINTS / ((1 + 2 * _MARGIN) * np.max(extent / np.array(size))))


def finish(axes: Axes, low: Floats, high: Floats) -> Figure:
    """Set the limits so that a box, given by two corners (m), fills the figure."""
    figure = axes.figure
    assert isinstance(figure, Figure)
    size = np.array(figure.get_size_inches())
    half = (0.5 + _MARGIN) * np.max((high - low) / size) * size
    (left, bottom), (right, top) = (low + high) / 2 - half, (low + high) / 2 + half
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, top)
    return figure


def finish_around_contents(axes: Axes) -> Figure:
    """Set the limits so that all that was drawn fills the figure."""
    corners = axes.dataLim.get_points()
    return finish(axes, corners.min(axis=0), corners.max(axis=0))


def faces_on_paper(size: Size, corners: Sequence[Floats], filled: Floats, lined: Floats) -> Figure:
    """Draw polygons in the order in which they hide each other.

    Args:
        size: Of the figure, inches.
        corners: Polygons on the screen, m, shape (points, 2) each.
        filled, lined: Colours of the polygons and of their edges, shape (polygons, 3).
    """
    axes = paper(size)
    axes.add_collection(
        PolyCollection(corners, facecolors=filled, edgecolors=lined, linewidths=_THIN)
    )
    return finish_around_contents(axes)
