"""Steady states of paths: when they are reached, when not, and paths that end by them."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.paths.ending import Ending
from lacore.paths.steady import drift_of
from lacore.reporting.errors import InputError
from tests.lacore.paths.test_path_checkpoint import Stop, assert_same, stop_after

STEPS = 24


def sled():
    """A block under a pressure of 0.5 that slides on a floor with friction 0.3: a force of 0.15."""
    block = la.meshes.quadrilaterals(x=(0, 1), y=(0, 1), nx=1, ny=1)
    metal = la.VonMises(hardening=la.hardening.Linear(1.0, slope=1.0))
    floor = la.RigidObstacle(point=(0, 0), normal=(0, 1))
    return la.Problem(
        bodies={"sled": la.Body(block, metal, space="q2")},
        interfaces=[la.Interface(("sled", "bottom"), floor, friction=0.3)],
        reference_loads=[la.RigidFooting("sled", "left", direction=(1, 0), rough=False)],
        dead_loads=[la.Pressure("sled", "top", 0.5)],
    )


@pytest.fixture(scope="module")
def sliding():
    return la.sequential(sled(), travel=0.6, steps=STEPS)


def with_forces(path, force):
    return replace(path, history=path.history.assign(force=force))


def test_a_load_that_stays_is_steady(sliding):
    found = sliding.steady()
    assert found.reached, found
    assert found.step == 2  # a window begins after the first step
    assert found.force == pytest.approx(0.15, rel=1e-6)
    assert found.drift < 1e-6
    assert found.flow < 1e-4
    assert str(found).startswith("from step 2 on load and flow are stationary: the load drifts by ")


@pytest.mark.parametrize("ratio", [1.0, 2.0, 5.0])
def test_what_the_drift_proves(ratio):
    """An exponential is that close to its limit, if the window is longer than its distance."""
    place = (np.arange(9000) + 0.5) / 9000
    load = 1 + 0.1 * np.exp(-ratio * place)
    mean = load.mean()
    assert 0.1 * np.exp(-ratio) < drift_of(load) * mean


def test_loads_that_change_are_not_steady(sliding):
    """A trend, a peak within the window, an oscillation as long as it."""
    x = sliding.history["travel"].to_numpy()
    end, window = x[-1], 0.2
    for force in (1 + x, 1 - 2 * ((x - end + window / 2) / window) ** 2, np.sin(2 * np.pi * x) + 2):
        found = with_forces(sliding, force).steady()
        assert not found.reached
        assert found.step is None
        assert found.drift > 0.01
        assert "not steady: the load drifts by" in str(found)


def test_the_first_steady_step_is_found(sliding):
    """From a transient on: the mean does not see it."""
    force = np.where(np.arange(STEPS) < 8, 3.0, 2.0)
    found = with_forces(sliding, force).steady()
    assert found.reached
    assert 8 <= found.step <= 9
    assert found.force == pytest.approx(2.0, rel=0.01)


def test_numbers_that_are_none_are_not_steady(sliding):
    force = sliding.history["force"].to_numpy().copy()
    force[-3] = np.nan
    assert not with_forces(sliding, force).steady().reached
    assert not with_forces(sliding, 0.0 * force).steady().reached
    assert not with_forces(sliding, np.zeros(STEPS)).steady().reached
    assert not with_forces(sliding, np.full(STEPS, np.inf)).steady().reached


def test_a_flow_that_changes_is_not_steady(sliding):
    """Of a constant load: the velocities at the end are turned by 90 degrees."""
    last = sliding.snapshots[-1]
    turned = {name: np.stack([-v[1], v[0]]) for name, v in last.velocity.items()}
    path = replace(sliding, snapshots=(*sliding.snapshots[:-1], replace(last, velocity=turned)))
    found = path.steady()
    assert not found.reached
    assert found.flow == pytest.approx(np.sqrt(2), rel=1e-6)
    unknown = replace(sliding, snapshots=(sliding.snapshots[0], last))
    assert np.isnan(unknown.steady().flow)
    assert not unknown.steady().reached


def test_few_steps_are_never_steady(sliding):
    """However constant the load is."""
    short = replace(sliding, history=sliding.history[:6])
    assert not short.steady().reached
    assert "needs 6 steps after the first one" in str(short.steady())
    found = sliding.steady(la.Steady(window=0.1))
    assert not found.reached
    assert "is not usable" in str(found)
    assert not sliding.steady(la.Steady(window=2.0)).reached
    assert np.isnan(found.force)


def test_a_path_until_it_is_steady(tmp_path):
    """It ends with the same steps as the whole path; from a checkpoint too."""
    asked = {"travel": 0.6, "steps": STEPS, "until": la.Steady(window=0.16)}
    path = la.sequential(sled(), **asked)
    assert path.status is Ending.STEADY
    assert path.message.startswith("steady: from step 2 on load and flow are stationary: ")
    assert 7 <= len(path.history) < STEPS / 2
    assert path.steady(asked["until"]).reached
    with pytest.raises(Stop):
        la.sequential(sled(), **asked, checkpoint=tmp_path / "p", on_step=stop_after(4))
    for _ in range(2):  # the second time nothing is left to do
        assert_same(la.sequential(sled(), **asked, checkpoint=tmp_path / "p"), path)
    other = {**asked, "until": la.Steady(tolerance=0.1)}
    with pytest.raises(InputError, match="is of another path: other until"):
        la.sequential(sled(), **other, checkpoint=tmp_path / "p")


def test_the_travel_is_the_limit():
    path = la.sequential(sled(), travel=0.1, steps=2, until=la.Steady())
    assert path.status is Ending.REACHED
    assert not path.steady().reached


@pytest.mark.parametrize("given", [{"tolerance": 0.0}, {"tolerance": 1.0}, {"flow": -1.0}])
def test_what_it_cannot_be(given):
    with pytest.raises(InputError, match=rf"Steady\.{next(iter(given))}"):
        la.Steady(**given)
    with pytest.raises(InputError, match=r"Steady\.window"):
        la.Steady(window=0.0)
