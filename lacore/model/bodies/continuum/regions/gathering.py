"""From what stands region by region to what stands body by body."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Protocol, TypeVar

import numpy as np

from lacore.model.bodies.continuum.regions.region import Region
from lacore.numerics.arrays import Floats


class HasRegions(Protocol):
    """A body that consists of regions."""

    @property
    def regions(self) -> tuple[Region, ...]:
        """They."""
        ...


class HasBody(Protocol):
    """What numbers the unknowns of such a body."""

    @property
    def body(self) -> Any:
        """It."""
        ...


T = TypeVar("T")
D = TypeVar("D", bound=HasBody)


def by_body(bodies: Mapping[str, D], values: Sequence[T]) -> Iterator[tuple[str, D, tuple[T, ...]]]:
    """Bodies with the values of their regions; values of what comes after are left out."""
    first = 0
    for name, dofs in bodies.items():
        count = len(dofs.body.regions)
        yield name, dofs, tuple(values[first : first + count])
        first += count


def region_count(bodies: Mapping[str, HasBody]) -> int:
    """Regions of all bodies: so many groups of dissipation are theirs."""
    return sum(len(dofs.body.regions) for dofs in bodies.values())


def region_numbers(body: HasRegions) -> Floats:
    """Number of the region of each element, in the order of the regions, shape (elements,)."""
    parts = [
        np.full(region.elements.size, float(number)) for number, region in enumerate(body.regions)
    ]
    return gathered(body, parts)


def gathered(body: HasRegions, parts: Sequence[Floats]) -> Floats:
    """Values of the elements of each region, first axes, as one array over all elements."""
    if len(parts) == 1:
        return parts[0]
    count = sum(region.elements.size for region in body.regions)
    whole = np.empty((count, *parts[0].shape[1:]), dtype=parts[0].dtype)
    for region, own in zip(body.regions, parts, strict=True):
        whole[region.elements] = own
    return whole


def element_sums(body: HasRegions, points: Sequence[Floats]) -> Floats:
    """Sums over the points of each element, shape (elements,), of regions' values (m,)."""
    sums = [
        own.reshape(region.elements.size, -1).sum(axis=1)
        for region, own in zip(body.regions, points, strict=True)
    ]
    return gathered(body, sums)


def continuum_stress(dofs: HasBody, stresses: Sequence[Floats], means: Sequence[Floats]) -> Floats:
    """Stresses at the points of elements, shape (elements, q, 4), from those of regions, Pa.

    In space (elements, q, 6), see `ConicForm.stress`.

    Args:
        dofs: of the body.
        stresses: conjugate to the cone rows of each region, shape (m, dim).
        means: conjugate to its volumetric rows, shape (m L,).
    """
    regions = zip(dofs.body.regions, stresses, means, strict=True)
    parts = [
        (found := region.form.stress(own, mean)).reshape(region.elements.size, -1, found.shape[1])
        for region, own, mean in regions
    ]
    return gathered(dofs.body, parts)
