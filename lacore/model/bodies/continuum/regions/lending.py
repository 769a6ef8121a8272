"""Regions without cohesion or without tension, and what lent to them no result sees (T45, T48)."""

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from lacore.model.bodies.continuum.regions.region import Region
from lacore.numerics.arrays import Floats

if TYPE_CHECKING:
    from lacore.model.bodies.continuum.body import Body

_LENT = 1e-5  # of the dead load per size of a body: no result sees it, and proofs do


def strengthless(body: "Body") -> Iterator[Region]:
    """Regions of a body that somewhere carry nothing where nothing presses them."""
    for region in body.regions:
        if region.form.surfaces and not region.least_strength > 0:
            yield region


def next_to_none(body: "Body", dead_load: Floats) -> float:
    """Strength without pressure that no result sees and proofs do, Pa.

    Args:
        body: with regions that have less.
        dead_load: on all unknowns, N/m; of bodies of revolution and in space N.
    """
    area = body.size ** (2 if body.axisymmetric or body.dimension == 3 else 1)
    return _LENT * (float(np.abs(dead_load).sum()) / area or largest_strength(body) or 0.1)


def lend(body: "Body", dead_load: Floats) -> str:
    """What to lend regions without strength, in words; arguments as of `next_to_none`."""
    lent = f"{next_to_none(body, dead_load):.1e} Pa of cohesion or of tension"
    return f"lend it next to none, {lent} (Rankine for NoTension)"


def hardly_any(body: "Body", dead_load: Floats) -> float | None:
    """The least strength of a body without pressure, Pa, if proofs have less room than they need.

    Arguments as of `next_to_none`; None if they have enough.
    """
    strengths = [region.least_strength for region in body.regions if region.form.surfaces]
    least = min(strengths, default=np.inf)
    return least if least < next_to_none(body, dead_load) else None


def largest_strength(body: "Body") -> float:
    """The largest of the strengths of its regions that no pressure makes, Pa: also of crushing."""
    return max(
        float(np.max(region.seen(own)))
        for region in body.regions
        for own in (region.form.bound, *(one.strength for one in region.form.surfaces))
    )
