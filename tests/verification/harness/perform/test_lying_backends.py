"""No backend makes a wrong number pass, or changes what another one finds."""

import re
from math import isfinite

import numpy as np
import pandas as pd
import pytest

import lacore as la
from lacore_verification.harness.analysis.noise import noise
from lacore_verification.harness.campaigns.comparison import plan
from lacore_verification.harness.perform.processes import run_in_processes
from lacore_verification.harness.verdicts.words import FAIL, PASS, SKIPPED
from tests.lacore.models import deformable_block
from tests.lying_backends import LIES, Undescribed, Untidy, register

QUICK = {
    *("DoublesReferenceLoad", "ForcesReferenceLoad", "ForcesContactNormalData"),
    *("DoublesTheLoadFactor", "ZeroVelocity", "StatusAsText", "RunsCodeWhereItIsRead"),
    *("PatchesHolds", "LeavesThreads", "UnavailableRaises"),
}
"""Those that are tried in fast tests: each starts an interpreter."""
HONEST = ("clarabel", "cvxpy")


def each(names):
    return [pytest.param(name, marks=[] if name in QUICK else [pytest.mark.slow]) for name in names]


WRONG = [name for name, own in LIES.items() if not issubclass(own.kind, (Untidy, Undescribed))]
UNTIDY = [name for name, own in LIES.items() if issubclass(own.kind, Untidy)]
UNDESCRIBED = [name for name, own in LIES.items() if issubclass(own.kind, Undescribed)]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lies")
    register(folder, {"clarabel": "tests.lying_backends:DoublesTheLoadFactor"})
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(folder))
        patch.setenv("LACORE_TEST_TRACE", str(folder / "trace"))
        yield folder


def solved(name):
    try:
        return la.solve(deformable_block(0.5), backend=name)
    except la.LacoreError as error:
        return error


def test_a_refuted_status_shows_the_mechanism_that_refutes_it(folder):
    found = solved("ClaimsLocked")
    assert "the program is feasible" in found.message
    assert "an admissible mechanism with F0.U = 1 (penetration" in found.message
    assert "tighten" not in found.message


def test_there_are_sixty_of_them():
    assert len(LIES) >= 60


@pytest.mark.parametrize("name", each(WRONG))
def test_no_wrong_number_is_solved(folder, name):
    found = solved(name)
    text = str(found) if isinstance(found, Exception) else found.message
    if isinstance(found, la.LimitState):
        assert found.status is not la.Status.SOLVED
        assert not isfinite(found.load_factor)
    assert re.search(LIES[name].message, text), text
    assert not (folder / "trace").exists(), "what was read ran code"


@pytest.mark.parametrize("name", each(UNTIDY))
def test_what_is_left_behind_costs_nothing(folder, name):
    found, honest = solved(name), la.solve(deformable_block(0.5), backend="clarabel")
    assert found.load_factor == pytest.approx(honest.load_factor, abs=1e-6)
    assert found.backend == name


@pytest.mark.parametrize("name", each(UNDESCRIBED))
def test_a_backend_that_describes_itself_wrongly_is_named(folder, name):
    with pytest.raises(la.CapabilityError, match=LIES[name].message) as caught:
        la.find_backend(name)
    assert "lying-backends 1" in str(caught.value)


def test_nobody_takes_the_name_of_another(folder):
    from lacore.solvers.registry import rejected_backends

    (rejected,) = rejected_backends()
    assert (rejected.name, "lying-backends 1" in rejected.conflict) == ("clarabel", True)
    assert la.solve(deformable_block(0.5), backend="clarabel").status is la.Status.SOLVED


def compared(names):
    runs = plan(["shear-patch:sliding"], names, ["coarse"], ["certified"])
    rows = [outcome.row for outcome in run_in_processes(runs, jobs=2, time_limit=60.0)]
    return {row.backend: row for row in rows}


@pytest.mark.slow
def test_a_comparison_passes_no_lie_and_honest_backends_do_not_notice(folder):
    """Names of backends are columns of rows; different kinds of lies have different messages."""
    alone = compared(HONEST)
    together = compared([name for lie in LIES for name in (lie, *HONEST)][: 3 * len(LIES)])
    for name in HONEST:
        assert together[name].load_factor == alone[name].load_factor
        assert together[name].verdict == PASS
    for name in WRONG:
        assert together[name].verdict == FAIL, name
        assert re.search(LIES[name].message, together[name].message), together[name].message
        assert not isfinite(together[name].load_factor), name
    kinds = {together[name].message: LIES[name].message for name in WRONG}
    assert set(kinds.values()) == {LIES[name].message for name in WRONG}
    for name in UNTIDY:
        assert together[name].verdict == PASS, name
        assert re.search(LIES[name].message, together[name].message), together[name].message
    for name in UNDESCRIBED:
        assert together[name].verdict == SKIPPED, name
        assert re.search(LIES[name].message, together[name].message), together[name].message


TROUBLE = ("LeavesThreads", "LeavesAProcess", "ChangesTheInterpreter", "PatchesNumPy")
"""Those that may slow down what runs after them."""


def timed(names):
    """Rows of the block with several friction coefficients, one run at a time."""
    runs = plan([f"deformable-block:mu-0.{tenth}" for tenth in (1, 2, 3, 4, 6, 7, 8)], names)
    outcomes = run_in_processes([run for run in runs if run.mesh == "coarse"], time_limit=60.0)
    return pd.DataFrame([outcome.row.record() for outcome in outcomes])


@pytest.mark.slow
def test_times_of_an_honest_backend_next_to_lies_are_unchanged_within_noise(folder):
    """The noise is the scatter of the calibrations in both runs."""
    alone, together = timed(["clarabel"]), timed([*TROUBLE, "clarabel"])
    found = noise(pd.concat([alone, together]))
    assert found.count >= 10
    ours = together[together.backend == "clarabel"]
    assert set(ours.verdict) == set(alone.verdict) == {PASS}
    for name in ("solver_time", "solve_time"):
        before, after = (frame.set_index("variant")[name].astype(float) for frame in (alone, ours))
        ratio = np.exp(np.log(after / before).median())
        assert 1 / found.factor < ratio < found.factor, (name, ratio, found)
