"""Figures of stored results, made in the process that draws them."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure
from skfem import MeshTet, MeshTri

import lacore as la
from lacore.bounds.bracket.bracket import BODY, POLYGON, heading
from lacore.pictures.bracket import plot_shares
from lacore.pictures.sketch.problem import plot_problem
from lacore.pictures.thumbnails import thumbnail_of_shape, thumbnail_of_shares
from lacore.reporting import views
from lacore.reporting.status import Rigor
from lacore_verification.case import Case, Variant
from lacore_verification.harness.evidence.bracket import Shares, unpacked_shares
from lacore_verification.harness.evidence.limit_state import restored
from lacore_verification.harness.evidence.path import last_shape
from lacore_verification.report.charts.theme import freeze
from lacore_verification.report.drawing import Figures
from lacore_verification.runs.outcome import Outcome
from lacore_verification.runs.row import Row


def sketch(case: Case, variant: Variant, path: Outcome | None) -> Figures:
    """Draw the problem of a variant; its thumbnail is the end of the path, if there is one."""
    problem, tools = sketched(case, variant)
    if path is None:
        small = views.thumbnail(problem)
    else:
        stage, shape = last_shape(path.run, path.evidence)
        small = thumbnail_of_shape(stage, stage, shape)
    figure = sketch_of(case, problem, tools)
    freeze(figure, again=case.sketch is not None)
    return Figures(figure, small)


def mechanism(outcome: Outcome) -> Figures:
    """Draw a stored state."""
    state = restored(outcome.run, outcome.row, outcome.evidence)
    figure = state.plot()
    freeze(figure, again=False)  # Laying it out again would take as long as everything else.
    return Figures(figure, views.thumbnail(state))


def bracket(outcome: Outcome) -> Figures:
    """Draw both meshes of a stored bracket."""
    above, below = stored_shares(outcome)
    return Figures(
        _drawn(outcome.row, above, below),
        thumbnail_of_shares(_mesh_of(above), above.shares),
    )


def stored_shares(outcome: Outcome) -> tuple[Shares, Shares]:
    """Restore the meshes of the upper and of the lower bound, with the shares of their elements.

    Raises:
        ValueError: The evidence is not that of a bracket.
    """
    found = {one.mesh: one for one in unpacked_shares(outcome.evidence.arrays)}
    if not {"upper", "lower"} <= set(found):
        raise ValueError("one of the meshes is missing")
    return found["upper"], found["lower"]


def _drawn(row: Row, above: Shares, below: Shares) -> Figure:
    """Draw both meshes of a stored bracket."""
    bounded = POLYGON if row.rigor == Rigor.DISCRETE.label else BODY
    return plot_shares(
        heading(row.lower, row.upper, row.width, row.message, bounded),
        _mesh_of(above),
        above.shares,
        _mesh_of(below),
        below.marks,
    )


def _mesh_of(shares: Shares) -> MeshTri | MeshTet:
    """Make the mesh of stored shares."""
    made = {2: MeshTri, 3: MeshTet}[len(shares.points)]
    return made(*map(np.ascontiguousarray, (shares.points, shares.elements)))


def sketched(case: Case, variant: Variant) -> tuple[la.Problem, Mapping[str, la.Tool]]:
    """Build the problem of a variant on its second mesh level, where curves look like curves.

    Returns:
        The problem, and the tools of its path, without what stands for them elsewhere.
    """
    level = (*case.meshes, *case.meshes)[1]
    problem = case.problem(variant, level)
    if case.path is None:
        return problem, {}
    stated = case.following_of(variant)
    return stated.problem(problem), stated.tools


def sketch_of(case: Case, problem: la.Problem, tools: Mapping[str, la.Tool]) -> Figure:
    """Sketch a problem of a case."""
    figure = plot_problem(problem, tools=tools)
    if case.sketch is not None:
        case.sketch(figure.axes[0], problem)
    return figure
