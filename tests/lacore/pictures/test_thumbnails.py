"""Thumbnails show the mechanism and nothing else, and fill their size."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text

import lacore as la
from lacore.pictures.thumbnails import SIZE
from lacore.reporting import views
from tests.frame_problems import pressed as pressed_portal
from tests.lacore.model.bodies.blocks3d.solids import box
from tests.lacore.models import punch
from tests.lacore.paths.path_billets import pressed as pressed_billet


def wall():
    return la.Problem(
        bodies={"wall": la.masonry.running_bond([[1, 1], [0.5, 1, 0.5], [1, 1]], friction=0.6)},
        supports=[la.Fix("wall", "base")],
        reference_loads=[la.BodyForce("wall", (1, 0))],
        dead_loads=[la.BodyForce("wall", (0, -1))],
    )


def tower():
    blocks = {"low": box((0, 0, 0), (1, 1, 1)), "top": box((0, 0, 1), (1, 1, 3))}
    return la.Problem(
        bodies={"tower": la.BlockAssembly3D(blocks, 0.2)},
        supports=[la.Fix("tower", "low")],
        reference_loads=[la.BodyForce("tower", (1, 0, 0))],
        dead_loads=[la.BodyForce("tower", (0, 0, -1))],
    )


def cube():
    mesh = la.meshes.box((0, 1), (0, 1), (0, 1), 1, 1, 1)
    return la.Problem(
        bodies={"cube": la.Body(mesh, la.VonMises(shear_strength=1.0), kinematics="3d")},
        supports=[la.Fix("cube", "bottom")],
        reference_loads=[la.Traction("cube", "top", (1, 0, 0))],
    )


PROBLEMS = {
    "continuum": punch,
    "blocks": wall,
    "frame": lambda: pressed_portal(0.8, 1.0),
    "blocks in 3-D": tower,
    "tetrahedra": cube,
}


@cache
def solved(name):
    state = la.solve(PROBLEMS[name]())
    assert state.status is la.Status.SOLVED
    return state


@cache
def path():
    return pressed_billet(2)


THINGS = {
    **{f"mechanism of a {name}": lambda name=name: solved(name) for name in PROBLEMS},
    **{f"problem of a {name}": PROBLEMS[name] for name in PROBLEMS},
    "path": path,
}


def pixels(figure):
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[:, :, :3]


def inked(figure):
    """Left, right, top and bottom of what was drawn, as shares of the width and the height."""
    ink = (pixels(figure) < 255).any(axis=2)
    height, width = ink.shape
    columns, rows = np.flatnonzero(ink.any(axis=0)), np.flatnonzero(ink.any(axis=1))
    return columns[0] / width, columns[-1] / width, rows[0] / height, rows[-1] / height


def shown_texts(figure):
    """Texts outside of axes without a frame, whose labels are not drawn."""
    own = [*figure.texts, *figure.legends]
    for axes in figure.axes:
        assert not axes.axison
        own += [item for item in axes.get_children() if isinstance(item, Text)]
        own += [axes.get_legend()]
    return [item for item in own if item is not None and (item.__dict__.get("_text") or None)]


@pytest.mark.parametrize("name", THINGS)
def test_nothing_but_the_mechanism_is_drawn(name):
    figure = views.thumbnail(THINGS[name]())
    assert len(figure.axes) == 1
    assert shown_texts(figure) == []


@pytest.mark.parametrize("name", THINGS)
@pytest.mark.parametrize("size", [SIZE, (2.0, 4.0)])
def test_it_fills_the_given_size(name, size):
    """In one direction, with a margin; nothing is cut off in the other."""
    figure = views.thumbnail(THINGS[name](), size)
    assert tuple(figure.get_size_inches()) == size
    left, right, top, bottom = inked(figure)
    assert max(right - left, bottom - top) > 0.7
    assert min(left, top) >= 0.005 or name == "path"  # the face of an obstacle goes on
    assert max(right, bottom) <= 0.995 or name == "path"
    assert (left + right) / 2 == pytest.approx(0.5, abs=0.12)


def test_it_has_the_colours_of_the_full_figure():
    """Of the same displaced elements."""
    state = solved("continuum")
    full, small = state.plot().axes[0], views.thumbnail(state).axes[0]
    faces = [
        next(own for own in axes.collections if own.get_array() is not None)
        for axes in (full, small)
    ]
    np.testing.assert_array_equal(*(own.get_array() for own in faces))
    for one, other in zip(*(own.get_paths() for own in faces), strict=True):
        np.testing.assert_array_equal(one.vertices, other.vertices)


def test_faces_of_solids_hide_those_behind():
    """Of a tower the top is in front of the block below where they overlap on the screen."""
    (faces,) = views.thumbnail(solved("blocks in 3-D")).axes[0].collections
    heights = [path.vertices[:, 1].max() for path in faces.get_paths()]
    assert len(heights) == 6  # three sides of each block look at the eye
    assert max(heights[:3]) < max(heights[3:])


def test_a_state_without_a_mechanism_has_no_thumbnail():
    with pytest.raises(ValueError, match="no "):
        views.thumbnail(replace(solved("continuum"), point=None))
