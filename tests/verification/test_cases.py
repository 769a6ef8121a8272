"""Every case builds, is told about, and holds for the exact backend; refinement behaves."""

from math import log

import numpy as np
import pytest

import lacore as la
from lacore.state import contact_force
from verification.analysis.slopes import fit_slope
from verification.assemblies import UNKNOWN
from verification.case import Allowed, allowed_values
from verification.catalogue import catalogue, find
from verification.harness import execute
from verification.judging import PASS
from verification.run import Run

CASES = list(catalogue().values())
VARIANTS = [(case, variant) for case in CASES if not case.on_demand for variant in case.variants]
MESHED = [(case, variant) for case, variant in VARIANTS if case.meshed]


def name_of(part):
    return getattr(part, "id", None) or getattr(part, "name", "")


def outcome_of(case, variant, mesh):
    (outcome,) = execute([Run(case, variant, mesh, "clarabel")])
    return outcome


def load_factor(case_id, variant_name, mesh):
    case, (variant,) = find(f"{case_id}:{variant_name}")
    return la.solve(case.problem(variant, mesh), throw=True).load_factor


def test_catalogue_holds_the_cases_of_the_references():
    assert {
        "block-between-walls",
        "block-incline",
        "block-incline-horizontal",
        "block-incline-vertical",
        "block-slide",
        "block-topple",
        "deformable-block",
        "platens-coulomb",
        "platens-square",
        "prandtl-punch",
        "pulled-under-stop",
        "shear-patch",
        "stack-n",
        "stack-two",
        "symmetric-wedge",
        "thick-cylinder",
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
        if reference is not UNKNOWN:
            assert reference.low <= reference.high
            assert reference.complete or reference.associated is not None
        assert reference.formula
        assert reference.source
        assert case.band_of(variant, 1000).reason
        if case.valid is not None:
            assert case.valid.__doc__
            assert case.valid(**variant.parameters)


@pytest.mark.parametrize("case", [case for case in CASES if case.meshed], ids=lambda case: case.id)
def test_meshes_have_their_sizes(case):
    variant = case.variants[0]
    sizes = {
        name: next(iter(case.problem(variant, name).bodies.values())).mesh.nelements
        for name in case.meshes
    }
    assert sizes["coarse"] <= 40
    assert 550 <= sizes["medium"] <= 610
    assert 4500 <= sizes["fine"] <= 5000


@pytest.mark.parametrize(("case", "variant"), VARIANTS, ids=name_of)
def test_exact_backend_passes_on_coarse(case, variant):
    outcome = outcome_of(case, variant, case.levels(variant, ["coarse"])[0])
    assert outcome.row.verdict == PASS, outcome.row.why


@pytest.mark.slow
@pytest.mark.parametrize(("case", "variant"), MESHED, ids=name_of)
def test_exact_backend_passes_on_medium_and_fine(case, variant):
    for mesh in ("medium", "fine"):
        outcome = outcome_of(case, variant, mesh)
        assert outcome.row.verdict == PASS, outcome.row.why


@pytest.mark.slow
@pytest.mark.parametrize(
    ("variant", "allowed", "order"), [("smooth", 0.002, 0.9), ("rough", 0.008, 0.55)]
)
def test_punch_converges_from_above(variant, allowed, order):
    case, _ = find("prandtl-punch")
    reference = case.reference(rough=True).value
    errors = [load_factor("prandtl-punch", variant, mesh) / reference - 1 for mesh in case.meshes]
    assert min(errors) >= 0
    assert errors[0] > errors[1] > errors[2]
    assert errors[2] <= allowed
    assert log(errors[1] / errors[2]) / log(4800 / 576) >= order


@pytest.mark.slow
def test_cylinder_converges_at_order_one():
    case, _ = find("thick-cylinder")
    reference = case.reference().value
    errors = [load_factor(case.id, "burst", mesh) / reference - 1 for mesh in case.meshes]
    assert errors[0] > errors[1] > errors[2]
    assert log(errors[1] / errors[2]) / log(4784 / 576) == pytest.approx(1.0, abs=0.15)


ORDERED = [(c, v, o) for c in CASES for v in c.variants if (o := c.order_of(v)) is not None]


def test_orders_are_expected_where_the_reference_is_good_enough():
    assert {f"{case.id}:{variant.name}" for case, variant, _ in ORDERED} == {
        "platens-coulomb:mu-0.3",
        "platens-square:mu-0.1",
        "platens-square:mu-0.5",
        "prandtl-punch:rough",
        "prandtl-punch:smooth",
        "thick-cylinder:burst",
    }


def test_nan_is_no_order():
    order = ORDERED[0][-1]
    assert order.holds(order.expected)
    assert not order.holds(float("nan"))


@pytest.mark.slow
@pytest.mark.parametrize(("case", "variant", "order"), ORDERED, ids=name_of)
def test_refinement_shows_the_expected_order(case, variant, order):
    """Over the whole ladder, in an interval of confidence no wider than the tolerance."""
    elements, errors = [], []
    reference = case.reference_of(variant).value
    for size in order.meshes:
        d = la.discretise(case.build(**size, **variant.parameters))
        elements.append(d.n_elements)
        errors.append(la.solve(d, throw=True).load_factor / reference - 1)
    fit = fit_slope(np.array(elements), np.array(errors))
    assert fit.points == len(order.meshes)
    assert order.holds(-fit.slope), fit
    assert (fit.high - fit.low) / 2 <= order.tolerance


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


@pytest.mark.parametrize(("case", "variant"), MESHED, ids=name_of)
def test_reactions_sum_to_the_loads(case, variant):
    """To 1e-8 of the load: ten times what a solve to 1e-10 leaves, 1.7e-9 at most."""
    for mesh in case.levels(variant):
        discretisation = la.discretise(case.problem(variant, mesh))
        state = la.solve(discretisation, throw=True)
        full = discretisation.full
        loads = state.load_factor * full.reference_load + full.dead_load
        outer = contact_force(full, state.point) + loads
        dofs = np.concatenate([body.dofs for body in discretisation.bodies.values()], axis=1)
        held = state.support_reactions[["force_x", "force_y"]].to_numpy().sum(axis=0)
        size = np.abs(state.load_factor * full.reference_load).sum() + np.abs(full.dead_load).sum()
        assert np.abs(outer[dofs].sum(axis=1) + held).max() <= 1e-8 * size, mesh
