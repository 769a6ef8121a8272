"""Ends of a range that are a little off prove less."""

import time
from dataclasses import replace
from math import inf
from types import SimpleNamespace

import numpy as np
import pytest

import lacore as la
from lacore.analyses.ranges import continuum, coulomb
from lacore.analyses.ranges.continuum import continuum_range
from lacore.bounds.bracket.bracket import Ending
from lacore.bounds.lower import LowerBound
from lacore.bounds.upper import UpperBound
from lacore.coupling.interval import End, EndStatus, Interval
from lacore.coupling.search import CertifiedMechanism
from lacore.reporting.errors import InputError
from lacore.reporting.findings import Finding
from lacore.reporting.kinds import Kind
from lacore.reporting.status import Rigor
from tests.lacore.coupling.test_injected_intervals import two_blocks
from tests.lacore.models import deformable_block


def test_an_end_next_to_its_bound_is_not_proven_by_it():
    """1e-4 apart, there may be lower and higher load factors in between."""
    found = la.coulomb_range(la.examples.column(friction=0.3), restarts=0)
    low, high = found.low, found.high
    for share, proven in ((0.0, True), (1e-8, True), (1e-4, False)):
        other = replace(found, bracket=(low * (1 - share), high * (1 + share)))
        assert (other.lowest_proven, other.highest_proven) == (proven, proven)


def test_bounds_of_a_polygon_are_none_of_the_continuum():
    """Edges that stand for a curve enclose other loads than the curve does."""
    problem = deformable_block(0.3)
    exact = continuum_range(la.discretise(problem), "clarabel", {}, None)
    assert -inf < exact.lower <= exact.upper < inf
    body = replace(problem.bodies["block"], geometry="approximated")
    polygon = replace(problem, bodies={"block": body})
    found = continuum_range(la.discretise(polygon), "clarabel", {}, None)
    assert (found.lower, found.upper) == (-inf, inf)
    assert len(found.missing) == 2


def test_bounds_that_the_first_solve_found_are_kept(monkeypatch):
    """A search whose own solves of the two problems fail knows what the loop proved."""
    problem = la.examples.column(friction=0.3)
    state = replace(la.solve(problem), status=la.Status.NOT_CERTIFIED, bracket=(0.1, 0.4))
    monkeypatch.setattr(coulomb, "solve", lambda *args, **more: state)
    bounds = coulomb.coulomb_bounds

    def failing(*args):
        return (-np.inf, np.inf), bounds(*args)[1]

    monkeypatch.setattr(coulomb, "coulomb_bounds", failing)
    assert la.coulomb_range(problem, restarts=0).bracket == (0.1, 0.4)


def bound(kind, load_factor, rigor):
    """A bound that is made up: what is read of it."""
    own = object.__new__(kind)
    for name, value in {"load_factor": load_factor, "rigor": rigor}.items():
        object.__setattr__(own, name, value)
    return own


@pytest.mark.parametrize(
    ("lower", "upper", "ending", "ends", "missing"),
    [
        (Rigor.LOWER, Rigor.UPPER, None, (1.0, 2.0), 0),
        (Rigor.DISCRETE, Rigor.UPPER, None, (-inf, 2.0), 1),
        (Rigor.LOWER, Rigor.DISCRETE, None, (1.0, inf), 1),
        (Rigor.LOWER, Rigor.UPPER, Ending.CROSSED, (-inf, inf), 1),
    ],
)
def test_a_bracket_bounds_the_continuum_by_its_strict_sides(
    monkeypatch, lower, upper, ending, ends, missing
):
    """Bounds that cross contradict each other, so that neither is one."""
    asked = []

    def bracketed(problem, width, *, backend):
        asked.append((width, backend))
        below, above = bound(LowerBound, 1.0, lower), bound(UpperBound, 2.0, upper)
        return SimpleNamespace(
            lower_bound=below, upper_bound=above, status=ending, failures=(), lent=()
        )

    monkeypatch.setattr(continuum, "bracket", bracketed)
    found = continuum_range(la.discretise(deformable_block(0.3)), "clarabel", {}, 0.1)
    assert (found.lower, found.upper) == ends
    assert len(found.missing) == missing
    assert asked == [(0.1, "clarabel")]


def test_a_bracket_tells_why_it_has_one_side_alone(monkeypatch):
    """The reason is that of the bracket, which knows it, where there is one."""
    below, above = bound(LowerBound, 1.0, Rigor.DISCRETE), bound(UpperBound, 2.0, Rigor.UPPER)
    for failures in ((), (Finding(Kind.STEP_OF_PATH),)):
        found = SimpleNamespace(
            lower_bound=below, upper_bound=above, status=None, failures=failures, lent=()
        )
        monkeypatch.setattr(continuum, "bracket", lambda *given, own=found, **more: own)
        missing = continuum_range(la.discretise(deformable_block(0.3)), "clarabel", {}, 0.1).missing
        kinds = [own.kind for own in missing]
        assert kinds == [Kind.STEP_OF_PATH if failures else Kind.STRAIGHT_EDGES]


def test_a_central_path_has_no_more_time_than_the_search(monkeypatch):
    """What is left of the limit, and never more than the backend is given for one solve."""
    left, begin = [], time.perf_counter()
    monkeypatch.setattr(coulomb.Search, "run", lambda own, *given: left.append(own.seconds()))
    for limit, options in ((50.0, None), (500.0, {"time_limit": 20.0})):
        coulomb.coulomb_range(two_blocks(0.3, 0.2), "clarabel", time_limit=limit, options=options)
        spent = time.perf_counter() - begin
        most = limit if options is None else options["time_limit"]
        assert min(limit - spent, most) <= left[-1] <= most


@pytest.mark.parametrize("worse", ["lower", "upper"])
def test_a_row_is_no_better_than_the_worse_of_its_ends(worse):
    def end(load_factor, residual):
        seen = SimpleNamespace(worst=("gap", residual))
        return End(EndStatus.EXACT, load_factor, None, seen)

    off = {"lower": 1e-12, "upper": 1e-12} | {worse: 3e-7}
    interval = Interval(end(0.2, off["lower"]), end(0.3, off["upper"]))
    row = coulomb._row(CertifiedMechanism(2, "path", interval, ()), 10.0)
    assert row["residual"] == 3e-7
    assert (row["low"], row["high"]) == (2.0, 3.0)


@pytest.mark.parametrize("failing", ["lower_bound", "upper_bound"])
def test_a_side_that_is_rejected_leaves_the_other_one(monkeypatch, failing):
    """The reason is reported for the side that it concerns."""

    def rejected(*given, **more):
        raise InputError("field", 1, "no bound", "none")

    def proven(*given, **more):
        if failing == "upper_bound":
            return bound(LowerBound, 1.0, Rigor.LOWER)
        return bound(UpperBound, 2.0, Rigor.UPPER)

    monkeypatch.setattr(continuum, "lower_bound", proven)
    monkeypatch.setattr(continuum, "upper_bound", proven)
    monkeypatch.setattr(continuum, failing, rejected)
    found = continuum_range(la.discretise(deformable_block(0.3)), "clarabel", {}, None)
    side = failing.removesuffix("_bound")
    assert (found.lower, found.upper) == ((1.0, inf) if side == "upper" else (-inf, 2.0))
    (missing,) = found.missing
    assert missing.kind is Kind.NO_BOUND
    assert side in str(missing)


def test_the_step_of_a_path_has_no_range_of_the_continuum():
    """Contact that closes a distance is a law of the step, and none of the problem."""
    stated = la.discretise(deformable_block(0.3))
    contact = replace(stated.program.contact, closing=np.full(stated.program.contact.count, 0.1))
    moving = replace(stated, program=replace(stated.program, contact=contact))
    found = continuum_range(moving, "clarabel", {}, None)
    assert (found.lower, found.upper) == (-inf, inf)
    assert [own.kind for own in found.missing] == [Kind.STEP_OF_PATH]
