"""Sketches of cases: the problem, with what the case adds to it."""

from matplotlib.figure import Figure

import lacore as la
from verification.case import Case, Variant


def sketched(case: Case, variant: Variant) -> la.Problem:
    """Build the problem of a variant on its second mesh level, where curves look like curves."""
    level = (*case.meshes, *case.meshes)[1]
    return case.problem(variant, level)


def sketch_of(case: Case, problem: la.Problem) -> Figure:
    """Sketch a problem of a case."""
    figure = problem.plot()
    if case.sketch is not None:
        case.sketch(figure.axes[0], problem)
    return figure
