"""Bounds of all cases of tetrahedra, judged from mesh, stresses and velocities alone."""

import numpy as np
import pytest

import lacore as la
from lacore_verification.catalogue.catalogue import catalogue
from tests.lacore.solid_statements import lower_proof, upper_proof

SOLIDS = [
    pytest.param(case, variant, id=f"{case.id}-{variant.name}")
    for case in catalogue().values()
    for variant in case.variants
    if {"space", "continuum"} <= set(case.tags) and "curved boundary" not in case.tags
]


def test_there_are_some():
    assert len({own.values[0].id for own in SOLIDS}) >= 8


@pytest.mark.parametrize(("case", "variant"), SOLIDS)
def test_what_is_proven_is_proven_by_fields_alone(case, variant):
    problem = case.build(**case.meshes["coarse"], **variant.parameters)
    low, high = (ask(problem, "auto") for ask in (la.lower_bound, la.upper_bound))
    below, carried = lower_proof(low)
    # Strengths, sizes and tractions are of order one: sums of a few terms of round-off.
    assert max(below.residuals.values()) <= 1e-12, below.residuals
    assert carried == pytest.approx(low.load_factor, rel=1e-12)
    above, power = upper_proof(high)
    fastest = np.abs(high.velocity).max()
    assert max(above.residuals.values()) <= 1e-11 * fastest, above.residuals
    assert power == pytest.approx(1, rel=1e-11)
    assert above.dissipation <= high.load_factor * (1 + 1e-12)
    assert low.load_factor <= high.load_factor * (1 + 1e-9)


@pytest.mark.slow
@pytest.mark.parametrize(("case", "variant"), [own for own in SOLIDS if own.values[0].bracket])
def test_brackets_are_proven_by_fields_alone(case, variant):
    """As narrow as the catalogue asks for them."""
    problem = case.build(**case.meshes["coarse"], **variant.parameters)
    found = la.bracket(problem, case.bracket.target_width, time_limit=200.0, jobs=1)
    _proven(found)


@pytest.mark.slow
def test_a_rough_square_footing_is_proven_by_fields_alone():
    case = catalogue()["square-footing"]
    problem = case.build(n=4, rough=True)
    found = la.bracket(problem, 0.06, time_limit=500.0, backend="interior_point", jobs=1)
    assert found.width <= 0.06
    _proven(found)
    known = case.reference(rough=True)
    assert found.lower <= known.up_to
    assert found.upper >= known.value


def _proven(found):
    below, carried = lower_proof(found.lower_bound)
    assert carried == pytest.approx(found.lower, rel=1e-12)
    # Per the largest stress; divided by sizes of elements of a hundredth inside.
    size = max(np.abs(own).max() for own in found.lower_bound.stress.values())
    inside = below.residuals.pop("inside")
    assert inside <= 1e-10 * size
    assert max(below.residuals.values()) <= 1e-12 * size, below.residuals
    above, power = upper_proof(found.upper_bound)
    rates = np.abs(found.upper_bound.velocity).max() / 0.01
    assert max(above.residuals.values()) <= 1e-12 * rates, above.residuals
    assert power == pytest.approx(1, rel=1e-10)
    assert above.dissipation <= found.upper * (1 + 1e-12)
