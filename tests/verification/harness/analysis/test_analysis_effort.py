"""Tables of effort by hand."""

import numpy as np
import pandas as pd
import pytest

import lacore as la
from lacore_verification.harness.analysis.effort import costs_of_accuracy, efforts


def results():
    columns = (
        "backend", "mesh", "run", "status", "verdict", "outer_iterations", "iterations",
        "contraction", "solve_time", "peak_memory_mb", "error", "n_dofs",
    )  # fmt: skip
    rows = [
        ("a", "coarse", "1", "solved", "pass", 4, 40, 0.5, 2.0, 100, 0.02, 10),
        ("a", "medium", "2", "solved", "pass", 6, 90, 0.7, 9.0, 150, -0.005, 100),
        ("a", "fine", "3", "solved", "pass", 9, 99, np.nan, 3.0, 120, 0.004, 1000),
        ("a", "finest", "4", "stalled", "FAIL", 100, 999, 0.99, 0.1, 999, 1e-9, 9999),
        ("b", "coarse", "5", "stalled", "FAIL", 7, 70, 0.9, 1.0, 90, np.nan, 10),
        ("b", "medium", "6", "", "skipped", np.nan, np.nan, np.nan, np.nan, np.nan, np.nan, 100),
    ]
    frame = pd.DataFrame(rows, columns=columns)
    return frame.assign(case="c", variant="v", coupling="reaction")


def test_efforts_by_hand():
    a, b = efforts(results()).to_dict("records")
    assert (a["runs"], a["certified"], b["runs"], b["certified"]) == (4, 3, 1, 0)
    assert (a["inner_solves"], a["most_inner_solves"]) == (6, 9)
    assert a["iterations"] == pytest.approx(90)
    assert a["iterations_per_solve"] == pytest.approx(11)  # of 10, 15, 11
    assert a["contraction"] == pytest.approx(0.6)
    assert a["worst_contraction"] == pytest.approx(0.7)
    assert a["solve_time"] == pytest.approx(3)
    assert a["time_per_solve"] == pytest.approx(0.5)  # of 1/2, 3/2, 1/3
    assert a["peak_memory_mb"] == pytest.approx(150)
    assert np.isnan(b["inner_solves"])


def test_costs_of_accuracy_by_hand():
    """The fine mesh of a is cheaper than the medium one; what is not certified does not count."""
    found = costs_of_accuracy(results(), levels=(0.05, 0.01, 0.001))
    a, b = (part.to_dict("records") for _, part in found.groupby("backend"))
    assert [row["cost"] for row in a] == pytest.approx([2, 3, np.nan], nan_ok=True)
    assert [row["run"] for row in a[:2]] == ["1", "3"]
    assert a[1]["mesh"] == "fine"
    assert a[1]["reached"] == pytest.approx(0.004)
    assert a[2]["reason"] == "never: 0.004 is the closest"
    assert [row["reason"] for row in b] == ["never: no certified run with an error"] * 3


def test_bad_input():
    with pytest.raises(la.InputError, match="level"):
        costs_of_accuracy(results(), levels=(0.0,))
    with pytest.raises(la.InputError, match="column"):
        costs_of_accuracy(results(), cost="euro")
    assert len(costs_of_accuracy(results()[:0])) == 0
    assert len(efforts(results()[:0])) == 0
