"""Pictures of frames: hinges, moments, feet."""

import numpy as np
import pytest
from matplotlib.collections import PathCollection, PolyCollection
from matplotlib.colors import to_hex

import lacore as la
from lacore.model.bodies.blocks import masonry
from lacore.pictures.forces import THRUST
from lacore.pictures.frames import HINGE, MOMENT
from lacore.pictures.mechanism import plot_mechanism
from tests.frame_problems import portal, pressed
from tests.frame_problems import pushed as pushed_portal
from tests.lacore.pictures.readings import drawn, words


@pytest.fixture(scope="module")
def broken_beam():
    """C12, where the beam breaks: hinges at its ends and under the load."""
    return la.solve(pressed(0.8, 1.0))


def hinge_marks(axes):
    """Places (k, 2) of the dots, and of the anticlockwise and clockwise arrows around them."""
    return [
        np.asarray(item.get_offsets())
        for item in axes.collections
        if isinstance(item, PathCollection)
        and to_hex(HINGE) in [to_hex(own) for own in item.get_facecolor()[:1]]
    ]


def test_hinges_are_dots_with_a_sense_of_rotation(broken_beam):
    axes, _ = drawn(plot_mechanism(broken_beam)).axes
    dots, anticlockwise, clockwise = hinge_marks(axes)
    left, middle, right = sorted(dots.tolist())
    size = np.hypot(4, 2)
    aside = 0.03 * size  # into the member that turns
    assert left == pytest.approx([aside, 2], abs=1e-6)
    assert right == pytest.approx([4 - aside, 2], abs=1e-6)
    assert middle[1] == pytest.approx(2 - 0.08 * size, abs=1e-6)
    assert abs(middle[0] - 2) == pytest.approx(aside, abs=1e-6)
    # The beam sags: its left half turns clockwise against what it meets, its right half not.
    assert np.all(clockwise[:, 0] < 2)
    assert np.all(anticlockwise[:, 0] > 2)
    assert len(clockwise) + len(anticlockwise) == 3
    text = words(axes.figure)
    for part in ("3 members", "hinge, anticlockwise", "hinge, clockwise", "contact: stick"):
        assert part in text, part


def test_moments_stand_on_the_tension_side(broken_beam):
    _, axes = drawn(plot_mechanism(broken_beam)).axes
    faces = [
        path.vertices
        for item in axes.collections
        if isinstance(item, PolyCollection)
        and to_hex(MOMENT) in [to_hex(own) for own in item.get_edgecolor()[:1]]
        for path in item.get_paths()
    ]
    assert len(faces) == 4  # two columns, two halves of the beam
    corners = np.concatenate(faces)
    ordinate = 0.12 * np.hypot(4, 2)  # of M_p
    assert corners[:, 1].max() == pytest.approx(2 + ordinate, abs=1e-6)  # hogging over corners
    sagging = corners[np.abs(corners[:, 0] - 2) < 1e-9, 1].min()
    assert sagging == pytest.approx(2 - ordinate, abs=1e-6)
    assert np.ptp(corners[:, 0]) == pytest.approx(4 + 2 * ordinate, abs=1e-6)  # columns: outside
    assert "moment (max 1 N)" in words(axes.figure)
    assert "reaction (max 2.06 N/m)" in words(axes.figure)  # M_p/h and 2


def test_feet_that_slide_are_blue_and_no_hinge_is_round_off():
    figure = drawn(plot_mechanism(la.solve(pushed_portal(0.1, 1.0))))
    assert "contact: slip" in words(figure)
    assert "hinge" not in words(figure)
    assert "obstacle" in words(figure)


def test_a_frame_on_blocks_shows_hinges_thrust_and_moments():
    blocks = {
        "base": masonry.rectangle(-1, 5, -2, -1),
        "left": masonry.rectangle(-0.5, 0.5, -1, 0),
        "right": masonry.rectangle(3.5, 4.5, -1, 0),
    }
    problem = la.Problem(
        {"frame": portal(), "blocks": la.BlockAssembly(blocks, 0.6)},
        [la.PointForce("frame", "B", (1, 0))],
        [la.Fix("blocks", "base")],
        [
            la.Interface(("frame", "A"), ("blocks", "left"), 0.6),
            la.Interface(("blocks", "right"), ("frame", "D"), 0.6),
        ],
        [la.PointForce("frame", node, (0, -1)) for node in "BC"]
        + [la.BodyForce("blocks", (0, -1))],
    )
    figure = drawn(plot_mechanism(la.solve(problem)))
    text = words(figure)
    for part in ("3 rigid blocks, 3 members", "fixed", "moment", "reaction", "contact force"):
        assert part in text, part
    assert len(figure.axes) == 2
    (feet,) = (
        item
        for item in figure.axes[1].collections
        if hasattr(item, "U") and to_hex(item.get_facecolor()[0]) == THRUST
    )
    assert len(feet.U) == 2
    assert np.all(feet.V > 0)  # on the frame, whichever side it is
