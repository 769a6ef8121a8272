"""The case variants that backends are compared on: of each case one in the fast tests, else all."""

import pytest

from verification.catalogue.catalogue import catalogue

VARIANTS = [
    pytest.param(
        case,
        variant,
        id=f"{case.id}-{variant.name}",
        marks=[pytest.mark.slow] if number else [],
    )
    for case in catalogue().values()
    if "coarse" in case.meshes  # rigid bodies: test_walls and the conformance suite
    for number, variant in enumerate(case.variants)
]
