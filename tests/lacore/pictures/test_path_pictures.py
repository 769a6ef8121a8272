"""Pictures of paths, still and moving."""

from dataclasses import asdict, replace
from functools import cache
from itertools import pairwise

import matplotlib.animation
import numpy as np
import pandas as pd
import pytest
from matplotlib.collections import LineCollection
from PIL import Image

import lacore as la
from lacore.paths.control import unit_of
from lacore.paths.path import Event
from lacore.pictures.path import strain_scale
from lacore.reporting.errors import InputError
from tests.lacore.paths.path_billets import PLATEN, billet, pressed, quad_billet
from tests.lacore.pictures.readings import drawn, words
from tests.shares import one_in

plain = cache(pressed)
"""A path a number of steps; paths are not changed."""


def smooth(made):
    """Without friction and hardening: the load is that of one material point."""
    problem, _ = made()
    body = replace(problem.bodies["billet"], criterion=la.VonMises(yield_stress=1.0))
    top = la.Interface(("billet", "top"), PLATEN, la.SMOOTH)
    return replace(problem, bodies={"billet": body}, interfaces=[top])


@pytest.mark.parametrize("made", one_in(2, [billet, quad_billet]), ids=["triangles", "quads"])
def test_bodies_and_load(made):
    path = plain(3, billet=made)
    figure = drawn(path.plot())
    bodies, load, _ = figure.axes
    text = words(figure)
    highest = path.history["load_factor"].max()
    for shown in (
        f"largest load factor {highest:.6g}",
        "3 steps, status: reached",
        *("initial shape", "rigid footing", "obstacle", "x [m]", "equivalent strain"),
        f"averaged at the vertices\n(maximum at a point: {path.history['max_strain'].max():.3g})",
        *("load factor", "plastic power", "friction", "travel [m]"),
    ):
        assert shown in text, shown
    assert f"{highest:.6g} at a travel of " in text
    (line,) = [own for own in load.get_lines() if own.get_label() == "load factor"]
    np.testing.assert_array_equal(line.get_xdata(), path.history["travel"])
    np.testing.assert_array_equal(line.get_ydata(), path.history["load_factor"])
    # The boundary passes through the midside nodes, wherever they are.
    stage = path.stage
    mesh = stage.meshes_at(path.snapshots[-1].configuration)["billet"]
    middles = mesh.p[:, mesh.nvertices + mesh.boundary_facets()].T
    drawn_points = np.concatenate(
        [
            segment
            for item in bodies.collections
            if isinstance(item, LineCollection)
            for segment in item.get_segments()
        ]
    )
    distance = np.linalg.norm(middles[:, None] - drawn_points[None], axis=2).min(axis=1)
    assert distance.max() < 1e-12
    # All of the way is in the picture.
    low, high = np.transpose([bodies.get_xlim(), bodies.get_ylim()])
    for snapshot in path.snapshots:
        nodes = snapshot.configuration.nodes["billet"].T
        assert np.all((nodes > low) & (nodes < high))


@pytest.mark.slow
def test_colours_are_the_strain():
    """Of a homogeneous path: 2/sqrt(3) times the logarithm, the same everywhere (T33)."""
    path = la.sequential(smooth(billet), 0.3, 3, "implicit-midpoint")
    scale = strain_scale(path)
    # Exact for any step but for the accuracy of the solves, 1e-6.
    assert scale.vmax == pytest.approx(2 / np.sqrt(3) * -np.log(0.7), rel=1e-5)
    figure = drawn(path.plot())
    (colours,) = [own for own in figure.axes[0].collections if own.get_array() is not None]
    np.testing.assert_allclose(colours.get_array(), scale.vmax, rtol=1e-4)
    assert "friction" not in words(figure)


@pytest.mark.slow
def test_a_tube_with_a_peak():
    """It hardens at first faster than its wall grows thin."""
    mesh = la.meshes.quadrilaterals(x=(1, 2), y=(0, 0.5), nx=2, ny=1)
    law = la.hardening.Linear(1.0, 3.0)
    tube = la.Body(mesh, la.VonMises(hardening=law), "axisymmetric", "q2")
    problem = la.Problem(
        bodies={"tube": tube},
        reference_loads=[la.Pressure("tube", "left")],
        supports=[la.Fix("tube", "bottom", "y"), la.Fix("tube", "top", "y")],
    )
    path = la.sequential(problem, 1.5, 10, control=la.PointTravel("tube", (1, 0), (1, 0)))
    assert list(path.events["kind"]) == ["peak load"]
    figure = drawn(path.plot())
    text = words(figure)
    for shown in ("peak load factor", "r [m]", "axis"):
        assert shown in text
    assert "peak load" in [own.get_text() for own in figure.axes[1].get_legend().get_texts()]
    for other in ("obstacle", "footing", "friction"):
        assert other not in text
    (mark,) = [own for own in figure.axes[1].get_lines() if own.get_marker() == "v"]
    row = path.history.set_index("step").loc[path.events["step"][0]]
    assert list(mark.get_xdata()) == [row["travel"]]
    assert figure.axes[0].get_xlim()[0] <= 0


def test_events():
    path = pressed(3, travel=0.6, billet=lambda: billet(crossed=True))
    assert "contact closed" in words(drawn(path.plot()))


def test_events_of_one_travel_stand_above_each_other():
    """And the last tick is not on the edge of the axes."""
    path = plain(3, billet=billet)
    at = path.snapshots[-1].travel
    rows = [
        Event("contact closed", 1, 0.1, "far from the others"),
        Event("contact closed", 2, at, ""),
        Event("inversion predicted", 3, at, ""),
        Event("remeshed", 3, at, ""),
    ]
    figure = drawn(replace(path, events=pd.DataFrame([asdict(row) for row in rows])).plot())
    load = figure.axes[1]
    ticks = [own for own in load.collections if isinstance(own, LineCollection)]
    closed, predicted, remeshed = (np.array(own.get_segments()) for own in ticks)
    assert closed[1, 1, 1] < predicted[0, 0, 1]
    assert predicted[0, 1, 1] < remeshed[0, 0, 1]
    np.testing.assert_allclose(closed[:, 0, 1], 0.0, atol=1e-12)
    assert load.get_xlim()[1] > 1.01 * at


def test_without_a_step():
    problem, _ = billet()
    control = la.PointTravel("billet", (0, 0), (0, -1))
    path = la.sequential(problem, 0.1, 2, control=control)
    assert "no step was taken" in words(drawn(path.plot()))
    with pytest.raises(InputError, match="has no step to show"):
        path.animate("a.gif")


def test_gif(tmp_path):
    path = plain(3, billet=billet)
    path.animate(tmp_path / "a.gif", fps=4, dpi=40)
    with Image.open(tmp_path / "a.gif") as image:
        # A picture a snapshot; the last, which stays, may be one or several.
        assert image.n_frames >= len(path.snapshots)
        pictures = []
        for number in range(image.n_frames):
            image.seek(number)
            pictures.append(np.asarray(image.convert("RGB"), dtype=int))
            assert image.info["duration"] >= 250
        assert len({picture.shape for picture in pictures}) == 1
        for one, two in pairwise(pictures[:4]):
            assert np.abs(one - two).max() > 50


def test_mp4(tmp_path, monkeypatch):
    path = plain(1)
    monkeypatch.setattr(
        matplotlib.animation.FFMpegWriter, "isAvailable", classmethod(lambda cls: False)
    )
    with pytest.raises(InputError, match=r"needs the program ffmpeg.*write a \.gif"):
        path.animate(tmp_path / "a.mp4")
    monkeypatch.undo()
    if not matplotlib.animation.FFMpegWriter.isAvailable():
        pytest.skip("ffmpeg is not installed")
    path.animate(tmp_path / "a.mp4", dpi=40)
    assert b"ftyp" in (tmp_path / "a.mp4").read_bytes()[:16]


@pytest.mark.slow
def test_places_that_cannot_be_written(tmp_path):
    path = plain(1)
    for name, why in (
        ("a.avi", "neither GIF nor MP4"),
        ("nowhere/a.gif", "its folder does not exist"),
    ):
        with pytest.raises(InputError, match=why):
            path.animate(tmp_path / name)
    (tmp_path / "folder.gif").mkdir()
    with pytest.raises(InputError, match="cannot be written"):
        path.animate(tmp_path / "folder.gif")
    with pytest.raises(InputError, match="fps"):
        path.animate(tmp_path / "a.gif", fps=0)


@pytest.mark.parametrize(("unit", "shown"), [("s", "travel [s]"), ("", "travel")])
def test_the_unit_of_the_travel_is_that_of_its_control(unit, shown):
    """A control of a user may say none."""
    path = replace(plain(3, billet=billet), unit=unit)
    assert path.plot().axes[1].get_xlabel() == shown
    assert unit_of(la.Time()) == "s"
    assert unit_of(object()) == ""
