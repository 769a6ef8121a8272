r"""A rigid strip footing of half width 1 is pressed into a half space of a von Mises material.

The right half is modelled. The footing is smooth (the soil slides freely beneath it) or rough (the
soil sticks to it); the collapse pressure is the same.

              alpha
              | | |
              v v v  footing
          o-----------+-----------------.---------------+
    u_x=0 o \    1   / \ .         3  .                 |
          o   \    /    \  2 .      .                   |
          o     \/_      \ .   .  .                     |  u = 0
          o          -  _ _ _ -                         |
          o---------------------------------------------+
                              u = 0
          |<--- 1 --->|
          |<-------------------- 4 -------------------->|   depth 2

Three zones: an active wedge (1) goes down, a 90-degree fan (2) turns the motion around the edge of
the footing, a passive wedge (3) goes up. The edge is a singular point where the strain rate is not
bounded, so the mesh is graded towards it: uniform meshes converge at order 1 only.
"""

from math import pi, sqrt
from typing import TYPE_CHECKING

import numpy as np

import lacore as la
from lacore.numerics.arrays import Bools, Floats
from lacore_verification.case import Band, Case, Convergence, First, Order, Reference, Variant
from lacore_verification.case.band import Bracketing

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_SMOOTH = Convergence(
    5.41, 0.965, "120 to 7440 elements: 5.33, 1.87, 0.707, 0.320, 0.150, 0.100 % above"
)
_ROUGH = Convergence(
    2.24, 0.68, "120 to 7440 elements: 8.63, 3.73, 1.92, 1.08, 0.690, 0.530 % above"
)

_LADDER = tuple(
    {"nx": nx, "ny": ny, "ratio_x": ratio_x, "ratio_y": ratio_y}
    for nx, ny, ratio_x, ratio_y in (
        (8, 4, 30.0, 10.0),
        (12, 6, 50.0, 16.0),
        (16, 9, 75.0, 24.0),
        (24, 13, 130.0, 42.0),
        (32, 17, 180.0, 60.0),
    )
)


def build(nx: int, ny: int, ratio_x: float, ratio_y: float, rough: bool) -> "la.Problem":
    """Return the problem: the right half, graded towards the edge of the footing."""
    mesh = la.meshes.rectangle(
        x=(0, 4), y=(-2, 0), nx=nx, ny=ny, grade_x=(1.0, ratio_x), grade_y=(0.0, ratio_y)
    )
    return la.Problem(
        bodies={"soil": la.Body(mesh, la.VonMises(shear_strength=1.0))},
        supports=[
            la.Fix("soil", "left", "x"),
            la.Fix("soil", "bottom"),
            la.Fix("soil", "right"),
        ],
        reference_loads=[la.RigidFooting("soil", _under_footing, (0, -1), rough=rough)],
    )


def _under_footing(x: Floats) -> Bools:
    return np.asarray((x[1] > -1e-9) & (x[0] < 1 + 1e-9))


def reference(rough: bool) -> Reference:
    """Return the reference: Prandtl's solution, for either footing."""
    return Reference(
        2 + pi, "(2 + pi) k", "Prandtl 1920; Hill, The Mathematical Theory of Plasticity", "exact"
    )


def band(elements: int, rough: bool) -> Band:
    """Return the band.

    Strict upper bound; a rough footing adds a stress jump at its surface, hence more error.
    """
    return (_ROUGH if rough else _SMOOTH).strict(elements)


def order(rough: bool) -> Order:
    """Return the order of convergence.

    Graded meshes win back most of what the singular edge costs.
    """
    if rough:
        return Order(
            _LADDER,
            0.64,
            0.1,
            "Measured: 0.640 +- 0.038 (95 %) over 128 to 2176 elements, 0.68 over 120 to 7440. The"
            " stress jumps along a rough footing, which grading towards its edge does not resolve."
            " Without grading 1/2.",
        )
    return Order(
        _LADDER,
        0.9,
        0.1,
        "Measured: 0.894 +- 0.069 (95 %) over 128 to 2176 elements, 0.965 over 120 to 7440:"
        " towards 1, that of squared mesh sizes, as meshes are graded to the edge ever more."
        " Without grading 1/2.",
    )


def sketch(axes: "Axes", problem: "la.Problem") -> None:
    """Draw the three zones."""
    turn = np.linspace(-3 * pi / 4, -pi / 4, 40)
    fan_x, fan_y = 1 + sqrt(2) * np.cos(turn), sqrt(2) * np.sin(turn)
    for line in (([*fan_x, 3], [*fan_y, 0]), ([0, 1, 2], [-1, 0, -1])):
        axes.plot(*line, color="#7a6a3a", lw=1.0, ls=(0, (5, 3)), zorder=3.5)
    for text, x, y in (("1", 0.3, -0.3), ("2", 1.0, -0.8), ("3", 2.0, -0.35)):
        axes.text(x, y, text, color="#7a6a3a", fontsize=9, ha="center", va="center")


CASE = Case(
    id="prandtl-punch",
    title="Strip footing on a half space (Prandtl)",
    tags=("continuum", "singular point", "upper bound"),
    unit="mean footing pressure / k",
    explanation=__doc__,
    hand_calculation="""\
passive wedge 3:  free surface, sigma_y = 0
                  mean pressure p3 = k
fan 2:            Hencky, p changes by 2 k times the turn (pi/2)
                  p1 = p3 + pi k
active wedge 1:   sigma_y = -(p1 + k)
                  alpha = (2 + pi) k = 5.141593 k
""",
    meshes={
        "coarse": {"nx": 4, "ny": 2, "ratio_x": 12.0, "ratio_y": 4.0},
        "medium": {"nx": 16, "ny": 9, "ratio_x": 75.0, "ratio_y": 24.0},
        "fine": {"nx": 48, "ny": 25, "ratio_x": 300.0, "ratio_y": 100.0},
    },
    build=build,
    reference=reference,
    band=band,
    order=order,
    bracket=Bracketing(target_width=0.005),
    sketch=sketch,
    first=First(meshes=("medium",), bracket=0.02),
    variants=(Variant("smooth", {"rough": False}), Variant("rough", {"rough": True})),
)
