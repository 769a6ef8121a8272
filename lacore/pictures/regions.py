"""Colours of the regions of a continuum."""

from collections.abc import Iterator

from lacore.bodies.continuum.body import Body
from lacore.bodies.continuum.regions.region import Region

_SHADES = ("#efe3c8", "#d9c4a3", "#c9d3c0", "#c2cdd6", "#e3c9bd", "#d8d2e0", "#b8a98f", "#dfe0b9")


def shaded(body: Body) -> Iterator[tuple[Region, str]]:
    """Regions of a body with a colour each; they come again after eight."""
    for number, region in enumerate(body.regions):
        yield region, _SHADES[number % len(_SHADES)]
