r"""A layer of soil between rough plates, one of which moves along it; the soil does not dilate.

                    ----> alpha
          =====================================   rough plate, at a fixed height
     p -> |                                   | <- p
     p -> |        c, phi;  psi = 0           | <- p     h = 1, length 2
     p -> |                                   | <- p     u_y = 0 on the sides
          =====================================
          #####################################   u = 0

The layer can shear, and grow at its sides only. If it does not dilate it shears as one: the strain
rate is a shear along the plates, its axes are those of the stress, and the mean stress is that of
the sides everywhere. What it carries is less than the friction angle says on a plane along the
plates: `c cos(phi) + p sin(phi)` in place of `c + p tan(phi)`, which is the strength Davis gave
non-dilatant soil (T55). This state needs no mesh, and its certificate is zero to round-off.

It is not the only state. Shear that is not the same everywhere has been found from 15 % less to
0.07 % more, with certificates as good; soil whose dilation follows its friction would have to
squeeze out at the sides, and carries more than twice as much.
"""

from math import cos, radians, sin

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant
from lacore_verification.cases.shared.friction_inside import UNFIT

C, P = 1.0, 1.0
_OTHERS = 0.2  # below: found are 15 % at 30 degrees on 64 triangles, 3 % on 512
_NEAR = 0.01  # above: found are 7e-4


def build(nx: int, ny: int, angle: float, dilation: float) -> "la.Problem":
    """Return the problem: the layer."""
    mesh = la.meshes.rectangle(x=(0, 2), y=(0, 1), nx=nx, ny=ny)
    soil = la.MohrCoulomb(C, angle, dilation_angle=dilation)
    return la.Problem(
        bodies={"layer": la.Body(mesh, soil, space="p2-gauss")},
        supports=[
            la.Fix("layer", "bottom"),
            la.Fix("layer", "left", "y"),
            la.Fix("layer", "right", "y"),
        ],
        reference_loads=[la.RigidFooting("layer", "top", (1, 0))],
        dead_loads=[la.Pressure("layer", side, P) for side in ("left", "right")],
    )


def reference(angle: float, dilation: float) -> Reference:
    """Return the reference: homogeneous shear."""
    phi = radians(angle)
    return Reference(
        C * cos(phi) + P * sin(phi),
        "c cos(phi) + p sin(phi), Davis's strength of soil that does not dilate",
        "homogeneous state: stress and strain rate with the same axes, mean stress -p (T55)",
        "exact",
    )


def band(elements: int, angle: float, dilation: float) -> Band:
    """Return the band of one of several states."""
    return Band(
        _OTHERS,
        _NEAR,
        "Homogeneous shear is a state of every mesh, and there are others: searches found loads"
        " from 15 % below to 0.07 % above it. That there are none beyond is not proven.",
    )


CASE = Case(
    id="simple-shear-layer",
    title="Layer of soil that does not dilate, in simple shear",
    tags=("continuum", "soil", "not associated", "certified"),
    unit="mean shear traction / c",
    explanation=__doc__,
    hand_calculation="""\
strain rate:   eps_xx = eps_yy = 0, gamma_xy > 0:  d = (0, gamma)
flow rule:     s = q d/||d|| = (0, tau), q = tau:  sigma_xx = sigma_yy
sides:         sigma_xx = -p everywhere, so P = -p
yield:         tau = c cos(phi) - P sin(phi) = c cos(phi) + p sin(phi)
phi = 30:      tau = 0.866025 + 0.5 = 1.366025
phi = 20:      tau = 0.939693 + 0.342020 = 1.281713
""",
    meshes={
        "coarse": {"nx": 4, "ny": 2},
        "medium": {"nx": 18, "ny": 8},
        "fine": {"nx": 49, "ny": 24},
    },
    build=build,
    reference=reference,
    band=band,
    surfaces=True,
    bracket=None,
    variants=(
        Variant("phi-20", {"angle": 20.0, "dilation": 0.0}, ("coarse",), unfit=UNFIT),
        Variant("phi-30", {"angle": 30.0, "dilation": 0.0}, ("coarse",), unfit=UNFIT),
    ),
)
