r"""A disc as high as its radius is upset between two rigid platens with Coulomb friction mu.

           alpha
        v  v  v  v  v                  platen, at rest
      +-------+-------+              //////// mu ////////
      |       :       |              +------------------+
      |  - -  :  - -  |  h = 1       |                  |  free
      |       :       |         axis |  quarter section |
      +-------+-------+              +------------------+
        ^  ^  ^  ^  ^                 ^  ^  ^  ^  ^  ^  ^
              |<- 1 ->|              smooth footing, moves up

Axisymmetric, r to the right and z upwards; by symmetry the upper half of a meridian section, seen
by an observer on the platen. Without friction the disc spreads evenly and needs its yield stress
times its area, whatever its height. Friction holds the material back, so that the pressure rises
towards the middle. The edge of the platen is a singular point. With friction the load need not be
unique; the reference encloses all Coulomb loads.
"""

from math import sqrt

import lacore as la
from lacore_verification.case import Band, Case, Convergence, Reference, Variant, exact_patch

RADIUS, HEIGHT = 1.0, 1.0  # of the disc; half of the height is modelled
_STICKING = 1 + 2 / (3 * sqrt(3)) * RADIUS / HEIGHT
_ERROR = Convergence(
    0.216,
    0.843,
    "mu = 0.4, the worst; 32 to 4800 elements: 1.16, 0.42, 0.13, 0.040, 0.018 % above the limit"
    " 1.1718 that they tend to",
)


def build(nx: int, ny: int, ratio: float, mu: float) -> "la.Problem":
    """Return the problem.

    A quarter of the section, graded towards the edge of the platen; yield stress 1.
    """
    half = HEIGHT / 2
    mesh = la.meshes.rectangle(
        x=(0, RADIUS), y=(0, half), nx=nx, ny=ny, grade_x=(RADIUS, ratio), grade_y=(half, ratio)
    )
    body = la.Body(mesh, la.VonMises(yield_stress=1.0), kinematics="axisymmetric", space="p2-gauss")
    return la.Problem(
        bodies={"disc": body},
        interfaces=[la.Interface(("disc", "top"), la.RigidObstacle((0, half), (0, -1)), mu)],
        reference_loads=[la.RigidFooting("disc", "bottom", (0, 1), rough=False)],
    )


def reference(mu: float) -> Reference:
    """Return the reference.

    Exact without friction; else between what no friction and what even spreading need.
    """
    if mu == 0:
        return Reference(1.0, "s0", "analytical: uniform stress, even spreading", "exact")
    lever = mu * RADIUS / HEIGHT
    upper = min(_STICKING, 1 / (1 - lever)) if lever < 1 else _STICKING
    return Reference(
        (1 + upper) / 2,
        "s0 <= alpha <= s0 min(1/(1 - mu R/h), 1 + 2 R/(3 sqrt3 h))",
        "analytical: no friction from below; even spreading from above, with the friction of"
        " whatever pressure there is; refinement tends to 1.0328, 1.0641, 1.1187 for mu = 0.05,"
        " 0.1, 0.2",
        "bracket",
        half_width=(upper - 1) / 2,
    )


def band(elements: int, mu: float) -> Band:
    """Return the band: interior strain points, and Coulomb friction."""
    if mu == 0:
        return exact_patch("even spreading is a linear velocity.")
    return _ERROR.two_sided(elements, "interior strain points, and Coulomb friction.")


CASE = Case(
    id="disc-upsetting",
    title="Disc upset between platens with friction, h = R",
    tags=("continuum", "contact", "axisymmetric", "Coulomb", "singular point", "bracket"),
    unit="F/(pi R^2 s0)",
    explanation=__doc__,
    hand_calculation="""\
no friction:  alpha = s0 (uniform compression)
even spread:  platens close at rate v, u_r = r v/(2 h) at each
              v F = v s0 pi R^2 + 2 int mu t_n u_r dA
                 <= v s0 pi R^2 + v mu (R/h) F
              alpha <= s0/(1 - mu R/h); no shear above k = s0/sqrt3:
              alpha <= s0 (1 + 2 R/(3 sqrt3 h)) = 1.3849 s0
slab method:  dp/dr = -2 mu p/h from p = s0 at the free side
              alpha = s0 (1 + 2 mu R/(3 h) + ...), an estimate
              mu = 0.05: 1.033, mu = 0.1: 1.067
""",
    meshes={
        "coarse": {"nx": 4, "ny": 2, "ratio": 4.0},
        "medium": {"nx": 18, "ny": 8, "ratio": 16.0},
        "fine": {"nx": 48, "ny": 25, "ratio": 60.0},
    },
    build=build,
    reference=reference,
    band=band,
    bracket=None,
    variants=tuple(Variant(f"mu-{mu:g}", {"mu": mu}) for mu in (0.0, 0.1, 0.2, 1.0)),
    sweep="mu",
)
