"""The layout of figures."""

from matplotlib.figure import Figure


def lay_out(figure: Figure) -> None:
    """Find the margins of a figure now, from the scales that its axes have.

    A layout that is found for the first time while the figure is saved does not know them.
    """
    engine = figure.get_layout_engine()
    if engine is not None:
        engine.execute(figure)
