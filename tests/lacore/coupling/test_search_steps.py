"""The steps of a search for Coulomb load factors, on mechanisms that are made up.

A state is known by its load factor. `settles` gives the state that alternation reaches from one,
`carries` the interval of a state; the ends of an interval are states of their own.
"""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from lacore.coupling import search as module
from lacore.coupling.interval import End, EndStatus, Interval
from lacore.coupling.search import HIGH, LOW, Search, coulomb_bounds
from lacore.program.certificate import certify
from lacore.solvers.backend import find_backend
from tests.lacore.block_programs import rough_stop, wall
from tests.lacore.planted import sliding

D, STATE = sliding()
UNBOUNDED, NONE = EndStatus.UNBOUNDED, EndStatus.NOT_CERTIFIED


def known(label):
    return replace(STATE, load_factor=label)


class MadeUp(Search):
    """A search whose loops and intervals are looked up; it notes what it does."""

    def __init__(self, monkeypatch, settles, carries, bounds=(-10.0, 10.0)):
        self.shaken, self.settled, self.rows = [], [], []
        nothing, rng = [None] * 2, np.random.default_rng(0)
        super().__init__(D.program, None, None, 1e-6, bounds, rng, self.rows.append, *nothing)
        self.settles, self.programs = settles, []

        def interval(program, state, prepare, tolerance):
            low, high, *status = carries[state.load_factor]
            lower, upper = status or (EndStatus.EXACT, EndStatus.EXACT)
            return Interval(End(lower, low, known(low), None), End(upper, high, known(high), None))

        monkeypatch.setattr(module, "load_factor_interval", interval)

    def _shaken(self, state, spread):
        self.shaken.append((state.load_factor, spread))
        return state

    def _settled(self, program, start):
        self.settled.append(start.load_factor)
        self.programs.append(program)
        label = self.settles.get(start.load_factor)
        return None if label is None else (known(label), SimpleNamespace(iterates=[]))

    def found(self):
        return [(own.restart, own.origin, own.interval.low) for own in self.rows]


def test_a_climb_goes_from_low_end_to_low_end_until_none_is_further(monkeypatch):
    """From 5 the low end at 4 settles to 3.5, whose low end at 3 settles to nothing lower."""
    carries = {5.0: (4.0, 6.0), 3.5: (3.0, 4.5), 3.2: (3.1, 3.3)}
    own = MadeUp(monkeypatch, {5.0: 5.0, 4.0: 3.5, 3.0: 3.2}, carries)
    own._climb(own._found(known(5.0), 2, "associated"), LOW)
    assert own.best[LOW].interval.low == 3.0
    spreads = list(module._SPREADS)
    assert own.shaken == [(4.0, spreads[0]), *((3.0, spread) for spread in spreads)]
    assert own.found() == [(2, "associated", 4.0), (2, "low end", 3.0)] + [
        (2, "low end", 3.1)
    ] * len(spreads)


def test_a_climb_to_high_ends_is_the_mirror_image(monkeypatch):
    carries = {5.0: (4.0, 6.0), 6.5: (5.5, 7.0)}
    own = MadeUp(monkeypatch, {6.0: 6.5, 5.0: 5.0}, carries)
    own._climb(own._found(known(5.0), 0, "associated"), HIGH)
    assert own.best[HIGH].interval.high == 7.0
    assert own.best[LOW].interval.low == 4.0
    assert own.found()[1] == (0, "high end", 5.5)
    assert len(own.shaken) == 1 + len(module._SPREADS)  # from 7 nothing settles


def test_a_climb_ends_at_its_bound_without_a_bound_and_where_it_has_been(monkeypatch):
    carries = {5.0: (4.0, 6.0), 6.5: (5.5, np.inf, EndStatus.EXACT, UNBOUNDED)}
    settles = {5.0: 5.0, 6.0: 6.5}
    bounded = MadeUp(monkeypatch, settles, carries, bounds=(4.0, 10.0))
    bounded._climb(bounded._found(known(5.0), 0, "associated"), LOW)
    assert not bounded.shaken
    unbounded = MadeUp(monkeypatch, settles, carries)
    unbounded._climb(unbounded._found(known(5.0), 0, "associated"), HIGH)
    assert unbounded.shaken == [(6.0, 0.0)]
    again = MadeUp(monkeypatch, settles, carries)
    again._climb(again._found(known(5.0), 0, "associated"), LOW)
    before = len(again.shaken)
    again._climb(again._found(known(5.0), 1, "associated"), LOW)
    assert before == len(module._SPREADS)
    assert len(again.shaken) == before
    again._climb(None, LOW)


def test_what_does_not_settle_or_carries_nothing_is_not_found(monkeypatch):
    own = MadeUp(monkeypatch, {1.0: 2.0}, {2.0: (np.nan, 1.0, NONE, EndStatus.EXACT)})
    assert own._found(known(5.0), 0, "associated") is None
    assert own._found(known(1.0), 0, "associated") is None
    assert not own.rows
    assert not own.best


def test_the_best_mechanism_of_a_side_is_the_one_furthest_out(monkeypatch):
    """Round-off does not replace a mechanism by another one."""
    carries = {1.0: (1.0, 2.0), 0.0: (1 - 1e-9, 2 + 1e-9), 3.0: (1.5, 3.0), 0.5: (0.5, 0.7)}
    own = MadeUp(monkeypatch, {label: label for label in carries}, carries)
    first, same, upper, lower = (own._found(known(label), 0, "path") for label in carries)
    assert own.best == {LOW: lower, HIGH: upper}
    assert own.rows == [first, same, upper, lower]


def test_a_search_starts_from_the_certified_state_then_from_the_associated_one(monkeypatch):
    """Of each restart from shaken reactions, from a continuation and from the best so far."""
    carries = {label: (label, label) for label in (1.0, 2.0)}
    settles = {1.0: 1.0, 2.0: 2.0}
    own = MadeUp(monkeypatch, settles, carries)
    own._continued = lambda start, spread: (own.shaken.append(("continued", spread)), start)[1]
    own.run(known(1.0), known(2.0), restarts=1)
    origins = [(own.restart, own.origin) for own in own.rows if "end" not in own.origin]
    assert origins == [
        (0, "certified"),
        (0, "associated"),
        (0, "continuation"),
        (1, "associated"),
        (1, "continuation"),
        (1, "best"),
        (1, "best"),
    ]
    assert [own for own in own.shaken if own[0] == "continued"] == [
        ("continued", 0.0),
        ("continued", module._SHAKEN),
    ]
    best = [state for state, spread in own.shaken if spread == module._BEST and state != 2.0]
    assert best.count(1.0) >= 1
    assert (2.0, 0.0) in own.shaken
    assert (2.0, module._SHAKEN) in own.shaken


@pytest.mark.parametrize(
    ("bounds", "origins"),
    [
        ((1.0, 1.0), ["certified"]),
        ((1.0, 9.0), ["certified", "associated", "associated", "best"]),
        ((0.0, 1.0), ["certified", *["associated", "continuation"] * 2, "best"]),
    ],
)
def test_a_search_ends_on_a_side_that_has_reached_its_bound(monkeypatch, bounds, origins):
    own = MadeUp(monkeypatch, {1.0: 1.0, 2.0: 1.0}, {1.0: (1.0, 1.0)}, bounds)
    own._continued = lambda start, spread: start
    own.run(known(1.0), known(2.0), restarts=1)
    assert [own.origin for own in own.rows if "end" not in own.origin] == origins


def test_friction_grows_in_ten_steps_along_low_ends(monkeypatch):
    """Each step starts where the low end of the last one is; those that fail change nothing."""
    settles = {5.0: 4.5, 4.0: 3.5, 3.0: None}
    own = MadeUp(monkeypatch, settles, {})
    ends = {4.5: known(4.0), 3.5: known(3.0)}
    asked = []

    def end(program, state, side, prepare, tolerance):
        asked.append((state.load_factor, side))
        return (
            None
            if state.load_factor not in ends
            else SimpleNamespace(point=ends[state.load_factor])
        )

    monkeypatch.setattr(module, "proven_end", end)
    assert own._continued(known(5.0), 0.25).load_factor == 3.0
    assert asked == [(4.5, LOW), (3.5, LOW)]
    full = D.program.contact.coefficient
    shares = [program.contact.coefficient / full for program in own.programs]
    assert np.allclose(shares, np.arange(1, 10)[:, None] / 10)
    assert own.shaken == [(5.0, 0.25), (4.0, 0.25), *[(3.0, 0.25)] * 8]


def real_search(program):
    """Search with a solver: the mechanisms found, the bounds, and the solves of both kinds."""
    engine = find_backend("clarabel")
    count = {"own": 0, "loop": 0}

    def prepare(own):
        count["own"] += 1
        return engine.prepare(own, engine.Options())

    solver = engine.prepare(program, engine.Options())
    bounds, start = coulomb_bounds(program, solver, 1e-6)

    def solved(_):
        count["loop"] += 1

    rows = []
    rng = np.random.default_rng(0)
    own = Search(program, solver, prepare, 1e-6, bounds, rng, rows.append, solved, lambda: 60.0)
    own.run(None, start, 0)
    return own, rows, count


def test_a_wall_has_certified_mechanisms_between_its_bounds():
    program = wall(courses=((1, 1), (0.5, 1, 0.5)))
    own, rows, count = real_search(program)
    assert {row.origin for row in rows} >= {"associated", "continuation"}
    for row in rows:
        for end in (row.interval.lower, row.interval.upper):
            assert certify(program, end.point).holds(1e-6)
            assert own.bounds[0] - 1e-6 <= end.load_factor <= own.bounds[1] + 1e-6
    assert own.best[LOW].interval.low == pytest.approx(min(row.interval.low for row in rows))
    assert own.best[HIGH].interval.high == pytest.approx(max(row.interval.high for row in rows))
    assert own.solves == count["own"] + count["loop"]


def test_a_range_of_closed_form():
    """Friction at the stop acts on the upper block up or down.

    The joint presses with ``n = 1/(1 -+ 0.4 0.5)``, and the load is ``0.5 n + 0.3 (2 + n)``
    (CLOSED_FORMS C5b).
    """
    own, _, _ = real_search(rough_stop())
    assert own.best[LOW].interval.low == pytest.approx(0.6 + 0.8 / 1.2, abs=1e-6)
    assert own.best[HIGH].interval.high == pytest.approx(0.6 + 0.8 / 0.8, abs=1e-6)
