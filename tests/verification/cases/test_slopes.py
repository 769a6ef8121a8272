"""Spirals that bound slopes from above, with and without water, minimised anew; and Archimedes."""

from math import cos, exp, inf, radians, sin, tan

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import minimize

import lacore as la
from lacore.bounds.static_model import static_model
from lacore_verification.cases.slope_with_water import CASE as WET
from lacore_verification.catalogue.catalogue import find


def spiral(angles, slope, friction, level=-inf, pool=False, water=0.5):
    """gamma H/c of a body that turns about the centre of ``r = exp((t - a) tan(phi))``, a to b.

    From the crest to the toe; angles are below the horizontal, lengths in units of the first
    radius, but the level of the water, which is in heights of the slope.
    """
    (a, b), rise = angles, tan(friction)
    end = exp((b - a) * rise)
    height = end * sin(b) - sin(a)
    back = cos(a) - end * cos(b) - height / tan(slope)  # from the edge of the crest
    if min(height, back) <= 0:
        return inf
    toe, edge = (end * cos(b), end * sin(b)), (cos(a) - back, sin(a))  # right of, below the centre
    sector = quad(lambda t: exp(3 * (t - a) * rise) * cos(t), a, b)[0] / 3
    # Less the triangles of the centre with the face and with the crest; their arms are thirds.
    face = (edge[0] * toe[1] - toe[0] * edge[1]) / 2 * (edge[0] + toe[0]) / 3
    crest = back * sin(a) / 2 * (cos(a) + edge[0]) / 3
    weight = sector - face - crest
    dissipated = (end**2 - 1) / (2 * rise)

    def pressure(depth):  # below the centre
        return water * max(depth - (toe[1] - level * height), 0.0)

    driven = quad(
        lambda t: pressure(exp((t - a) * rise) * sin(t)) * exp(2 * (t - a) * rise) * rise,
        a,
        b,
        limit=200,
    )[0]
    if pool:  # against the face, from its edge to the toe
        right, down = toe[0] - edge[0], toe[1] - edge[1]

        def leant(s):
            place = edge[0] + s * right, edge[1] + s * down
            return pressure(place[1]) * (down * place[1] + right * place[0])

        driven -= quad(leant, 0, 1, points=[1 - min(level, 1.0)])[0]
    power = weight + driven
    return height * dissipated / power if power > 0 else inf


def least(slope, friction, **water):
    found = minimize(
        lambda angles: spiral(angles, radians(slope), radians(friction), **water),
        (radians(35), radians(95)),
        method="Nelder-Mead",
        tol=1e-9,
    )
    return found.fun


@pytest.mark.parametrize("name", ["steep", "gentle"])
def test_the_least_spiral_is_that_of_the_reference(name):
    """To its four digits, rounded up."""
    case, (variant,) = find(f"slope-phi:{name}")
    own = least(variant.parameters["slope"], variant.parameters["angle"])
    assert 0 <= case.reference_of(variant).high - own < 1e-4


def test_spirals_with_water():
    """Of a pool, and of a slope under water to the crest, which that of buoyant weight must be."""
    case, (variant,) = find("slope-with-water:pool")
    assert 0 <= case.reference_of(variant).high - least(60, 20, level=0.5, pool=True) < 1e-4
    assert least(60, 20, level=1.0, pool=True) == pytest.approx(2 * least(60, 20), rel=1e-6)
    case, (variant,) = find("slope-with-water:drawn-down")
    assert (
        case.reference_of(variant).high
        < least(60, 20, level=0.5)
        == pytest.approx(7.5480, abs=1e-4)
    )


def test_a_slope_under_water_is_one_of_buoyant_weight():
    """The same program but for half of the load: of velocities, and of equilibrium elements."""
    mesh = {"nx": 5, "ny": 4, "ratio": 3.0}
    dry_case, (steep,) = find("slope-phi:steep")
    dry = dry_case.build(**mesh, **steep.parameters)
    wet = WET.build(**mesh, level=1.5, pool=True)
    for assembled in (la.discretise, static_model):
        own, other = (assembled(problem).program.reference_load for problem in (dry, wet))
        assert np.allclose(2 * other, own, rtol=0, atol=1e-14)
