"""T19 on real solves: slopes, floors and limits, and orders of refinement."""

from functools import cache

import numpy as np
import pandas as pd
import pytest

import lacore as la
from lacore_verification.catalogue.catalogue import find
from lacore_verification.harness.analysis.exact import with_exact
from lacore_verification.harness.analysis.extrapolation import lambda_limits, refinement_limits
from lacore_verification.harness.analysis.slope_fits import refinement_orders, regularisation_slopes
from tests.shares import one_in
from tests.verification.harness.analysis.analysis_rows import DECADES, row_of, sweep

ERRORS = ["error_alpha_reg", "error_lambda"]
R = [{"r": r} for r in DECADES]
PUNCH, SLIDING, CRUSHING = (
    "prandtl-punch:smooth",
    "deformable-block:sliding",
    "deformable-block:crushing",
)


@cache
def by_newton(name):
    return sweep(name, ["newton"], R)


def slopes_of(results, parameter="option_r"):
    found = regularisation_slopes(with_exact(results), parameter)
    return {row["error"]: row for row in found.to_dict("records")}


@pytest.mark.slow
@pytest.mark.parametrize("name", [PUNCH, SLIDING, CRUSHING])
def test_alpha_reg_errs_linearly_in_r(name):
    row = slopes_of(by_newton(name))["error_alpha_reg"]
    assert row["slope"] == pytest.approx(1, abs=0.1)  # -1 +- 0.1 against 1/r
    assert (row["points"], row["floor_points"]) == (9, 0)


@pytest.mark.parametrize("name", one_in(2, [PUNCH, CRUSHING]))
def test_lambda_errs_quadratically_until_the_floor(name):
    """Also after the reaction loop of the crushed block, whose normal forces are known."""
    row = slopes_of(by_newton(name))["error_lambda"]
    assert row["slope"] >= 1.8
    assert row["points"] >= 4
    assert row["stop"] == pytest.approx(0.1)
    assert row["floor_points"] >= 3
    # Newton and clarabel are asked for 1e-8; what they reach together is no worse.
    assert row["floor"] <= 1e-8 * 6.03


def test_lambda_of_a_sliding_block_has_no_regularisation_error():
    """Total sliding is rigid: statics alone give alpha = mu p b/h, whatever the penalties.

    So lambda, the multiplier, is exact at every r, and there is no slope to be found.
    """
    results = by_newton(SLIDING)
    row = slopes_of(results)["error_lambda"]
    assert np.isnan(row["slope"])
    assert "above the noise" in row["reason"]
    assert results["lambda"].dropna().to_numpy() == pytest.approx(2, abs=2e-8)  # tolerance 1e-8


@pytest.mark.parametrize(
    ("name", "penalty"),
    [
        (PUNCH, "eta"),
        (PUNCH, "bulk"),
        pytest.param(SLIDING, "bulk", marks=pytest.mark.slow),
        (SLIDING, "normal"),
        pytest.param(SLIDING, "tangential", marks=pytest.mark.slow),
    ],
)
def test_each_penalty_alone(name, penalty):
    """The other ones at r = 1e-7: their own share is below 1 % of the errors."""
    softs = [{"r": 1e-7, penalty: 10 ** (k / 2)} for k in range(3, 11)]
    found = slopes_of(sweep(name, ["newton"], softs), f"option_{penalty}")
    assert found["error_alpha_reg"]["slope"] == pytest.approx(-1, abs=0.1)
    assert found["error_alpha_reg"]["points"] >= 6
    if name == PUNCH:
        assert found["error_lambda"]["slope"] <= -1.8
        assert found["error_lambda"]["points"] >= 5
    else:
        assert np.isnan(found["error_lambda"]["slope"])


def test_a_penalty_that_nothing_feels_has_no_slope():
    """The punch has no contact, so K_n is of no effect."""
    stiff = [{"r": 1e-4, "normal": 10.0**k} for k in range(1, 6)]
    found = slopes_of(sweep(PUNCH, ["newton"], stiff), "option_normal")
    for error in ERRORS:
        assert np.isnan(found[error]["slope"])
    assert "does not follow" in found["error_alpha_reg"]["reason"]


def test_extrapolated_lambda_beats_lambda():
    """By more than 100 times down to r = 1e-3, where the limit is at the floor of the solvers.

    The cubic errs by d (r1 r2)^2 with r1 = sqrt(10) r2, lambda by b r2^2: the ratio is d/b 10 r2^2,
    1e-2 at r2 = 0.03 with d = b.
    """
    results = by_newton(PUNCH)
    exact = results.loc[results["backend"] == "clarabel", "load_factor"].item()
    limits = lambda_limits(results[results["backend"] == "newton"])
    strong = limits[limits["r"] >= 2e-3]
    assert len(strong) == 3
    own, better = (np.abs(exact - strong[name].to_numpy()) for name in ("lambda", "limit"))
    assert (own / better > 100).all()
    assert (np.abs(exact - limits["limit"]) <= limits["uncertainty"]).all()


@pytest.mark.parametrize("name", [PUNCH, SLIDING, pytest.param(CRUSHING, marks=pytest.mark.slow)])
def test_slopes_without_an_exact_backend(name):
    results = by_newton(name)
    joined = with_exact(results[results["backend"] == "newton"])
    assert set(joined["alpha_star_from"]) == {"extrapolated"}
    exact = results.loc[results["backend"] == "clarabel", "load_factor"].item()
    star = joined["alpha_star"].iloc[0]
    assert abs(star - exact) <= joined["alpha_star_noise"].iloc[0]
    found = regularisation_slopes(joined).set_index("error")
    assert found.loc["error_alpha_reg", "slope"] == pytest.approx(1, abs=0.1)


def test_frozen_friction_keeps_the_sides():
    """At frozen reactions, as with associated friction, P <= alpha_reg <= lambda <= alpha*."""
    results = sweep(CRUSHING, ["newton"], R[:5], coupling="associated")
    joined = with_exact(results)
    assert (joined["alpha_star_from"] == "clarabel").all()
    # 1e-8, what both solvers are asked for, of the load factor 3.
    assert (joined["error_lambda"] >= -3e-8).all()
    assert (joined["error_alpha_reg"] >= joined["error_lambda"]).all()


@pytest.mark.slow
def test_the_reaction_loop_costs_lambda_an_order_where_normal_forces_are_hyperstatic():
    """Reactions err linearly in r, and lambda with them (T19: the order holds at frozen ones).

    At frozen laws, associated ones here, the order is 2 on the same mesh.
    """
    name = "platens-coulomb:mu-0.2"
    looped = slopes_of(sweep(name, ["newton"], R, tolerance=1e-9))
    frozen = slopes_of(sweep(name, ["newton"], R, coupling="associated"))
    assert frozen["error_lambda"]["frozen"]
    assert frozen["error_lambda"]["slope"] >= 1.8
    assert not looped["error_lambda"]["frozen"]
    assert looped["error_lambda"]["slope"] == pytest.approx(1, abs=0.15)
    for found in (frozen, looped):
        assert found["error_alpha_reg"]["slope"] == pytest.approx(1, abs=0.1)
        assert found["error_alpha_reg"]["points"] == 9


@cache
def refined():
    """The smooth punch on uniform meshes, each cell cut into four."""
    case, _ = find(PUNCH)
    rows = []
    for n in (2, 4, 8, 16):
        state = la.solve(case.build(nx=2 * n, ny=n, ratio_x=1.0, ratio_y=1.0, rough=False))
        error = state.load_factor / (2 + np.pi) - 1
        rows.append(row_of(PUNCH, f"uniform-{n}", state, {}, size_n=n, error=error))
    return pd.DataFrame(rows)


def test_order_of_refinement_at_a_singular_point():
    """Order 1 in h on uniform meshes, whatever the element: the strain rate is not bounded."""
    (row,) = refinement_orders(refined()).to_dict("records")
    assert row["order"] == pytest.approx(1, abs=0.1)
    assert row["order_low"] < 1 < row["order_high"]
    assert row["points"] == 4


def test_limit_of_refinement_is_prandtls():
    (row,) = refinement_limits(refined()).to_dict("records")
    assert row["order"] == pytest.approx(1, abs=0.1)
    assert abs(row["limit"] - (2 + np.pi)) <= row["uncertainty"]
    assert abs(row["limit"] - (2 + np.pi)) <= 0.1 * abs(row["finest"] - (2 + np.pi))


@pytest.mark.slow
@pytest.mark.parametrize("backend", ["ipopt", "clarabel-regularised"])
@pytest.mark.parametrize("name", [PUNCH, CRUSHING])
def test_other_regularised_backends(name, backend):
    found = slopes_of(sweep(name, [backend], R))
    assert found["error_alpha_reg"]["slope"] == pytest.approx(1, abs=0.1)
    assert found["error_lambda"]["slope"] >= 1.8
