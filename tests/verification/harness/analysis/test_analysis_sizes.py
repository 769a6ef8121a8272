"""Success by size, accuracy and answers, computed by hand."""

import numpy as np
import pandas as pd
import pytest

import lacore as la
from lacore_verification.harness.analysis.sizes import (
    accuracies,
    answers,
    rates_by_size,
    residual_means,
    separate_residual_means,
    size_classes,
    with_size_classes,
)

HELPER = "lacore (path following)"
RUNS = [
    # backend, case, unknowns, status, verdict, answered by, load factor, error, residuals
    ("a", "small", 40, "solved", "pass", "a", 1.0, 0.0, (1e-8, 1e-9)),
    ("a", "limit", 100, "solved", "pass", f"a and {HELPER}", 1.0, 0.1, (1e-6, 1e-7)),
    ("a", "large", 5000, "solved", "FAIL", "a", 2.0, -0.5, (1e-6, 1e-4)),
    ("b", "small", 40, "solved", "pass", HELPER, 1.0, 0.0, (1e-8, 1e-9)),
    ("b", "limit", 100, "solved", "pass", "b", 1.0, -0.2, (np.nan, 0.0)),
    ("b", "large", np.nan, "failed", "FAIL", "", np.nan, np.nan, (np.nan, np.nan)),
]


def results():
    names = ("backend", "case", "n_dofs", "status", "verdict", "answered_by", "load_factor")
    rows = [
        dict(zip(names, run[:7], strict=True))
        | {"error": run[7], "residual_flow": run[8][0], "residual_gap": run[8][1]}
        | {"coupling": "", "variant": "v", "mesh": "m", "claimed": True, "solve_time": 1.0}
        for run in RUNS
    ]
    return pd.DataFrame(rows)


def test_classes_have_the_unknowns_that_their_names_state():
    assert size_classes((100, 1000)) == ["up to 100", "101 to 1000", "more than 1000"]
    found = with_size_classes(results(), (99, 100))["unknowns"].tolist()
    assert found == ["up to 99", "100 to 100", "more than 100"] * 2


def test_a_run_that_was_lost_counts_as_large_as_its_problem():
    found = rates_by_size(results()).set_index(["backend", "unknowns"])
    assert found.loc[("b", "1001 to 10000"), "runs"] == 1
    assert found.loc[("b", "1001 to 10000"), "wrong_claims"] == 1
    assert [*found.index] == [
        (backend, size) for backend in "ab" for size in ("up to 100", "1001 to 10000")
    ]


def test_problems_of_unknown_size_have_no_class():
    assert len(rates_by_size(results().assign(n_dofs=np.nan))) == 0


def test_rates_count_only_what_a_backend_answered_itself():
    found = rates_by_size(results()).set_index(["backend", "unknowns"])
    assert found["certified"].tolist() == [1, 1, 1, 0]
    assert found["correct"].tolist() == [1, 0, 1, 0]


def test_answers_are_counted_by_who_found_them():
    found = answers(results()).set_index("backend")
    assert found.loc["a"].tolist()[1:] == [3, 2, 1, 0]
    assert found.loc["b"].tolist()[1:] == [3, 1, 1, 1]


def test_older_results_do_not_state_who_answered():
    found = answers(results().drop(columns="answered_by"))
    assert found["with_lacore"].tolist() == [0, 0]


def test_accuracies_have_the_largest_residual_and_the_size_of_the_error():
    found = accuracies(results())
    assert found["case"].tolist() == ["small", "large", "limit"]
    assert found["error"].tolist() == [0.0, 0.5, 0.2]
    assert found["residual"].tolist() == [1e-8, 1e-4, 0.0]


def test_residual_means_are_geometric():
    """A residual of zero counts as round-off, 1e-16."""
    found = residual_means(results()).set_index("backend")
    assert found["mean_residual"].tolist() == pytest.approx([1e-6, 1e-16])
    assert found["worst_residual"].tolist() == [1e-4, 0.0]
    assert found["worst_error"].tolist() == [0.5, 0.2]


def test_separate_residuals_have_means_of_their_own():
    """Of certified runs: flow 1e-8 and 1e-6; gap 1e-9 and 1e-4; shifted by 1e-12."""
    found = separate_residual_means(results()).set_index("backend")
    shift = 1e-12
    flow = np.sqrt((1e-8 + shift) * (1e-6 + shift)) - shift
    gap = np.sqrt((1e-9 + shift) * (1e-4 + shift)) - shift
    assert found.loc["a", "mean_flow"] == pytest.approx(flow, rel=1e-9)
    assert found.loc["a", "mean_gap"] == pytest.approx(gap, rel=1e-9)
    assert found.loc["b", "mean_gap"] == 0.0
    assert np.isnan(found.loc["b", "mean_flow"])
    assert found["mean_cone"].isna().all()  # older results have no such residual


def test_results_without_residuals_have_no_accuracy():
    bare = results().drop(columns=["residual_flow", "residual_gap"])
    assert residual_means(bare)["measured"].tolist() == [0, 0]
    assert len(residual_means(results()[:0])) == 0


def test_a_missing_column_is_named():
    with pytest.raises(la.InputError, match="n_dofs"):
        rates_by_size(results().drop(columns="n_dofs"))
