r"""A rigid strip footing of half width 1 on sand: what weight alone carries, N_gamma.

The right half is modelled; no cohesion, unit weight gamma = 1.

              alpha
              | | | |
              v v v v footing            free
          o-----------+-------------------------------o
    u_x=0 o    . '    |  .                  .         o
          o . '        |    `  .       . '            o   u = 0
          o` - _        |       . ' '                 o
          o      ` - _ _ _ - '            | gamma     o
          o                               v           o
          o-------------------------------------------o
                              u = 0
          |<--- 1 --->|

The shear strength of sand is that of its own weight above, so that slip lines are curved all
through, and stresses fall to nothing at the edge of the footing: the pressure under it rises from
there inwards, to twice its mean and more. A rough footing holds a wedge beneath itself and carries
almost twice of what a smooth one does. There is no closed form: slip lines are integrated
numerically, and where their net continues to a stress field of all the soil its load is exact.

No stress is admissible in floating point where nothing presses and nothing coheres. So the soil has
a cohesion of 1e-5 gamma times the half width, which lifts the load by 1e-4 of it. Its mechanism
outruns the footing, 585 times at the edge on the finest mesh, and is then solved once more in units
of local speeds.
"""

import numpy as np

import lacore as la
from lacore.numerics.arrays import Bools, Floats
from lacore_verification.case import Band, Bracketing, Case, Convergence, First, Reference, Variant

_EXACT = {
    (20.0, False): 1.57863,
    (20.0, True): 2.8389,
    (30.0, False): 7.6530,
    (30.0, True): 14.7545,
}
"""(angle, rough) to N_gamma; a unit of the last digit is what they may be off by."""
_LENT = 1e-5  # Pa
_BOX = {20.0: (4.0, 1.8), 30.0: (5.0, 2.3)}
"""Width and depth by angle; a rough footing moves soil as far as 2.5 and 3.6 sideways."""

_SMOOTH = Convergence(
    9.08, 0.689, "30 degrees, 72 to 2048 elements: 47.2, 32.9, 18.4, 11.9, 7.0, 4.8 % above"
)
_ROUGH = Convergence(
    13.0, 0.665, "30 degrees, 72 to 2048 elements: 75.2, 53.7, 29.5, 20.0, 12.0, 8.3 % above"
)


def build(nx: int, ny: int, ratio: float, angle: float, rough: bool) -> "la.Problem":
    """Return the problem.

    The right half, graded towards the edge; with half width and weight 1 alpha is N_gamma.
    """
    width, depth = _BOX[angle]
    mesh = la.meshes.rectangle(
        x=(0, width), y=(-depth, 0), nx=nx, ny=ny, grade_x=(1.0, ratio), grade_y=(0.0, ratio / 2)
    ).with_boundaries({"under": _under})
    return la.Problem(
        bodies={"sand": la.Body(mesh, la.MohrCoulomb(_LENT, angle))},
        supports=[
            la.Fix("sand", "left", "x"),
            la.Fix("sand", "bottom"),
            la.Fix("sand", "right"),
        ],
        reference_loads=[la.RigidFooting("sand", "under", (0, -1), rough=rough)],
        dead_loads=[la.BodyForce("sand", (0, -1))],
    )


def _under(x: Floats) -> Bools:
    return np.asarray((x[1] > -1e-9) & (x[0] < 1))


def reference(angle: float, rough: bool) -> Reference:
    """Return the reference: slip lines integrated numerically."""
    value = _EXACT[angle, rough]
    return Reference(
        value,
        "method of characteristics; no closed form",
        "90 and 180 slip lines extrapolated; agrees with the table of Martin 2005 to all of its"
        " digits. The half width is what the lent cohesion adds",
        "exact, numerical",
        half_width=2e-4 * value,
    )


def band(elements: int, angle: float, rough: bool) -> Band:
    """Return the band: strict upper bound."""
    return (_ROUGH if rough else _SMOOTH).strict(elements)


CASE = Case(
    id="strip-footing-gamma",
    title="Strip footing on sand, by its weight alone",
    tags=("continuum", "soil", "body force", "upper bound", "bracket"),
    unit="N_gamma = mean pressure / (gamma B/2)",
    explanation=__doc__,
    hand_calculation="""\
scale:        no cohesion, no surcharge: pressure ~ gamma B/2,
              the only stress there is
at the edge:  Prandtl's fan turns stresses that are zero: N_q 0 = 0
inwards:      pressure grows linearly there, as depth does
slip lines:   dp and dtheta along both families with weight
              (Martin 2005), integrated inwards from the free
              surface: N_gamma
                        smooth    rough
  phi = 20             1.57863   2.8389
  phi = 30             7.6530   14.7545
a fit:        (N_q - 1) tan(1.34 phi): 2.83 and 14.7 (rough)
""",
    meshes={
        "coarse": {"nx": 5, "ny": 2, "ratio": 4.0},
        "medium": {"nx": 16, "ny": 9, "ratio": 10.0},
        "refined": {"nx": 28, "ny": 16, "ratio": 30.0},
        "fine": {"nx": 44, "ny": 26, "ratio": 16.0},
    },
    build=build,
    reference=reference,
    band=band,
    surfaces=True,
    bracket=Bracketing(target_width=0.6),
    first=First(meshes=("refined",)),
    variants=(
        Variant("smooth-30", {"angle": 30.0, "rough": False}, ("coarse",)),
        Variant("rough-30", {"angle": 30.0, "rough": True}, ("coarse",)),
        Variant("rough-20", {"angle": 20.0, "rough": True}, ("coarse",)),
    ),
)
