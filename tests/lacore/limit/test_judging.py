"""Judges of an outcome refuse what they cannot measure."""

from math import inf, nan
from types import SimpleNamespace

import pytest

from lacore.limit.judges.judging import moments_inside
from lacore.reporting.kinds import Kind
from lacore.reporting.status import Status


@pytest.mark.parametrize(
    ("excess", "refused"), [(0.0, False), (1e-3, True), (inf, True), (nan, True)]
)
def test_an_unknown_excess_of_moments_is_refused(excess, refused):
    found = list(moments_inside(SimpleNamespace(excess=excess, allowed_excess=0.0), Status.SOLVED))
    assert [own.kind for own in found] == [Kind.MOMENTS_INSIDE] * refused
