"""The noise of a machine, and which backends it cannot rank."""

from math import isnan

import numpy as np
import pytest

from lacore_verification.harness.analysis.noise import noise, rankings
from tests.verification.harness.analysis.test_analysis_profiles import results


def quiet():
    """Twelve runs with twelve times of the calibration that differ by a few per cent."""
    times = [0.98, 0.99, 1.0, 1.0, 1.0, 1.01, 1.02, np.nan, np.nan, 1.0, 0.99, 5.0]
    return results().assign(calibration_before=np.nan, calibration_after=times)


def test_the_noise_is_the_scatter_of_a_solve_that_is_always_the_same():
    found = noise(quiet())
    assert (found.count, found.median) == (10, 1.0)
    assert 0.005 < found.scatter < 0.03  # one interruption does not count
    assert found.factor == pytest.approx(np.exp(1.96 * 2**0.5 * found.scatter))


def test_few_times_say_nothing():
    few = results().assign(calibration_before=1.0, calibration_after=np.nan)[:4]
    assert noise(few).count == 4
    assert isnan(noise(few).factor)
    assert noise(results()).count == 0  # written before there were calibrations
    assert list(rankings(results(), noise(results()))["undecided"]) == [None] * 3


def test_rankings_are_ratios_on_problems_that_both_solved():
    found = rankings(quiet(), noise(quiet())).set_index(["one", "other"])
    assert found.loc[("A", "B"), "ratio"] == pytest.approx(2 ** (1 / 3))  # 2, 1/2 and 2
    assert found.loc[("A", "B"), "problems"] == 3
    assert found.loc[("A", "C"), "ratio"] == pytest.approx(2)  # 4 and 1
    assert list(found.index[found["undecided"]]) == [("B", "C")]  # 2 and 1/2: equally fast


def test_a_noisy_machine_decides_nothing():
    times = [1, 2, 1, 3, 1, 2, 3, 1, 2, 3, 1, 2]
    noisy = results().assign(calibration_before=np.nan, calibration_after=times)
    assert rankings(noisy, noise(noisy))["undecided"].all()


def test_settings_of_one_backend_are_ranked_as_solvers_of_their_own():
    frame = quiet().replace({"backend": {"B": "A", "C": "A"}})
    frame["options"] = ["", *[""] * 3, *["tolerance=1e-06"] * 4, *["tolerance=1e-09"] * 4]
    found = rankings(frame, noise(frame))
    assert set(found["one"]) | set(found["other"]) == {
        *("A", "A tolerance=1e-06", "A tolerance=1e-09"),
    }
