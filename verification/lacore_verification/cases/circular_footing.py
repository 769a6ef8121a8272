r"""A rigid circular footing of radius 1 is pressed into a half space of a von Mises material.

                 alpha
        axis   | | | |
           |   v v v v  footing, radius 1
           o-----------+-------------------+
           |            .               .  |
    u_r=0  |  goes down   .  .  .  .  . up |  u = 0
           |                               |
           o-------------------------------+
                        u = 0
           |<--- 1 --->|
           |<------------- 3 ------------->|   depth 1.5

Axisymmetric, r to the right and z upwards. The footing is smooth (the soil slides freely beneath
it) or rough (the soil sticks to it), and unlike under a strip the rough one carries more: soil
that flows outwards stretches around the circumference, too. There is no closed form. Published
values of 5.69 and 6.05 are those of a *Tresca* material, which is stronger here at equal strength
in shear. The edge of the footing is a singular point, towards which the mesh is graded.
"""

import numpy as np

import lacore as la
from lacore.numerics.arrays import Bools, Floats
from lacore_verification.case import Band, Case, Convergence, First, Reference, Variant

RADIUS, WIDTH, DEPTH = 1.0, 3.0, 1.5
_SMOOTH = Convergence(
    3.81,
    0.887,
    "32 to 4800 elements: 17.6, 3.60, 1.06, 0.59, 0.36, 0.21 % above the limit 5.218 that they tend"
    " to; through the first and the last",
)
_ROUGH = Convergence(
    3.90,
    0.867,
    "32 to 4800 elements: 19.3, 4.78, 1.33, 0.76, 0.44, 0.25 % above the limit 5.516 that they tend"
    " to; through the first and the last",
)


def build(nx: int, ny: int, ratio_x: float, ratio_y: float, rough: bool) -> "la.Problem":
    """Return the problem: graded towards the edge of the footing; k = 1."""
    mesh = la.meshes.rectangle(
        x=(0, WIDTH),
        y=(-DEPTH, 0),
        nx=nx,
        ny=ny,
        grade_x=(RADIUS, ratio_x),
        grade_y=(0.0, ratio_y),
    )
    body = la.Body(
        mesh, la.VonMises(shear_strength=1.0), kinematics="axisymmetric", space="p2-gauss"
    )
    return la.Problem(
        bodies={"soil": body},
        supports=[la.Fix("soil", "bottom"), la.Fix("soil", "right")],
        reference_loads=[la.RigidFooting("soil", _under_footing, (0, -1), rough=rough)],
    )


def _under_footing(x: Floats) -> Bools:
    return np.asarray((x[1] > -1e-9) & (x[0] < RADIUS + 1e-9))


def reference(rough: bool) -> Reference:
    """Return the reference: extrapolated, no closed form."""
    return Reference(
        5.51 if rough else 5.21,
        "extrapolated from refined finite elements",
        "independent computation, no bound; three meshes here (128, 576, 2304 elements) extrapolate"
        f" to {5.523 if rough else 5.222}, finer ones to {5.518 if rough else 5.220}",
        "bracket",
        half_width=0.05,
    )


def band(elements: int, rough: bool) -> Band:
    """Return the band: interior strain points: from above, though this is not proven."""
    return (_ROUGH if rough else _SMOOTH).two_sided(elements, "interior strain points.")


CASE = Case(
    id="circular-footing",
    title="Circular footing on a half space",
    tags=("continuum", "axisymmetric", "singular point"),
    unit="mean footing pressure / k",
    explanation=__doc__,
    hand_calculation="""\
from above: a strip of the same material carries (2 + pi) k =
            5.14 k; around a circle soil that moves outwards
            stretches, which costs more: a few per cent
Tresca:     5.69 k smooth, 6.05 k rough (slip lines after Shield
            1955, Eason & Shield 1960), k its strength in shear
von Mises:  below, no hand calculation: 5.21 k and 5.51 k
""",
    meshes={
        "coarse": {"nx": 4, "ny": 2, "ratio_x": 8.0, "ratio_y": 4.0},
        "medium": {"nx": 16, "ny": 9, "ratio_x": 36.0, "ratio_y": 18.0},
        "fine": {"nx": 48, "ny": 25, "ratio_x": 100.0, "ratio_y": 50.0},
    },
    build=build,
    reference=reference,
    band=band,
    bracket=None,
    first=First(meshes=("medium",)),
    variants=(Variant("smooth", {"rough": False}), Variant("rough", {"rough": True})),
)
