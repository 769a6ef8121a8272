"""Stored states of frames whose hinges lie between the nodes of the problem."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore_verification.catalogue.catalogue import catalogue
from lacore_verification.harness.evidence.limit_state import packed, recheck, restored, unpacked
from lacore_verification.harness.evidence.span_nodes import as_solved, nodes_of, require_hinges
from lacore_verification.harness.perform.one_run import run_here
from lacore_verification.runs.run import Run


@pytest.fixture(scope="module")
def outcome():
    case = catalogue()["propped-beam"]
    run = Run(case, case.variants[0], next(iter(case.meshes)), "clarabel", None)
    (found,) = run_here([run])
    return found


def proof(outcome, arrays):
    evidence = type(outcome.evidence)(outcome.evidence.residuals, outcome.evidence.history, arrays)
    problem = outcome.run.problem()
    return recheck(as_solved(problem, la.discretise(problem), evidence), outcome.row, evidence)


def test_a_state_comes_back_with_the_hinge_that_was_found(outcome):
    state = restored(outcome.run, outcome.row, outcome.evidence)
    (place,) = state.hinges.query("state == 'turns' and node != 'A'")["x"].unique()
    # A load factor off by 1e-6 leaves the place off by its root.
    assert place == pytest.approx(3 * (2 - np.sqrt(2)), abs=3e-3)
    again = proof(outcome, outcome.evidence.arrays)
    assert again.certificate.holds(again.bar)


def test_nodes_that_lie_elsewhere_are_refused(outcome):
    state = restored(outcome.run, outcome.row, outcome.evidence)
    point, places = unpacked(outcome.evidence.arrays), nodes_of(state)
    for wrong in (
        {name: own[:, :2] for name, own in places.items()},
        {name: own + np.array([[0.0], [0.5]]) for name, own in places.items()},
    ):
        with pytest.raises(ValueError, match="lie on no member"):
            proof(outcome, packed(point, **wrong))
    with pytest.raises(ValueError, match="no state"):
        proof(outcome, b"no archive")


def test_states_beyond_yield_between_nodes_are_refused(outcome):
    """All moments and loads larger by 3 %: found without looking at the hinges at nodes."""
    state = restored(outcome.run, outcome.row, outcome.evidence)
    require_hinges(state.discretisation, state.point, exact=True)
    stress = tuple(1.03 * own for own in state.point.stress)
    larger = replace(state.point, load_factor=1.03 * state.load_factor, stress=stress)
    for exact in (True, False):
        with pytest.raises(ValueError, match=r"beyond yield by 3.0e-02"):
            require_hinges(state.discretisation, larger, exact)
