r"""A slope of height H = 1 in soil with friction and cohesion: the largest gamma H / c.

                              |<------ 1.8 ------>|
                   crest   ___o___________________o
                          /  .                    o
                       H /  .                     o  u = 0
                        / .   1                   o
          o------------/ '  beta                  o    gamma
    u = 0 o          toe                          o      |
          o                                       o      v
          o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o
          |<-- 0.6 -->|      u = 0            depth 0.5

A body (1) turns out of the face along a logarithmic spiral through the toe, which opens as the soil
dilates: an analytical upper bound. No closed form is known; proven lower bounds must stay below the
spiral, and are close to it.

The toe is a singular point: meshes are graded towards it.
"""

import lacore as la
from lacore_verification.case import Band, Case, Convergence, First, Reference, Variant
from lacore_verification.case.band import Bracketing
from lacore_verification.cases.shared.slopes import MESHES, held, mesh_of_slope

_PROVEN = {(60.0, 20.0): (10.2925, 10.3907), (45.0, 10.0): (9.2090, 9.3098)}
"""By slope and friction angle: a strict lower bound, and the least of spirals through the toe."""

_STEEP = Convergence(
    10.4, 0.88, "60 and 20 degrees, 40 to 1368 elements: 27.4, 26.7, 10.0, 3.5, 1.8 % above"
)
_GENTLE = Convergence(
    5.26, 0.91, "45 and 10 degrees, 40 to 1368 elements: 19.7, 11.9, 6.3, 1.8, 0.7 % above"
)


def build(nx: int, ny: int, ratio: float, slope: float, angle: float) -> "la.Problem":
    """Return the problem: soil around the toe at the origin, graded towards it."""
    mesh = mesh_of_slope(nx, ny, ratio, slope)
    return la.Problem(
        bodies={"soil": la.Body(mesh, la.MohrCoulomb(1.0, angle))},
        supports=held(),
        reference_loads=[la.BodyForce("soil", (0, -1))],
    )


def reference(slope: float, angle: float) -> Reference:
    """Return the reference: below the spiral, and by little."""
    least, most = _PROVEN[slope, angle]
    return Reference(
        (least + most) / 2,
        "limit analysis from both sides",
        "from above the logarithmic spiral of Chen 1975, minimised anew; from below equilibrium"
        " elements of lacore, 3673 and 6605 of them",
        "bracket",
        half_width=(most - least) / 2,
    )


def band(elements: int, slope: float, angle: float) -> Band:
    """Return the band: strict upper bound."""
    return (_STEEP if slope == 60 else _GENTLE).strict(elements)


CASE = Case(
    id="slope-phi",
    title="Slope of soil with friction",
    tags=("continuum", "soil", "singular point", "body force", "upper bound", "bracket"),
    unit="gamma H/c",
    explanation=__doc__,
    hand_calculation="""\
spiral:       r = r0 exp(t tan(phi)) through the toe; the body that it
              cuts off turns about its centre with w
              dissipation c r0^2 w (exp(2 t tan(phi)) - 1)/(2 tan(phi))
              alpha = dissipation / power of the unit weight
              the least over both angles (Chen 1975):
              beta = 60, phi = 20: 10.3907
              beta = 45, phi = 10:  9.3097
friction alone, c = 0, holds a slope that is no steeper than phi.
""",
    meshes=MESHES,
    build=build,
    reference=reference,
    band=band,
    surfaces=True,
    bracket=Bracketing(target_width=0.25),
    first=First(meshes=("medium",)),
    variants=(
        Variant("steep", {"slope": 60.0, "angle": 20.0}, ("coarse",)),
        Variant("gentle", {"slope": 45.0, "angle": 10.0}, ("coarse",)),
    ),
)
