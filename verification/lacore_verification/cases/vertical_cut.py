r"""A vertical cut of height H = 1 stands up under its own weight gamma: the largest gamma H / k.

                     |<----- 1.6 ---->|
              free   +----------------o
                     |            .   o
                   H |   1     .      o  u = 0
                     |      .         o
          +----------+ .  '           o    gamma
      u=0 o          toe              o      |
          o                           o      v
          o-o-o-o-o-o-o-o-o-o-o-o-o-o-o
          |<-- 1 --->|       u = 0         depth 0.7

A wedge of soil (1) slides down behind the face and out at the toe, along a surface that is a little
curved. No closed form is known; it is the classical example of a problem that bounds from both
sides have closed in on, over fifty years. The far sides are held and take no part in the collapse.

The toe is a singular point: meshes are graded towards it.
"""

import numpy as np

import lacore as la
from lacore_verification.case import Band, Case, Convergence, First, Order, Reference, Variant
from lacore_verification.case.band import Bracketing

_ERROR = Convergence(2.671, 0.707, "32 to 4744 elements: 22.7, 6.50, 3.00, 1.39, 0.64 % above")


def build(nx: int, ny: int, ratio: float) -> "la.Problem":
    """Return the problem.

    Soil around the toe at the origin, graded towards it; nx by ny cells before the cut.
    """
    block = la.meshes.rectangle(
        x=(-1, 1.6), y=(-0.7, 1), nx=nx, ny=ny, grade_x=(0.0, ratio), grade_y=(0.0, ratio)
    )
    x, y = block.p[:, block.t].mean(axis=1)
    mesh = block.remove_elements(np.flatnonzero((x < 0) & (y > 0)))
    return la.Problem(
        bodies={"soil": la.Body(mesh, la.VonMises(shear_strength=1.0))},
        supports=[la.Fix("soil", side) for side in ("bottom", "left", "right")],
        reference_loads=[la.BodyForce("soil", (0, -1))],
    )


def reference() -> Reference:
    """Return the reference: published bounds: about 100 times as close as the meshes here."""
    return Reference(
        3.7764,
        "limit analysis from both sides",
        "bounds 3.7752 and 3.7776 of Kammoun et al. 2010; Martin 2011: 3.7764978",
        "bracket",
        half_width=0.0012,
    )


def band(elements: int) -> Band:
    """Return the band: strict upper bound."""
    return _ERROR.strict(elements)


def order() -> Order:
    """Return the order of convergence: between 1/2, that of the toe without grading, and 1.

    Errors down to 2 % are 60 times what the reference is uncertain by.
    """
    sizes = ((5, 4, 4.0), (8, 6, 6.0), (11, 8, 8.0), (16, 12, 10.0), (20, 15, 14.0))
    return Order(
        tuple({"nx": nx, "ny": ny, "ratio": ratio} for nx, ny, ratio in sizes),
        0.74,
        0.08,
        "Measured: 0.741 +- 0.037 (95 %) over 64 to 912 elements, 0.707 from 32 to 4744. Grading"
        " towards the toe wins back a part of what it costs; without it 1/2.",
    )


CASE = Case(
    id="vertical-cut",
    title="Vertical cut under its own weight",
    tags=("continuum", "singular point", "body force", "upper bound", "bracket"),
    unit="gamma H/k",
    explanation=__doc__,
    hand_calculation="""\
from below:   sigma_y = -gamma (1 - y) behind the face, else 0:
              largest shear gamma H/2 = k         alpha = 2
from above:   a rigid wedge slides at 45 degrees with speed v
              weight gamma H^2/2, power gamma H^2 v/(2 sqrt2)
              cut of length sqrt2 H dissipates k sqrt2 H v
              alpha = gamma H/k = 4
a curved cut: 3.83 (Fellenius)
""",
    meshes={
        "coarse": {"nx": 4, "ny": 3, "ratio": 4.0},
        "medium": {"nx": 16, "ny": 12, "ratio": 10.0},
        "fine": {"nx": 46, "ny": 34, "ratio": 30.0},
    },
    build=build,
    reference=reference,
    band=band,
    order=order,
    bracket=Bracketing(target_width=0.005),
    first=First(meshes=("medium",), bracket=0.02),
    variants=(Variant("cut", {}),),
)
