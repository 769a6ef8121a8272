"""Pictures show what the state says, for any state with a point."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.collections import PolyCollection

import lacore as la
from lacore.pictures.contact import COLOURS
from lacore.pictures.mechanism import plot_mechanism
from tests.lacore.pictures.readings import drawn, lines, words
from tests.shares import one_in


def block(friction, top=(0, -1)):
    mesh = la.meshes.rectangle(x=(0, 4), y=(0, 1), nx=4, ny=2)
    return la.Problem(
        bodies={"block": la.Body(mesh, la.VonMises(shear_strength=1.0))},
        interfaces=[la.Interface(("block", "bottom"), la.RigidObstacle((0, 0), (0, 1)), friction)],
        reference_loads=[la.Traction("block", "left", (1, 0))],
        dead_loads=[la.Traction("block", "top", top)],
    )


@pytest.fixture(scope="module")
def sliding():
    return la.solve(block(0.5))


def test_title_names_value_rigor_backend_and_status(sliding):
    text = words(drawn(plot_mechanism(sliding)))
    for part in ("load factor 2 ", "not a bound", sliding.backend, "status: solved"):
        assert part in text


def test_rigid_sliding_shows_slip_and_no_dissipation(sliding):
    text = words(drawn(sliding.plot()))
    assert "contact: slip" in text
    assert "contact: stick" not in text
    assert "no plastic dissipation" in text
    assert "dissipation density" not in text


def test_crushing_shows_stick_and_dissipation():
    text = words(drawn(plot_mechanism(la.solve(block(0.9)))))
    assert "contact: stick" in text
    assert "dissipation density" in text


def test_each_element_is_one_face(sliding):
    figure = plot_mechanism(sliding)
    faces = [item for item in figure.axes[0].collections if isinstance(item, PolyCollection)]
    elements = sliding.discretisation.continua["block"].body.mesh.nelements
    assert len(faces[0].get_paths()) == elements


def test_panel_shows_edge_means_that_carry_the_load(sliding):
    figure = plot_mechanism(sliding)
    traction = next(axes for axes in figure.axes if axes.get_ylabel() == "traction [Pa]")
    pressure, friction = (patch.get_data() for patch in traction.patches)
    assert (pressure.values * (pressure.edges[1:] - pressure.edges[:-1])).sum() == pytest.approx(4)
    # The block is pushed to the right, so friction acts on it to the left.
    assert (friction.values * (friction.edges[1:] - friction.edges[:-1])).sum() == pytest.approx(-2)


def test_without_interfaces():
    mesh = la.meshes.quarter_ring(1.0, 2.0, 2, 4)
    tube = la.Body(mesh, la.VonMises(yield_stress=1.0), geometry="approximated")
    state = la.solve(
        la.Problem(
            {"tube": tube},
            [la.Pressure("tube", "bore")],
            [la.Fix("tube", "x_axis", "y"), la.Fix("tube", "y_axis", "x")],
        )
    )
    figure = drawn(plot_mechanism(state))
    assert "contact" not in words(figure)


def pair_of_continua(swap=False, friction=0.3):
    criterion = la.VonMises(shear_strength=1.0)
    low = la.meshes.rectangle((0, 4), (0, 1), 8, 2)
    high = la.meshes.rectangle((0.5, 3), (1, 2), 5, 2)
    sides = [("high", "bottom"), ("low", "top")]
    slave, master = sides[::-1] if swap else sides
    return la.Problem(
        {"low": la.Body(low, criterion), "high": la.Body(high, criterion)},
        [la.Traction("high", "left", (1, 0))],
        [la.Fix("low", "bottom")],
        [la.Interface(slave, master, friction)],
        [la.Traction("high", "top", (0, -1))],
    )


@pytest.mark.parametrize("swap", one_in(2, [False, True]))
def test_two_continua_show_their_contact_once_with_one_panel(swap):
    figure = drawn(plot_mechanism(la.solve(pair_of_continua(swap))))
    assert len(figure.axes) == 3  # mechanism, tractions, velocities: it slides rigidly
    slip = lines(figure.axes[0], COLOURS["slip"])
    length = sum(np.ptp(segment[:, 0]) for segment, _ in slip)
    assert length == pytest.approx(2.5, abs=1e-6)
    assert "contact: stick" not in words(figure)
    pressure, friction = (patch.get_data() for patch in figure.axes[1].patches)
    assert pressure.edges[[0, -1]] == pytest.approx([0.5, 3.0])
    width = np.diff(pressure.edges)
    assert (pressure.values * width).sum() == pytest.approx(2.5, abs=1e-5)
    # Tractions on the slave: the friction on the upper body points to the left.
    assert (friction.values * width).sum() == pytest.approx(0.75 if swap else -0.75, abs=1e-5)


def test_unsolved_state_says_so(sliding):
    state = replace(sliding, status=la.Status.NOT_CONVERGED, load_factor=float("nan"))
    text = words(drawn(plot_mechanism(state)))
    assert "NOT CONVERGED" in text
    assert "inspection only" in text
    assert "load factor" not in text


def test_state_without_a_point_cannot_be_drawn(sliding):
    with pytest.raises(ValueError, match="no state to look at"):
        plot_mechanism(replace(sliding, point=None))
