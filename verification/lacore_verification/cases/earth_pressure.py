r"""A rigid wall of height H = 1 is moved against soil, or away from it: passive, active pressure.

               q  q  q  q  q  q  q  q
        +-----+v--v--v--v--v--v--v--v-+
  alpha |     |                   .   o
    --> | wall|  delta        .       o
    --> |     |           .           o  gamma
    --> |     | 1     . '             o  c, phi
        oo o oo toe . '               o
        o      '- -                   o
        o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o
        |<0.5>|<------- 3.6 --------->|  depth 1.5

The wall runs on rollers over a smooth bed and does not turn. Its face is smooth or rough: soil
slips past it where the traction is at the angle delta off the normal, and opens as it slips
(associated friction), so that bounds hold. Passive, alpha is the mean pressure it is pushed with;
active, soil would push it away, and the load that lets it go is negative: minus the pressure.

A smooth wall has Rankine's uniform stress ratio, whatever weight, surcharge and cohesion: unlike
under a footing they superpose. Next to a rough wall and without weight, a fan around the top of the
wall turns the stress from the face (1) to the surface: Prandtl's field again. With weight and
roughness there is no closed form.

The toe, and the top of a rough wall, are singular points. Soil without cohesion has a cohesion of
1e-5 q, so that stresses can be proven in floating point; the reference does not contain it, it is
2e-5 of it.
"""

from math import asin, cos, exp, pi, radians, sin, sqrt, tan

import numpy as np

import lacore as la
from lacore.model.conditions.loads import Load
from lacore.numerics.arrays import Bools, Floats
from lacore_verification.case import Band, Bracketing, Case, Convergence, First, Reference, Variant

WIDTH, DEPTH, THICKNESS = 3.6, 1.5, 0.5
_LENT = 1e-5  # Pa

_RANKINE = Convergence(
    11.8, 0.715, "30 degrees, 40 to 1664 elements: 80.0, 40.2, 21.2, 12.5, 5.7 % above"
)
_RANKINE_ACTIVE = Convergence(
    5.01, 0.626, "30 degrees, 40 to 1664 elements: 49.8, 26.1, 17.1, 9.3, 4.8 % above"
)
_ROUGH = Convergence(
    5.11, 0.680, "delta = phi = 30, 40 to 1664 elements: 41.6, 17.5, 10.2, 6.3, 3.3 % above"
)
_ROUGH_ACTIVE = Convergence(
    3.60, 0.660, "delta = phi = 30, 40 to 1664 elements: 27.7, 16.3, 10.3, 5.2, 2.5 % above"
)


def build(
    nx: int,
    ny: int,
    ratio: float,
    angle: float,
    delta: float,
    cohesion: float,
    weight: float,
    active: bool,
) -> "la.Problem":
    """Return the problem.

    Soil before the wall and under its bed, graded towards the toe; surcharge 1.
    """
    block = la.meshes.rectangle(
        x=(-THICKNESS, WIDTH),
        y=(-DEPTH, 0),
        nx=nx,
        ny=ny,
        grade_x=(0.0, ratio),
        grade_y=(-1.0, ratio),
    )
    x, y = block.p[:, block.t].mean(axis=1)
    mesh = block.remove_elements(np.flatnonzero((x < 0) & (y > -1))).with_boundaries(
        {"face": _face, "bed": _bed, "top": _top, "left": _left}
    )
    outline = [(-THICKNESS, -1), (0, -1), (0, 0), (-THICKNESS, 0)]
    dead: list[Load] = [la.Pressure("soil", "top", 1.0)]
    dead += [la.BodyForce("soil", (0, -weight))] if weight else []
    rough = la.Coulomb(tan(radians(delta)), associated=True) if delta else la.SMOOTH
    return la.Problem(
        bodies={
            "soil": la.Body(mesh, la.MohrCoulomb(cohesion or _LENT, angle)),
            "wall": la.RigidBlock(outline),
        },
        supports=[
            *(la.Fix("soil", side) for side in ("left", "bottom", "right")),
            la.Fix("wall", _bed, "y"),
        ],
        interfaces=[
            la.Interface(("soil", "face"), ("wall", _face), rough),
            la.Interface(("soil", "bed"), ("wall", _bed), la.SMOOTH),
        ],
        reference_loads=[la.Traction("wall", _left, (-1.0 if active else 1.0, 0.0))],
        dead_loads=dead,
    )


def _face(x: Floats) -> Bools:
    return np.asarray((np.abs(x[0]) < 1e-9) & (x[1] > -1))


def _bed(x: Floats) -> Bools:
    return np.asarray((np.abs(x[1] + 1) < 1e-9) & (x[0] < 0))


def _top(x: Floats) -> Bools:
    return np.asarray(x[1] > -1e-9)


def _left(x: Floats) -> Bools:
    return np.asarray(x[0] < -THICKNESS + 1e-9)


def reference(
    angle: float, delta: float, cohesion: float, weight: float, active: bool
) -> Reference:
    """Return the reference: Rankine's pressure of a smooth wall, Prandtl's field of a rough one."""
    phi, rub, side = radians(angle), radians(delta), -1.0 if active else 1.0
    if not delta:
        ratio = tan(pi / 4 + side * phi / 2) ** 2
        mean = ratio * (1 + weight / 2) + side * 2 * cohesion * sqrt(ratio)
        return Reference(
            side * mean,
            "K (q + gamma H/2) +- 2 c sqrt(K), K = tan(45 +- phi/2)^2",
            "Rankine 1857",
            "exact",
        )
    root = side * sqrt(sin(phi) ** 2 - sin(rub) ** 2)
    turned = side * (asin(sin(rub) / sin(phi)) + side * rub)
    ratio = cos(rub) * (cos(rub) + root) / (1 - side * sin(phi)) * exp(turned * tan(phi))
    return Reference(
        side * ratio,
        "cos(d) (cos(d) +- sqrt(sin(phi)^2 - sin(d)^2))/(1 -+ sin(phi)) exp(+-(D +- d) tan(phi)),"
        " D = asin(sin(d)/sin(phi))",
        "Prandtl's field next to a wall, after Sokolovskii",
        "exact",
    )


def valid(angle: float, delta: float, cohesion: float, weight: float, active: bool) -> bool:
    """Return whether the parameters are valid.

    A rough wall has a closed form without weight and cohesion, and is no rougher than soil.
    """
    return not delta or (delta <= angle and not (weight or cohesion))


def band(
    elements: int, angle: float, delta: float, cohesion: float, weight: float, active: bool
) -> Band:
    """Return the band: strict upper bound."""
    if delta:
        return (_ROUGH_ACTIVE if active else _ROUGH).strict(elements)
    return (_RANKINE_ACTIVE if active else _RANKINE).strict(elements)


def _variant(
    name: str, delta: float, cohesion: float = 0.0, weight: float = 0.0, active: bool = False
) -> Variant:
    parameters = {
        "angle": 30.0,
        "delta": delta,
        "cohesion": cohesion,
        "weight": weight,
        "active": active,
    }
    return Variant(name, parameters, ("coarse",))


CASE = Case(
    id="earth-pressure",
    title="Earth pressure on a wall, smooth or rough, passive or active",
    tags=("continuum", "soil", "blocks", "contact", "singular point", "upper bound", "bracket"),
    unit="mean pressure on the wall / q",
    explanation=__doc__,
    hand_calculation="""\
smooth:  sigma_1, sigma_3 upright and level: Mohr's circle
         p = K (q + gamma y) +- 2 c sqrt(K)
         K = tan(45 +- phi/2)^2
         mean over H = 1: K (q + gamma/2) +- 2 c sqrt(K)
rough:   weightless, c = 0; passive, with r = sin(d)/sin(phi)
 face:   traction at d, D = asin(r); mean stress m
         sigma_n = m cos(d) (cos(d) + root)
         root = sqrt(sin(phi)^2 - sin(d)^2)
 fan:    turns by (D + d)/2
         m = m_top exp((D + d) tan(phi))
 top:    sigma_3 = q = m_top (1 - sin(phi))
         active: signs of phi, d and of the root reversed
phi = 30:    d = 15      20      30
  passive    4.28765  4.63271  5.02620
  active     0.29441  0.28522  0.27315
""",
    meshes={
        "coarse": {"nx": 4, "ny": 3, "ratio": 3.0},
        "medium": {"nx": 15, "ny": 11, "ratio": 6.0},
        "fine": {"nx": 45, "ny": 31, "ratio": 10.0},
    },
    build=build,
    reference=reference,
    valid=valid,
    band=band,
    surfaces=True,
    bracket=Bracketing(target_width=0.3),
    first=First(meshes=(), bracket=0.03),
    variants=(
        _variant("half", 15.0),
        _variant("full", 30.0),
        _variant("full-active", 30.0, active=True),
        _variant("smooth", 0.0, cohesion=1.0, weight=1.0),
        _variant("smooth-active", 0.0, cohesion=0.1, weight=1.0, active=True),
    ),
)
