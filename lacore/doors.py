"""Who draws, animates and writes what: the top floor, the only one that knows all rooms.

What does the work is imported when it is asked for: `import lacore` loads no matplotlib.
"""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from lacore import views

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@views.picture.of("lacore.bodies.continuum.body.Body")
def _body(body: Any) -> "Figure":
    from lacore.pictures.mesh import plot_body

    return plot_body(body)


@views.picture.of("lacore.problem.problem.Problem")
def _problem(problem: Any) -> "Figure":
    from lacore.pictures.sketch.problem import plot_problem

    return plot_problem(problem)


@views.picture.of("lacore.limit.state.LimitState")
def _state(state: Any) -> "Figure":
    from lacore.pictures.mechanism import plot_mechanism

    return plot_mechanism(state)


@views.picture.of("lacore.bounds.lower.LowerBound")
def _strength(bound: Any) -> "Figure":
    from lacore.pictures.mesh import plot_strength

    return plot_strength(bound)


@views.picture.of("lacore.bounds.gap_identity.GapIdentity")
def _gap(identity: Any) -> "Figure":
    from lacore.pictures.mesh import plot_gap

    return plot_gap(identity)


@views.picture.of("lacore.adaptive.bracket.Bracket")
def _bracket(bracket: Any) -> "Figure":
    from lacore.pictures.bracket import plot_bracket

    return plot_bracket(bracket)


@views.picture.of("lacore.paths.path.Path")
def _path(path: Any) -> "Figure":
    from lacore.pictures.path import plot_path

    return plot_path(path)


@views.animation.of("lacore.paths.path.Path")
def _film(path: Any, *how: Any) -> None:
    from lacore.pictures.animation import animate_path

    animate_path(path, *how)


@views.files.of("lacore.limit.state.LimitState")
def _state_file(state: Any, place: Any) -> Path:
    from lacore.files.vtu import write_state

    return write_state(state, place)


@views.files.of("lacore.paths.path.Path")
def _path_files(path: Any, folder: Any) -> Path:
    from lacore.files.vtu import write_path

    return write_path(path, folder)
