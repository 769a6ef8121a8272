"""Rounds of brackets: how much finer the next meshes are, and several solves at a time."""

import time
from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.adaptive import asking
from lacore.adaptive.track import Track, growth, next_round, order
from tests.lacore.adaptive.test_adaptivity import even_punch
from tests.lacore.models import CRITERION


@pytest.mark.parametrize("arguments", [{}, {"meshes": "separate"}], ids=["shared", "separate"])
@pytest.mark.parametrize("soil", [CRITERION, la.MohrCoulomb(1.0, 10.0)], ids=["clay", "sand"])
def test_bounds_are_the_same_whatever_runs_at_a_time(arguments, soil):
    """To the last bit: threads share nothing but what they read."""
    stated = even_punch()
    stated = replace(stated, bodies={"soil": la.Body(stated.bodies["soil"].mesh, soil)})
    one, two = (la.bracket(stated, 0.08, jobs=jobs, **arguments) for jobs in (1, 2))
    assert one.status is two.status is la.Ending.REACHED
    assert (one.lower, one.upper) == (two.lower, two.upper)
    told = ["step", "bound", "elements", "solved", "lower", "upper", "width"]
    assert one.history[told].equals(two.history[told])


def test_what_fails_in_a_thread_is_raised(monkeypatch):
    def broken(*_, **__):
        raise ZeroDivisionError

    monkeypatch.setattr(asking, "lower_bound", broken)
    with pytest.raises(ZeroDivisionError):
        la.bracket(even_punch(), jobs=2)


def test_no_jobs_are_refused():
    with pytest.raises(la.InputError, match="jobs"):
        la.bracket(even_punch(), jobs=0)


@pytest.mark.parametrize("true", [0.8, 1.0, 1.2])
def test_an_order_that_widths_have_is_seen_and_lands_on_the_target(true):
    """Widths of 3 N^-order: no solve more than growth allows, and the last one at the target."""
    elements, target = 100, 0.001
    seen = [(elements, 3 * elements**-true)]
    while seen[-1][1] > target * (1 + 1e-9):  # round-off of powers
        times = growth(seen[-1][1] / target, order(seen))
        assert times <= 3.0
        elements = elements * times
        seen.append((elements, 3 * elements**-true))
    assert order(seen) == pytest.approx(true, rel=1e-9)
    # The first step may guess the order wrong; from the second on it is known. A mesh grows by a
    # fifth at least, and is that much finer than asked for at most.
    assert seen[-1][1] >= target * 1.2**-true * (1 - 1e-9)


def test_widths_that_fall_slowly_take_more_elements():
    assert order([(100, 1.0), (400, 0.3)]) == pytest.approx(np.log(1 / 0.3) / np.log(4))
    # 3 times as wide, order 1.2 or .8: 3^(1/1.2) at once, or 3^(1/.8) = 3.9 in two steps.
    assert growth(3.0, 1.2) == pytest.approx(3 ** (1 / 1.2))
    assert growth(3.0, 0.8) == pytest.approx(3 ** (1 / 1.6))


def test_what_is_not_proven_is_asked_once_more_as_the_backend_would(monkeypatch):
    """With the tolerance of the question first, and then with that of the backend."""
    seen = []

    def careless(problem, backend, options):
        seen.append(options.get("tolerance"))
        found = la.lower_bound(problem, backend, options=options)
        return replace(found, status=la.Status.NOT_CERTIFIED) if len(seen) == 1 else found

    monkeypatch.setattr(asking, "lower_bound", careless)
    solver = asking.Solver("clarabel", {}, time.perf_counter() + 60, 1)
    found = solver.bound(asking.Asked("lower", even_punch(), 1e-6))
    assert found.status is la.Status.SOLVED
    assert seen == [1e-6, None]


def test_an_order_is_guessed_while_nothing_is_known():
    assert order([]) == order([(100, np.inf)]) == order([(100, np.inf), (200, 0.5)]) == 1.0
    assert growth(np.inf, 1.0) == 3.0
    # Between those of even and of adapted meshes, whatever a single step pretends.
    assert order([(100, 0.5), (200, 0.5)]) < 1.0 < order([(100, 0.5), (200, 1e-6)]) < 2.0


def test_meshes_that_promise_as_much_are_refined_together():
    stated = even_punch()
    coarse = Track(("lower",), stated, gains=(1.0,))
    good, bad = replace(coarse, gains=(0.6,)), replace(coarse, gains=(0.1,))
    assert next_round([0, 1], [coarse, good]) == [0, 1]
    assert next_round([0, 1], [bad, coarse]) == [1]
    assert next_round([0], [bad, coarse]) == [0]
