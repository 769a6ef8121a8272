"""Colours of the regions of a continuum."""

from collections.abc import Iterator

from lacore.bodies.continuum.body import Body
from lacore.bodies.continuum.regions.region import Region

_SHADES = ("#efe3c8", "#d9c4a3", "#c9d3c0", "#c2cdd6", "#e3c9bd", "#d8d2e0", "#b8a98f", "#dfe0b9")


def shaded(body: Body, before: int = 0) -> Iterator[tuple[Region, str]]:
    """Regions of a body with a colour each; they come again after eight.

    Args:
        body: of any regions.
        before: regions of other bodies in the same picture, which have the first colours.
    """
    for number, region in enumerate(body.regions, before):
        yield region, _SHADES[number % len(_SHADES)]
