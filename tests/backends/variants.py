"""The case variants that backends are compared on: all; of every third case one is fast."""

import pytest

from lacore_verification.catalogue.catalogue import catalogue


def _associated(variant):
    """Whether soil dilates by the angle of its friction: no backend alone knows another one."""
    given = variant.parameters
    return given.get("dilation", given.get("angle")) == given.get("angle")


def _variants(surfaces):
    """Of cases whose strength depends on pressure, or not, as parameters of a test."""
    # Rigid bodies have no meshes: test_walls and the conformance suite.
    # Flow that is not associated takes a loop: tests/lacore/coupling/test_soils.py.
    cases = [
        case
        for case in catalogue().values()
        if "coarse" in case.meshes and "not associated" not in case.tags
    ]
    return [
        pytest.param(
            case,
            variant,
            id=f"{case.id}-{variant.name}",
            marks=[pytest.mark.slow] if number or place % 3 else [],
        )
        for place, case in enumerate(case for case in cases if case.surfaces == surfaces)
        for number, variant in enumerate(filter(_associated, case.variants))
    ]


METALS = _variants(surfaces=False)
"""For every backend."""
SOILS = _variants(surfaces=True)
"""For those that take surfaces."""
VARIANTS = METALS + SOILS
"""For those that take both."""


def require_fit(variant, backend):
    """Skip what a case says that a backend cannot do."""
    why = variant.unfit.get(backend.partition(":")[0])
    if why:
        pytest.skip(why)
