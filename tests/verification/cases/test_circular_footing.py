"""Three meshes of the circular footing extrapolate to its reference."""

import pytest

import lacore as la
from lacore_verification.cases.circular_footing import CASE
from tests.shares import one_in

LADDER = [
    {"nx": 8, "ny": 4, "ratio_x": 16.0, "ratio_y": 8.0},
    {"nx": 16, "ny": 9, "ratio_x": 36.0, "ratio_y": 18.0},
    {"nx": 32, "ny": 18, "ratio_x": 72.0, "ratio_y": 36.0},
]


@pytest.mark.parametrize("variant", one_in(2, CASE.variants), ids=lambda variant: variant.name)
def test_three_meshes_extrapolate_to_the_reference(variant):
    """From above, each mesh nearer by the same ratio; the limit within 0.05 k (issue: +- 0.05)."""
    values = [
        la.solve(CASE.build(**size, **variant.parameters), throw=True).load_factor
        for size in LADDER
    ]
    first, last = values[1] - values[0], values[2] - values[1]
    assert first < last < 0
    limit = values[2] - last**2 / (last - first)  # Aitken
    reference = CASE.reference_of(variant)
    assert abs(limit - reference.value) <= reference.half_width == 0.05
