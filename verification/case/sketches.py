"""Sketches of cases: of the problem, with what the case adds to it."""

from matplotlib.figure import Figure

from verification.case import Case, Variant


def sketch_of(case: Case, variant: Variant) -> Figure:
    """Sketch of a variant, on its second mesh level, where curves look like curves."""
    level = (*case.meshes, *case.meshes)[1]
    problem = case.problem(variant, level)
    figure = problem.plot()
    if case.sketch is not None:
        case.sketch(figure.axes[0], problem)
    return figure
