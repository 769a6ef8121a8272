"""Limit states of a path: their contact, in the table and in the picture."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure

from lacore.pictures.contact import draw_panel
from lacore.pictures.contact_segments import segmented_contacts
from lacore.reporting.units import Units
from tests.lacore.paths.path_billets import pressed
from tests.lacore.pictures.readings import drawn, words

# Of the velocity 1 of the footing, that point counts as at rest: see `lacore.limit.state`.
REST = 1e-5


@pytest.fixture(scope="module")
def path():
    return pressed(3)


@pytest.mark.parametrize("step", [2, 3])
def test_what_does_not_come_to_the_obstacle_is_open(path, step):
    state = path.state(step)
    table = state.reactions
    duration = path.snapshot(step).moment.duration
    left = table["gap"] + duration * table["u_n"]
    touches = table["state"] != "open"
    np.testing.assert_allclose(left[touches], 0.0, atol=REST * duration)
    assert left[~touches].min() > 1e-3
    assert np.all(table["t_n"][touches] > 0)
    np.testing.assert_allclose(table[["t_n", "t_t"]][~touches], 0.0, atol=1e-6)
    side = table["interface"] == "billet.right"
    assert list(table["gap"][side & touches].round(9)) == [0.0]  # the corner, that is on both
    assert touches[~side].any()
    assert table["gap"].max() > 0.5


def test_pictures_show_obstacle_and_contact(path):
    state = path.state(3)
    figure = drawn(state.plot())
    text = words(figure)
    for shown in ("obstacle", "contact: slip", "contact: open"):
        assert shown in text, shown
    for name in ("billet.top", "billet.right"):
        assert f"x [m] along {name}" in text
    (top, side), joints = segmented_contacts(state, 1.0)
    assert not joints
    table = state.reactions.groupby("interface").get_group("billet.top")
    # Both edges of the top lie on the platen: means over them carry the force of the points, but
    # for midside nodes that have left the middle by a few hundredths of an edge.
    force = float(np.sum(table["t_n"] * table["length"]))
    lengths = np.linalg.norm(top.segments.end - top.segments.start, axis=0)
    assert top.kind.size == 2
    assert float(np.sum(top.t_n * lengths)) == pytest.approx(force, rel=0.05)
    # Of the side only the edge at the corner has come to it, with one end.
    assert list(side.kind) == ["open"]
    assert side.t_n[0] > 0
    np.testing.assert_allclose(side.segments.start[1], 1.0, rtol=1e-12)
    np.testing.assert_allclose(side.segments.end[1], 1.0, rtol=1e-12)


def test_a_part_of_the_top_that_is_away_is_a_hole_in_its_panel(path):
    """Of three edges in a row the middle one does not touch."""
    (top, _), _ = segmented_contacts(path.state(3), 1.0)
    start, end = (np.array([[x, x + 2.0], [1.0, 1.0]]) for x in (0.0, 1.0))
    apart = replace(top, segments=replace(top.segments, start=start, end=end))
    figure = Figure()
    draw_panel(figure, figure.add_gridspec(1, 1)[0], apart, 1.0, Units())
    steps = figure.axes[0].patches[0].get_data()
    np.testing.assert_allclose(steps.edges, [0, 1, 2, 3], rtol=1e-12)
    np.testing.assert_array_equal(np.isnan(steps.values), [False, True, False])
