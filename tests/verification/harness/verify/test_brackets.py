"""Brackets in the verification run: what is asked, what rows carry, that planted errors are found.

Every case is bracketed by `lacore verify` and `pytest verification`.
"""

import json
import re
from dataclasses import replace
from math import inf, isnan, nan

import numpy as np
import pytest

import lacore as la
import lacore_verification.catalogue.plugins as plugins
from lacore.bounds.bracket.refine import width
from lacore.model.meshes.checks import quality
from lacore_verification.case import UNKNOWN, Reference
from lacore_verification.case.band import BRACKET, Bracketing
from lacore_verification.catalogue.catalogue import Catalogue, catalogue, find
from lacore_verification.harness.analysis.slope_fits import fit_slope
from lacore_verification.harness.evidence.bracket import packed_shares, unpacked_shares
from lacore_verification.harness.perform.irregular import irregular
from lacore_verification.harness.perform.one_run import run_here
from lacore_verification.harness.store.results import load_results
from lacore_verification.harness.verdicts.bracket import between
from lacore_verification.harness.verdicts.words import FAIL, NO_REFERENCE, PASS, SKIPPED
from lacore_verification.harness.verify import Finished, answer, ask, finish, runs_of
from lacore_verification.report.bracket import widths, widths_chart
from lacore_verification.report.drawing import brackets, painted
from lacore_verification.report.stored_figures import stored_shares
from tests.verification.command_line import lacore

STRIP = find("opposed-punches:h-1")[0]  # exact: 2, without friction
NAMED = {
    *("rough-platens-2", "opposed-punches", "layer-rough", "vertical-cut", "notched-strip"),
    *("centre-crack", "plate-hole", "thick-cylinder", "prandtl-punch"),
}


def asked(name, check, **fields):
    """The question on a case with other fields."""
    (found,) = (q for q in ask([name], ["clarabel"]) if q.coupling == BRACKET and q.check == check)
    case = replace(found.case, **fields)
    return replace(found, runs=tuple(replace(run, case=case) for run in found.runs))


def solved(question):
    return finish([question], run_here(runs_of([question])))


@pytest.fixture(scope="module")
def strip():
    return solved(asked("opposed-punches:h-1", "bracket"))


def row_of(finished):
    (outcome,) = finished.outcomes.values()
    return outcome.row


def changed(finished, **values):
    return Finished(
        {
            key: replace(outcome, row=replace(outcome.row, **values))
            for key, outcome in finished.outcomes.items()
        }
    )


# ---- what is asked


def test_each_deformable_body_with_a_load_factor_is_asked_once():
    names = {}
    # A case of each kind that has none, too.
    for question in ask([*sorted(NAMED), "wall-1", "portal-sway", "wedge-in-walls", "block-slide"]):
        if question.coupling == BRACKET:
            key = f"{question.case.id}:{question.variant.name}"
            names.setdefault(key, []).append((question.check, question.backend))
    assert {name.partition(":")[0] for name in names} == NAMED
    assert {"centre-crack:plane-strain", "centre-crack:plane-stress"} <= set(names)
    assert all(found == [("bracket", "clarabel"), ("gap", "clarabel")] for found in names.values())


def test_the_first_exact_backend_that_is_named_makes_it():
    def makers(*backends):
        questions = ask(["prandtl-punch:smooth"], backends, ["medium"])
        return {(q.backend, q.runs[0].mesh) for q in questions if q.coupling == BRACKET}

    assert makers("newton", "cvxpy", "clarabel") == {("cvxpy", "coarse")}  # its own mesh
    assert makers("newton") == set()


def test_a_case_may_want_none():
    known = Catalogue({STRIP.id: replace(STRIP, bracket=None)}, {STRIP.id: "test"})
    assert not any(q.coupling == BRACKET for q in ask([], ["clarabel"], known=known))


def test_curved_boundaries_start_from_the_mesh_that_they_say():
    assert asked("thick-cylinder", "bracket").runs[0].mesh == "medium"
    assert asked("opposed-punches:h-1", "bracket").runs[0].mesh == "coarse"


def test_associated_friction_carries_no_less_than_any_coulomb_load():
    exact = Reference(2.0, "f", "s", "exact", half_width=0.1)
    assert between(exact, coulomb=False) is exact
    assert (between(exact, True).low, between(exact, True).high) == (1.9, inf)
    interval = replace(exact, half_width=0.0, up_to=2.5)
    assert between(interval, True).low == 2.5
    assert between(replace(exact, associated=3.0), True).value == 3.0
    assert isnan(between(UNKNOWN, True).value)


# ---- what a row carries


def test_a_row_has_both_bounds_with_their_meshes(strip):
    row = row_of(strip)
    assert row.lower <= 2.0 <= row.upper
    assert row.width == pytest.approx((row.upper - row.lower) / 2.0, rel=0.01)
    assert row.width <= 0.01
    assert row.rigor == "lower, upper"
    assert isnan(row.load_factor)  # it is between them: that is all that is known
    assert min(row.n_elements, row.n_elements_lower) > 0
    assert row.verdict == PASS
    record = next(iter(strip.outcomes.values())).record()
    assert isinstance(record["n_elements_lower"], int)
    assert record["residual_equilibrium"] <= 1e-12
    assert record["residual_divergence"] <= 1e-12


def test_all_is_well(strip):
    for check in ("bracket", "gap"):
        found = answer(asked("opposed-punches:h-1", check), strip)
        assert found.verdict == PASS, found.why
    assert found.measured < 1e-9
    assert "on 4 meshes (uniform, irregular, upper, lower)" in found.why


def test_coulomb_friction_is_made_associated():
    question = asked("shear-patch:sliding", "bracket")
    found = answer(question, solved(question))
    assert found.verdict == PASS, found.why
    assert "with the reference 0.32, associated: " in found.why


def test_shares_come_back_from_the_store_as_they_were(strip):
    (outcome,) = strip.outcomes.values()
    found = unpacked_shares(outcome.evidence.arrays)
    again = unpacked_shares(packed_shares(found))
    assert [one.mesh for one in again] == ["uniform", "irregular", "upper", "lower"]
    assert all(np.array_equal(a.shares, b.shares) for a, b in zip(found, again, strict=True))
    assert found[2].elements.shape[1] == outcome.row.n_elements
    assert found[3].marks.size == outcome.row.n_elements_lower


def test_an_irregular_mesh_covers_the_same_body():
    problem = STRIP.problem(STRIP.variants[0], "coarse")
    (body,) = problem.bodies.values()
    mesh = irregular(body.mesh)
    a, b, c = mesh.p[:, mesh.t].transpose(1, 0, 2)
    area = ((b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0]) / 2
    assert np.abs(area).sum() == pytest.approx(3.0, rel=1e-12)
    assert quality(mesh).min() > 0.1
    assert np.unique(np.abs(area).round(9)).size > 0.9 * mesh.nelements  # no two alike
    assert mesh.nelements > body.mesh.nelements
    names = set(body.mesh.boundaries)
    assert set(mesh.boundaries) == names
    assert not np.array_equal(irregular(body.mesh, seed=1).p, mesh.p)


# ---- planted errors


def planted(value, half_width=0.0):
    def reference(**parameters):
        return Reference(value, "planted", "wrong", "exact", half_width)

    return reference


@pytest.mark.parametrize(
    ("reference", "verdict"),
    [
        (planted(2.02), FAIL),
        (planted(1.99), FAIL),
        (planted(2.02, half_width=0.015), PASS),
        (planted(1.99, half_width=0.01), PASS),
        (planted(nan), FAIL),
        (lambda **_: UNKNOWN, NO_REFERENCE),
    ],
)
def test_a_reference_outside_of_what_is_proven_is_found(strip, reference, verdict):
    found = answer(asked("opposed-punches:h-1", "bracket", reference=reference), strip)
    assert found.verdict == verdict, found.why
    if verdict == FAIL:
        assert re.search("planted, lies outside of what is proven|reference is NaN", found.why)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"lower": 2.03}, "above the upper one"),
        ({"upper": 1.999}, "above the upper one"),
        ({"lower": -inf}, "no bracket"),
        ({"upper": nan}, "no bracket"),
        ({"width": 0.02}, "wide, not 0.5 %"),
        ({"width": nan}, "wide, not 0.5 %"),
        ({"width": -0.1}, "wide, not 0.5 %"),
        ({"status": "time limit", "why": "stopped after 1 s"}, "stopped after 1 s"),
    ],
)
def test_a_bracket_that_is_none_is_found(strip, values, words):
    found = answer(asked("opposed-punches:h-1", "bracket"), changed(strip, **values))
    assert found.verdict == FAIL
    assert words in found.why


def test_straight_edges_say_nothing_unless_the_case_knows_what_they_do(strip):
    discrete = changed(strip, rigor="discrete")
    question = asked("opposed-punches:h-1", "bracket")
    assert answer(question, discrete).verdict == SKIPPED
    for below, verdict in ((0.006, FAIL), (0.02, PASS)):
        fields = {
            "reference": planted(2.04),
            "bracket": Bracketing(below=below, reason="planted"),
        }
        found = answer(asked("opposed-punches:h-1", "bracket", **fields), discrete)
        assert found.verdict == verdict, found.why


def broken(strip, mesh, **fields):
    """Evidence in which one mesh has something else."""
    (outcome,) = strip.outcomes.values()
    shares = [
        replace(one, **{name: change(one) for name, change in fields.items()})
        if one.mesh == mesh
        else one
        for one in unpacked_shares(outcome.evidence.arrays)
    ]
    return with_arrays(strip, packed_shares(shares))


def with_arrays(strip, arrays):
    ((key, outcome),) = strip.outcomes.items()
    return Finished({key: replace(outcome, evidence=replace(outcome.evidence, arrays=arrays))})


def one_more(size):
    def change(one):
        shares = one.shares.copy()
        shares[0] += size * (one.upper - one.lower)
        return shares

    return change


def exchanged(one):
    """As much off one share as is put onto another: the sum stays."""
    shares = one.shares.copy()
    shares[:2] = [shares[0] + shares[1] + 1e-7, -1e-7]
    return shares


@pytest.mark.parametrize("mesh", ["uniform", "irregular", "upper", "lower"])
def test_a_broken_share_is_found(strip, mesh):
    gap = asked("opposed-punches:h-1", "gap")
    for size, verdict in ((9e-6, PASS), (1.1e-5, FAIL), (-1.1e-5, FAIL), (nan, FAIL)):
        found = answer(gap, broken(strip, mesh, shares=one_more(size)))
        assert found.verdict == verdict, found.why
        assert f"the worst {mesh}" in found.why
    found = answer(gap, broken(strip, mesh, shares=exchanged))
    assert found.verdict == FAIL, found.why
    assert found.measured < 1e-5
    wrong = answer(gap, broken(strip, mesh, lower=lambda one: one.lower * (1 + 1e-4)))
    assert wrong.verdict == FAIL


def test_evidence_that_is_none_is_found(strip):
    gap = asked("opposed-punches:h-1", "gap")
    (outcome,) = strip.outcomes.values()
    some = [one for one in unpacked_shares(outcome.evidence.arrays) if one.mesh != "lower"]
    cut = [replace(one, shares=one.shares[1:]) for one in some]
    for arrays, words in (
        (b"", "no bracket"),
        (b"PK\x03\x04", "no bracket"),
        (packed_shares(some), "no gap of the mesh of the lower bound"),
        (packed_shares(cut), "shares of another mesh"),
    ):
        found = answer(gap, with_arrays(strip, arrays))
        assert found.verdict == FAIL
        assert words in found.why


def pushed(**parameters):
    stated = STRIP.build(**parameters)
    at = replace(stated, reference_loads=[la.PointForce("strip", (0, 1), (0, -1))])
    return replace(at, bodies=stated.bodies)


def test_what_no_lower_bound_can_state_is_skipped_with_the_reason():
    for check in ("bracket", "gap"):
        question = asked("opposed-punches:h-1", check, build=pushed)
        found = answer(question, solved(question))
        assert found.verdict == SKIPPED, found.why
        assert "point force; spread it over an edge" in found.why


def test_limits_that_cannot_be_are_a_failure_not_a_skip():
    few = asked("opposed-punches:h-1", "bracket", bracket=Bracketing(max_elements=3))
    found = answer(few, solved(few))
    assert found.verdict == FAIL
    assert "raise it, or start coarser" in found.why
    early = asked("opposed-punches:h-1", "bracket", bracket=Bracketing(0.004, max_elements=400))
    found = answer(early, solved(early))
    assert found.verdict == FAIL
    assert "`max_elements`" in found.why


def with_strip(**fields):
    """The catalogue with other fields of the strip."""
    cases = {**catalogue(), STRIP.id: replace(STRIP, **fields)}
    return Catalogue(cases, dict.fromkeys(cases, "lacore"))


def wrong(**parameters):
    """Far enough for the bracket, inside of the band of the coarse mesh."""
    return Reference(2.1, "planted", "wrong", "exact")


@pytest.mark.slow
def test_a_reference_outside_its_bracket_is_exit_code_1(tmp_path, monkeypatch):
    monkeypatch.setattr(plugins, "catalogue", lambda: with_strip(reference=wrong, order=None))
    command = ["verify", "opposed-punches:h-1", "--backends", "clarabel", "--meshes", "coarse"]
    result = lacore(*command, "--out", tmp_path, "--json")
    assert result.exit_code == 1
    document = json.loads(result.stdout)
    assert [found["check"] for found in document["checks"] if found["verdict"] == FAIL] == [
        "bracket"
    ]
    shown = lacore(*command, "--out", tmp_path, "--full")  # as stored
    assert shown.exit_code == 1
    assert "FAIL bracket: opposed-punches:h-1 coarse clarabel bracket: [1.99" in shown.stdout


# ---- where it is shown


def test_a_comparison_and_its_report_show_the_bracket_beside_the_reference(tmp_path, monkeypatch):
    known = with_strip(bracket=Bracketing(0.04))
    monkeypatch.setattr(plugins, "catalogue", lambda: known)
    command = ["compare", "opposed-punches:h-1", "--backends", "clarabel", "--meshes", "coarse"]
    options = ["--couplings", "certified,bracket", "--out", tmp_path, "--full"]
    result = lacore(*command, *options)
    assert result.exit_code == 0, result.output
    assert re.search(r"1\.9\d+ <= load factor <= 2\.\d+, [0-4]\.\d+ % wide", result.stdout)
    assert "bracket              " not in result.stdout.partition("couplings, where")[2]
    page = (tmp_path / "cases" / "opposed-punches.html").read_text(encoding="utf-8")
    assert "Lower and upper bounds" in page
    assert "Bracket of h-1: contributions of the elements to the gap" in page
    assert "cannot be drawn" not in page
    assert "% at N = 32." in page  # the allowed error is that of the solve, not of the bracket
    table = load_results(tmp_path).set_index("coupling")
    assert table.loc["bracket", "lower"] <= 2.0 <= table.loc["bracket", "upper"]
    assert table.loc["certified", "upper"] == table.loc["certified", "load_factor"]


def test_what_is_stored_but_no_bracket_is_said_on_the_page(strip):
    (outcome,) = with_arrays(strip, b"nonsense").outcomes.values()
    with pytest.raises(ValueError, match="no bracket"):
        stored_shares(outcome)
    (subject,) = brackets([outcome], 1)
    assert "cannot be drawn from the stored results" in painted(subject).lead
    assert widths_chart([outcome]) is not None  # the history is another part of what is stored


def test_widths_are_told_of_both_meshes_together(strip):
    (outcome,) = strip.outcomes.values()
    found = widths(outcome)
    assert found["n_elements"].is_monotonic_increasing
    both = outcome.row.n_elements + outcome.row.n_elements_lower
    assert found["n_elements"].iloc[-1] >= both / 2
    assert found["width"].iloc[-1] == outcome.row.width


@pytest.mark.slow
def test_adaptive_refinement_closes_in_faster_than_uniform_one():
    """Widths as N**-p (T26): 0.97 and 0.466 +- 0.016 when this was measured."""
    case, (variant,) = find("prandtl-punch:smooth")
    uniform = []
    for n in (4, 8, 12, 16):
        size = {"nx": 2 * n, "ny": n, "ratio_x": 1.0, "ratio_y": 1.0}
        stated = case.problem_of(size, variant.parameters)
        found = la.lower_bound(stated).load_factor, la.upper_bound(stated).load_factor
        uniform.append((8 * n**2, width(*found)))
    plain = fit_slope(*np.array(uniform).T)
    assert plain.slope == pytest.approx(-0.47, abs=0.05)
    question = asked("prandtl-punch:smooth", "bracket")
    (outcome,) = solved(question).outcomes.values()
    close = widths(outcome).query("width < 0.05")
    adaptive = np.polyfit(np.log(close["n_elements"]), np.log(close["width"]), 1)[0]
    assert adaptive < -0.8
    drawing = widths_chart([outcome])
    assert "smooth: slope" in drawing.chart.summary
