r"""A strip with two notches, cut straight into it from both edges, is pulled until it tears.

           alpha                           alpha
         ^  ^  ^  ^                      ^  ^  ^  ^
       +------------+                  +------------+
       |            |                  o            |
       |            |                  o            |
       |            |           u_x=0  o            | free
       |---      ---|                  o            |
       |            |                  o   . ' .    |
       |            |                  o .  1   ' . |
       +------------+                  o-o-o--------+
         v  v  v  v                    u_y=0  notch, free
                                       |<-->|<----->|
                                        1/2    a = 1/2

Half the width is 1, a notch a = 1/2 deep; a quarter of the strip is modelled, of half length 2.
As under a punch, turned around, slip lines fan out around the tip of the notch (1) and meet on the
axis, and the ligament carries more than its 2 k. From a = 0.884 on the fan is complete, as under
the punch, and the ligament carries (2 + pi) k; here the strip gives way before, bending inwards
above the notches, so it must be long: half a length of 2 is enough.

The tip is a singular point: meshes are graded towards it.
"""

from math import log

import numpy as np

import lacore as la
from lacore.numerics.arrays import Bools, Floats
from lacore_verification.case import Band, Case, Convergence, First, Order, Reference, Variant
from lacore_verification.case.band import Bracketing

NOTCH, LENGTH = 0.5, 2.0  # half the width is 1; half the length
_ERROR = Convergence(1.033, 0.543, "36 to 4624 elements: 17.1, 5.90, 3.04, 1.92, 1.14 % above")


def build(nx: int, ny: int, ratio: float) -> "la.Problem":
    """Return the problem: a quarter, graded towards the tip of the notch."""
    mesh = la.meshes.rectangle(
        x=(0, 1),
        y=(0, LENGTH),
        nx=nx,
        ny=ny,
        grade_x=(1 - NOTCH, ratio),
        grade_y=(0.0, 4 * ratio),  # four times as far as in x: cells of one size at the tip
    )
    return la.Problem(
        bodies={"strip": la.Body(mesh, la.VonMises(shear_strength=1.0))},
        supports=[la.Fix("strip", "left", "x"), la.Fix("strip", _ligament, "y")],
        reference_loads=[la.Traction("strip", "top", (0, 1))],
    )


def _ligament(x: Floats) -> Bools:
    return np.asarray((x[1] < 1e-9) & (x[0] < 1 - NOTCH + 1e-9))


def reference() -> Reference:
    """Return the reference.

    Notches between shallow and deep: the fan reaches the free side before it is complete.
    """
    return Reference(
        2 * (1 - NOTCH) * (1 + log((1 - NOTCH / 2) / (1 - NOTCH))),
        "2 k (1 - a) (1 + ln((1 - a/2)/(1 - a)))",
        "Ewing & Hill 1967",
        "exact",
    )


def band(elements: int) -> Band:
    """Return the band: strict upper bound."""
    return _ERROR.strict(elements)


def order() -> Order:
    """Return the order of convergence.

    That of a singular point which a mild grading does not resolve: 1/2.
    """
    sizes = ((4, 3.0), (6, 5.0), (8, 7.0), (12, 10.0), (16, 14.0))
    return Order(
        tuple({"nx": n, "ny": n, "ratio": ratio} for n, ratio in sizes),
        0.5,
        0.06,
        "Velocities turn around the tip of the notch within any element there is: order 1/2."
        " Measured: 0.487 +- 0.031 (95 %) over 64 to 1024 elements, 0.476 +- 0.028 up to 1296.",
    )


CASE = Case(
    id="notched-strip",
    title="Strip in tension with two edge notches (Ewing & Hill)",
    tags=("continuum", "singular point", "upper bound", "closed form"),
    unit="mean traction / k",
    explanation=__doc__,
    hand_calculation="""\
slab:        without its surroundings the ligament carries 2 k:
             alpha > 2 k (1 - a) = 1 k
deep:        fans of 90 degrees, as under a punch:
             alpha < (2 + pi) k (1 - a) = 2.571 k
a = 1/2:     2 k (1/2) (1 + ln(0.75/0.5))
             alpha = 1.405465 k
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
    first=First(meshes=("medium",), bracket=0.02),
    variants=(Variant("half", {}),),
)
