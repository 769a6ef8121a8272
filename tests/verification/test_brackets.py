"""Brackets contain the references of every case with deformable bodies.

Coulomb friction is made associated, which carries no less.
"""

from dataclasses import replace
from math import inf

import pytest

import lacore as la
from verification.catalogue import catalogue

RUNS = [
    (case, variant) for case in catalogue().values() if case.meshed for variant in case.variants
]


@pytest.mark.slow
@pytest.mark.parametrize("run", RUNS, ids=lambda run: f"{run[0].id}:{run[1].name}")
def test_bracket(run):
    case, variant = run
    reference = case.reference_of(variant)
    stated = case.problem(variant, case.levels(variant)[0])
    coulomb = any(pair.law.terms().coefficient > 0 for pair in stated.interfaces)
    high = reference.high
    if coulomb:
        stated = replace(stated, interfaces=[associated(pair) for pair in stated.interfaces])
        high = inf if reference.associated is None else reference.associated
    found = la.bracket(stated, 0.01, max_elements=6000)
    assert found.status in (la.Ending.REACHED, la.Ending.MAX_ELEMENTS)
    if not found.strict:
        pytest.skip(f"no bounds of the continuum: width {found.width:.2%}")
    assert found.lower <= high * (1 + 1e-9)
    assert found.upper >= reference.low * (1 - 1e-9)
    identity = found.gaps
    # Where bounds meet, what is left is round-off of the load factor.
    gap = identity.upper - identity.lower
    assert identity.total == pytest.approx(gap, rel=1e-5, abs=1e-9 * abs(identity.upper))
    assert identity.least >= -1e-9


def associated(pair):
    coefficient = pair.law.terms().coefficient
    if coefficient == 0:
        return pair
    return replace(pair, friction=la.Coulomb(coefficient, associated=True))
