"""Slopes against errors of known slope, floor and range; frames against a join by hand."""

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lacore as la
from lacore_verification.harness.analysis.exact import with_exact
from lacore_verification.harness.analysis.slope_fits import (
    fit_slope,
    refinement_orders,
    regularisation_slopes,
    slopes,
)
from tests.verification.harness.analysis.analysis_rows import DECADES

R = np.array(DECADES)


@given(
    slope=st.floats(0.3, 4).map(lambda s: round(s, 3)),
    sign=st.sampled_from([-1, 1]),
    side=st.sampled_from([-1, 1]),
    size=st.floats(1e-3, 1e3),
    scatter=st.integers(0, 2**32 - 1),
)
def test_a_power_law_is_found_with_its_range(slope, sign, side, size, scatter):
    # Scatter of +-2 % changes a local slope over a factor sqrt(10) by at most
    # 2*0.02/1.151 = 0.035, two of them differ by 0.07 < 0.25: all 9 points are in the range. A
    # fitted slope is a weighted mean of local ones, so it is off by at most 0.035.
    error = side * size * R ** (slope * sign)
    error = error * (1 + 0.02 * np.random.default_rng(scatter).uniform(-1, 1, 9))
    found = fit_slope(R, error)
    assert found.reason == ""
    assert (found.points, found.usable, found.floor_points) == (9, 9, 0)
    assert found.slope == pytest.approx(sign * slope, abs=0.036)
    assert found.low <= found.slope <= found.high
    assert (found.start, found.stop) == (min(R), max(R))
    assert np.isnan(found.floor)


@given(
    slope=st.sampled_from([-2.0, -1.0, 1.0, 2.0]),
    reach=st.floats(4.2, 6.8),
    wobble=st.integers(0, 2**32 - 1),
)
def test_a_floor_is_found_beyond_the_range(slope, reach, wobble):
    """The law reaches the floor after `reach` intervals; noise is within a factor 1.5 of it."""
    x = R if slope > 0 else 1 / R
    law = x**slope
    floor = 10 ** (-abs(slope) * (1 + reach / 2))
    noise = floor * np.random.default_rng(wobble).uniform(1 / 1.5, 1.5, 9)
    found = fit_slope(x, law + noise)
    assert found.reason == ""
    # The range may contain the first points where the noise shows: its local slopes stay within
    # 0.25 of each other, and so of the slope.
    assert found.slope == pytest.approx(slope, abs=0.25)
    assert 4 <= found.points <= 8
    assert found.floor_points + found.points <= 9
    assert floor / 1.5 <= found.floor <= 4 * floor  # the first of them are law and noise together
    edge = found.start if slope > 0 else found.stop
    assert abs(np.log10(edge / x[0])) <= (np.ceil(reach) + 1) / 2


def test_regression_is_that_of_the_textbook():
    """x = 1, e, e^2, e^3; log y = 0, 1.1, 1.9, 3: Sxy = 4.9, Sxx = 5, slope 0.98.

    Residuals about the line 0.03 + 0.98 t: -0.03, 0.09, -0.09, 0.03; s^2 = 0.018/2, standard error
    sqrt(0.009/5); Student with 2 degrees of freedom at 95 %: 4.302653.
    """
    x = np.exp([0.0, 1.0, 2.0, 3.0])
    found = fit_slope(x, np.exp([0.0, 1.1, 1.9, 3.0]), agreement=0.31)
    assert found.slope == pytest.approx(0.98, rel=1e-12)
    assert found.standard_error == pytest.approx(np.sqrt(0.009 / 5), rel=1e-10)
    assert found.high - found.slope == pytest.approx(4.302653 * np.sqrt(0.009 / 5), rel=1e-6)
    assert found.coefficient == pytest.approx(np.exp(0.03), rel=1e-10)
    assert found.spread == pytest.approx(0.3)


@pytest.mark.parametrize(
    ("error", "reason"),
    [
        (R[:3], "3 points"),
        (np.full(9, 1e-9), "does not follow"),
        (R * (-1.0) ** np.arange(9), "changes its sign"),
        (np.exp(np.sin(5 * np.arange(9.0))), "no 4 neighbours"),
        (np.zeros(9), "0 of 9 errors are above the noise"),
        (np.full(9, np.nan), "0 points"),
    ],
)
def test_without_a_range_there_is_a_reason_and_no_number(error, reason):
    found = fit_slope(R[: len(error)], error)
    assert reason in found.reason
    assert np.isnan([found.slope, found.standard_error, found.low, found.high]).all()
    assert found.points == 0


def test_floor_without_a_slope():
    assert fit_slope(R, np.full(9, -3e-9)).floor == pytest.approx(3e-9)
    bent = np.array([1e-3, 1e-4, 3e-5, 2e-5, *np.full(5, 2e-5)])
    found = fit_slope(R, bent)
    assert (found.floor, found.floor_points) == (pytest.approx(2e-5), 6)
    assert "only 6 neighbours on a floor" in found.reason
    below = fit_slope(R, np.array([1, -2, 3, -4, 5, -6, 7, -8, 9]) * 1e-9, 1e-8)
    assert (below.floor, below.floor_points) == (pytest.approx(5e-9), 9)


def test_the_longer_of_two_ranges_is_taken():
    """Slope 1 over four points, then 2 over six, of which one belongs to both."""
    error = np.where(np.arange(9) > 3, R**2 / R[3], R)
    found = fit_slope(R, error)
    assert (found.slope, found.points) == (pytest.approx(2), 6)
    assert found.stop == pytest.approx(R[3])
    assert found.floor_points == 0


def test_noise_that_is_known_ends_the_range():
    error = R.copy()
    found = fit_slope(R, error, noise=error[6] * 1.01)
    assert (found.points, found.floor_points) == (6, 3)
    assert found.slope == pytest.approx(1)


def test_two_values_at_one_parameter_are_refused():
    found = fit_slope(np.array([1, 1, 2, 3, 4.0]), np.ones(5))
    assert "group by more columns" in found.reason


@pytest.mark.parametrize(
    "rule", [{"fewest": 2}, {"agreement": 0.0}, {"confidence": 1.0}, {"confidence": float("nan")}]
)
def test_bad_rules_are_refused(rule):
    with pytest.raises(la.InputError):
        fit_slope(R, R, **rule)
    with pytest.raises(la.InputError):
        slopes(pd.DataFrame({"x": R, "y": R}), "x", "y", [], **rule)


def test_groups_and_missing_values():
    frame = pd.DataFrame(
        {
            "backend": ["a"] * 9 + ["b"] * 9 + ["c"],
            "option_k": pd.array([None] * 9 + [1] * 10, dtype="Int64"),
            "x": pd.array([*R, *R, 1.0], dtype="Float64"),
            "y": [*R, *(R**2), 1.0],
        }
    )
    found = slopes(frame, "x", "y", ["backend", "option_k"])
    assert list(found["backend"]) == ["a", "b"]  # c is no sweep
    assert found["slope"].tolist() == pytest.approx([1, 2])
    assert found["parameter"].tolist() == ["x", "x"]
    empty = slopes(frame[:0], "x", "y", ["backend"])
    assert list(empty.columns[:2]) == ["backend", "parameter"]
    with pytest.raises(la.InputError, match="did you mean 'backend'"):
        slopes(frame, "x", "y", ["backnd"])
    with pytest.raises(la.InputError, match="does not hold numbers"):
        slopes(frame, "backend", "y", [])


def made(**columns):
    """Results of one case: the columns that the join needs, each a list or one value."""
    fixed = {
        "case": "c",
        "variant": "v",
        "mesh": "m",
        "backend": "newton",
        "coupling": "reaction",
        "status": "solved",
        "gap": 1e-9,
        "outer_iterations": 1,
    }
    nothing = dict.fromkeys(("load_factor", "alpha_reg", "lambda", "energy"), np.nan)
    return pd.DataFrame(fixed | nothing | columns)


def law(r):
    """alpha* = 5, a = 1, b = 2, c = 3 in the notation of `hermite_limit`; slowly varying."""
    alpha_reg, energy = 5 - r + 2 * r**2 - 3 * r**3, r - 4 * r**2 + 9 * r**3
    return {"alpha_reg": alpha_reg, "energy": energy, "lambda": alpha_reg + energy, "option_r": r}


def test_each_row_gets_the_exact_value_of_its_own_problem():
    r = R[2:]
    newton = made(**law(r), param_mu=0.5)
    results = pd.concat(
        [
            newton,
            newton.assign(param_mu=np.nan),
            newton.assign(coupling="associated"),
            newton.assign(status="not converged"),
            made(backend="good", coupling="certified", load_factor=[5.0], param_mu=0.5),
            made(backend="bad", coupling="certified", load_factor=[5.1], param_mu=0.5, gap=1e-3),
            made(backend="good", coupling="associated", load_factor=[7.0], param_mu=0.5),
            made(backend="good", coupling="stick", load_factor=[8.0], param_mu=0.5),
        ],
        ignore_index=True,
    )
    joined = with_exact(results)
    assert len(joined) == 3 * len(r)
    star = joined.groupby(["coupling", "param_mu"], dropna=False)["alpha_star"]
    assert star.first()["reaction", 0.5] == pytest.approx(5)
    assert star.first()["associated", 0.5] == pytest.approx(7)
    assert set(joined["alpha_star_from"]) == {"good", "extrapolated"}
    alone = joined[joined["param_mu"].isna()]
    # The smaller r, the closer: error O(r^4) of the limit, 1e-16 and the accuracy 1e-8.
    assert alone["alpha_star"].to_numpy() == pytest.approx(5, abs=5e-8)
    assert (alone["alpha_star_from"] == "extrapolated").all()
    assert joined["error_lambda"].to_numpy() == pytest.approx(
        joined["alpha_star"].to_numpy() - joined["lambda"].to_numpy()
    )
    found = regularisation_slopes(joined)
    assert found.groupby("error")["expected"].first().to_dict() == {
        "error_alpha_reg": 1,
        "error_lambda": 2,
    }
    own = found[(found["coupling"] == "reaction") & (found["param_mu"] == 0.5)]
    assert own["slope"].tolist() == pytest.approx([1, 2], abs=0.05)


@pytest.mark.parametrize("missing", [None, np.nan, pd.NA])
def test_kinds_of_columns_do_not_matter(missing):
    """Missing parameters, as None, NaN or NA, in columns of any type."""
    results = pd.concat(
        [
            made(**law(R), param_rough=missing, size_n=3),
            made(backend="clarabel", load_factor=[5.0], param_rough=missing, size_n=3),
            made(**law(R), param_rough=True, mesh="n"),
        ],
        ignore_index=True,
    )
    for frame in (results, results.convert_dtypes(), results.astype({"param_rough": object})):
        joined = with_exact(frame)
        assert joined["alpha_star"].to_numpy(float) == pytest.approx(5, abs=5e-8)
        assert joined["alpha_star_from"].value_counts().to_dict() == {
            "clarabel": 9,
            "extrapolated": 9,
        }
        found = regularisation_slopes(joined)
        assert found["slope"].to_numpy() == pytest.approx([1, 1, 2, 2], abs=0.1)


def test_nothing_to_join_leaves_nan():
    joined = with_exact(made(alpha_reg=[4.9], energy=[0.1], **{"lambda": [5.0]}))
    assert joined["alpha_star"].isna().all()
    assert joined["alpha_star_from"].tolist() == [""]
    assert len(with_exact(made(load_factor=[5.0]))) == 0


def test_a_penalty_alone_is_not_extrapolated_in_r():
    """K_n does not follow r, so r -> 0 does not lead to alpha*."""
    joined = with_exact(made(**law(R[2:]), option_normal=10.0))
    assert joined["alpha_star"].isna().all()


def test_orders_of_refinement():
    """Errors N^-1 and N^-0.5 are of order 2 and 1 in h; those of an exact case have no order."""
    size = np.array([64, 256, 1024, 4096])
    rows = [
        made(backend=name, mesh=list("abcd"), n_elements=size, error=error)
        for name, error in {
            "second": 5 / size,
            "first": 2 / np.sqrt(size),
            "exact": np.array([1e-9, -2e-9, 3e-9, 1e-9]),
        }.items()
    ]
    found = refinement_orders(pd.concat(rows, ignore_index=True)).set_index("backend")
    assert found["order"].tolist() == pytest.approx([2, 1, np.nan], nan_ok=True)
    assert found.loc["second", "order_low"] <= 2 + 1e-12
    assert found.loc["second", "order_high"] >= 2 - 1e-12
    assert "above the noise" in found.loc["exact", "reason"]
