"""The least admissible share of a motion that is inside of all cones."""

from types import SimpleNamespace

import numpy as np
import pytest

from lacore.bounds import constants, possible


def between(monkeypatch, velocity, inside, rates=(0.0, 2.0)):
    """Flow is possible up to a rate of 1; `rates` are the strain rates of two groups."""
    monkeypatch.setattr(possible, "_outside", lambda program, own: own - 1.0)
    groups = [
        SimpleNamespace(cone_vectors=lambda own, rate=rate: np.array([rate])) for rate in rates
    ]
    program = SimpleNamespace(groups=groups)
    return possible._between(program, np.array(velocity), np.array(inside))


@pytest.mark.parametrize("rates", [(0.0, 2.0), (2.0, 0.0)])
def test_a_velocity_is_moved_to_the_edge_of_what_is_possible_and_a_little_beyond(
    monkeypatch, rates
):
    """The margin is round-off of the fastest strain rate, whichever group has it."""
    (found,) = between(monkeypatch, [1.5], [0.0], rates)
    margin = constants.MARGIN_ROUND_OFF * 2.0
    assert 1 - found == pytest.approx(margin, rel=0.1)


def test_the_worst_point_decides(monkeypatch):
    found = between(monkeypatch, [1.5, 2.0, 0.5], [0.0, 0.0, 0.0])
    assert found == pytest.approx([0.75, 1.0, 0.25], abs=1e-9)
    assert found.max() < 1


def test_what_is_possible_stays(monkeypatch):
    assert between(monkeypatch, [0.5, 0.9], [0.0, 0.0]).tolist() == [0.5, 0.9]


def test_a_motion_at_the_edge_itself_leaves_no_room_for_a_margin(monkeypatch):
    found = between(monkeypatch, [1.5], [1.0])
    assert found == pytest.approx([1.0])
    assert found <= 1
