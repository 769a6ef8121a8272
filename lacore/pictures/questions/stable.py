"""Pictures of structures under their dead loads alone."""

from matplotlib.figure import Figure

from lacore.pictures.mechanism import plot_mechanism
from lacore.questions.stable import Stable
from lacore.reporting.units import Units
from lacore.showing import cut


def plot_stable(found: Stable, units: Units | None = None) -> Figure:
    """What carries the dead loads, or the mechanism by which they fall.

    Args:
        found: the answer.
        units: as of `plot_mechanism`.

    Raises:
        ValueError: neither is proven.
    """
    figure = plot_mechanism(found.state, units)
    standing = found.stability.standing
    heading = cut(f"{standing.label.upper()}: {standing.value}", 95)
    residual = found.stability.residual
    told = f"{found.state.backend}, largest residual of the certificate {residual:.1e}"
    figure.suptitle(f"{heading}\n{told}", fontsize=11, x=0.01, ha="left", wrap=True)
    figure.draw_without_rendering()
    return figure
