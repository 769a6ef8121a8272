"""The spiral that bounds a vertical cut from above, minimised anew."""

from math import cos, exp, inf, radians, sin, tan

import pytest
from scipy.integrate import quad
from scipy.optimize import minimize

from lacore_verification.catalogue.catalogue import find


def spiral(angles, slope):
    """gamma H/c of a body that turns about the centre of ``r = exp((t - a) slope)``, a to b."""
    a, b = angles
    end = exp((b - a) * slope)
    height, crest = end * sin(b) - sin(a), cos(a) - end * cos(b)
    if min(height, crest) <= 0:
        return inf
    sector = quad(lambda t: exp(3 * (t - a) * slope) * cos(t), a, b)[0] / 3
    # Less the triangles of the centre with the face and with the crest; their arms are thirds.
    face = end * cos(b) * height / 2 * (2 * end * cos(b)) / 3
    top = crest * sin(a) / 2 * (cos(a) + end * cos(b)) / 3
    weight = sector - face - top
    dissipated = (end**2 - 1) / (2 * slope)
    return height * dissipated / weight if weight > 0 else inf


@pytest.mark.parametrize("angle", [20, 30])
def test_the_least_spiral_is_that_of_the_reference(angle):
    """To its four digits."""
    found = minimize(
        spiral, (radians(40), radians(70)), (tan(radians(angle)),), "Nelder-Mead", tol=1e-9
    )
    case, (variant,) = find(f"vertical-cut-phi:phi-{angle}")
    assert case.reference_of(variant).high == pytest.approx(found.fun, abs=5.1e-5)
