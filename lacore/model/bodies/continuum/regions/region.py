"""Part of a mesh with one criterion."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from lacore.model.bodies.continuum.regions.varying import Varying
from lacore.model.materials.angles import CutOff
from lacore.model.materials.conic_form import ConicForm, of_elements
from lacore.model.materials.criterion import Criterion
from lacore.model.materials.fields import Field, Ranged, Strengths, varying, with_fields
from lacore.numerics.arrays import Floats, Ints
from lacore.program.surfaces import Surfaces
from lacore.reporting.showing import Compact
from lacore.reporting.text import Quantity, join, text

_ROUND_OFF = 1e-12  # by a strength


@dataclass(frozen=True, repr=False, eq=False)
class Region(Compact):
    """Elements of a mesh with the same criterion.

    Attributes:
        name: name of the region; empty if it is the whole body.
        elements: elements of the mesh, ascending, shape (e,).
        criterion: yield criterion.
        form: form of its dissipation.
        varying: fields of the criterion, and their values in these elements.
        within: form within its criterion, for lower bounds, if it differs.
    """

    name: str
    elements: Ints
    criterion: Criterion
    form: ConicForm
    varying: tuple[tuple[Field, Varying], ...] = ()
    within: ConicForm | None = None

    @property
    def weakest(self) -> "Region":
        """The region with the form of lower bounds."""
        return self if self.within is None else replace(self, form=self.within)

    def group_name(self, body: str) -> str:
        """Return the name of its dissipation: that of the body, or ``soil.clay``."""
        return f"{body}.{self.name}" if self.name else body

    @property
    def label(self) -> str:
        """Label of its criterion, with the range of varying values."""

        def ranged(own: Field) -> Field:
            values = self.of(own).vertex
            return Ranged(own.values, own.steepest, own.factor, (values.min(), values.max()))

        own: Criterion = with_fields(self.criterion, ranged)
        return own.label

    @property
    def told(self) -> str:
        """Text on the values of its fields: ``VonMises, shear_strength 1 to 3 Pa``; or empty."""
        parts = [type(self.criterion).__name__]
        for name, own in varying(self.criterion).items():
            values, unit = self.seen(own), "°" if name.endswith("_angle") else "Pa"
            ends = (float(values.min()), float(values.max()))
            parts.append(text("{} {}", name, Quantity(ends, unit, ".4g", "{} to {}")))
        return join(", ", parts) if len(parts) > 1 else ""

    @property
    def without_effect(self) -> float:
        """Share of its elements in which a cut-off has no effect, as far as they were looked at."""
        if not self.varying or not isinstance(self.criterion, CutOff):
            return 0.0
        beyond = self.criterion.beyond_apex(self.seen)
        if beyond is None:
            return 0.0
        beyond = np.atleast_2d(beyond)
        least = _ROUND_OFF * self.cohesion  # A cut-off beyond the apex has no effect.
        return float(((beyond >= -least).all(axis=1) & (beyond > least).any(axis=1)).mean())

    @property
    def bounded(self) -> bool:
        """Whether strengths are known between places: linear, or from below and above."""
        return all(own.linear or own.least is not None for _, own in self.varying)

    @property
    def cohesion(self) -> float:
        """Largest shear strength at zero pressure, Pa."""
        if self.form.uniform:
            return self.criterion.strength
        return float(np.max(self.seen(self.form.bound)))

    @property
    def least_strength(self) -> float:
        """Smallest strength of the bound, or of all surfaces, at any place of evaluation, Pa."""
        own = [one.strength for one in self.form.surfaces] or [self.form.bound]
        return min(float(np.min(self.seen(strength))) for strength in own)

    @property
    def largest_shear(self) -> float:
        """Largest shear stress at any pressure, Pa; inf with friction."""
        _, surfaces = self.strengths(self.elements, self._greatest)
        if surfaces is not None:
            return surfaces.largest_shear
        return self.cohesion

    def seen(self, strength: Strengths) -> Floats:
        """Return a strength of the form at vertices, (elements, a), or one for all elements.

        It may also be one value for each element.
        """
        if isinstance(strength, Field):
            factors = of_elements(strength.factor, self.elements)
            return np.asarray(factors[:, None] * self.of(strength).vertex)
        return (
            np.asarray(strength) if np.ndim(strength) == 0 else np.asarray(strength)[self.elements]
        )

    def of(self, own: Field) -> Varying:
        """Return the values of a field of its form."""
        return next(known for given, known in self.varying if given.values is own.values)

    def strengths(
        self, elements: Ints, values: Callable[[Field], Floats]
    ) -> tuple[Floats, Surfaces | None]:
        """Return the bound, shape (m,), and the surfaces at m points.

        Args:
            elements: elements of the points, shape (m,).
            values: function for values of a field at the points, without its factor, shape (m,).
        """
        if not self.form.varies:
            return self.form.bounds(elements), self.form.surfaces_of(elements)
        points = np.arange(elements.size)
        form = self.form.at_points(elements, values)
        return form.bounds(points), form.surfaces_of(points)

    def at_points(
        self, values: Callable[[Varying], Floats], count: int
    ) -> tuple[Floats, Surfaces | None]:
        """Return bound and surfaces at `count` points per element, by values (elements, count)."""

        def own(strength: Field) -> Floats:
            return values(self.of(strength)).ravel()

        return self.strengths(np.repeat(self.elements, count), own)

    def _greatest(self, own: Field) -> Floats:
        return np.asarray(self.of(own).vertex.max(axis=1))
