"""Outcomes of pairs of solvers, counted by hand."""

import numpy as np
import pytest

import lacore as la
from lacore_verification.harness.analysis.noise import Noise
from lacore_verification.harness.analysis.pairs import OUTCOMES, pairwise_outcomes
from tests.verification.harness.analysis.test_analysis_profiles import results

EXACT = Noise(10, 1.0, 0.0, 1.0)
UNKNOWN = Noise(0, np.nan, np.nan, np.nan)
HELPER = "lacore (path following)"


def outcomes(frame, found=EXACT):
    """First faster, tie, second faster, only first, only second, neither."""
    by_pair = pairwise_outcomes(frame, found).set_index(["first", "second"])
    return {pair: [*row] for pair, row in by_pair[[*OUTCOMES]].iterrows()}


def test_outcomes_by_hand():
    assert outcomes(results()) == {
        ("A", "B"): [2, 0, 1, 0, 0, 1],
        ("A", "C"): [1, 1, 0, 1, 0, 1],
        ("B", "C"): [1, 0, 1, 1, 0, 1],
    }


def test_times_within_the_noise_tie():
    assert outcomes(results(), Noise(10, 1.0, 0.2, 2.0))[("A", "B")] == [0, 3, 0, 0, 0, 1]


def test_unknown_noise_decides_no_time():
    found = outcomes(results(), UNKNOWN)
    assert found[("A", "C")] == [None, None, None, 1, 0, 1]
    assert pairwise_outcomes(results(), UNKNOWN)["both"].tolist() == [3, 2, 2]


def test_only_problems_that_both_were_run_on_count():
    frame = results()
    frame.loc[frame["case"] == "P2", "verdict"] = "skipped"
    rest = frame[~((frame["backend"] == "C") & (frame["case"] != "P2"))]
    assert outcomes(rest) == {("A", "B"): [2, 0, 0, 0, 0, 1]}
    assert pairwise_outcomes(frame, EXACT)["problems"].tolist() == [3, 3, 3]


def test_answers_of_path_following_are_not_solved():
    frame = results().assign(answered_by=lambda own: own["backend"])
    frame.loc[(frame["backend"] == "A") & (frame["case"] == "P1"), "answered_by"] = HELPER
    assert outcomes(frame)[("A", "B")] == [1, 0, 1, 0, 1, 1]


def test_counts_add_up_to_the_problems_of_a_pair():
    found = pairwise_outcomes(results(), EXACT)
    assert (found[[*OUTCOMES]].sum(axis=1) == found["problems"]).all()


def test_no_runs_have_no_pairs():
    assert len(pairwise_outcomes(results()[:0], EXACT)) == 0


def test_two_runs_of_one_problem_are_named():
    frame = results()
    twice = frame.loc[[*frame.index, frame.index[0]]].reset_index(drop=True)
    with pytest.raises(la.InputError, match="two runs of one problem"):
        pairwise_outcomes(twice, EXACT)
