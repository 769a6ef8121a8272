"""NaN, inf and nothing at all, wherever something is compared: none of them may pass."""

from dataclasses import replace
from math import inf, nan

import numpy as np
import pandas as pd
import pytest

import lacore as la
from lacore_verification import conformance
from lacore_verification.case import UNKNOWN_KINDS, Band, Order, Reference
from lacore_verification.case.band import Bracketing
from lacore_verification.case.following import Following, Reading
from lacore_verification.catalogue.catalogue import Catalogue, find
from lacore_verification.catalogue.checks import check
from lacore_verification.conformance.judge import measured
from lacore_verification.harness.analysis.effort import couplings
from lacore_verification.harness.analysis.profiles import rates
from lacore_verification.harness.campaigns.comparison import plan
from lacore_verification.harness.evidence.bracket import Shares, packed_shares
from lacore_verification.harness.evidence.limit_state import Proof
from lacore_verification.harness.perform.one_run import run_here
from lacore_verification.harness.store.results import as_table
from lacore_verification.harness.verdicts.allowed import Allowed
from lacore_verification.harness.verdicts.bracket import judge_bracket
from lacore_verification.harness.verdicts.limit_state import judge
from lacore_verification.harness.verdicts.path import judge_path, largest_error
from lacore_verification.harness.verdicts.words import FAIL, NO_REFERENCE, PASS, tally
from lacore_verification.harness.verify import answer, ask, finish
from lacore_verification.harness.verify.bracket import gap
from lacore_verification.harness.verify.limit_state import (
    lambda_below_exact,
    upper_from_above,
    value,
)
from lacore_verification.harness.verify.residuals import residuals
from lacore_verification.runs.outcome import Evidence, Outcome
from lacore_verification.runs.row import STRICT, Row

CASE, (VARIANT,) = find("shear-patch:yielding")
KNOWN = Reference(0.6, "f", "s", "exact")
BAND = Band(1e-5, 1e-5, "r")
UNKNOWN = Reference(nan, "f", "s", "none", complete=False)
NAN_REFERENCES = [
    Reference(nan, "f", "s", "exact"),
    Reference(nan, "f", "s", "status", status=la.Status.JAM),
    replace(KNOWN, half_width=nan),
    replace(KNOWN, half_width=inf),
    replace(KNOWN, up_to=nan),
    replace(KNOWN, associated=nan),
]
NAN_BANDS = [
    Band(nan, 1e-5, ""), Band(1e-5, nan, ""), Band(1e-5, 1e-5, "", scale=nan), Band(inf, 1e-5, ""),
    Band(1e-5, inf, ""), Band(1e-5, 1e-5, "", scale=inf), Band(-1.0, 1e-5, ""),
]  # fmt: skip


@pytest.fixture(scope="module")
def state():
    return la.solve(CASE.problem(VARIANT, "coarse"))


@pytest.fixture(scope="module")
def solved():
    """An outcome of the case with its run."""
    (run,) = plan(["shear-patch:yielding"], ["clarabel"], ["coarse"], ["certified"])
    (outcome,) = run_here([run])
    assert outcome.row.verdict == PASS
    return outcome


def with_case(outcome, **fields):
    return replace(outcome, run=replace(outcome.run, case=replace(CASE, **fields)))


def row_with(outcome, **values):
    return replace(outcome, row=replace(outcome.row, **values))


# ---- what a case says


def nan_reference(**parameters):
    return Reference(nan, "planted", "wrong", "exact")


def no_reference(**parameters):
    return Reference(1.0, "planted", "wrong", "none")


@pytest.mark.parametrize("reference", [nan_reference, no_reference])
def test_a_case_with_nan_for_a_reference_is_refused(reference):
    with pytest.raises(la.InputError, match="does not go with the kind"):
        check(replace(CASE, reference=reference))


def test_a_nan_reference_passes_no_check():
    """What `lacore verify` asks of a case: once 4 checks passed."""
    case = replace(CASE, reference=nan_reference)
    questions = ask([], ["clarabel"], ["coarse"], Catalogue({CASE.id: case}, {CASE.id: "test"}))
    questions = [one for one in questions if one.variant.name == VARIANT.name]
    asked = [one for one in questions if one.check in ("value", "side")]
    outcomes = run_here({run.key: run for one in asked for run in one.runs}.values())
    finished = finish(asked, outcomes)
    assert asked
    assert {answer(one, finished).verdict for one in asked} == {FAIL}
    assert {outcome.row.verdict for outcome in finished.outcomes.values()} == {FAIL}


@pytest.mark.parametrize("kind", UNKNOWN_KINDS)
def test_what_is_unknown_has_a_verdict_of_its_own(solved, kind):
    def unknown(**parameters):
        return replace(UNKNOWN, kind=kind)

    found = value([with_case(solved, reference=unknown)], unknown())
    assert found.verdict == NO_REFERENCE
    (outcome,) = run_here([with_case(solved, reference=unknown).run])
    assert outcome.row.verdict == NO_REFERENCE
    count = tally([outcome])
    assert (count.passed, count.failed, count.no_reference) == (0, 0, 1)
    assert count.text.endswith("1 no reference")


# ---- verdicts


@pytest.mark.parametrize("reference", NAN_REFERENCES, ids=lambda r: r.text)
@pytest.mark.parametrize("load_factor", [0.6, nan, inf])
def test_a_reference_that_is_none_fails(state, reference, load_factor):
    for status in (la.Status.SOLVED, la.Status.LOCKED, la.Status.FREE, la.Status.UNSAFE):
        found = replace(state, status=status, load_factor=load_factor)
        verdict, why = judge(found, reference, BAND)
        assert verdict == FAIL
        assert why == reference.wrong  # and not what a comparison with NaN says


@pytest.mark.parametrize("band", NAN_BANDS)
def test_a_band_that_is_none_fails(state, band):
    for reference in (KNOWN, UNKNOWN):
        assert judge(replace(state, load_factor=0.6), reference, band)[0] == FAIL


@pytest.mark.parametrize("reference", [KNOWN, UNKNOWN, replace(KNOWN, up_to=inf)])
@pytest.mark.parametrize("load_factor", [nan, inf, -inf])
def test_solved_without_a_load_factor_fails(state, reference, load_factor):
    assert judge(replace(state, load_factor=load_factor), reference, BAND)[0] == FAIL


def test_values_outside_of_a_list_that_nothing_bounds_are_not_passed(state):
    listed = replace(KNOWN, up_to=0.7, complete=False)
    assert judge(replace(state, load_factor=0.65), listed, BAND)[0] == PASS
    assert judge(replace(state, load_factor=123.0), listed, BAND)[0] == NO_REFERENCE
    assert (
        judge(replace(state, load_factor=123.0), replace(listed, associated=1.0), BAND)[0] == FAIL
    )


@pytest.mark.parametrize("ends", [(nan, 1.0), (0.0, nan), (nan, nan), (1.0, 0.0)])
def test_nothing_lies_in_an_interval_that_is_none(ends):
    assert not any(Allowed(*ends).holds(at) for at in (0.5, nan, inf, -inf))
    assert not Allowed().holds(nan)


@pytest.mark.parametrize("order", [nan, inf, -inf])
def test_no_order_is_the_expected_one(order):
    assert not Order([], 1.0, 0.1, "").holds(order)
    assert not Order([], nan, 0.1, "").holds(1.0)
    assert not Order([], 1.0, nan, "").holds(1.0)


# ---- checks of rows


@pytest.mark.parametrize("load_factor", [nan, inf, -inf])
def test_rows_without_a_load_factor_pass_nothing(solved, load_factor):
    row = row_with(solved, load_factor=load_factor)
    reference = CASE.reference_of(VARIANT)
    assert value([row], reference).verdict == FAIL
    assert upper_from_above([row], reference).verdict == FAIL
    proof = Proof(load_factor, _certificate(0.0))
    assert residuals([row], {row.run.key: proof}).verdict == FAIL


def _certificate(size, **others):
    names = la.Certificate.__dataclass_fields__
    return la.Certificate(**{**dict.fromkeys(names, size), **others})


@pytest.mark.parametrize("name", la.Certificate.__dataclass_fields__)
def test_a_nan_residual_fails(solved, name):
    proof = Proof(solved.row.load_factor, _certificate(0.0))
    assert residuals([solved], {solved.run.key: proof}).verdict == PASS
    for size in (nan, inf):
        wrong = replace(proof, certificate=_certificate(0.0, **{name: size}))
        assert residuals([solved], {solved.run.key: wrong}).verdict == FAIL


@pytest.mark.parametrize("bar", [nan, inf, 0.0, -1.0])
def test_a_bar_that_is_none_fails(solved, bar):
    outcome = replace(solved, run=replace(solved.run, settings={"tolerance": bar}))
    proof = Proof(solved.row.load_factor, _certificate(0.0))
    assert residuals([outcome], {outcome.run.key: proof}).verdict == FAIL


CHAIN = {"P": 0.5, "alpha_reg": 0.55, "load_factor": 0.58, "energy": 0.02}


@pytest.mark.parametrize("wrong", [nan, inf, -inf])
@pytest.mark.parametrize("name", ["P", "alpha_reg", "load_factor", "star"])
def test_the_order_of_regularised_values_holds_for_numbers_only(solved, name, wrong):
    """The built-in max drops NaN unless it comes first."""
    exact = row_with(solved, load_factor=wrong if name == "star" else 0.6)
    given = row_with(solved, **{**CHAIN, **({name: wrong} if name != "star" else {})})
    sound = row_with(solved, **CHAIN)
    exacts = {solved.run.key: row_with(solved, load_factor=0.6)}
    assert lambda_below_exact([sound], exacts).verdict == PASS
    assert lambda_below_exact([given], {solved.run.key: exact}).verdict == FAIL


# ---- brackets

WIDTH = 0.005
BRACKETED = Row(
    "c", "v", "b", "bracket", "m", lower=2.0, upper=2.01, width=0.01 / 2.005, rigor=STRICT
)
INSIDE = Reference(2.005, "f", "s", "exact")


def test_a_bracket_of_numbers_passes():
    assert judge_bracket(BRACKETED, INSIDE, Bracketing(WIDTH), BAND)[0] == PASS
    assert judge_bracket(BRACKETED, UNKNOWN, Bracketing(WIDTH), BAND)[0] == NO_REFERENCE


@pytest.mark.parametrize("wrong", [nan, inf, -inf])
@pytest.mark.parametrize("name", ["lower", "upper", "width"])
def test_a_bracket_without_numbers_fails(name, wrong):
    row = replace(BRACKETED, **{name: wrong})
    for reference in (INSIDE, UNKNOWN):
        assert judge_bracket(row, reference, Bracketing(WIDTH), BAND)[0] == FAIL


@pytest.mark.parametrize("reference", NAN_REFERENCES, ids=lambda r: r.text)
def test_a_bracket_of_a_reference_that_is_none_fails(reference):
    assert judge_bracket(BRACKETED, reference, Bracketing(WIDTH), BAND)[0] == FAIL


@pytest.mark.parametrize("band", NAN_BANDS)
def test_a_bracket_with_a_band_that_is_none_fails(band):
    assert judge_bracket(BRACKETED, INSIDE, Bracketing(WIDTH), band)[0] == FAIL


@pytest.mark.parametrize("stated", [Bracketing(nan), Bracketing(WIDTH, below=nan, reason="r")])
def test_a_bracket_that_is_asked_for_nothing_fails(stated):
    assert judge_bracket(BRACKETED, INSIDE, stated, BAND)[0] == FAIL


SHARES = Shares(
    mesh="upper",
    points=np.zeros((2, 3)),
    elements=np.zeros((3, 2), dtype=int),
    shares=np.array([0.004, 0.006]),
    interfaces=np.zeros(0),
    marks=np.zeros(0),
    lower=2.0,
    upper=2.01,
    scale=2.01,
)


def gap_of(solved, shares, row=BRACKETED):
    evidence = Evidence({}, (), packed_shares([shares, replace(shares, mesh="lower")]))
    return gap([Outcome(solved.run, replace(row, status="solved"), evidence)])


def test_gaps_of_numbers_pass(solved):
    assert gap_of(solved, SHARES).verdict == PASS


@pytest.mark.parametrize("wrong", [nan, inf, -inf])
@pytest.mark.parametrize("name", ["lower", "upper", "scale", "shares", "interfaces"])
def test_gaps_without_numbers_fail(solved, name, wrong):
    field = getattr(SHARES, name)
    planted = np.array([wrong, 0.01]) if isinstance(field, np.ndarray) else wrong
    assert gap_of(solved, replace(SHARES, **{name: planted})).verdict == FAIL


def test_gaps_of_nothing_and_of_other_bounds_fail(solved):
    empty = replace(SHARES, elements=np.zeros((3, 0), dtype=int), shares=np.zeros(0), lower=2.01)
    row = replace(BRACKETED, lower=2.01)
    assert gap_of(solved, empty, row).verdict == FAIL
    assert gap_of(solved, SHARES, replace(BRACKETED, upper=2.02)).verdict == FAIL
    assert gap_of(solved, SHARES, replace(BRACKETED, lower=nan)).verdict == FAIL


# ---- paths

FOLLOWED = Following(
    1.0,
    4,
    "leapfrog",
    la.FootingTravel(),
    exact=lambda travel: 1.0,
    volume=1e-6,
    reading=Reading("radius", lambda path: 1.0, 0.5, 1.5),
    bounded=True,
)
WALKED = Row(
    *("c", "v", "b", "", "m"),
    **{"load_factor": 0.6, "ending": "reached", "path_error": 1e-6, "volume_change": 1e-9},
    **{"reading": 1.0, "lower": 0.5, "upper": 0.7, "start": 0.6},
)


def test_a_path_of_numbers_passes():
    assert judge_path(WALKED, FOLLOWED, KNOWN, BAND)[0] == PASS
    assert judge_path(WALKED, FOLLOWED, UNKNOWN, BAND)[0] == NO_REFERENCE
    assert judge_path(replace(WALKED, energy=0.01), FOLLOWED, KNOWN, BAND)[0] == PASS


@pytest.mark.parametrize("wrong", [nan, inf, -inf])
@pytest.mark.parametrize(
    "name", ["path_error", "volume_change", "reading", "lower", "upper", "start"]
)
def test_a_path_without_numbers_fails(name, wrong):
    for reference in (KNOWN, UNKNOWN):
        verdict, _ = judge_path(replace(WALKED, **{name: wrong}), FOLLOWED, reference, BAND)
        assert verdict == FAIL


def test_a_path_without_a_last_load_or_with_any_energy_fails():
    for wrong in (nan, inf, -inf, 0.0):
        assert judge_path(replace(WALKED, load_factor=wrong), FOLLOWED, KNOWN, BAND)[0] == FAIL
    without = replace(WALKED, energy=0.01, load_factor=0.0)
    assert judge_path(without, FOLLOWED, KNOWN, BAND)[0] == FAIL
    assert judge_path(replace(WALKED, energy=inf), FOLLOWED, KNOWN, BAND)[0] == FAIL


@pytest.mark.parametrize("reference", NAN_REFERENCES, ids=lambda r: r.text)
def test_a_path_of_a_reference_that_is_none_fails(reference):
    assert judge_path(WALKED, FOLLOWED, reference, BAND)[0] == FAIL


def test_the_largest_error_of_a_path_drops_no_load():
    exact = np.array([nan, 1.0, 2.0])
    assert largest_error(np.array([5.0, 1.0, 2.2]), exact) == pytest.approx(0.1)
    for wrong in (nan, inf):
        assert not largest_error(np.array([1.0, wrong, 2.0]), exact) <= 1.0
    assert not largest_error(np.array([1.0, 2.0]), np.array([0.0, 2.0])) <= 1.0
    assert largest_error(np.array([0.0, 2.0]), np.array([0.0, 2.0])) == 0.0
    assert np.isnan(largest_error(np.zeros(0), np.zeros(0)))
    assert np.isnan(largest_error(np.ones(2), np.full(2, nan)))


# ---- nothing at all


def test_of_no_runs_there_is_nothing_to_pass(solved):
    assert tally([]).text == "0 pass, 0 FAIL, 0 skipped"
    assert len(couplings(as_table([]))) == 0
    assert value([], KNOWN).verdict != PASS
    assert upper_from_above([], KNOWN).verdict != PASS
    assert lambda_below_exact([], {}).verdict != PASS
    assert residuals([row_with(solved, status="stalled")], {}).verdict != PASS


def test_rates_of_unjudged_runs_are_neither_right_nor_wrong():
    frame = pd.DataFrame(
        {"backend": "a", "status": "solved", "claimed": True, "verdict": [NO_REFERENCE, PASS, FAIL]}
    )
    (found,) = rates(frame, ["backend"]).to_dict("records")
    assert (found["correct"], found["unjudged"], found["wrong_claims"]) == (1, 1, 1)
    assert found["correctness_rate"] == 0.5
    (none,) = rates(frame[:1], ["backend"]).to_dict("records")
    assert np.isnan(none["correctness_rate"])


@pytest.mark.parametrize("column", ["verdict", "status", "claimed"])
def test_a_missing_column_is_named(column):
    frame = pd.DataFrame({"backend": ["a"], "status": "solved", "claimed": True, "verdict": PASS})
    with pytest.raises(la.InputError, match=column):
        rates(frame.drop(columns=column), ["backend"])


def test_conformance_lets_no_nan_through():
    for value_, allowed in ((nan, 1.0), (1.0, nan), (inf, 1.0)):
        assert measured("p", "c", value_, allowed, "").verdict == conformance.FAIL
