r"""A rigid strip footing of half width 1/2 on clay whose strength rises with depth.

The right half is modelled; the shear strength is k = 1 + rho z at the depth z.

              alpha
              | | | |
              v v v v footing            free
          o-----------+-------------------------------o
    u_x=0 o                 | k = 1 + rho z           o
          o                 v z                       o   u = 0
          o                                           o
          o-------------------------------------------o
                              u = 0
          |<-- 1/2 -->|

The stronger the ground below, the shallower the mechanism: fans are no longer circles, their slip
lines bend upwards, and beneath most of a rough footing nothing slides. Davis and Booker write the
load as F (5.14 + rho/4), F from 1 to 1.7.

The strength is given as a function of place. It is linear, so that bounds take it as it is:
stresses that are linear in an element are within it where they are at its vertices, and what flow
dissipates is integrated exactly over the interpolant of strain rates.
"""

import numpy as np

import lacore as la
from lacore.numerics.arrays import Bools, Floats
from lacore_verification.case import Band, Bracketing, Case, Convergence, First, Reference, Variant

_LOADS = {
    (1.0, True): 6.609245,
    (4.0, True): 9.130441,
    (16.0, True): 15.602195,
    (1.0, False): 5.981829,
    (4.0, False): 7.818793,
    (16.0, False): 13.139041,
}
"""(rho B/k0, rough) to the mean pressure, by characteristics; a unit of the last digit is open."""
_CONVERGENCE = {
    (1.0, True): Convergence(2.37, 0.627, "rho = 1, rough: 13.8, 7.6, 4.0, 2.6, 1.5 % above"),
    (4.0, True): Convergence(3.69, 0.617, "rho = 4, rough: 23.4, 12.6, 6.8, 4.4, 2.6 % above"),
    (16.0, True): Convergence(7.95, 0.616, "rho = 16, rough: 49.1, 27.2, 14.6, 9.6, 5.5 % above"),
    (1.0, False): Convergence(1.55, 0.620, "rho = 1, smooth: 9.1, 5.2, 2.8, 1.8, 1.1 % above"),
    (4.0, False): Convergence(2.28, 0.650, "rho = 4, smooth: 12.4, 6.5, 3.3, 2.1, 1.2 % above"),
    (16.0, False): Convergence(3.98, 0.700, "rho = 16, smooth: 16.9, 8.6, 4.1, 2.5, 1.4 % above"),
}
"""On 96, 240, 640, 1344 and 3168 elements."""


def build(nx: int, ny: int, ratio: float, rho: float, rough: bool) -> "la.Problem":
    """Return the problem: the right half, graded towards the edge of the footing."""
    mesh = la.meshes.rectangle(
        x=(0, 1.5), y=(-1.0, 0), nx=nx, ny=ny, grade_x=(0.5, ratio), grade_y=(0.0, ratio)
    ).with_boundaries({"under": _under})

    def strength(x: Floats) -> Floats:
        return np.asarray(1.0 - rho * x[1])

    return la.Problem(
        bodies={"clay": la.Body(mesh, la.VonMises(strength))},
        supports=[
            la.Fix("clay", "left", "x"),
            la.Fix("clay", "bottom"),
            la.Fix("clay", "right"),
        ],
        reference_loads=[la.RigidFooting("clay", "under", (0, -1), rough=rough)],
    )


def _under(x: Floats) -> Bools:
    return np.asarray((x[1] > -1e-9) & (x[0] < 0.5))


def reference(rho: float, rough: bool) -> Reference:
    """Return the reference: by characteristics, confirmed by strict brackets."""
    return Reference(
        _LOADS[rho, rough],
        "F (5.1416 k0 + rho B/4), F by integration",
        "method of characteristics, 50 to 400 slip lines extrapolated, in the form of Davis and"
        " Booker 1973; strict brackets about 1 % wide hold it",
        "exact, numerical",
        half_width=1e-5,
    )


def band(elements: int, rho: float, rough: bool) -> Band:
    """Return the band: strict upper bound."""
    return _CONVERGENCE[rho, rough].strict(elements)


CASE = Case(
    id="strength-with-depth",
    title="Strip footing on clay that grows stronger with depth",
    tags=("continuum", "field", "singular point", "upper bound", "bracket"),
    unit="mean footing pressure / k0",
    explanation=__doc__,
    hand_calculation="""\
by p = F (2 + pi + rho/4):
rough  rho =  1:  F =  6.609245/5.391593 = 1.22584
       rho =  4:  F =  9.130441/6.141593 = 1.48666
       rho = 16:  F = 15.602195/9.141593 = 1.70673
smooth rho =  1:  F =  5.981829/5.391593 = 1.10947
       rho =  4:  F =  7.818793/6.141593 = 1.27309
       rho = 16:  F = 13.139041/9.141593 = 1.43728
""",
    meshes={
        "coarse": {"nx": 3, "ny": 3, "ratio": 4.0},
        "medium": {"nx": 16, "ny": 9, "ratio": 4.5},
        "fine": {"nx": 44, "ny": 26, "ratio": 6.0},
    },
    build=build,
    reference=reference,
    band=band,
    bracket=Bracketing(target_width=0.01, max_elements=9000),
    first=First(meshes=("medium",), bracket=0.02),
    variants=(
        Variant("rough-1", {"rho": 1.0, "rough": True}),
        Variant("rough-4", {"rho": 4.0, "rough": True}, ("coarse",)),
        Variant("rough-16", {"rho": 16.0, "rough": True}, ("coarse",)),
        Variant("smooth-1", {"rho": 1.0, "rough": False}, ("coarse",)),
        Variant("smooth-4", {"rho": 4.0, "rough": False}, ("coarse",)),
        Variant("smooth-16", {"rho": 16.0, "rough": False}, ("coarse",)),
    ),
)
