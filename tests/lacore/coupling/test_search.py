"""Decisions of the search for Coulomb load factors, on ends that are made up."""

from math import inf

import numpy as np
import pytest

from lacore.coupling.interval import End, EndStatus, Interval, further
from lacore.coupling.search import HIGH, LOW, CertifiedMechanism, Search
from tests.lacore.planted import P0, sliding

D, STATE = sliding()
TOLERANCE = 1e-6


def end(load_factor, status=EndStatus.EXACT):
    return End(status, load_factor, STATE, None)


def found(low, high):
    return CertifiedMechanism(0, "path", Interval(end(low), end(high)), ())


def search(bounds=(0.0, 2.0), seed=0):
    nothing = [None] * 3
    rng = np.random.default_rng(seed)
    return Search(D.program, None, None, TOLERANCE, bounds, rng, *nothing)


def test_an_end_is_further_out_by_more_than_a_share_of_the_bounds():
    """In units of the larger bound, 2, whatever the ends are."""
    own = search((-1.0, 2.0))
    for side in (LOW, HIGH):
        assert own._beyond(side, end(0.1 + side * 0.021), end(0.1), 0.01)
        assert not own._beyond(side, end(0.1 + side * 0.019), end(0.1), 0.01)
        assert not own._beyond(side, end(0.1 - side * 0.5), end(0.1), 0.01)
    assert search((-3.0, inf))._size == 3
    assert search((-inf, inf))._size == 1
    assert search((0.0, 0.0))._size == 1


@pytest.mark.parametrize(("low", "high"), [(0.0, 2.0), (1e-7, 2 - 1e-7), (-1e-3, 2.001)])
def test_an_end_at_its_bound_ends_the_search(low, high):
    own = search()
    assert not own._bounded(LOW)
    assert not own._bounded(HIGH)
    own.best = {LOW: found(low, 1.0), HIGH: found(1.0, high)}
    assert own._bounded(LOW)
    assert own._bounded(HIGH)


def test_an_end_inside_its_bound_does_not():
    own = search()
    own.best = {LOW: found(1e-5, 1.0), HIGH: found(1.0, 2 - 1e-5)}
    assert not own._bounded(LOW)
    assert not own._bounded(HIGH)
    open_ended = search((-inf, inf))
    open_ended.best = own.best
    assert not open_ended._bounded(LOW)
    assert not open_ended._bounded(HIGH)


def test_a_climb_knows_where_it_has_been():
    """On its own side, and to the accuracy of load factors."""
    own = search()
    assert not own._left(LOW, end(0.5))
    assert own._left(LOW, end(0.5))
    assert own._left(LOW, end(0.5 + own._apart))
    assert not own._left(HIGH, end(0.5))
    assert not own._left(LOW, end(0.5 + 10 * own._apart))


def test_shaken_reactions_stay_compressive():
    """Each by a random factor whose logarithm has the spread; tensions are none."""
    own, count = search(), STATE.normal_reaction.size
    same = own._shaken(STATE, 0.0)
    assert np.array_equal(same.normal_reaction, STATE.normal_reaction)
    factors = [own._shaken(STATE, 0.5).normal_reaction / P0 for _ in range(2000 // count)]
    logs = np.log(np.concatenate(factors))
    assert np.std(logs) == pytest.approx(0.5, rel=0.1)
    assert np.mean(logs) == pytest.approx(0.0, abs=0.1)
    pulled = own._shaken(
        type(STATE)(**(vars(STATE) | {"normal_reaction": -STATE.normal_reaction})), 0.5
    )
    assert not pulled.normal_reaction.any()


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_an_end_is_no_nearer_than_the_state_itself(sign):
    known = end(1.0, EndStatus.FOUND)
    outside = end(1.0 + sign * 0.1)
    assert further(outside, known, sign) is outside
    inside = End(EndStatus.EXACT, 1.0 - sign * 1e-9, STATE, None, slack=0.3)
    kept = further(inside, known, sign)
    assert (kept.load_factor, kept.status, kept.slack) == (1.0, EndStatus.EXACT, 0.3)


def test_an_interval_is_exact_where_both_ends_are_proven():
    for one, other, exact in (
        (EndStatus.EXACT, EndStatus.UNBOUNDED, True),
        (EndStatus.EXACT, EndStatus.FOUND, False),
        (EndStatus.NOT_CERTIFIED, EndStatus.EXACT, False),
    ):
        assert Interval(end(0.0, one), end(1.0, other)).exact == exact
