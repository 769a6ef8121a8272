"""Bounds of all cases of tetrahedra, judged from mesh, stresses and velocities alone."""

import numpy as np
import pytest

import lacore as la
from tests.lacore.solid_statements import lower_proof, upper_proof
from verification.catalogue.catalogue import catalogue

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
