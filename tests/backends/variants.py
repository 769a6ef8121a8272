"""The case variants that backends are compared on: all; of every third case one is fast."""

import pytest

from verification.catalogue.catalogue import catalogue

# Rigid bodies have no meshes: test_walls and the conformance suite.
CASES = [case for case in catalogue().values() if "coarse" in case.meshes]
VARIANTS = [
    pytest.param(
        case,
        variant,
        id=f"{case.id}-{variant.name}",
        marks=[pytest.mark.slow] if number or place % 3 else [],
    )
    for place, case in enumerate(CASES)
    for number, variant in enumerate(case.variants)
]
