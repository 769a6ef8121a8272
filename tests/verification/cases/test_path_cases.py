"""What paths must come to, against the exact ones (T33)."""

import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import lacore as la
from lacore.model.materials.hardening import HardeningLaw, Linear, Perfect, Voce
from lacore.numerics.arrays import Floats
from lacore.paths.ending import Ending
from lacore_verification.case import Band, Reference
from lacore_verification.case.following import Following
from lacore_verification.cases.shared.exact_paths import cylinder, peak, pressure
from lacore_verification.catalogue.catalogue import find
from lacore_verification.catalogue.checks import check
from lacore_verification.harness.analysis.stepping import step_orders
from lacore_verification.harness.campaigns.comparison import plan
from lacore_verification.harness.campaigns.sweep import plan as sweep
from lacore_verification.harness.perform.one_run import run_here
from lacore_verification.harness.verdicts.path import judge_path
from lacore_verification.harness.verdicts.words import FAIL, NO_REFERENCE, NO_RESULT, PASS
from lacore_verification.report.blocks import Gallery
from lacore_verification.report.page import comparison_report, results_frame
from lacore_verification.report.path import path_chart
from lacore_verification.report.studies.convergence import steps_section
from lacore_verification.runs.row import Row
from tests.shares import one_in

LAWS = {
    "perfect": Perfect(1.0),
    "linear": Linear(1.0, 3.0),
    "voce": Voce(1.0, 3.0, 2 * np.sqrt(3)),
}


def tube(law: HardeningLaw, n: int = 8) -> la.Problem:
    """A slice of a thick tube, radii 1 and 2."""
    mesh = la.meshes.quadrilaterals((1, 2), (0, 0.25), n, 1, grade_x=(1.0, 2.0))
    return la.Problem(
        bodies={"tube": la.Body(mesh, la.VonMises(hardening=law), "axisymmetric", "q2")},
        supports=[la.Fix("tube", "bottom", "y"), la.Fix("tube", "top", "y")],
        reference_loads=[la.Pressure("tube", "left")],
    )


def errors(path: la.Path, law: HardeningLaw) -> Floats:
    """Relative, of the pressure at every step."""
    exact = [pressure(cylinder(law), 1 + at) for at in path.history["travel"]]
    return np.asarray(path.history["load_factor"] / exact - 1)


@cache
def followed(name: str) -> la.Path:
    """The tube in 20 steps."""
    bore = la.PointTravel("tube", (1.0, 0.0), (1.0, 0.0))
    return la.sequential(tube(LAWS[name]), 0.5, 20, control=bore)


@pytest.mark.parametrize("name", one_in(3, ["voce", "perfect", "linear"]))
def test_leapfrog_is_within_1e_4_of_the_exact_pressure_at_every_one_of_20_steps(name: str) -> None:
    path = followed(name)
    assert path.status is Ending.REACHED
    assert len(path.history) == 20
    assert np.abs(errors(path, LAWS[name])).max() <= 1e-4
    assert path.history["solves"].sum() == 21  # one a step, and one at the beginning


@pytest.mark.parametrize("name", one_in(2, ["voce", "linear"]))
def test_leapfrog_finds_the_peak_of_the_pressure(name: str) -> None:
    """20 steps; the radius is that of a cubic through four of them."""
    exact = peak(cylinder(LAWS[name]))
    events = followed(name).events
    (found,) = events[events["kind"] == "peak load"].itertuples()
    assert float(found.what.split()[-1]) == pytest.approx(exact.pressure, rel=1e-4)
    assert 1 + found.travel == pytest.approx(exact.radius, rel=1e-4)


def ran(name: str, **settings: object) -> Row:
    """The row of a variant with clarabel."""
    (asked,) = plan([name], ["clarabel"], ["coarse"])
    parameters = {**asked.variant.parameters, **settings}
    (outcome,) = run_here([replace(asked, variant=replace(asked.variant, parameters=parameters))])
    return outcome.row


def test_a_path_leaves_its_worst_error_its_end_and_its_history() -> None:
    (run,) = plan(["hardening-cylinder:perfect"], ["clarabel"])
    (outcome,) = run_here([run])
    row, history = outcome.row, outcome.evidence.history
    assert (row.verdict, row.ending, row.rigor) == (PASS, "reached", "discrete")
    assert len(history) == 20
    worst = max(abs(step["load_factor"] / step["exact"] - 1) for step in history)
    assert row.path_error == pytest.approx(worst)
    assert row.error == pytest.approx(history[-1]["load_factor"] / row.reference - 1)
    assert outcome.record()["param_steps"] == 20


def test_a_path_that_ends_otherwise_fails_by_name() -> None:
    (run,) = plan(["punch-indentation:perfect-rough"], ["clarabel"])
    (outcome,) = run_here([run])
    stated = run.case.following_of(run.variant)
    reference, band = run.case.reference_of(run.variant), run.case.band_of(run.variant, 32)
    assert outcome.row.verdict == NO_REFERENCE
    assert outcome.row.ending == "inversion"
    whole = replace(stated, ending=Ending.REACHED)
    verdict, why = judge_path(outcome.row, whole, reference, band)
    assert verdict == FAIL
    assert "inversion" in why
    assert judge_path(outcome.row, whole, reference, band, insist=False)[0] == NO_RESULT


def test_what_is_wrong_with_a_path_is_said() -> None:
    (run,) = plan(["upsetting:smooth-voce"], ["clarabel"])
    (outcome,) = run_here([run])
    stated = run.case.following_of(run.variant)
    reference, band = run.case.reference_of(run.variant), run.case.band_of(run.variant, 32)
    for planted, word in (
        ({"path_error": 1e-7}, "largest error"),
        ({"load_factor": 1.00001 * outcome.row.load_factor}, "last load"),
        ({"volume_change": 1e-9}, "volume"),
        ({"reading": 1e-3}, "spread"),
        ({"start": 1.2}, "begins"),
    ):
        verdict, why = judge_path(replace(outcome.row, **planted), stated, reference, band)
        assert verdict == FAIL
        assert word in why


def test_explicit_steps_do_not_keep_a_bar_uniform() -> None:
    explicit, leapfrog = ran("tension:linear-1-explicit"), ran("tension:linear-1")
    assert explicit.reading > 0.01
    assert leapfrog.reading <= 1e-4


@pytest.mark.slow
def test_the_bore_of_a_ring_tells_the_friction() -> None:
    bores = [ran("ring-compression:mu-0.05", mu=mu).reading for mu in (0.02, 0.05, 0.1, 0.2)]
    assert sorted(bores, reverse=True) == bores
    assert bores[0] > 1.2
    assert bores[-1] < 0.8


def test_sweeps_vary_steps_and_scheme_like_parameters() -> None:
    runs = sweep(["hardening-cylinder:perfect"], ["steps=5:40:4:log", "scheme=leapfrog,explicit"])
    asked = {(run.parameters["steps"], run.parameters["scheme"]) for run in runs}
    assert asked == {(n, s) for n in (5, 10, 20, 40) for s in ("leapfrog", "explicit")}


@pytest.mark.parametrize(
    ("axis", "said"),
    [("scheme=leapfrg", "did you mean 'leapfrog'?"), ("steps=0,4", "steps = 0")],
)
def test_a_sweep_refuses_steps_that_there_are_not(axis: str, said: str) -> None:
    with pytest.raises(la.InputError, match=re.escape(said)):
        sweep(["upsetting"], [axis])


@pytest.mark.slow
def test_orders_of_a_sweep_are_those_of_the_schemes() -> None:
    runs = sweep(["hardening-cylinder:perfect"], ["steps=5,7,10", "scheme=leapfrog,explicit"])
    results = results_frame([*run_here(run for run in runs if run.backend == "clarabel")])
    fits = step_orders(results).set_index("param_scheme")
    assert fits["expected"].to_dict() == {"leapfrog": 2.0, "explicit": 1.0}
    assert np.abs(fits["order"] - fits["expected"]).max() <= 0.2  # 5 steps are few
    section = steps_section(results)
    assert section is not None
    assert "steps" in section.title
    assert steps_section(results[results["param_steps"] == 5]) is None


def test_the_page_of_a_path_shows_its_loads_on_the_exact_ones() -> None:
    outcomes = [*run_here(plan(["tension:linear-1"], ["clarabel"]))]
    case = outcomes[0].run.case
    drawing = path_chart(case, outcomes)
    assert drawing is not None
    assert len(drawing.chart.tips) == 10
    assert all("exact" in tip.text for tip in drawing.chart.tips)
    assert path_chart(case, []) is None
    page = comparison_report(outcomes, {"machine": "one"}, {}).pages["cases/tension.html"]
    (results, _) = page.sections
    (gallery,) = [block for block in results.blocks if isinstance(block, Gallery)]
    assert "tension-paths" in {item.name for item in gallery.items}


def planted(law: str, steps: int, scheme: str) -> Following:
    """That of the tube, with something wrong in it, named by the law."""
    right = find("hardening-cylinder:perfect")[0].path
    assert right is not None
    stated: Following = right(law="perfect", steps=steps, scheme=scheme)
    wrong = {"steps": {"steps": 7}, "ladder": {"ladder": (5, 10)}, "travel": {"travel": 0.0}}
    return replace(stated, **wrong[law])  # type: ignore[arg-type]


@pytest.mark.parametrize("field", ["steps", "ladder", "travel"])
def test_a_path_that_cannot_be_right_is_refused(field: str) -> None:
    case, (variant,) = find("hardening-cylinder:perfect")
    wrong = replace(variant, parameters={**variant.parameters, "law": field})
    with pytest.raises(la.InputError, match=field):
        check(
            replace(
                case,
                path=planted,
                reference=any_reference,
                band=any_band,
                variants=(wrong,),
            )
        )


def any_reference(law: str, steps: int, scheme: str) -> Reference:
    """Whatever the law."""
    return Reference(1.0, "1", "nobody", "exact")


def any_band(elements: int, law: str, steps: int, scheme: str) -> Band:
    """Whatever the law."""
    return Band(0.0, 0.0, "none")
