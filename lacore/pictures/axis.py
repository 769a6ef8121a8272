"""Axes in pictures: names of coordinates, units, powers of ten; the axis of revolution."""

from __future__ import annotations  # not evaluated: what they name is not loaded

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
_FAR = 1.0  # sizes of the body: an axis farther off is not drawn


_BAR = 0.16  # inches: width of a colour bar
_NEAR_BAR, _FAR_BAR = 0.12, 0.5  # inches between axes in the plane, or in space, and their bar


def has_axis(bodies: Iterable[Stated]) -> bool:
    """Whether bodies are axisymmetric: then all are."""
    return any(body.axisymmetric for body in bodies)


class _Ticks(AutoLocator):
    """Ticks at round lengths of a unit, on an axis in m."""

    def __init__(self, size: float) -> None:
        super().__init__()
        self._size = size

    def tick_values(self, vmin: float, vmax: float) -> Any:
        """Where they are between two ends, m."""
        return self._size * np.asarray(super().tick_values(vmin / self._size, vmax / self._size))


def label_coordinates(axes: Axes, bodies: Iterable[Stated], units: Units = _SI) -> None:
    """Names of x and y, r and z around an axis, and ticks in the unit of lengths."""
    label_lengths(axes, "rz" if has_axis(bodies) else "xy", units)


def label_lengths(axes: Axes, names: Sequence[str], units: Units) -> None:
    """Names of both axes, which are in m, and ticks in the unit of lengths."""
    size = units.size("m")
    for axis, name in zip((axes.xaxis, axes.yaxis), names, strict=True):
        axis.set_label_text(f"{name} [{units.length}]", fontsize=9)
        if size != 1.0:
            axis.set_major_locator(_Ticks(size))
            axis.set_major_formatter(FuncFormatter(lambda at, _: _typeset(at / size)))


def _typeset(length: float) -> str:
    """With the minus that all other axes have."""
    return f"{round(length, 9):g}".replace("-", "\N{MINUS SIGN}")


def superscript(number: int) -> str:
    """Write a whole number in superscript letters: ``⁻³``."""
    return str(number).translate(_SUPERSCRIPT)


def power(value: float) -> str:
    """Write a positive number in letters that every font has: ``10⁻³``, ``2·10⁻³``."""
    exponent = floor(log10(value) + 1e-9)  # of an exact power, whatever log10 rounds to
    digit = round(value / 10.0**exponent)
    return ("" if digit == 1 else f"{digit}·") + f"10{superscript(exponent)}"


class PowerFormatter(LogFormatterSciNotation):
    """Labels the ticks that matplotlib labels on a logarithmic axis.

    Typesetting them as formulas takes a sixth of the time of a picture.
    """

    def __call__(self, x: float, pos: int | None = None) -> str:
        """Write the label of a tick; empty where there is none."""
        return power(x) if super().__call__(x, pos) else ""


def colour_bar(colours: ScalarMappable, axes: Axes, label: str = "", shrink: float = 0.85) -> None:
    """Draw a colour bar to the right of axes, in the plane or in space.

    A logarithmic one that spans a decade has no ticks between powers of ten: together they would
    take as long to draw as all else.
    """
    figure = axes.get_figure(root=True)
    assert figure is not None
    logarithmic = isinstance(colours.norm, LogNorm)
    # In inches from the right edge of the axes, wherever equal scales of both coordinates leave it.
    within = axes.transAxes
    assert isinstance(within, Affine2DBase)  # as of all axes
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
    """Remove minor ticks of a colour bar between two powers of ten; else label them alike."""
    low, high = bar.ax.get_ylim()
    powers = floor(log10(high)) - ceil(log10(low)) + 1
    if powers > 1:
        bar.minorlocator = NullLocator()
    else:
        bar.minorformatter = PowerFormatter()


def draw_axis(axes: Axes, bodies: Iterable[Stated]) -> list[Line2D]:
    """The axis, where there is one near, and its entry in a legend."""
    if not any(body.axisymmetric and body.box[0][0] <= _FAR * body.size for body in bodies):
        return []
    axes.axvline(0.0, color=_COLOUR, lw=_WIDTH, ls=_DASHES, zorder=1.2)
    return [Line2D([], [], color=_COLOUR, lw=_WIDTH, ls=_DASHES, label="axis")]


def lay_out(figure: Figure) -> None:
    """Find the margins of a figure now, from the scales that its axes have.

    A layout that is found for the first time while the figure is saved does not know them.
    """
    engine = figure.get_layout_engine()
    if engine is not None:
        # Without a canvas of pixels, each layout and each saving measures all texts anew.
        if not isinstance(figure.canvas, FigureCanvasAgg):
            FigureCanvasAgg(figure)
        engine.execute(figure)
