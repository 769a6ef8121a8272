"""Profiles, means and rates by hand."""

import numpy as np
import pandas as pd
import pytest

import lacore as la
from lacore_verification.harness.analysis.profiles import (
    budget_profile,
    costs,
    data_profile,
    performance_profile,
    rates,
    shifted_geometric_means,
)

# Seconds; a minus sign: not solved.       ratios to the best
#        P1  P2  P3  P4                    P1   P2   P3   P4
#   A     1   4   3  -8                     1    2    1    -
#   B     2   2   6  -9                     2    1    2    -
#   C     4  -7   3  -5                     4    -    1    -
SECONDS = {"A": [1, 4, 3, -8], "B": [2, 2, 6, -9], "C": [4, -7, 3, -5]}
DOFS = [9, 19, 29, 39]  # of P1 ... P4


def results():
    rows = [
        {
            "case": f"P{i + 1}",
            "variant": "v",
            "mesh": "m",
            "backend": name,
            "coupling": "",
            "solve_time": float(abs(seconds)),
            "n_dofs": DOFS[i],
            "status": "solved" if seconds > 0 else "stalled",
            "verdict": "pass" if seconds > 0 else "FAIL",
            "claimed": True,
        }
        for name, row in SECONDS.items()
        for i, seconds in enumerate(row)
    ]
    return pd.DataFrame(rows)


def steps(profile, axis):
    return {
        name: list(zip(part[axis], part["share"], strict=True))
        for name, part in profile.groupby("solver")
    }


def test_performance_profile_by_hand():
    kept = performance_profile(costs(results(), "solve_time", "certificate", "keep"))
    assert steps(kept, "factor") == {
        "A": [(1, 2 / 4), (2, 3 / 4), (4, 3 / 4)],
        "B": [(1, 1 / 4), (2, 3 / 4), (4, 3 / 4)],
        "C": [(1, 1 / 4), (4, 2 / 4)],
    }
    dropped = performance_profile(costs(results(), "solve_time", "certificate", "drop"))
    assert steps(dropped, "factor")["A"] == [(1, 2 / 3), (2, 1), (4, 1)]
    assert steps(dropped, "factor")["C"] == [(1, 1 / 3), (4, 2 / 3)]


def test_filters_are_named_in_the_result():
    for profile in (performance_profile, data_profile, budget_profile):
        found = profile(costs(results(), "solve_time", "verdict", "drop", per="n_dofs"))
        told = {
            "measure": "solve_time",
            "solved_by": "verdict",
            "unsolved": "drop",
            "problems": 3,
            "nobody": 1,
        }
        assert found.attrs == told
        assert {name: found[name].iloc[0] for name in told} == told


def test_data_profile_by_hand():
    """Seconds over n_dofs + 1 = 10, 20, 30, 40."""
    found = data_profile(costs(results(), "solve_time", "certificate", "keep", per="n_dofs"))
    shape = {
        "A": [(0, 0), (0.1, 2 / 4), (0.2, 3 / 4), (0.4, 3 / 4)],  # 1/10, 4/20, 3/30
        "B": [(0, 0), (0.1, 1 / 4), (0.2, 3 / 4), (0.4, 3 / 4)],  # 2/10, 2/20, 6/30
        "C": [(0, 0), (0.1, 1 / 4), (0.4, 2 / 4)],  # 4/10, -, 3/30
    }
    for name, rows in steps(found, "budget").items():
        assert np.array(rows) == pytest.approx(np.array(shape[name]))


def test_budget_profile_by_hand():
    found = budget_profile(costs(results(), "solve_time", "certificate", "drop"))
    assert steps(found, "budget")["B"] == [(0, 0), (2, 2 / 3), (6, 1)]


def test_who_says_solved_decides():
    """All of them claim, so P4 has a winner: C with 5 s, A 8/5, B 9/5; on P2 C needs 7/2."""
    found = performance_profile(costs(results(), "solve_time", "claim", "keep"))
    assert steps(found, "factor")["C"] == [(1, 2 / 4), (3.5, 3 / 4), (4, 1)]
    assert found.attrs["nobody"] == 0


def test_runs_that_are_missing_or_skipped_are_not_solved():
    frame = results()
    frame.loc[0, "verdict"] = "skipped"  # A on P1
    found = costs(frame.drop(index=4), "solve_time", "certificate", "keep")  # B on P1
    assert found.cost.iloc[0].tolist() == [np.inf, np.inf, 4]


def test_shifted_geometric_means_by_hand():
    """Shift 1, unsolved ones at 9: A (2*5*4*10)^(1/4) - 1, B (3*3*7*10), C (5*10*4*10)."""
    found = shifted_geometric_means(costs(results(), "solve_time", "verdict", "keep"), 1, 9)
    means = [product**0.25 - 1 for product in (400, 630, 2000)]
    assert found["solver"].tolist() == ["A", "B", "C"]
    assert found["mean"].tolist() == pytest.approx(means)
    assert found["ratio"].tolist() == pytest.approx([mean / means[0] for mean in means])
    assert found["solved"].tolist() == [3, 3, 2]
    assert found.attrs["unsolved"] == "keep"


def test_rates_by_hand():
    frame = results()
    frame.loc[0, "claimed"] = False  # A does not know that it solved P1
    frame["claimed"] = frame["claimed"].astype(object)
    frame.loc[1, "claimed"] = None  # nor P2
    frame.loc[2, "verdict"] = "FAIL"  # certified, but of another value than the reference
    frame.loc[11, "verdict"] = "skipped"  # C on P4
    found = rates(frame, ["backend"]).set_index("backend")
    assert found["runs"].tolist() == [4, 4, 3]
    assert found["claimed"].tolist() == [2, 4, 3]
    assert found["certified"].tolist() == [3, 3, 2]
    assert found["correct"].tolist() == [2, 3, 2]
    assert found["wrong_claims"].tolist() == [2, 1, 1]  # A: P3, P4; B: P4; C: P2
    assert found["success_rate"].tolist() == pytest.approx([2 / 4, 1, 1])
    assert found["correctness_rate"].tolist() == pytest.approx([2 / 4, 3 / 4, 2 / 3])


def test_claims_without_a_reference_are_not_wrong():
    frame = results()
    frame["verdict"] = "no reference"
    found = rates(frame, ["backend"])
    assert (found["claimed"] == found["runs"]).all()
    assert (found["unjudged"] == found["runs"]).all()
    assert not found["wrong_claims"].any()
    assert found["correctness_rate"].isna().all()


def test_bad_input():
    frame = results()
    for words in ({"solved_by": "vote"}, {"unsolved": "hide"}):
        with pytest.raises(la.InputError, match="unknown name"):
            costs(frame, "solve_time", **({"solved_by": "claim", "unsolved": "keep"} | words))
    with pytest.raises(la.InputError, match="two runs"):
        costs(pd.concat([frame, frame]), "solve_time", "claim", "keep")
    with pytest.raises(la.InputError, match="no cost"):
        costs(frame.assign(solve_time=np.nan), "solve_time", "claim", "keep")
    found = costs(frame, "solve_time", "claim", "keep")
    with pytest.raises(la.InputError, match="at least that"):
        shifted_geometric_means(found, 1, 2)
    with pytest.raises(la.InputError, match="negative"):
        shifted_geometric_means(found, -1, 100)
    unknown = costs(frame.assign(n_dofs=np.nan), "solve_time", "claim", "keep", per="n_dofs")
    with pytest.raises(la.InputError, match="no such number"):
        data_profile(unknown)


def test_no_results_give_no_rows():
    found = costs(results()[:0], "solve_time", "claim", "keep")
    assert len(performance_profile(found)) == 0
    assert len(shifted_geometric_means(found, 1, 9)) == 0
    assert len(rates(results()[:0])) == 0
