"""Rounds of brackets: how much finer the next meshes are, and several solves at a time."""

import time
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import lacore as la
from lacore.bounds import constants
from lacore.bounds.bracket import asking, refine
from lacore.bounds.bracket.track import Track, _in_steps, growths, order
from tests.lacore.bounds.bracket.test_adaptivity import even_punch
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
    loose = asking.RequestedBound("upper", sand_punch(), 1e-4)
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
    loose = asking.RequestedBound("upper", sand_punch(), 1e-6, affordable=1e-9)
    assert solver.answer(loose).bound.lost == 1.0  # the second loses more
    assert solver.answer(loose).bound.lost == 0.5
    assert asked == pytest.approx([1e-6, constants.TIGHTEST_TOLERANCE] * 2, rel=1e-12)


def test_a_given_tolerance_is_kept_whatever_is_lost(tolerances):
    solver = asking.Solver("clarabel", {"tolerance": 1e-4}, time.perf_counter() + 60, 1)
    answer = solver.answer(asking.RequestedBound("upper", sand_punch(), 1e-6, affordable=0.0))
    assert answer.sharper == 1
    assert list(tolerances.values()) == [[1e-4]]


def test_what_loses_much_is_not_asked_for_twice_on_finer_meshes(tolerances, monkeypatch):
    """They lose more; and what was learnt does not depend on what runs at a time."""
    monkeypatch.setattr(refine, "AFFORDABLE_LOSS", 1e-6)
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
@pytest.mark.parametrize("sizes", [(1.0,), (1.0, 4.0)], ids=["shared", "separate"])
def test_meshes_land_on_the_target(true, sizes):
    """Errors of s N^-order: no mesh grows by more than marks can see, and the last one suffices."""
    tracks = [SimpleNamespace(elements=100.0, rest=np.nan, size=size) for size in sizes]

    def error(track):
        return track.size * track.elements**-true

    target, seen, rounds = 1e-3 * sum(map(error, tracks)), [], 0
    while (width := sum(map(error, tracks))) > target:
        seen.append((sum(track.elements for track in tracks), width))
        for track, times in zip(tracks, growths(tracks, width / target, order(seen)), strict=True):
            assert 1 <= times <= 3.4
            gained = error(track)
            track.elements *= times
            if times > 1:
                track.rest = (gained - error(track)) / (times - 1)
        rounds += 1
    # From 3.4 times the elements a round on, 1000^(1/order) in all; a guess halfway to 1 of an
    # order that is off by a fifth may take one round more, and stops short by its last step.
    assert rounds <= np.ceil(np.log(1000) / true / np.log(3.4)) + 2
    assert width >= target * 3.4 ** (-0.1 - 0.2 * len(sizes)) * 0.94


def test_the_mesh_that_leaves_more_to_gain_grows_by_more():
    few, many = SimpleNamespace(elements=100.0, rest=1.0), SimpleNamespace(elements=100.0, rest=4.0)
    one, other = growths([few, many], 2.0, 1.0)
    assert other / one == pytest.approx(4 ** (1 / 2.25))
    assert (1 / one + 4 / other) / 5 * 2 == pytest.approx(0.97)
    # What is nearly done waits, and the other makes up for it.
    few.rest = 0.5
    one, other = growths([few, many], 1.3, 1.0)
    assert one == 1.0
    assert (0.5 + 4 / other) / 4.5 * 1.3 == pytest.approx(0.97)


@pytest.mark.parametrize(
    ("whole", "steps"),
    [([9.0, 4.0], [3, 2]), ([4.0, 9.0], [2, 3]), ([27.0, 1.0], [3, 1]), ([1e9, 1e9], [3.4, 3.4])],
)
def test_meshes_grow_in_even_steps_of_which_the_largest_is_allowed(whole, steps):
    """No mesh has more than 3.4 times the elements of the last one, whatever it takes in all."""
    assert _in_steps(np.array(whole)) == pytest.approx(steps, rel=0.01)


@pytest.mark.parametrize("rate", [0.8, 1.3])
def test_growths_reach_the_target_in_the_least_time(rate):
    """Of all growths with errors ``sum e n^-p`` at the target, by search; times are ``(N n)^1.25``.

    A tenth of the width, 2 targets, cannot be gained.
    """
    tracks = [SimpleNamespace(elements=n, rest=own) for n, own in ((100.0, 1.0), (300.0, 4.0))]
    found = growths(tracks, 2.0, rate, apart=0.1)
    errors = 0.9 * 2.0 * np.array([0.2, 0.8])
    target = 0.97 * (1 - 0.1 * 2.0)
    assert errors @ np.power(found, -rate) == pytest.approx(target)
    one = np.linspace(1, 3.4, 100_001)
    left = target - errors[0] * one**-rate
    other = (errors[1] / np.where(left > 0, left, np.nan)) ** (1 / rate)
    times = (100 * one) ** 1.25 + (300 * np.where(other >= 1, other, np.nan)) ** 1.25
    best = np.nanargmin(times)
    assert found == pytest.approx([one[best], other[best]], rel=1e-3)


def test_widths_that_fall_slowly_take_more_elements():
    seen = np.log(1 / 0.3) / np.log(4)
    assert order([(100, 1.0), (400, 0.3)]) == pytest.approx((1 + seen) / 2)
    track = SimpleNamespace(elements=100.0, rest=1.0)
    # Order 1.2 or .8: (3/.94)^(1/1.2) at once, or (3/.94)^(1/.8) = 4.3 in two steps.
    assert growths([track], 3.0, 1.2) == pytest.approx([(3 / 0.94) ** (1 / 1.2)])
    assert growths([track], 3.0, 0.8) == pytest.approx([(3 / 0.94) ** (1 / 1.6)])


def test_two_problems_apart_by_the_whole_width_are_refined_evenly():
    """Refinement gains nothing, so that no mesh gains more than another."""
    tracks = [SimpleNamespace(elements=float(own), rest=rest) for own, rest in ((33, 0.1), (32, 0))]
    one, other = growths(tracks, 2.0, 1.0, apart=1.0)
    assert one == other == pytest.approx(2 / 0.97)


def test_where_two_problems_stay_apart_what_can_be_gained_counts():
    """Of a width of 1.2 targets 0.5 stay: 0.7 are to become 0.5, and a little less."""
    track = SimpleNamespace(elements=100.0, rest=1.0)
    assert growths([track], 1.2, 1.0, apart=0.5 / 1.2) == pytest.approx([0.7 / (0.94 * 0.5)])


def test_what_is_not_proven_is_asked_once_more_as_the_backend_would(monkeypatch):
    """With the tolerance of the question first, and then with that of the backend."""
    seen = []

    def careless(problem, backend, options):
        seen.append(options.get("tolerance"))
        found = la.lower_bound(problem, backend, options=options)
        return replace(found, status=la.Status.NOT_CERTIFIED) if len(seen) == 1 else found

    monkeypatch.setattr(asking, "lower_bound", careless)
    solver = asking.Solver("clarabel", {}, time.perf_counter() + 60, 1)
    found = solver.answer(asking.RequestedBound("lower", even_punch(), 1e-6)).bound
    assert found.status is la.Status.SOLVED
    assert seen == [1e-6, None]


def test_an_order_is_guessed_while_nothing_is_known():
    assert order([]) == order([(100, np.inf)]) == order([(100, np.inf), (200, 0.5)]) == 1.0
    # Between those of even and of adapted meshes, whatever a single step pretends.
    assert order([(100, 0.5), (200, 0.5)]) < 1.0 < order([(100, 0.5), (200, 1e-6)]) < 2.0


def test_meshes_that_promise_nothing_yet_grow_alike_unless_one_costs_little():
    coarse, fine = (SimpleNamespace(elements=n, rest=np.nan) for n in (100.0, 900.0))
    assert growths([coarse, fine], np.inf, 1.0) == [3.4, 1.0]
    assert growths([coarse, coarse], np.inf, 1.0) == [3.4, 3.4]
    assert growths([coarse], 1.5, 1.0) == pytest.approx([1.5 / 0.94])
    known = SimpleNamespace(elements=100.0, rest=1.0)
    assert growths([known, fine], 2.0, 1.0) == pytest.approx([2 / 0.97, 2 / 0.97])


def test_what_a_refinement_left_to_gain_is_told_by_the_last_two():
    stated = even_punch()
    new = Track(("lower",), stated)
    assert np.isnan(new.rest)
    # 2 gained at 3 times the elements left 1, of which 2 times the elements leave a half.
    assert replace(new, gains=(2.0, 0.1), times=(3.0, 2.0)).rest == pytest.approx(0.5)
    assert replace(new, gains=(2.0, 1.0), times=(3.0, 2.0)).rest == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("left", "options", "expected"),
    [
        (60.0, {}, 60.0),
        (60.0, {"time_limit": 5.0}, 5.0),
        (60.0, {"time_limit": 100.0}, 60.0),
        (-60.0, {}, 1.0),
    ],
)
@pytest.mark.parametrize("kind", ["lower", "upper"])
def test_a_solve_has_the_time_that_is_left(monkeypatch, kind, left, options, expected):
    """Or what the user gives it, if that is less; and a second where nothing is left."""
    seen = []

    def solved(*_, options, **__):
        seen.append(options["time_limit"])

    name = {"lower": "lower_bound", "upper": "solve"}[kind]
    monkeypatch.setattr(asking, name, solved)
    monkeypatch.setattr(asking, "upper_bound", lambda state: state)
    solver = asking.Solver("clarabel", options, time.perf_counter() + left, 1)
    solver._bound(asking.RequestedBound(kind, even_punch(), 1e-6), {})
    assert seen == pytest.approx([expected], abs=1.0 if expected == 60 else 0.0)


def test_a_repeated_solve_that_proves_nothing_is_not_taken(monkeypatch):
    """Whatever its numbers are."""
    bounds = iter([(la.Status.SOLVED, 1.0), (la.Status.NOT_CERTIFIED, 0.1)])

    def bound(*_):
        status, lost = next(bounds)
        return SimpleNamespace(status=status, lost=lost)

    monkeypatch.setattr(asking.Solver, "_bound", bound)
    solver = asking.Solver("clarabel", {}, time.perf_counter() + 60, 1)
    loose = asking.RequestedBound("upper", even_punch(), 1e-6, affordable=0.1)
    assert solver.answer(loose).bound.status is la.Status.SOLVED
