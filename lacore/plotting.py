"""Pictures of limit states (matplotlib, without global state)."""

from matplotlib.figure import Figure

from lacore.result import LimitState


def plot_mechanism(state: LimitState) -> Figure:
    """Deformed mesh, dissipation density, slip and opening on the interfaces."""
    raise NotImplementedError("mechanism plots are not written yet")
