"""Yield and plastic power of soils in plane strain, from the sides of Mohr-Coulomb's surface.

In the mean stress and the radius of Mohr's circle it has straight sides: friction, and cut-offs.
Where strengths vary, programs take averages and cones around those of an element: stresses stay
within the largest strengths of their element, and flow dissipates at least at the smallest ones.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from lacore.numerics.arrays import Floats
from lacore_verification.fuzz.checks.verdict import Wrong, beyond
from lacore_verification.fuzz.drawn.recipe import Soil


@dataclass(frozen=True)
class Sides:
    """Sides of a yield surface in each element, shapes (cells, 1).

    Attributes:
        apex: mean stress at the tip of the cone, Pa.
        sine: of the friction angle.
        tension: largest principal stress, Pa; at most that at the apex.
        crushing: largest compression, Pa; infinite for none.
    """

    apex: Floats
    sine: Floats
    tension: Floats
    crushing: Floats


def sides(soil: Soil, corners: Floats, end: Callable[..., Floats]) -> Sides:
    """Return the surface inside, or around, those at all corners (2, cells, n) of elements.

    Args:
        soil: the soil.
        corners: of the elements, m.
        end: `numpy.min` for the surface inside, `numpy.max` for the one around.
    """

    def of(values: Floats) -> Floats:
        return np.asarray(end(values, axis=1, keepdims=True))

    angle = np.radians(soil.at("angle", corners))
    apex = of(soil.at("cohesion", corners)) * of(1 / np.tan(angle))
    cuts = soil.data["soil"]
    tension = apex if cuts["tension"] is None else of(soil.at("tension", corners))
    none = np.full_like(apex, np.inf)
    crushing = none if cuts["crushing"] is None else of(soil.at("crushing", corners))
    return Sides(apex, of(np.sin(angle)), np.minimum(apex, tension), crushing)


def check_soil(surface: Sides, name: str, stress: Floats) -> Iterator[Wrong]:
    """Check stresses (cells, q, 4) of a body against the surface of each element."""
    xx, yy, _, xy = np.moveaxis(stress, -1, 0)
    mean, radius = (xx + yy) / 2, np.hypot((xx - yy) / 2, xy)
    past = [
        radius + (mean - surface.apex) * surface.sine,
        mean + radius - surface.tension,
        radius - mean - surface.crushing,
    ]
    size = surface.apex * surface.sine + np.abs(mean)
    yield from beyond("yield", f"stress of {name!r} beyond", np.max(past, axis=0), size)


def plastic_power(surface: Sides, growth: Floats, shear: Floats) -> Floats:
    """Return the plastic power of flow, W/m^3: the largest over the corners of the surface.

    Flow beyond the normals of sides without an end is not detected here.

    Args:
        surface: of each element.
        growth, shear: strain rates ``xx + yy`` and ``hypot(xx - yy, 2 xy)``, shape (cells, q).
    """
    top, least, sine = surface.tension, surface.crushing, surface.sine
    # Intersection of friction with mean + radius = top.
    mean = (top - surface.apex * sine) / (1 - sine)
    corners = [(top, 0 * top), (mean, top - mean)]
    if np.all(np.isfinite(least)):
        # Intersection with radius - mean = crushing.
        other = (surface.apex * sine - least) / (1 + sine)
        meet = other > mean  # The cut-offs intersect below the friction.
        mean, other = (np.where(meet, (top - least) / 2, one) for one in (mean, other))
        corners = [(top, 0 * top), (mean, top - mean), (other, least + other), (-least, 0 * top)]
    return np.asarray(np.max([p * growth + radius * shear for p, radius in corners], axis=0))
