"""Regions without cohesion or tension, and negligible strengths for proofs (T45, T48)."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from lacore.model.bodies.continuum.regions.region import Region
from lacore.numerics.arrays import Floats
from lacore.reporting.text import Term, Text, text

if TYPE_CHECKING:
    from lacore.model.bodies.continuum.body import Body

# by the dead load and the size of a body: negligible for results, sufficient for proofs
_LENT = 1e-5


def strengthless(body: "Body") -> Iterator[Region]:
    """Yield the regions of a body without strength at zero pressure somewhere."""
    for region in body.regions:
        if region.form.surfaces and not region.least_strength > 0:
            yield region


def next_to_none(body: "Body", dead_load: Floats) -> float:
    """Return a strength at zero pressure that is negligible, but sufficient for proofs, Pa.

    Args:
        body: body with regions of smaller strength.
        dead_load: dead load on all unknowns, N/m; for axisymmetric and three-dimensional bodies N.
    """
    area = body.size ** (2 if body.axisymmetric or body.dimension == 3 else 1)
    return _LENT * (float(np.abs(dead_load).sum()) / area or largest_strength(body) or 0.1)


def lend(body: "Body", dead_load: Floats) -> Text:
    """Return advice on the strength for regions without any; see `next_to_none`."""
    least = f"{next_to_none(body, dead_load):.1e}"
    whole = f"{least} Pa (Rankine for NoTension)"
    with_argument = Term(f", or `lent_cohesion={least}`", "")
    return text("give it a negligible cohesion or tensile strength, {}{}", whole, with_argument)


def hardly_any(body: "Body", dead_load: Floats) -> float | None:
    """Return the smallest strength at zero pressure, Pa, if it is too small for proofs.

    The arguments are those of `next_to_none`; None if it is sufficient.
    """
    strengths = [region.least_strength for region in body.regions if region.form.surfaces]
    least = min(strengths, default=np.inf)
    return least if least < next_to_none(body, dead_load) else None


def largest_strength(body: "Body") -> float:
    """Return the largest strength of its regions without friction, Pa, including crushing."""
    return max(
        float(np.max(region.seen(own)))
        for region in body.regions
        for own in (region.form.bound, *(one.strength for one in region.form.surfaces))
    )
