"""Verdicts, rows and the file that they are written to."""

from dataclasses import replace
from math import inf, isnan, nan

import pytest

import lacore as la
import lacore_verification.harness.perform.one_run as harness
from lacore.program.regularization import RegularisedValues
from lacore.solvers.backend import Capabilities
from lacore_verification.case import Band, Reference, Variant
from lacore_verification.catalogue.catalogue import find
from lacore_verification.harness.campaigns import comparison
from lacore_verification.harness.campaigns.comparison import capabilities, plan
from lacore_verification.harness.campaigns.run_all import run_all
from lacore_verification.harness.perform import limit_state
from lacore_verification.harness.perform.one_run import run_here
from lacore_verification.harness.perform.processes import lost
from lacore_verification.harness.store.results import load_results
from lacore_verification.harness.store.store import NAME
from lacore_verification.harness.verdicts.limit_state import judge, refutation
from lacore_verification.harness.verdicts.words import (
    BOUND_ONLY,
    FAIL,
    NO_REFERENCE,
    NO_RESULT,
    PASS,
    SKIPPED,
    tally,
)
from lacore_verification.runs.outcome import NO_EVIDENCE
from lacore_verification.runs.run import Run
from tests.verification.command_line import run_in_order

CASE, (VARIANT,) = find("shear-patch:yielding")
NEXT_TO_NOTHING = Band(1e-5, 1e-5, "")


def planted_reference(**parameters):
    return Reference(0.61, "planted", "wrong", "exact")


def wrong_case():
    return replace(CASE, reference=planted_reference)


@pytest.fixture(scope="module")
def state():
    return la.solve(CASE.problem(VARIANT, "coarse"))


def regularised(state, value, energy):
    values = RegularisedValues(value - 2 * energy, value - energy, value, value)
    return replace(state, load_factor=value, regularised=values)


@pytest.mark.parametrize(
    ("value", "energy", "verdict"),
    [
        (0.6, 0.0, PASS),
        (0.595, 0.006, PASS),  # from below, by less than C
        (0.595, 0.004, FAIL),  # by more than C
        (0.601, 0.006, FAIL),  # from above
        (0.6, 0.04, FAIL),  # C above 5 %
        (float("nan"), 0.0, FAIL),
    ],
)
def test_verdict_on_regularised_values(state, value, energy, verdict):
    reference = Reference(0.6, "", "", "exact")
    found, why = judge(regularised(state, value, energy), reference, NEXT_TO_NOTHING)
    assert found == verdict
    assert why


def test_verdict_needs_a_solved_status(state):
    unsolved = replace(state, status=la.Status.STALLED)
    verdict, why = judge(unsolved, Reference(0.6, "", "", "exact"), NEXT_TO_NOTHING)
    assert verdict == FAIL
    assert "not solved" in why


LOADS = Reference(1.0, "", "", "interval", up_to=2.0, associated=2.0)
LISTED = replace(LOADS, associated=3.0, complete=False)
JAMMED = Reference(inf, "", "", "status", status=la.Status.JAM)
BELOW_ZERO = Reference(-0.5, "", "", "exact")
ZERO = Reference(0.0, "", "", "exact")
UNKNOWN = Reference(nan, "", "", "none", complete=False)
WEIGHTY = Band(1e-6, 1e-6, "", scale=10.0)
SOLVED, STUCK = la.Status.SOLVED, la.Status.NOT_CONVERGED


@pytest.mark.parametrize(
    ("reference", "coupling", "status", "value", "verdict"),
    [
        (LOADS, "certified", SOLVED, 1.5, PASS),
        (LOADS, "shift", SOLVED, 2.1, FAIL),
        (LOADS, "shift", SOLVED, 0.9, FAIL),
        (LOADS, "associated", SOLVED, 2.0, PASS),
        (LOADS, "associated", SOLVED, 1.5, FAIL),
        (LOADS, "stick", SOLVED, 2.0, PASS),
        (LOADS, "stick", SOLVED, 2.5, BOUND_ONLY),
        (LOADS, "stick", la.Status.LOCKED, nan, BOUND_ONLY),
        (LOADS, "stick", SOLVED, 1.9, FAIL),
        (LOADS, "frictionless", SOLVED, 1.0, PASS),
        (LOADS, "frictionless", la.Status.UNSAFE, nan, BOUND_ONLY),
        (LOADS, "frictionless", SOLVED, 0.5, BOUND_ONLY),
        (LOADS, "frictionless", SOLVED, 1.1, FAIL),
        (LOADS, "certified", la.Status.LOCKED, nan, FAIL),
        (LISTED, "certified", SOLVED, 2.5, PASS),
        (LISTED, "certified", SOLVED, 0.5, PASS),
        (LISTED, "certified", SOLVED, 3.1, FAIL),
        (JAMMED, "certified", la.Status.JAM, nan, PASS),
        (JAMMED, "shift", SOLVED, 7.0, FAIL),
        (JAMMED, "associated", la.Status.LOCKED, nan, PASS),
        (JAMMED, "associated", SOLVED, 7.0, FAIL),
        (BELOW_ZERO, "certified", SOLVED, -0.5, PASS),
        (BELOW_ZERO, "certified", SOLVED, 0.5, FAIL),
        (BELOW_ZERO, "certified", la.Status.UNSAFE, nan, FAIL),
        (ZERO, "certified", SOLVED, 9e-6, PASS),
        (ZERO, "certified", SOLVED, -2e-5, FAIL),
        (UNKNOWN, "certified", SOLVED, 4.0, NO_REFERENCE),
        (UNKNOWN, "certified", la.Status.UNSAFE, nan, NO_REFERENCE),
        (UNKNOWN, "certified", la.Status.NOT_CERTIFIED, nan, FAIL),
    ],
)
def test_verdict_on_coulomb_loads(state, reference, coupling, status, value, verdict):
    found = replace(state, coupling=coupling, status=status, load_factor=value)
    assert judge(found, reference, WEIGHTY)[0] == verdict


def test_no_result_is_no_failure_where_none_is_insisted_on(state):
    stuck = replace(state, coupling="shift", status=STUCK)
    assert judge(stuck, LOADS, WEIGHTY, insist=False)[0] == NO_RESULT
    assert judge(stuck, LOADS, WEIGHTY)[0] == FAIL
    wrong = replace(state, coupling="shift", load_factor=3.0)
    assert judge(wrong, LOADS, WEIGHTY, insist=False)[0] == FAIL


@pytest.mark.parametrize(
    ("claimed", "residuals", "verdict"),
    [
        (False, {"equilibrium": 0.5, "yield_violation": 0.0, "normalisation": 0.0}, NO_RESULT),
        (True, {"equilibrium": 2e-6, "yield_violation": 0.0, "normalisation": 0.0}, NO_RESULT),
        (True, {"equilibrium": 0.5, "yield_violation": 0.0, "normalisation": 0.0}, FAIL),
        (True, {"equilibrium": 0.0, "yield_violation": nan, "normalisation": 0.0}, FAIL),
        (True, {"divergence": 0.5}, FAIL),  # forged: the others are missing
        (True, {}, NO_RESULT),  # it came to no state
    ],
)
def test_a_claim_is_refuted_by_residuals_that_are_no_matter_of_digits(
    state, claimed, residuals, verdict
):
    stuck = replace(state, status=la.Status.NOT_CERTIFIED)
    refuted = refutation(claimed, residuals)
    assert judge(stuck, LOADS, WEIGHTY, insist=False, refuted=refuted)[0] == verdict


def test_only_exact_backends_must_answer():
    """Of regularised ones a comparison counts how often they do."""
    runs = {run.backend: run for run in plan(["shear-patch:yielding"], meshes=["coarse"])}
    assert runs["clarabel"].insist
    assert runs["cvxpy"].insist
    assert not any(runs[name].insist for name in ("newton", "ipopt", "slsqp"))
    assert lost(runs["newton"], la.Status.TIME_LIMIT, "late").row.verdict == NO_RESULT
    assert lost(runs["newton"], la.Status.FAILED, "signal 11").row.verdict == FAIL
    assert lost(runs["clarabel"], la.Status.TIME_LIMIT, "late").row.verdict == FAIL


def test_an_exact_backend_must_answer_with_associated_friction():
    """The program is convex: it has a solution, or a proof that it has none."""
    couplings = ["associated", "shift"]
    names = ["clarabel", "newton"]
    runs = plan(["block-slide"], names[:1], couplings=couplings)
    assert {run.coupling: run.insist for run in runs} == {"associated": True, "shift": False}
    regularised = plan(["shear-patch:yielding"], names[1:], ["coarse"], couplings)
    assert not any(run.insist for run in regularised)


def test_a_regularised_backend_that_gives_up_is_no_failure():
    (run,) = plan(["shear-patch:yielding"], ["slsqp"], ["coarse"])
    (outcome,) = run_here([replace(run, options={"max_iterations": 1})])
    assert outcome.row.status == la.Status.ITERATION_LIMIT.label
    assert isnan(outcome.row.load_factor)
    assert outcome.row.verdict == NO_RESULT
    assert "not solved" in outcome.row.why


def test_a_load_that_is_not_listed_is_named(state):
    why = judge(replace(state, coupling="certified", load_factor=2.5), LISTED, WEIGHTY)[1]
    assert "listed are [1, 2]" in why


def test_planted_wrong_reference_fails(tmp_path):
    runs = [Run(wrong_case(), VARIANT, "coarse", "clarabel")]
    (outcome,) = run_all(runs, tmp_path / NAME, executor=run_in_order)
    assert outcome.row.verdict == FAIL
    assert "not in" in outcome.row.why


def test_rows_are_on_disk_as_they_finish(tmp_path):
    path = tmp_path / "new" / NAME
    seen = []
    run_all(
        plan(["shear-patch"], ["clarabel"], ["coarse"]),
        path,
        on_finish=lambda _: seen.append(len(load_results(path))),
        executor=run_in_order,
    )
    assert seen == [1, 2]
    first = load_results(path).iloc[0]
    assert (first["case"], first["variant"], first["verdict"]) == ("shear-patch", "sliding", PASS)
    assert first["load_factor"] == pytest.approx(0.32)
    assert isnan(first["alpha_reg"])
    assert isnan(first["upper"])
    assert first["param_mu"] == 0.2


def test_upper_bound_is_filled_only_where_rigor_says_so():
    case, variants = find("prandtl-punch")
    runs = [Run(case, variant, "coarse", "clarabel") for variant in variants]
    for outcome in run_here(runs):
        assert outcome.row.upper == outcome.row.load_factor
        assert outcome.row.record()["lower"] != outcome.row.record()["lower"]  # NaN


def test_a_backend_that_breaks_is_a_failed_row_and_the_run_goes_on(monkeypatch):
    solve = la.solve

    def breaks(problem, backend, **options):
        if backend == "cvxpy":
            raise ZeroDivisionError("planted")
        return solve(problem, backend, **options)

    monkeypatch.setattr(limit_state, "solve", breaks)
    runs = [Run(CASE, VARIANT, "coarse", name) for name in ("cvxpy", "clarabel")]
    first, second = run_here(runs)
    assert (first.row.status, first.row.verdict) == ("failed", FAIL)
    assert first.row.message == "ZeroDivisionError: planted"
    assert second.row.verdict == PASS


def test_a_backend_that_cannot_is_skipped_and_says_why(monkeypatch):
    def cannot(problem, **options):
        raise la.CapabilityError("too big: take a coarser mesh")

    monkeypatch.setattr(limit_state, "solve", cannot)
    outcomes = list(run_here([Run(CASE, VARIANT, "coarse", "cvxpy")]))
    assert outcomes[0].row.verdict == SKIPPED
    assert outcomes[0].row.message == "too big: take a coarser mesh"
    assert tally(outcomes).skipped == 1


def test_a_case_that_does_not_build_is_a_failed_row():
    def build(**parameters):
        raise la.InputError("mesh", None, "planted", "fix it")

    runs = [Run(replace(CASE, build=build), VARIANT, "coarse", "clarabel")]
    (outcome,) = run_here(runs)
    assert (outcome.row.verdict, outcome.evidence) == (FAIL, NO_EVIDENCE)


def test_backends_share_the_discretisation(monkeypatch):
    calls = []
    discretise = la.discretise
    monkeypatch.setattr(
        harness.la, "discretise", lambda problem: calls.append(1) or discretise(problem)
    )
    runs = [Run(CASE, VARIANT, "coarse", "clarabel")] * 2
    first, second = run_here(runs)
    assert len(calls) == 1
    assert first.row.build_time == second.row.build_time > 0


def test_plan_takes_each_variant_once_and_keeps_their_order():
    runs = plan(["shear-patch:yielding", "shear-patch"], ["clarabel"], ["coarse"])
    assert [*dict.fromkeys(run.variant.name for run in runs)] == ["sliding", "yielding"]
    assert len({run.key for run in runs}) == len(runs)


def test_plan_takes_variants_of_a_family_and_all_there_is():
    runs = plan(["shear-patch"], ["cvxpy:SCS"], ["coarse"])
    assert {run.variant.name for run in runs} == {"sliding", "yielding"}
    assert {run.backend for run in runs} == {"cvxpy:SCS"}
    runs = plan(["shear-patch"], ["all"], ["coarse"])
    assert {run.backend for run in runs} == set(la.backend_names())


def test_default_plan_has_every_case_and_backend():
    runs = plan()
    often = {name for name in la.backend_names() if not capabilities(name).on_demand}
    assert {run.backend for run in runs} == often
    assert {"clarabel", "newton", "highs"} <= often
    assert {run.mesh for run in runs} >= {"coarse", "medium", "blocks"}


CAN = {
    "dense": Capabilities(regularised=True, dense=True),
    "exact": Capabilities(regularised=False, paths=True),
    "linear": Capabilities(regularised=False, max_cone=1),
    "named": Capabilities(regularised=False, on_demand=True, paths=True),
    "pressed": Capabilities(regularised=False, surfaces=True),
    "smooth": Capabilities(regularised=True, paths=True),
}


@pytest.mark.parametrize(
    ("name", "backends"),
    [
        ("shear-patch", ["dense", "exact", "pressed", "smooth"]),
        ("wall-1", ["exact", "linear", "pressed"]),  # which is none for penalties
        ("block-slide", ["dense", "exact", "linear", "pressed", "smooth"]),
        ("biaxial", ["pressed"]),  # strength depends on pressure
        ("tension:linear-1", ["exact", "smooth"]),
        ("upsetting", ["exact"]),  # nobody knows its loads
    ],
)
def test_backends_are_run_by_what_they_say_of_themselves(name, backends, monkeypatch):
    monkeypatch.setattr(comparison, "fault_of", lambda name: "")
    monkeypatch.setattr(comparison, "capabilities", CAN.__getitem__)
    monkeypatch.setattr(comparison.la, "backend_names", lambda: list(CAN))
    case, (variant, *_) = find(name)
    assert comparison.default_backends(case, variant) == backends


def test_a_variant_that_no_table_lists_has_nothing_to_be_compared_with():
    case, (listed,) = find("wall-1")
    (outcome,) = run_here([Run(case, Variant("mu-0.5", {"mu": 0.5}), "blocks", "clarabel")])
    assert (outcome.row.verdict, outcome.row.expected) == (NO_REFERENCE, "unknown")
    assert 0 < outcome.row.load_factor < 0.642859  # that of more friction
    with pytest.raises(LookupError):  # a variant of the case is to be in its table
        replace(case, reference=no_table).reference_of(listed)


def no_table(mu):
    return {}[mu]
