r"""A slope of height H = 1 under and next to water: the largest gamma H / c.

          . . . . . . . . . . . . . . . . . . . . .  submerged
                              |<------ 1.8 ------>|
                           ___o___________________o
                          /                       o
          - - - - - - - -/- - - - - - - - - - - - o  pool, at half of the height
                        / beta                    o  u = 0
          o------------/                          o    gamma
    u = 0 o          toe                          o      |
          o                                       o      v
          o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o
          |<-- 0.6 -->|      u = 0            depth 0.5

The soil of `slope-phi`, beta = 60 and phi = 20 degrees, of unit weight gamma. Water weighs half of
that, and grows with it, as it does with the height of a slope. Pores are pressed as by water at
rest.

Submerged, under 0.5 of free water, it is a slope of its buoyant weight: Archimedes. Next to a pool,
which presses on the face, it carries more than without water. Where the pool is gone, and the pore
water is not, it carries a third less: the safe side of a rapid drawdown, and the ground in front
lifts.

The toe is a singular point: meshes are graded towards it. The surface of the water is one of their
rows, as pressures are linear in elements.
"""

import lacore as la
from lacore_verification.case import Band, Case, Convergence, First, Reference, Variant
from lacore_verification.case.band import Bracketing
from lacore_verification.cases.shared.slopes import MESHES, held, mesh_of_slope

_SLOPE, _ANGLE, _WATER = 60.0, 20.0, 0.5
_DRY = (10.2925, 10.3907)
"""Of `slope-phi`: a strict lower bound, and the least of spirals through the toe."""
_POOL = (11.8438, 11.9005)
_DRAWN_DOWN = (7.1989, 7.2388)

_ERROR = Convergence(10.4, 0.88, "as of `slope-phi`, 40 to 1368 elements: 27 to 1.8 % above")


def build(nx: int, ny: int, ratio: float, level: float, pool: bool) -> "la.Problem":
    """Return the problem.

    Soil around the toe at the origin, with water up to a level, and in front of it, or not.
    """
    row = level if level < 1 else 0.0
    mesh = mesh_of_slope(nx, ny, ratio, _SLOPE, row)
    table = la.WaterTable(level, _WATER)
    free = [la.StandingWater("soil", "ground", table)] if pool else []
    return la.Problem(
        bodies={"soil": la.Body(mesh, la.MohrCoulomb(1.0, _ANGLE))},
        supports=held(),
        reference_loads=[
            la.BodyForce("soil", (0, -1)),
            la.PorePressure("soil", table),
            *free,
        ],
    )


def reference(level: float, pool: bool) -> Reference:
    """Return the reference: by buoyant weight, below the spiral, or between bounds."""
    if pool and level > 1:
        least, most = (own / (1 - _WATER) for own in _DRY)
        formula = "that of a dry slope, slope-phi, over 1 - gamma_w/gamma"
        source = "Archimedes, and the bracket of `slope-phi`"
    elif pool:
        (least, most), formula = _POOL, "limit analysis from both sides"
        source = (
            "from above a logarithmic spiral through the toe, with the power of the water on what"
            " it opens and on the face; from below equilibrium elements of lacore, 2928 of them"
        )
    else:
        (least, most), formula = _DRAWN_DOWN, "limit analysis from both sides"
        source = (
            "equilibrium elements and velocities of lacore, up to 3142 elements; the spiral through"
            " the toe is an upper bound, 7.548, and not the closest"
        )
    return Reference((least + most) / 2, formula, source, "bracket", half_width=(most - least) / 2)


def band(elements: int, level: float, pool: bool) -> Band:
    """Return the band: strict upper bound."""
    return _ERROR.strict(elements)


CASE = Case(
    id="slope-with-water",
    title="Slope of soil with water in and before it",
    tags=("continuum", "soil", "water", "singular point", "body force", "upper bound", "bracket"),
    unit="gamma H/c",
    explanation=__doc__,
    hand_calculation="""\
submerged:    on soil and on the boundary water does the power
              int u div(v) dV - int u v.n dS = - int grad(u).v dV
              = power of gamma_w upwards: weight gamma - gamma_w
              alpha = 10.3907/(1 - 1/2) = 20.7813 at most
pool:         a body that turns about the centre of the spiral
              r = r0 exp(t tan(phi)) opens it by r w sin(phi):
              water does  int u w r^2 tan(phi) dt  along it, and
              - int u v.n dS on the face
              the least over both angles: 11.9004
drawn down:   the same without the face: 7.5480 at most
""",
    meshes=MESHES,
    build=build,
    reference=reference,
    band=band,
    surfaces=True,
    bracket=Bracketing(target_width=0.25),
    first=First(meshes=("medium",)),
    variants=(
        Variant("submerged", {"level": 1.5, "pool": True}, ("coarse",)),
        Variant("pool", {"level": 0.5, "pool": True}, ("coarse",)),
        Variant("drawn-down", {"level": 0.5, "pool": False}, ("coarse",)),
    ),
)
