"""Conversion of values by region to values by body."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Protocol, TypeVar

import numpy as np

from lacore.model.bodies.continuum.regions.region import Region
from lacore.numerics.arrays import Floats


class HasRegions(Protocol):
    """Body that consists of regions."""

    @property
    def regions(self) -> tuple[Region, ...]:
        """They."""
        ...


class HasBody(Protocol):
    """Numbering of the unknowns of such a body."""

    @property
    def body(self) -> Any:
        """It."""
        ...


T = TypeVar("T")
D = TypeVar("D", bound=HasBody)


def by_body(bodies: Mapping[str, D], values: Sequence[T]) -> Iterator[tuple[str, D, tuple[T, ...]]]:
    """Yield the bodies with the values of their regions; further values are left out."""
    first = 0
    for name, dofs in bodies.items():
        count = len(dofs.body.regions)
        yield name, dofs, tuple(values[first : first + count])
        first += count


def region_count(bodies: Mapping[str, HasBody]) -> int:
    """Return the number of regions of all bodies, which is that of their dissipation groups."""
    return sum(len(dofs.body.regions) for dofs in bodies.values())


def region_numbers(body: HasRegions) -> Floats:
    """Return the number of the region of each element, in the order of the regions.

    The shape is (elements,).
    """
    parts = [
        np.full(region.elements.size, float(number)) for number, region in enumerate(body.regions)
    ]
    return gathered(body, parts)


def gathered(body: HasRegions, parts: Sequence[Floats]) -> Floats:
    """Return values of the elements of each region, along first axes, as one array."""
    if len(parts) == 1:
        return parts[0]
    count = sum(region.elements.size for region in body.regions)
    whole = np.empty((count, *parts[0].shape[1:]), dtype=parts[0].dtype)
    for region, own in zip(body.regions, parts, strict=True):
        whole[region.elements] = own
    return whole


def element_sums(body: HasRegions, points: Sequence[Floats]) -> Floats:
    """Return the sums of regions' values (m,) over the points of each element, (elements,)."""
    sums = [
        own.reshape(region.elements.size, -1).sum(axis=1)
        for region, own in zip(body.regions, points, strict=True)
    ]
    return gathered(body, sums)


def continuum_stress(dofs: HasBody, stresses: Sequence[Floats], means: Sequence[Floats]) -> Floats:
    """Return the stresses at the points of elements, shape (elements, q, 4), from regions, Pa.

    In three dimensions (elements, q, 6), see `ConicForm.stress`.

    Args:
        dofs: unknowns of the body.
        stresses: conjugate to the cone rows of each region, shape (m, dim).
        means: conjugate to its volumetric rows, shape (m L,).
    """
    regions = zip(dofs.body.regions, stresses, means, strict=True)
    parts = [
        (found := region.form.stress(own, mean)).reshape(region.elements.size, -1, found.shape[1])
        for region, own, mean in regions
    ]
    return gathered(dofs.body, parts)
