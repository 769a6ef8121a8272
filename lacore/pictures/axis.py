"""Bodies of revolution in pictures: their axis, the names of coordinates, units."""

from collections.abc import Iterable

from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from lacore.bodies.any_body import Stated

_COLOUR, _WIDTH, _DASHES = "#7a7a7a", 0.9, (0.0, (9.0, 3.0, 2.0, 3.0))
_FAR = 1.0  # sizes of the body: an axis farther off is not drawn


def has_axis(bodies: Iterable[Stated]) -> bool:
    """Whether bodies are axisymmetric: then all are."""
    return any(body.axisymmetric for body in bodies)


def label_coordinates(axes: Axes, bodies: Iterable[Stated]) -> None:
    """Names of x and y: r and z around an axis."""
    names = ("r [m]", "z [m]") if has_axis(bodies) else ("x [m]", "y [m]")
    axes.set_xlabel(names[0], fontsize=9)
    axes.set_ylabel(names[1], fontsize=9)


def draw_axis(axes: Axes, bodies: Iterable[Stated]) -> list[Line2D]:
    """The axis, where there is one near, and its entry in a legend."""
    if not any(body.axisymmetric and body.box[0][0] <= _FAR * body.size for body in bodies):
        return []
    axes.axvline(0.0, color=_COLOUR, lw=_WIDTH, ls=_DASHES, zorder=1.2)
    return [Line2D([], [], color=_COLOUR, lw=_WIDTH, ls=_DASHES, label="axis")]
