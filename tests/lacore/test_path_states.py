"""Limit states of a path: their contact, in the table and in the picture."""

import numpy as np
import pytest

from tests.lacore.path_billets import pressed

# Of the velocity 1 of the footing, that point counts as at rest: see `lacore.result`.
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
