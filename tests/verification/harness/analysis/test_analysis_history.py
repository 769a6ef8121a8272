"""Results of several versions, compared by hand."""

import numpy as np
import pandas as pd
import pytest

from lacore_verification.harness.analysis.history import SHIFT, history

COLUMNS = ("case", "backend", "verdict", "load_factor", "solve_time", "error")


def results(*runs):
    rows = [
        dict(zip(COLUMNS, run, strict=True))
        | {"variant": "v", "mesh": "m", "coupling": "", "answered_by": run[1], "n_dofs": 9}
        | {"claimed": run[2] == "pass", "status": "solved" if run[2] == "pass" else "failed"}
        for run in runs
    ]
    return pd.DataFrame(rows)


OLD = results(
    ("one", "a", "pass", 1.0, 1.0, 0.01),
    ("two", "a", "pass", 2.0, 4.0, 0.02),
    ("three", "a", "FAIL", np.nan, 9.0, np.nan),
    ("old", "a", "pass", 3.0, 100.0, 0.5),
    ("one", "b", "pass", 1.0, 2.0, 0.0),
)
NEW = results(
    ("three", "a", "pass", 3.0, 3.0, -0.04),
    ("two", "a", "FAIL", 2.5, 5.0, 0.25),
    ("one", "a", "pass", 1.001, 2.0, 0.011),
    ("one", "c", "pass", 1.0, 1.0, 0.0),
)


@pytest.fixture
def found():
    return history({"old": OLD, "new": NEW})


def test_rates_refer_to_the_runs_that_all_versions_have(found):
    rates = found.backends.set_index(["backend", "version"])
    assert rates.loc[("a", "old"), "all_runs"] == 4
    assert rates.loc["a"]["runs"].tolist() == [3, 3]
    assert rates.loc["a"]["correct"].tolist() == [2, 2]
    assert rates.loc["a"]["worst_error"].tolist() == [0.02, 0.04]
    assert found.only == {"old": 2, "new": 1}


def test_means_count_what_a_version_did_not_solve_with_the_longest_time(found):
    """That is 4 s: three in the old version, two in the new one."""
    means = found.backends.set_index(["backend", "version"])["mean_time"]
    times = {"old": (1.0, 4.0, 4.0), "new": (3.0, 4.0, 2.0)}
    for version, own in times.items():
        mean = np.prod([time + SHIFT for time in own]) ** (1 / 3) - SHIFT
        assert means["a", version] == pytest.approx(mean)


def test_a_backend_of_one_version_is_listed_for_that_one(found):
    versions = found.backends.groupby("backend")["version"].apply(list)
    assert versions["b"] == ["old"]
    assert versions["c"] == ["new"]


def test_changes_of_verdict_and_load_factor_are_listed(found):
    changes = found.changes.set_index("case")
    assert set(changes.index) == {"one", "two", "three"}
    assert changes.loc["one", "change"] == pytest.approx(0.001)
    assert changes.loc["two", "verdict_after"] == "FAIL"
    assert changes.loc["three", "load_factor_after"] == 3.0
    assert np.isnan(changes.loc["three", "change"])
    assert found.worse == 1


def test_a_small_change_is_none():
    moved = OLD.assign(load_factor=OLD["load_factor"] * (1 + 1e-9))
    assert len(history({"old": OLD, "new": moved}).changes) == 0
    assert len(history({"old": OLD, "new": moved}, tolerance=1e-10).changes) == 4


def test_a_run_is_compared_with_the_last_version_that_has_it():
    middle = results(("other", "a", "pass", 1.0, 1.0, 0.0))
    changes = history({"old": OLD, "middle": middle, "new": NEW}).changes
    assert set(changes["before"]) == {"old"}


def test_the_order_and_the_types_of_columns_do_not_matter():
    typed = OLD.assign(param_n=[1, 2, 3, 4, 5], option_r=1e-3)
    other = typed[sorted(typed.columns)].assign(param_n=[1.0, 2.0, 3.0, 4.0, 5.0])
    assert history({"old": typed, "new": other}).only == {"old": 0, "new": 0}


def test_runs_without_a_time_are_left_out_of_the_means():
    untimed = NEW.assign(solve_time=[np.nan, 5.0, 2.0, 0.0])
    found = history({"old": OLD, "new": untimed})
    means = found.backends.set_index(["backend", "version"])["mean_time"]
    mean = np.sqrt((1 + SHIFT) * (4 + SHIFT)) - SHIFT
    assert means["a", "old"] == pytest.approx(mean)
    assert np.isnan(means["c", "new"])
