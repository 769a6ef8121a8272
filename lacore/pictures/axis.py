"""Axes in pictures: names of coordinates, units, powers of ten, axis of symmetry."""

# Annotations are not evaluated, so their modules are not loaded.
from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import ceil, floor, log10
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colorbar import Colorbar
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import AutoLocator, FuncFormatter, LogFormatterSciNotation, NullLocator
from matplotlib.transforms import Affine2DBase, ScaledTranslation, blended_transform_factory

from lacore.reporting.units import Units

if TYPE_CHECKING:
    from lacore.model.bodies.any_body import Stated

_COLOUR, _WIDTH, _DASHES = "#7a7a7a", 0.9, (0.0, (9.0, 3.0, 2.0, 3.0))
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_SI = Units()
_FAR = 1.0  # by the size of the body: an axis farther away is not drawn


_BAR = 0.16  # inches, width of a colour bar
_NEAR_BAR, _FAR_BAR = 0.12, 0.5  # inches between two- or three-dimensional axes and their bar


def has_axis(bodies: Iterable[Stated]) -> bool:
    """Return whether bodies are axisymmetric; then all of them are."""
    return any(body.axisymmetric for body in bodies)


class _Ticks(AutoLocator):
    """Ticks at round lengths of a unit, on an axis in m."""

    def __init__(self, size: float) -> None:
        super().__init__()
        self._size = size

    def tick_values(self, vmin: float, vmax: float) -> Any:
        """Return the ticks between two ends, m."""
        return self._size * np.asarray(super().tick_values(vmin / self._size, vmax / self._size))


def label_coordinates(axes: Axes, bodies: Iterable[Stated], units: Units = _SI) -> None:
    """Set the names of x and y, or r and z, and ticks in the unit of lengths."""
    label_lengths(axes, "rz" if has_axis(bodies) else "xy", units)


def label_lengths(axes: Axes, names: Sequence[str], units: Units) -> None:
    """Set the names of both axes, which are in m, and ticks in the unit of lengths."""
    size = units.size("m")
    for axis, name in zip((axes.xaxis, axes.yaxis), names, strict=True):
        axis.set_label_text(f"{name} [{units.length}]", fontsize=9)
        if size != 1.0:
            axis.set_major_locator(_Ticks(size))
            axis.set_major_formatter(FuncFormatter(lambda at, _: _typeset(at / size)))


def _typeset(length: float) -> str:
    """Return a number with the minus sign of other axes."""
    return f"{round(length, 9):g}".replace("-", "\N{MINUS SIGN}")


def superscript(number: int) -> str:
    """Write a whole number in superscript letters: ``⁻³``."""
    return str(number).translate(_SUPERSCRIPT)


def power(value: float) -> str:
    """Write a positive number in letters that every font has: ``10⁻³``, ``2·10⁻³``."""
    exponent = floor(log10(value) + 1e-9)  # for an exact power despite the round-off of log10
    digit = round(value / 10.0**exponent)
    return ("" if digit == 1 else f"{digit}·") + f"10{superscript(exponent)}"


class PowerFormatter(LogFormatterSciNotation):
    """Formatter of the labelled ticks of a logarithmic axis.

    Typesetting them as formulas takes a sixth of the time of a picture.
    """

    def __call__(self, x: float, pos: int | None = None) -> str:
        """Return the label of a tick; may be empty."""
        return power(x) if super().__call__(x, pos) else ""


def colour_bar(colours: ScalarMappable, axes: Axes, label: str = "", shrink: float = 0.85) -> None:
    """Draw a colour bar to the right of two- or three-dimensional axes.

    A logarithmic one that spans a decade has no ticks between powers of ten, which would take as
    long to draw as everything else.
    """
    figure = axes.get_figure(root=True)
    assert figure is not None
    logarithmic = isinstance(colours.norm, LogNorm)
    # In inches from the right edge of the axes, whose position follows from equal scales.
    within = axes.transAxes
    assert isinstance(within, Affine2DBase)  # true for all axes
    edge = figure.dpi_scale_trans + ScaledTranslation(1.0, 0.0, within)
    place = blended_transform_factory(edge, within)
    gap = _FAR_BAR if axes.name == "3d" else _NEAR_BAR
    bar = figure.colorbar(
        colours,
        cax=axes.inset_axes((gap, (1 - shrink) / 2, _BAR, shrink), transform=place),
        extend="min" if logarithmic else "neither",
        format=PowerFormatter() if logarithmic else None,
    )
    if logarithmic:
        _thin(bar)
    bar.set_label(label, fontsize=8)
    bar.ax.tick_params(labelsize=8, which="both")


def _thin(bar: Colorbar) -> None:
    """Remove minor ticks of a colour bar that contains two powers of ten.

    Else label them as well.
    """
    low, high = bar.ax.get_ylim()
    powers = floor(log10(high)) - ceil(log10(low)) + 1
    if powers > 1:
        bar.minorlocator = NullLocator()
    else:
        bar.minorformatter = PowerFormatter()


def draw_axis(axes: Axes, bodies: Iterable[Stated]) -> list[Line2D]:
    """Draw the axis if it is close, and return its entry in a legend."""
    if not any(body.axisymmetric and body.box[0][0] <= _FAR * body.size for body in bodies):
        return []
    axes.axvline(0.0, color=_COLOUR, lw=_WIDTH, ls=_DASHES, zorder=1.2)
    return [Line2D([], [], color=_COLOUR, lw=_WIDTH, ls=_DASHES, label="axis")]


def lay_out(figure: Figure) -> None:
    """Compute the margins of a figure from the present scales of its axes.

    A layout that is first computed while the figure is saved would not use them.
    """
    engine = figure.get_layout_engine()
    if engine is not None:
        # Without a canvas of pixels, each layout and each save would measure all texts again.
        if not isinstance(figure.canvas, FigureCanvasAgg):
            FigureCanvasAgg(figure)
        engine.execute(figure)
