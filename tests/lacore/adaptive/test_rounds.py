"""Rounds of brackets: how much finer the next meshes are, and several solves at a time."""

import time
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import lacore as la
from lacore.adaptive import asking, refine
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


def sand_punch():
    stated = even_punch()
    soil = la.MohrCoulomb(1.0, 20.0)
    return replace(stated, bodies={"soil": la.Body(stated.bodies["soil"].mesh, soil)})


@pytest.fixture
def tolerances(monkeypatch):
    """Of all solves for upper bounds, by number of elements."""
    seen: dict[int, list[float]] = {}

    def noted(problem, *args, options, **named):
        elements = problem.bodies["soil"].mesh.nelements
        seen.setdefault(elements, []).append(options["tolerance"])
        return la.solve(problem, *args, options=options, **named)

    monkeypatch.setattr(asking, "solve", noted)
    return seen


def test_an_upper_bound_that_loses_much_is_asked_for_again(tolerances):
    """What makes a loose velocity of soil possible raises the load factor."""
    solver = asking.Solver("clarabel", {}, time.perf_counter() + 60, 1)
    loose = asking.Asked("upper", sand_punch(), 1e-4)
    first = solver.answer(loose)
    assert first.sharper == 1
    assert first.bound.lost > 0
    second = solver.answer(replace(loose, affordable=first.bound.lost / 4))
    assert second.bound.lost < first.bound.lost / 4
    assert second.bound.load_factor < first.bound.load_factor
    (asked,) = tolerances.values()
    assert asked == [1e-4, 1e-4, second.sharper * 1e-4]


def test_the_better_of_two_bounds_is_kept_and_none_is_asked_for_too_sharply(monkeypatch):
    lost, asked = iter([1.0, 2.0, 1.0, 0.5]), []

    def bound(_, asked_for, options):
        asked.append(options["tolerance"])
        return SimpleNamespace(status=la.Status.SOLVED, lost=next(lost))

    monkeypatch.setattr(asking.Solver, "_bound", bound)
    solver = asking.Solver("clarabel", {}, time.perf_counter() + 60, 1)
    loose = asking.Asked("upper", sand_punch(), 1e-6, affordable=1e-9)
    assert solver.answer(loose).bound.lost == 1.0  # the second loses more
    assert solver.answer(loose).bound.lost == 0.5
    assert asked == pytest.approx([1e-6, asking.TIGHTEST] * 2, rel=1e-12)


def test_a_given_tolerance_is_kept_whatever_is_lost(tolerances):
    solver = asking.Solver("clarabel", {"tolerance": 1e-4}, time.perf_counter() + 60, 1)
    answer = solver.answer(asking.Asked("upper", sand_punch(), 1e-6, affordable=0.0))
    assert answer.sharper == 1
    assert list(tolerances.values()) == [[1e-4]]


def test_what_loses_much_is_not_asked_for_twice_on_finer_meshes(tolerances, monkeypatch):
    """They lose more; and what was learnt does not depend on what runs at a time."""
    monkeypatch.setattr(refine, "_LOST", 1e-4)
    one = la.bracket(sand_punch(), 0.05, jobs=1)
    meshes = [tolerances[elements] for elements in sorted(tolerances)]
    again = next(number for number, asked in enumerate(meshes) if len(asked) > 1)
    # Widths fall by less than 100 from mesh to mesh, and tolerances that nothing sharpened alike.
    assert all(asked[0] <= meshes[again][0] / 10 for asked in meshes[again + 1 :])
    assert len(meshes) > again + 1
    two = la.bracket(sand_punch(), 0.05, jobs=2)
    assert (one.lower, one.upper) == (two.lower, two.upper)


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
    found = solver.answer(asking.Asked("lower", even_punch(), 1e-6)).bound
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
