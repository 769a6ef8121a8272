"""Runs of one program with several values of an option of a backend."""

from math import nan

import pandas as pd
import pytest

from lacore_verification.harness.analysis.columns import solver_columns
from lacore_verification.report.studies.single_solves import ladders

ROW = {
    **{"case": "made", "variant": "up", "mesh": "coarse", "n_dofs": 40, "backend": "first"},
    **{"coupling": "associated", "answered_by": "", "outer_iterations": 1, "solve_time": 0.5},
    **{"verdict": "no result", "residual_gap": 1e-3, "residual_load": 2e-3, "gap": 1e-3},
    **{"option_tolerance": nan, "option_max_iterations": nan},
}


def rows(*changes):
    return pd.DataFrame([ROW | change for change in changes])


def ladder(**more):
    return [{"option_tolerance": value} | more for value in (1e-2, 1e-4, nan)]


def test_a_curve_has_its_option_its_values_and_the_largest_residuals():
    found = ladders(rows(*ladder()))
    assert found["ladder"].tolist() == ["tolerance"] * 3
    assert found["value"].tolist() == ["0.01", "0.0001", "default"]
    assert found["residual"].tolist() == [2e-3] * 3
    assert found["option_tolerance"].isna().all()


def test_two_values_make_no_curve():
    found = ladders(rows(*ladder()[:2]))
    assert len(found) == 0
    assert {"ladder", "value", "residual"} <= set(found.columns)


def test_results_without_options_have_no_curve():
    results = rows({}, {}, {}).drop(columns=["option_tolerance", "option_max_iterations"])
    assert len(ladders(results)) == 0


def test_each_backend_and_problem_has_its_own_curve():
    second = ladder(backend="second")[:2]
    fine = ladder(mesh="fine")
    found = ladders(rows(*ladder(), *second, *fine))
    assert len(found) == 6
    assert set(found["backend"]) == {"first"}


def test_other_options_distinguish_curves():
    short = ladder(option_max_iterations=5.0)
    found = ladders(rows(*ladder(), *short))
    assert len(found) == 6
    assert set(found["ladder"]) == {"tolerance"}
    lines = found.groupby(solver_columns(found), dropna=False).size()
    assert lines.tolist() == [3, 3]


@pytest.mark.parametrize(
    "change",
    [
        {"outer_iterations": 2},
        {"verdict": "skipped"},
        {"residual_gap": nan, "residual_load": nan},
        {"solve_time": nan},
        {"answered_by": "another"},
    ],
)
def test_what_is_no_single_solve_of_the_backend_is_left_out(change):
    assert len(ladders(rows(*ladder(**change)))) == 0


def test_options_that_change_the_program_are_no_measure_of_accuracy():
    results = rows(*({"option_r": value} for value in (1e-1, 1e-2, 1e-3)))
    assert len(ladders(results)) == 0
