r"""A smooth rigid strip footing of half width 1 on soil with friction, weight and a surcharge.

The right half is modelled; cohesion c = 1.

              alpha
              | | | |
              v v v v footing    q   q   q   q   q
          o-----------+----------v---v---v---v---v----o
    u_x=0 o      \ 1 /  .  2   .         3     .      o
          o       \ /      . .             .          o
          o        \_       .          .              o   u = 0
          o           ` - _ _ _ .  -       |          o
          o                                v gamma    o
          o-------------------------------------------o
                              u = 0
          |<--- 1 --->|

A wedge (1) goes down, a fan (2) bounded by a logarithmic spiral turns the motion around the edge of
the footing, a wedge (3) goes up next to it: Hill's mechanism. It reaches farther with more
friction, and the box with it. Weightless soil has a closed form. With weight slip lines are curved,
and the load is more than the sum of what cohesion, surcharge and weight carry alone.

The edge of the footing is a singular point; meshes are graded towards it.
"""

from math import cos, exp, pi, radians, tan

import numpy as np

import lacore as la
from lacore.model.conditions.loads import Load
from lacore.numerics.arrays import Bools, Floats
from lacore_verification.case import Band, Case, Convergence, First, Order, Reference, Variant
from lacore_verification.case.band import Bracketing

_HEAVY = {(20.0, 0.0): 17.893, (20.0, 1.0): 24.370}
"""By characteristics, at unit weight 1: (angle, surcharge) to the mean pressure."""
_DIGITS = 0.002  # what their last digit may be off by

_MILD = Convergence(
    2.07,
    0.626,
    "20 degrees without weight, 40 to 4576 elements: 19.7, 10.1, 6.57, 4.08, 2.63, 1.03 % above;"
    " with it less",
)
_STEEP = Convergence(
    2.69, 0.600, "30 degrees, 40 to 4576 elements: 26.6, 15.3, 10.2, 6.36, 4.08, 1.60 % above"
)


def build(
    nx: int, ny: int, ratio: float, angle: float, surcharge: float, weight: float
) -> "la.Problem":
    """Return the problem: the right half, in a box that holds the mechanism."""
    width, depth = _box(angle)
    mesh = la.meshes.rectangle(
        x=(0, width), y=(-depth, 0), nx=nx, ny=ny, grade_x=(1.0, ratio), grade_y=(0.0, ratio / 2)
    ).with_boundaries({"under": _under, "beside": _beside})
    dead: list[Load] = [la.Pressure("soil", "beside", surcharge)] if surcharge else []
    dead += [la.BodyForce("soil", (0, -weight))] if weight else []
    return la.Problem(
        bodies={"soil": la.Body(mesh, la.MohrCoulomb(1.0, angle))},
        supports=[
            la.Fix("soil", "left", "x"),
            la.Fix("soil", "bottom"),
            la.Fix("soil", "right"),
        ],
        reference_loads=[la.RigidFooting("soil", "under", (0, -1), rough=False)],
        dead_loads=dead,
    )


def _box(angle: float) -> tuple[float, float]:
    """Return the width and depth of Hill's mechanism without weight, with a margin of a tenth."""
    phi = radians(angle)
    wedge = pi / 4 + phi / 2
    width = 1 + tan(wedge) * exp(pi / 2 * tan(phi))
    depth = cos(phi) / (2 * cos(wedge)) * exp(wedge * tan(phi))
    return 1.1 * width, 1.2 * depth


def _under(x: Floats) -> Bools:
    return np.asarray((x[1] > -1e-9) & (x[0] < 1))


def _beside(x: Floats) -> Bools:
    return np.asarray((x[1] > -1e-9) & (x[0] > 1))


def reference(angle: float, surcharge: float, weight: float) -> Reference:
    """Return the reference.

    Prandtl and Reissner without weight; with weight what characteristics give.
    """
    if weight:
        return Reference(
            _HEAVY[angle, surcharge],
            "c, q and gamma together: no closed form",
            "method of characteristics, 90 and 180 slip lines extrapolated; N_gamma of the same"
            " program agrees with the table of Martin 2005 to all of its digits",
            "exact, numerical",
            half_width=_DIGITS,
        )
    phi = radians(angle)
    n_q = exp(pi * tan(phi)) * tan(pi / 4 + phi / 2) ** 2
    n_c = (n_q - 1) / tan(phi) if angle else 2 + pi
    return Reference(
        n_c + surcharge * n_q,
        "N_c c + N_q q, N_q = exp(pi tan(phi)) tan(45 + phi/2)^2, N_c = (N_q - 1) cot(phi)",
        "Prandtl 1920, Reissner 1924",
        "exact",
    )


def band(elements: int, angle: float, surcharge: float, weight: float) -> Band:
    """Return the band: strict upper bound."""
    return (_MILD if angle <= 20 else _STEEP).strict(elements)


def order(angle: float, surcharge: float, weight: float) -> Order | None:
    """Return the order of convergence: that of the edge, of the first variant.

    Others reach 0.63.
    """
    if weight or surcharge or angle != 20:
        return None
    sizes = ((6, 3, 4.0), (8, 4, 4.5), (10, 5, 5.0), (12, 7, 5.5), (16, 9, 6.0))
    return Order(
        tuple({"nx": nx, "ny": ny, "ratio": ratio} for nx, ny, ratio in sizes),
        0.61,
        0.08,
        "Measured: 0.614 over 72 to 880 elements, 0.626 over 40 to 4576. Without grading 1/2; with"
        " more of it meshes follow the spiral worse, which dissipates here, and errors are larger.",
    )


CASE = Case(
    id="strip-footing",
    title="Strip footing on soil with friction, weight and a surcharge",
    tags=("continuum", "soil", "singular point", "body force", "upper bound", "bracket"),
    unit="mean footing pressure / c",
    explanation=__doc__,
    hand_calculation="""\
with x = mean pressure + c cot(phi), weightless:
passive wedge 3:  sigma_y = -q, pressed sideways
                  x3 = (q + H)/(1 - sin(phi)), H = c cot(phi)
fan 2:            turn of pi/2:  x1 = x3 exp(pi tan(phi))
active wedge 1:   p + H = x1 (1 + sin(phi))
                  p = N_c c + N_q q
phi = 20:         N_q = 6.399394,  N_c = 14.834712
phi = 30:         N_q = 18.401122, N_c = 30.139628
phi = 20, gamma = 1, B = 2:  N_gamma = 1.57863
                  superposed, q = 0: 16.413; exact 17.893
                  superposed, q = 1: 22.813; exact 24.370
""",
    meshes={
        "coarse": {"nx": 5, "ny": 2, "ratio": 4.0},
        "medium": {"nx": 16, "ny": 9, "ratio": 6.0},
        "fine": {"nx": 44, "ny": 26, "ratio": 8.0},
    },
    build=build,
    reference=reference,
    band=band,
    order=order,
    surfaces=True,
    bracket=Bracketing(target_width=0.15),
    first=First(meshes=("medium",), bracket=0.03),
    variants=(
        Variant("phi-20", {"angle": 20.0, "surcharge": 0.0, "weight": 0.0}),
        Variant("phi-30", {"angle": 30.0, "surcharge": 0.0, "weight": 0.0}, ("coarse",)),
        Variant("weight", {"angle": 20.0, "surcharge": 0.0, "weight": 1.0}, ("coarse",)),
        Variant("all-three", {"angle": 20.0, "surcharge": 1.0, "weight": 1.0}, ("coarse",)),
    ),
)
