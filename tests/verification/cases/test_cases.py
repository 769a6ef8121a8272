"""Every case builds, is told about, and holds for the exact backend; refinement behaves."""

from math import isnan

import numpy as np
import pytest

import lacore as la
from lacore.program.state import contact_force
from lacore_verification.case.band import BRACKET
from lacore_verification.catalogue.catalogue import catalogue, find
from lacore_verification.harness.perform.one_run import run_here
from lacore_verification.harness.verdicts.allowed import Allowed, allowed_values
from lacore_verification.harness.verdicts.words import NO_REFERENCE, PASS
from lacore_verification.harness.verify import answer, ask, finish, runs_of

CASES = list(catalogue().values())
VARIANTS = [(case, variant) for case in CASES if not case.on_demand for variant in case.variants]
MESHED = [(case, variant) for case, variant in VARIANTS if case.meshed]


def name_of(part):
    return getattr(part, "id", None) or getattr(part, "name", "")


def test_catalogue_holds_the_cases_of_the_references():
    assert {
        "biaxial",
        "block-between-walls",
        "block-incline",
        "block-incline-horizontal",
        "block-incline-vertical",
        "block-slide",
        "block-topple",
        "bonded-layers",
        "cavity-cylinder",
        "cavity-expansion",
        "cavity-sphere",
        "centre-crack",
        "circular-footing",
        "circular-footing-tresca",
        "compression-free",
        "deformable-block",
        "earth-pressure",
        "hardening-cylinder",
        "hardening-sphere",
        "layer-rough",
        "masonry-panel",
        "mortar-incline",
        "no-tension-cut",
        "notched-strip",
        "opposed-punches",
        "plate-hole",
        "platens-coulomb",
        "platens-square",
        "prandtl-punch",
        "pulled-under-stop",
        "rectangular-footing",
        "punch-indentation",
        "ring-compression",
        "rough-cube",
        "rough-platens-2",
        "shear-patch",
        "slab-punch",
        "square-footing",
        "stack-n",
        "stack-two",
        "strip-footing",
        "strip-footing-gamma",
        "symmetric-wedge",
        "tension",
        "thick-cylinder",
        "thick-sphere",
        "thick-sphere-solid",
        "torsion-round",
        "torsion-square",
        "upsetting",
        "vertical-cut",
        "vertical-cut-finite",
        "vertical-cut-phi",
        "wall-1",
        "wall-2",
        "wall-3",
        "wedge-extraction",
        "wedge-in-walls",
    } <= set(catalogue())


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.id)
def test_case_explains_itself(case):
    assert any(line.startswith("   ") for line in case.explanation.splitlines()), "no sketch"
    assert max(map(len, case.hand_calculation.splitlines())) <= 72
    names = [variant.name for variant in case.variants]
    assert len(set(names)) == len(names)
    for variant in case.variants:
        assert set(case.levels(variant)) <= set(case.meshes)
        reference = case.reference_of(variant)
        if not isnan(reference.value):
            assert reference.low <= reference.high
            assert reference.complete or reference.associated is not None
        assert reference.formula
        assert reference.source
        assert case.band_of(variant, 1000).reason
        if case.valid is not None:
            assert case.valid.__doc__
            assert case.valid(**variant.parameters)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.id)
def test_a_case_says_whether_its_strength_depends_on_pressure(case):
    """What comparisons choose backends by is what its materials are."""
    pressed = [
        region.form.surfaces
        for variant in case.variants
        for body in case.problem(variant, next(iter(case.meshes))).bodies.values()
        if isinstance(body, la.Body)
        for region in body.regions
    ]
    assert case.surfaces == any(pressed)


STATIC = [case for case in CASES if case.meshed and case.path is None]


@pytest.mark.parametrize("case", STATIC, ids=lambda case: case.id)
def test_meshes_have_their_sizes(case):
    variant = case.variants[0]
    first = {name: next(iter(case.problem(variant, name).bodies.values())) for name in case.meshes}
    sizes = {name: body.mesh.nelements for name, body in first.items()}
    if first["coarse"].dimension == 3:  # no fine ones: every exact backend is asked
        assert sizes["coarse"] <= 100
        assert 90 <= sizes["medium"] <= 800
        return
    assert sizes["coarse"] <= 40
    assert 550 <= sizes["medium"] <= 610
    assert 4500 <= sizes["fine"] <= 5000


def checked(questions):
    return finish(questions, run_here(runs_of(questions)))


def coarse(case, variant):
    """All that is asked of a variant on its coarse mesh; asked in a test, it builds the problem."""
    return ask([f"{case.id}:{variant.name}"], ["clarabel"], ["coarse"])


def marked(case, variant):
    """Of each case one is fast, of paths, which are tens of solves, of one case."""
    more = variant is not case.variants[0] or (case.path is not None and case.id != "tension")
    marks = [pytest.mark.slow] if more else []
    return pytest.param(case, variant, marks=marks, id=f"{case.id}:{variant.name}")


@pytest.mark.parametrize(("case", "variant"), [marked(*one) for one in VARIANTS])
def test_exact_backend_passes_on_coarse(case, variant):
    """The quick part of `pytest verification`."""
    questions = [
        question
        for question in coarse(case, variant)
        if question.check not in ("order", "steps") and question.coupling != BRACKET
    ]
    finished = checked(questions)
    for question in questions:
        found = answer(question, finished)
        assert found.verdict in (PASS, NO_REFERENCE), f"{question.name}: {found.why}"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("case", "variant"), [one for one in VARIANTS if one[0].path is not None], ids=name_of
)
def test_errors_of_paths_fall_with_their_steps(case, variant):
    for question in coarse(case, variant):
        if question.check == "steps":
            found = answer(question, checked([question]))
            assert found.verdict == PASS, found.why


BEYOND = {("no-tension-cut", "fine")}  # the case says why no solver comes to the bar there


@pytest.mark.slow
@pytest.mark.parametrize(("case", "variant"), MESHED, ids=name_of)
def test_exact_backend_passes_on_medium_and_fine(case, variant):
    """Beyond `pytest verification`: levels that a variant does not run by itself."""
    name = f"{case.id}:{variant.name}"
    levels = [level for level in ("medium", "fine") if (case.id, level) not in BEYOND]
    questions = ask([name], ["clarabel"], levels)
    questions = [q for q in questions if q.check != "order" and q.coupling != BRACKET]
    finished = checked(questions)
    for question in questions:
        found = answer(question, finished)
        assert found.verdict == PASS, found.why


@pytest.mark.slow
@pytest.mark.parametrize(("case", "variant"), MESHED, ids=name_of)
def test_brackets_enclose_the_reference_and_their_gaps_add_up(case, variant):
    questions = [question for question in coarse(case, variant) if question.coupling == BRACKET]
    if not questions:
        pytest.skip("it has none")
    finished = checked(questions)
    for question in questions:
        found = answer(question, finished)
        assert found.verdict == PASS, found.why


ORDERED = [(c, v, o) for c in CASES for v in c.variants if (o := c.order_of(v)) is not None]


def test_orders_are_expected_where_the_reference_is_good_enough():
    assert {f"{case.id}:{variant.name}" for case, variant, _ in ORDERED} == {
        "cavity-cylinder:phi-30",
        "cavity-sphere:phi-30",
        "centre-crack:plane-strain",
        "centre-crack:plane-stress",
        "no-tension-cut:phi-0",
        "no-tension-cut:phi-20",
        "masonry-panel:guided",
        "notched-strip:half",
        "opposed-punches:h-1",
        "opposed-punches:h-2",
        "opposed-punches:h-4",
        "platens-coulomb:mu-0.3",
        "platens-square:mu-0.1",
        "platens-square:mu-0.5",
        "prandtl-punch:rough",
        "prandtl-punch:smooth",
        "rough-platens-2:sticking",
        "strip-footing:phi-20",
        "thick-cylinder-slice:diagonal",
        "thick-cylinder:burst",
        "thick-sphere:quadrilaterals",
        "vertical-cut:cut",
    }


def test_nan_is_no_order():
    order = ORDERED[0][-1]
    assert order.holds(order.expected)
    assert not order.holds(float("nan"))


def test_allowed_values_widen_by_half_width_and_band():
    case, (variant,) = find("platens-coulomb:mu-0.1")
    reference = case.reference(**variant.parameters)
    band = case.band(1000, **variant.parameters)
    allowed = allowed_values(reference, band)
    assert allowed.low == pytest.approx(2.194 * (1 - band.below))
    assert allowed.high == pytest.approx(2.200 * (1 + band.above))


@pytest.mark.parametrize("value", [float("nan"), float("inf"), 0.9, 1.2])
def test_nothing_outside_is_allowed(value):
    assert not Allowed(1.0, 1.1).holds(value)


LEVELS = [
    pytest.param(
        case,
        variant,
        mesh,
        marks=[pytest.mark.slow] if number or variant is not case.variants[0] else [],
        id=f"{case.id}-{variant.name}-{mesh}",
    )
    for case, variant in MESHED
    for number, mesh in enumerate(case.levels(variant))
]


@pytest.mark.parametrize(("case", "variant", "mesh"), LEVELS)
def test_reactions_sum_to_the_loads(case, variant, mesh):
    """To 1e-8 of the load: ten times what a solve to 1e-10 leaves, 1.7e-9 at most."""
    discretisation = la.discretise(case.problem(variant, mesh))
    state = la.solve(discretisation, throw=True)
    full = discretisation.full
    loads = state.load_factor * full.reference_load + full.dead_load
    outer = contact_force(full, state.point) + loads
    dofs = np.concatenate([body.dofs for body in discretisation.continua.values()], axis=1)
    held = state.support_reactions.query("body in @discretisation.continua.keys()")
    held = (
        held[[f"force_{axis}" for axis in "xyz"[: len(dofs)]]].to_numpy().sum(axis=0)
    )  # blocks have rollers of their own
    size = np.abs(state.load_factor * full.reference_load).sum() + np.abs(full.dead_load).sum()
    # Around an axis forces along r are carried by the hoop stress, and have no sum.
    round_ones = any(body.body.axisymmetric for body in discretisation.continua.values())
    sums = (outer[dofs].sum(axis=1) + held)[1 if round_ones else 0 :]
    assert np.abs(sums).max() <= 1e-8 * size, mesh
