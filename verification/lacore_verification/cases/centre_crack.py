r"""A strip with a straight crack across its middle is pulled until the ligaments yield.

           alpha                           alpha
         ^  ^  ^  ^                      ^  ^  ^  ^
       +------------+                  +------------+
       |            |                  o            |
       |            |                  o     1      |
       |            |           u_x=0  o           .|
       |    ----    |                  o        .   | free
       |            |                  o     .   2  |
       |            |                  |            |
       +------------+                  +-----o-o-o--+
         v  v  v  v                 crack, free  u_y=0
                                       |<--->|<---->|
                                       a=1/2   1/2

Half the width is 1, half the crack a = 1/2; a quarter is modelled. In plane strain the cut runs
from the tip of the crack to the free side under 45 degrees: above it the strip goes up (1), below
it a rigid wedge moves inwards (2). The free side confines nothing, so the ligaments carry their
2 k and no more. In plane stress they carry s0 = sqrt3 k: the strip becomes thinner along a neck,
35.3 degrees from the line of the crack, in which nothing stretches along the neck.

Velocities here are continuous, and show the cut as a shear band of about one element's width.
"""

from math import sqrt
from typing import TYPE_CHECKING

import numpy as np

import lacore as la
from lacore.numerics.arrays import Bools, Floats
from lacore_verification.case import Band, Case, Convergence, First, Order, Reference, Variant
from lacore_verification.case.band import Bracketing

if TYPE_CHECKING:
    from matplotlib.axes import Axes

CRACK, LENGTH = 0.5, 2.0  # half the width is 1; half the length
_ERRORS = {
    "plane_strain": Convergence(
        1.695, 0.613, "36 to 4624 elements: 19.0, 8.58, 3.00, 1.86, 1.01 % above"
    ),
    "plane_stress": Convergence(
        2.142, 0.710, "36 to 4624 elements: 15.7, 7.55, 2.10, 1.08, 0.57 % above"
    ),
}


def build(nx: int, ny: int, ratio: float, kinematics: str) -> "la.Problem":
    """Return the problem: a quarter, graded towards the tip of the crack."""
    mesh = la.meshes.rectangle(
        x=(0, 1),
        y=(0, LENGTH),
        nx=nx,
        ny=ny,
        grade_x=(CRACK, ratio),
        grade_y=(0.0, 4 * ratio),  # four times as far as in x: cells of one size at the tip
    )
    return la.Problem(
        bodies={"strip": la.Body(mesh, la.VonMises(shear_strength=1.0), kinematics)},
        supports=[la.Fix("strip", "left", "x"), la.Fix("strip", _ligament, "y")],
        reference_loads=[la.Traction("strip", "top", (0, 1))],
    )


def _ligament(x: Floats) -> Bools:
    return np.asarray((x[1] < 1e-9) & (x[0] > CRACK - 1e-9))


def reference(kinematics: str) -> Reference:
    """Return the reference: ligaments at yield."""
    if kinematics == "plane_stress":
        return Reference(
            sqrt(3) * (1 - CRACK),
            "s0 (1 - a) = sqrt3 k (1 - a)",
            "analytical: a strip of stress next to the crack, and a straight neck",
            "exact",
        )
    return Reference(
        2 * (1 - CRACK),
        "2 k (1 - a)",
        "analytical: a strip of stress next to the crack, and a straight cut",
        "exact",
    )


def band(elements: int, kinematics: str) -> Band:
    """Return the band: strict upper bound."""
    return _ERRORS[kinematics].strict(elements)


_ORDERS = {  # grading per sqrt(n), order, both as measured
    "plane_strain": (1.5, 0.64, "0.636 +- 0.048", "0.465 +- 0.004"),
    "plane_stress": (2.0, 0.76, "0.764 +- 0.041", "0.484 +- 0.002"),
}


def order(kinematics: str) -> Order:
    """Return the order of convergence.

    Above 1/2, which is that of a cut smeared over one element, as meshes are graded more.
    """
    ratio, expected, graded, equal = _ORDERS[kinematics]
    return Order(
        tuple({"nx": n, "ny": n, "ratio": ratio * sqrt(n)} for n in (6, 8, 10, 14, 18)),
        expected,
        0.1,
        "The cut, or the neck, is a band of one element's width: an error of the size of elements,"
        f" order 1/2 on equal cells (measured: {equal}, 128 to 2048 elements). Grading towards the"
        f" tip gains: measured {graded} (95 %) over 144 to 1296 elements.",
    )


def sketch(axes: "Axes", problem: "la.Problem") -> None:
    """Draw the cut, or the middle of the neck."""
    (body,) = problem.bodies.values()
    assert isinstance(body, la.Body)
    height = (1 - CRACK) * (1.0 if body.kinematics == "plane_strain" else 1 / sqrt(2))
    axes.plot([CRACK, 1], [0, height], color="#7a6a3a", lw=1.0, ls=(0, (5, 3)), zorder=3.5)


CASE = Case(
    id="centre-crack",
    title="Strip in tension with a crack across its middle",
    tags=("continuum", "singular point", "upper bound", "closed form"),
    unit="mean traction / k",
    explanation=__doc__,
    hand_calculation="""\
from below:  sigma_y = 2 k next to the crack, 0 above and below
             it; rigid grips at the ends put up with this
             force F = 2 (2 k) (1 - a) over a width of 2
from above:  ends part at rate 2 v; four cuts of length
             sqrt2 (1 - a) with a velocity jump sqrt2 v dissipate
             D = 8 k (1 - a) v = 2 v F
both:        alpha = F/2 = 2 k (1 - a) = 1 k
plane stress: s0 in place of 2 k, from below as before; from
             above a neck at b to the crack with tan b = 1/sqrt2
             alpha = sqrt3 k (1 - a) = 0.866025 k
""",
    meshes={
        "coarse": {"nx": 3, "ny": 3, "ratio": 3.0},
        "medium": {"nx": 12, "ny": 12, "ratio": 10.0},
        "fine": {"nx": 34, "ny": 34, "ratio": 30.0},
    },
    build=build,
    reference=reference,
    band=band,
    order=order,
    bracket=Bracketing(target_width=0.005),
    sketch=sketch,
    first=First(meshes=("medium",), bracket=0.02),
    variants=(
        Variant("plane-strain", {"kinematics": "plane_strain"}),
        Variant("plane-stress", {"kinematics": "plane_stress"}),
    ),
)
