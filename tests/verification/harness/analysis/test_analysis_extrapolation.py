"""Limits of series with known ones."""

from itertools import pairwise

import numpy as np
import pandas as pd
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from lacore_verification.harness.analysis.extrapolation import (
    hermite_limit,
    lambda_limits,
    refinement_limits,
    richardson,
)
from tests.verification.harness.analysis.test_analysis_slopes import R, law, made


@given(
    order=st.floats(0.3, 6),
    limit=st.floats(-10, 10),
    factor=st.floats(0.1, 10).flatmap(lambda c: st.sampled_from([-c, c])),
    ratios=st.lists(st.floats(1.3, 3), min_size=2, max_size=4),
)
def test_a_power_law_is_extrapolated_exactly(order, limit, factor, ratios):
    size = 1 / np.cumprod([1.0, *ratios])
    values = limit + factor * size**order
    found = richardson(size, values)
    # Round-off of the values, 1e-15 of 20, against their last difference, which is what order and
    # correction are made of; the correction is at most 1/(1.3**0.3 - 1) = 12 times that.
    steps = np.abs(np.diff(values))
    share = 20 * 1e-15 / steps.min() * 100
    assume(share < 1e-3)
    assert found.reason == ""
    assert found.order == pytest.approx(order, rel=max(share, 1e-9), abs=20 * share)
    reach = abs(factor) * size[-3] ** order + 12 * steps[-1]
    assert found.value == pytest.approx(limit, abs=20 * share * reach + 1e-12)


def test_uncertainty_is_the_correction_of_three_values_and_a_change_of_more():
    h = np.array([1, 0.5, 0.25, 0.125])
    values = 1 + h + 0.3 * h**2
    three, four = richardson(h[:3], values[:3]), richardson(h, values)
    assert three.uncertainty == pytest.approx(abs(three.value - values[2]))
    assert four.uncertainty == pytest.approx(abs(four.value - three.value))
    for found in (three, four):
        assert abs(found.value - 1) <= found.uncertainty


@pytest.mark.parametrize(
    ("size", "values", "reason"),
    [
        ([1, 2], [1, 2], "2 values"),
        ([1, 2, 4], [1, 2, 1.5], "monotonously"),
        ([1, 2, 4], [1, 2, 2.01], "order is outside"),  # differences grow towards h = 0
        ([1, 2, 4], [1, 1, 1], "no more than their accuracy"),
        ([1, 1, 4], [1, 2, 3], "several values at one size"),
        ([1, 2, np.nan], [1, 2, 3], "2 values"),
    ],
)
def test_refused(size, values, reason):
    found = richardson(np.array(size, float), np.array(values, float))
    assert reason in found.reason
    assert np.isnan(found.value)


def test_frame_of_refinement_limits():
    size = np.array([64, 256, 1024])
    rows = [
        made(mesh=list("abc"), n_elements=size, load_factor=3 + 1 / size, reference=3.0),
        made(backend="x", mesh=list("abc"), n_elements=size, load_factor=[3, 3.1, 3], reference=3),
        made(backend="y", mesh=["a"], n_elements=[64], load_factor=[3.0], reference=3.0),
    ]
    found = refinement_limits(pd.concat(rows, ignore_index=True)).set_index("backend")
    assert list(found.index) == ["newton", "x"]
    assert found.loc["newton", "limit"] == pytest.approx(3, abs=1e-12)
    assert found.loc["newton", "order"] == pytest.approx(2)
    assert np.isnan(found.loc["x", "limit"])
    assert "monotonously" in found.loc["x", "reason"]


@given(
    terms=st.lists(st.floats(-3, 3), min_size=4, max_size=4),
    r=st.floats(1e-3, 0.3),
    ratio=st.floats(1.5, 10),
)
def test_hermite_is_exact_on_cubics(terms, r, ratio):
    """The energy is ``-r`` times the slope, whatever the cubic."""
    cubic = np.polynomial.Polynomial(terms)
    both = np.array([r * ratio, r])
    limit, _ = hermite_limit(both, cubic(both), -both * cubic.deriv()(both))
    # Weights of the cubic at 0 are at most (2 t^3, t = 1/(ratio-1) <= 2) about 30.
    assert limit == pytest.approx(terms[0], abs=1e-11 * 4)


@given(terms=st.lists(st.floats(-3, 3), min_size=3, max_size=3), r=st.floats(1e-3, 0.3))
def test_two_lambdas_are_exact_on_parabolas(terms, r):
    parabola = np.polynomial.Polynomial(terms)
    both = np.array([3 * r, r])
    _, limit = hermite_limit(both, parabola(both), -both * parabola.deriv()(both))
    assert limit == pytest.approx(terms[0], abs=1e-11)


def test_lambda_limits_say_how():
    single = lambda_limits(made(**law(R)))
    assert len(single) == len(R) - 1
    assert (np.diff(single["r"]) < 0).all()
    assert single["rule"].iloc[0] == "Hermite, two values (T19)"
    assert single["rule"].iloc[-1] == "settled"
    assert (np.abs(single["limit"] - 5) <= single["uncertainty"]).all()
    looped = lambda_limits(made(**law(R), outer_iterations=5))
    assert "3 make an extrapolation" in looped["reason"].iloc[0]
    assert looped["rule"].iloc[1] == "Richardson, three values"
    # lambda errs by b r^2 (1 - 2 c r/b) = 2 r^2 (1 - 3 r): order 2 - 3 r at r up to 0.01.
    assert looped["order"].iloc[3] == pytest.approx(2, abs=0.03)
    good = looped[looped["reason"] == ""]
    assert (np.abs(good["limit"] - 5) <= good["uncertainty"]).all()
    assert all(a != b for a, b in pairwise(single["r"]))
    twice = lambda_limits(pd.concat([made(**law(R)), made(**law(R))]))
    assert twice["reason"].str.contains("several values").any()
    assert len(lambda_limits(made(**law(R), status="failed"))) == 0
