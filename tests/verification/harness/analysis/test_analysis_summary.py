"""One answer a variant: proven bounds, worst error beside the allowed one, who agrees."""

from dataclasses import replace
from math import inf, isnan, nan, pi

import pytest

from lacore_verification.catalogue.catalogue import find
from lacore_verification.harness.analysis.summary import CONTINUUM, DISCRETE, percent, summaries
from lacore_verification.harness.campaigns.comparison import planned
from lacore_verification.harness.verdicts.allowed import about, distance
from lacore_verification.harness.verdicts.limit_state import judge
from lacore_verification.harness.verdicts.words import (
    BOUND_ONLY,
    FAIL,
    NO_REFERENCE,
    NO_RESULT,
    PASS,
    SKIPPED,
    tally,
)
from lacore_verification.runs.outcome import Outcome
from lacore_verification.runs.row import STRICT, Row


def made(name, value, backend="clarabel", mesh="coarse", coupling="certified", **more):
    """An outcome as a solve would leave it that found `value`; its verdict is that of the rules."""
    case, (variant,) = find(name)
    run = planned(case, variant, mesh, backend, None if coupling == "certified" else coupling)
    elements = {"coarse": 100.0, "medium": 400.0, "fine": 1600.0}.get(mesh, 3.0)
    reference, band = case.reference_of(variant), case.band_of(variant, int(elements))
    row = Row(
        *(case.id, variant.name, backend, coupling, mesh),
        n_elements=elements,
        load_factor=value,
        error=distance(value, reference, band),
        rigor="discrete",
        status="solved",
        solve_time=0.5,
        verdict=PASS,
        **about(reference),
    )
    return Outcome(run, replace(row, **more))


def one(*outcomes):
    (found,) = summaries(outcomes)
    return found


def test_the_error_is_the_worst_of_exact_backends_on_their_finest_meshes():
    """Beside what is allowed there; coarse meshes and regularised backends err by more."""
    name, exact = "prandtl-punch:smooth", 5.141593
    found = one(
        made(name, 1.20 * exact),
        made(name, 1.01 * exact, mesh="medium"),
        made(name, 1.012 * exact, "cvxpy", mesh="medium"),
        made(name, 0.9 * exact, "newton", coupling="reaction", rigor="regularised", energy=0.3),
    )
    assert found.error == pytest.approx(0.012, rel=1e-3)
    assert (found.mesh, found.elements, found.value) == ("medium", 400, 1.012 * exact)
    case, (variant,) = find(name)
    assert found.allowed == pytest.approx(case.band_of(variant, 400).above, rel=1e-3)
    assert (found.runs, found.seconds) == (4, 2.0)


@pytest.mark.parametrize(
    "name",
    ["prandtl-punch:smooth", "platens-coulomb:mu-0.1", "pulled-under-stop:mu_w-0.2",
     "block-incline:down-mu-0.2", "disc-upsetting:mu-0.1"],
)  # fmt: skip
@pytest.mark.parametrize("off", [-0.3, -0.05, -1e-3, -1e-7, 0.0, 1e-7, 1e-3, 0.05, 0.3])
def test_an_error_is_allowed_where_and_only_where_its_verdict_says_so(name, off):
    """Numbers, brackets, intervals, and such as are small against the dead loads."""

    class Said:
        coupling, message, regularised = "certified", "", None

    case, (variant,) = find(name)
    reference = case.reference_of(variant)
    Said.load_factor = reference.value + off * abs(reference.value)
    outcome = made(name, Said.load_factor, mesh=next(iter(case.meshes)))
    Said.status = reference.status
    band = case.band_of(variant, int(outcome.row.n_elements))
    verdict, _ = judge(Said, reference, band)
    found = one(outcome)
    assert (-found.below <= found.error <= found.above) == (verdict == PASS)
    assert (abs(found.error) <= abs(found.allowed)) == (verdict == PASS)


def test_the_closest_bounds_are_shown_and_the_problem_that_they_are_of():
    name = "prandtl-punch:smooth"
    found = one(
        made(name, 5.3, rigor="upper", upper=5.3),
        made(name, 5.2, rigor="upper", upper=5.2, mesh="medium"),
        made(name, nan, coupling="bracket", rigor=STRICT, lower=5.1, upper=5.25),
    )
    assert (found.lower, found.upper, found.bounded) == (5.1, 5.2, CONTINUUM)
    straightened = made(
        "plate-hole:uniaxial", nan, coupling="bracket", rigor="discrete", lower=0.7, upper=0.9
    )
    value = made("plate-hole:uniaxial", 0.8)
    found = one(value, straightened)
    assert (found.lower, found.upper, found.bounded) == (0.7, 0.9, DISCRETE)
    assert isnan(one(value).lower)
    assert one(value).bounded == ""


def test_associated_friction_proves_nothing_from_below():
    """T14: it carries no less than Coulomb friction, and may carry more."""
    name = "platens-coulomb:mu-0.1"
    found = one(
        made(name, 2.2),
        made(name, 2.3, coupling="associated", rigor="upper", upper=2.3),
        made(
            "platens-coulomb:mu-0.1", nan, coupling="bracket", rigor=STRICT, lower=2.25, upper=2.4
        ),
    )
    assert isnan(found.lower)
    assert found.upper == 2.3
    assert found.value == 2.2


def test_bounds_of_what_is_not_solved_and_those_of_the_beginning_of_a_path_are_none():
    name = "prandtl-punch:smooth"
    lost = made(name, nan, coupling="bracket", rigor=STRICT, lower=5.1, upper=inf, status="failed")
    path = made(name, 5.2, rigor="upper", lower=1.0, upper=2.0, ending="reached")
    found = one(lost, path)
    assert isnan(found.lower)
    assert isnan(found.upper)
    assert found.bounded == ""


def test_backends_agree_when_all_of_their_results_are_right():
    name = "prandtl-punch:smooth"
    found = one(
        made(name, 5.2),
        made(name, 5.18, mesh="medium"),
        made(name, 5.2, "cvxpy"),
        made(name, 9.9, "cvxpy", mesh="medium", verdict=FAIL, why="9.9 not in [5, 6]"),
        made(name, nan, "slsqp", verdict=NO_RESULT, status="stalled", why="not solved"),
        made(name, nan, "ipopt", verdict=SKIPPED, status="skipped", why="it cannot"),
    )
    assert (found.agreeing, found.answered, found.asked) == (1, 2, 3)
    assert found.verdict == FAIL
    assert found.runs == 5
    assert [short.why for short in found.shortfalls] == [
        *("9.9 not in [5, 6]", "not solved", "it cannot"),
    ]
    assert found.shortfalls[1].label == "prandtl-punch:smooth coarse slsqp"


def test_without_a_reference_backends_agree_with_the_exact_one():
    """Regularised ones to their energy, to the side on which they err (T19)."""

    def row(value, *names, **more):
        unknown = {"verdict": NO_REFERENCE, "reference": nan, "expected": "unknown", "error": nan}
        return made("prandtl-punch:smooth", value, *names, **unknown | more)

    near = row(3.99, "newton", rigor="regularised", energy=0.02)
    above = row(4.01, "ipopt", rigor="regularised", energy=0.02)
    found = one(row(4.0), row(4.000001, "cvxpy"), near, above)
    assert (found.agreeing, found.answered, found.asked) == (3, 4, 4)
    assert found.verdict == NO_REFERENCE
    assert isnan(found.error)
    assert isnan(found.allowed)
    assert one(near).agreeing == 0  # there is nothing to agree with


def test_what_is_nan_is_no_error_and_agrees_with_nothing():
    name = "prandtl-punch:smooth"
    lost = made(
        name, nan, mesh="medium", rigor="not certified", status="not certified", verdict=FAIL
    )
    found = one(made(name, 5.2), lost)
    assert found.mesh == "coarse"
    assert found.verdict == FAIL
    found = one(lost)
    assert isnan(found.error)
    assert isnan(found.allowed)
    assert isnan(found.value)
    assert (found.agreeing, found.answered, found.asked) == (0, 0, 1)
    odd = made(name, nan, verdict=PASS, error=nan)
    assert isnan(one(odd, lost).error)
    unmeasured = made(name, 5.2, error=nan)
    known = made(name, 5.2, "cvxpy")
    assert one(unmeasured, known).error == known.row.error


def test_a_status_that_must_come_is_a_result_without_an_error():
    found = one(
        made("symmetric-wedge:jam", nan, mesh="blocks", status="jam", rigor="not certified"),
    )
    assert (found.expected, found.agreeing, found.verdict) == ("jam", 1, PASS)
    assert isnan(found.error)


def test_of_a_path_the_worst_load_on_the_way_counts():
    path = made("hardening-cylinder:voce", 1.0809, ending="reached", path_error=2e-4, error=-1e-5)
    found = one(path)
    assert found.error == 2e-4
    assert found.below == found.above > 0


def test_variants_are_told_apart_and_keep_their_order():
    names = ("prandtl-punch:smooth", "prandtl-punch:rough", "deformable-block:sliding")
    outcomes = [made(name, 5.2, backend) for backend in ("clarabel", "cvxpy") for name in names]
    assert [found.name for found in summaries(outcomes)] == list(names)
    assert summaries([]) == []


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.98321, "+98 %"), (1.3, "+130 %"), (-0.17, "-17 %"), (0.0481, "+4.8 %"),
     (6.3e-5, "+0.0063 %"),
     (1e-9, "0 %"), (0.0, "0 %"), (nan, ""), (inf, "")],
)  # fmt: skip
def test_errors_are_printed_in_per_cent_without_exponents(value, text):
    assert percent(value) == text


def test_of_a_narrow_bracket_the_error_is_that_of_the_farther_end():
    """It is compared with the width that the bracket has to reach."""
    bracket = made(
        "prandtl-punch:smooth", nan, coupling="bracket", rigor=STRICT, lower=5.0, upper=5.2,
        width=0.039,
    )  # fmt: skip
    run = replace(bracket.run, settings={"target_width": 0.04})
    found = one(replace(bracket, run=run))
    assert found.error == pytest.approx(5.0 / (2 + pi) - 1)
    assert found.allowed == -0.04
    assert found.agreeing == found.asked == 1
    assert found.tolerance_text == "-4.0 %"
    near, far = (made("prandtl-punch:smooth", factor * (2 + pi)) for factor in (1.01, 1.2))
    assert one(replace(bracket, run=run), far).error == found.error
    assert one(replace(bracket, run=run), near).error == near.row.error


def test_bounds_by_another_model_are_no_passes():
    stick = made("platens-coulomb:mu-0.1", 4.0, coupling="stick", verdict=BOUND_ONLY)
    found = one(stick)
    assert found.verdict == BOUND_ONLY
    assert found.agreeing == 1
    assert tally([stick]).text == "0 pass, 0 FAIL, 0 skipped, 1 bound only"
