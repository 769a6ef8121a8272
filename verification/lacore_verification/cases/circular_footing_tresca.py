r"""A rigid circular footing of radius 1 on a half space of Tresca's or Mohr and Coulomb's material.

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

Axisymmetric, r to the right and z upwards. The hoop stress lies between two principal stresses of
the plane or equals one of them, and slip lines have been drawn by assuming the latter (Haar and von
Karman). No such hypothesis is made here: all planes of the yield surface are enforced, three cones
per point, and the values of slip lines result.

At equal strength in shear Tresca's material carries 9 or 10 % more than that of von Mises in
`circular-footing`, being stronger where two principal stresses are equal. With friction a circular
footing carries a third more than a strip. Loads converge from above; nothing here is a bound, as
strain rates are taken at interior points. The edge of the footing is a singular point.
"""

import numpy as np

import lacore as la
from lacore.numerics.arrays import Bools, Floats
from lacore_verification.case import Band, Case, Convergence, First, Reference, Variant

_PUBLISHED = {(0.0, False): 5.689, (0.0, True): 6.048, (20.0, False): 20.1}
"""(angle, rough) to mean pressure per strength."""
_BOX = {0.0: (3.0, 1.5), 20.0: (4.5, 2.0)}
"""Width and depth by angle."""

_SMOOTH = Convergence(
    3.08, 0.867, "32 to 2304 elements: 17.0, 7.8, 3.9, 1.9, 1.2, 0.65, 0.41 % above"
)
_ROUGH = Convergence(
    3.92, 0.870, "32 to 2304 elements: 20.0, 10.5, 5.2, 2.4, 1.5, 0.81, 0.50 % above"
)
_FRICTION = Convergence(
    3.59, 0.819, "20 degrees, smooth, 32 to 1248 elements: 21.8, 10.3, 6.5, 3.4, 1.9, 1.0 % above"
)


def build(nx: int, ny: int, ratio: float, angle: float, rough: bool) -> "la.Problem":
    """Return the problem: graded towards the edge of the footing; cohesion 1."""
    width, depth = _BOX[angle]
    mesh = la.meshes.rectangle(
        x=(0, width), y=(-depth, 0), nx=nx, ny=ny, grade_x=(1.0, 2 * ratio), grade_y=(0.0, ratio)
    )
    criterion = la.MohrCoulomb(1.0, angle) if angle else la.MaximumShear(1.0)
    body = la.Body(mesh, criterion, kinematics="axisymmetric", space="p2-gauss")
    return la.Problem(
        bodies={"soil": body},
        supports=[la.Fix("soil", "bottom"), la.Fix("soil", "right")],
        reference_loads=[la.RigidFooting("soil", _under_footing, (0, -1), rough=rough)],
    )


def _under_footing(x: Floats) -> Bools:
    return np.asarray((x[1] > -1e-9) & (x[0] < 1 + 1e-9))


def reference(angle: float, rough: bool) -> Reference:
    """Return the reference: axisymmetric slip lines."""
    value = _PUBLISHED[angle, rough]
    if angle:
        return Reference(
            value,
            "slip lines with the hypothesis of Haar and von Karman",
            "Cox, Eason & Hopkins 1961, to three digits",
            "exact, numerical",
            half_width=0.05,
        )
    source = "Eason & Shield 1960" if rough else "Shield 1955; Cox, Eason & Hopkins 1961"
    return Reference(
        value,
        "slip lines with the hypothesis of Haar and von Karman",
        f"{source}, to four digits",
        "exact, numerical",
        half_width=0.001,
    )


def band(elements: int, angle: float, rough: bool) -> Band:
    """Return the band: interior strain points: from above, though this is not proven."""
    error = _FRICTION if angle else _ROUGH if rough else _SMOOTH
    return error.two_sided(elements, "interior strain points.")


CASE = Case(
    id="circular-footing-tresca",
    title="Circular footing on Tresca's material, and on soil with friction",
    tags=("continuum", "soil", "axisymmetric", "singular point"),
    unit="mean footing pressure / c",
    explanation=__doc__,
    hand_calculation="""\
strip:      (2 + pi) c = 5.142 c, N_c = 14.835 at 20 degrees
circle:     hoop stress equal to the larger of the other two,
            slip lines in meridian planes, integrated numerically:
            smooth   5.689 c    (Shield 1955)
            rough    6.048 c    (Eason & Shield 1960)
            smooth  20.1 c      at 20 degrees (Cox et al. 1961)
von Mises:  5.21 c and 5.51 c at the same strength in shear
""",
    meshes={
        "coarse": {"nx": 4, "ny": 2, "ratio": 4.0},
        "medium": {"nx": 16, "ny": 9, "ratio": 18.0},
        "fine": {"nx": 48, "ny": 25, "ratio": 50.0},
    },
    build=build,
    reference=reference,
    band=band,
    surfaces=True,
    bracket=None,
    first=First(meshes=("medium",)),
    variants=(
        Variant("smooth", {"angle": 0.0, "rough": False}),
        Variant("rough", {"angle": 0.0, "rough": True}, ("coarse",)),
        Variant("phi-20", {"angle": 20.0, "rough": False}, ("coarse",)),
    ),
)
