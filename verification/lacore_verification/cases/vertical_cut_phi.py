r"""A vertical cut of height H = 1 in soil with friction: the largest gamma H / c.

                     |<----- 1.6 ---->|
              free   +----------------o
                     |           .    o
                   H |   1    .       o  u = 0
                     |     .          o
          +----------+ . '            o    gamma
      u=0 o          toe              o      |
          o                           o      v
          o-o-o-o-o-o-o-o-o-o-o-o-o-o-o
          |<-- 1 --->|       u = 0         depth 0.7

The soil of `vertical-cut`, with friction: a body (1) turns out of the face along a logarithmic
spiral through the toe, which opens as the soil dilates. It is an analytical upper bound. No closed
form is known; proven lower bounds must stay below the spiral.

The toe is a singular point: meshes are graded towards it.
"""

import numpy as np

import lacore as la
from lacore_verification.case import Band, Case, Convergence, First, Reference, Variant
from lacore_verification.case.band import Bracketing

_PROVEN = {20.0: (5.4479, 5.5049), 30.0: (6.6528, 6.6869)}
"""By friction angle: a strict lower bound, and the least of spirals through the toe."""

_MILD = Convergence(
    10.6, 0.90, "20 degrees, 32 to 4744 elements: 36.2, 12.7, 4.18, 1.65, 0.40 % above the spiral"
)
_STEEP = Convergence(
    13.5, 0.90, "30 degrees, 32 to 4744 elements: 49.7, 16.7, 4.15, 2.71, 0.54 % above the spiral"
)


def build(nx: int, ny: int, ratio: float, angle: float) -> "la.Problem":
    """Return the problem.

    Soil around the toe at the origin, graded towards it; nx by ny cells before the cut.
    """
    block = la.meshes.rectangle(
        x=(-1, 1.6), y=(-0.7, 1), nx=nx, ny=ny, grade_x=(0.0, ratio), grade_y=(0.0, ratio)
    )
    x, y = block.p[:, block.t].mean(axis=1)
    mesh = block.remove_elements(np.flatnonzero((x < 0) & (y > 0)))
    return la.Problem(
        bodies={"soil": la.Body(mesh, la.MohrCoulomb(1.0, angle))},
        supports=[la.Fix("soil", side) for side in ("bottom", "left", "right")],
        reference_loads=[la.BodyForce("soil", (0, -1))],
    )


def reference(angle: float) -> Reference:
    """Return the reference: below the spiral, and by little."""
    least, most = _PROVEN[angle]
    return Reference(
        (least + most) / 2,
        "limit analysis from both sides",
        "from above the logarithmic spiral of Chen 1975, minimised anew; from below equilibrium"
        " elements of lacore, 1157 and 2828 of them",
        "bracket",
        half_width=(most - least) / 2,
    )


def band(elements: int, angle: float) -> Band:
    """Return the band: strict upper bound."""
    return (_MILD if angle <= 20 else _STEEP).strict(elements)


CASE = Case(
    id="vertical-cut-phi",
    title="Vertical cut in soil with friction",
    tags=("continuum", "soil", "singular point", "body force", "upper bound", "bracket"),
    unit="gamma H/c",
    explanation=__doc__,
    hand_calculation="""\
plane wedge:  slides at 45 + phi/2, velocity phi off the plane
              alpha = 4 tan(45 + phi/2): 5.712592 at phi = 20
spiral:       r = r0 exp(t tan(phi)) through the toe
              dissipation c r0^2 w (exp(2 t tan(phi)) - 1)/(2 tan(phi))
              its least alpha over both angles (Chen 1975):
              5.5049, 6.6869 at phi = 20, 30
from below:   sigma_y = -gamma (1 - y) behind the face, else 0:
              alpha = 2 tan(45 + phi/2)
""",
    meshes={
        "coarse": {"nx": 4, "ny": 3, "ratio": 4.0},
        "medium": {"nx": 16, "ny": 12, "ratio": 10.0},
        "fine": {"nx": 46, "ny": 34, "ratio": 30.0},
    },
    build=build,
    reference=reference,
    band=band,
    surfaces=True,
    bracket=Bracketing(target_width=0.15),
    first=First(meshes=("medium",)),
    variants=(
        Variant("phi-20", {"angle": 20.0}),
        Variant("phi-30", {"angle": 30.0}, ("coarse",)),
    ),
)
