"""Ends of a range that are a little off prove less."""

from dataclasses import replace
from math import inf

import numpy as np

import lacore as la
from lacore.analyses.ranges import coulomb
from lacore.analyses.ranges.continuum import continuum_range
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
