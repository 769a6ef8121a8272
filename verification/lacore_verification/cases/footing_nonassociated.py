r"""A smooth rigid strip footing on weightless soil with non-associated flow.

              alpha
              | | | |
              v v v v footing
          o-----------+---------------------------o
    u_x=0 o      \   /  .            psi < phi    o
          o       \ /      . .                    o
          o        \_       .                     o   u = 0
          o           ` - _ _ _ .  -              o
          o---------------------------------------o
                         u = 0
          |<--- 1 --->|

No stresses within the criterion carry more than Prandtl's load, whatever the soil dilates, and flow
that is not associated may do with less. How much less has been answered by elasto-plastic steps,
whose loads oscillate, and by fits to them. Here each load factor is that of a limit state of the
mesh, with a certificate. From `psi = 2 phi/3` on it is within 2 % of the associated one of the same
mesh, and all searches give the same value. Without dilation states are many: on one mesh of 512
triangles loads from 26 to 30.4 are certified alike (`lacore.soil_range`), and where flow localises
the lower ones appear.
"""

from math import atan, cos, degrees, exp, pi, radians, sin, tan

import lacore as la
from lacore.model.bodies.any_body import of_kind
from lacore_verification.case import Band, Beside, Case, First, Reference, Variant
from lacore_verification.cases import strip_footing
from lacore_verification.cases.shared.friction_inside import UNFIT


def build(nx: int, ny: int, ratio: float, angle: float, dilation: float) -> "la.Problem":
    """Return the problem.

    The right half, as of `strip-footing`, in a space that is not strict by itself.
    """
    problem = strip_footing.build(nx, ny, ratio, angle, 0.0, 0.0)
    (mesh,) = (body.mesh for body in of_kind(problem.bodies, la.Body).values())
    soil = la.MohrCoulomb(1.0, angle, dilation_angle=dilation)
    return la.Problem(
        bodies={"soil": la.Body(la.meshes.unaligned(mesh), soil, space="p2-gauss")},
        supports=problem.supports,
        reference_loads=problem.reference_loads,
    )


def _n_c(angle: float) -> float:
    phi = radians(angle)
    return (exp(pi * tan(phi)) * tan(pi / 4 + phi / 2) ** 2 - 1) / tan(phi)


def _davis(angle: float, dilation: float) -> float:
    """Return N_c with Davis's strength, per c."""
    phi, psi = radians(angle), radians(dilation)
    beta = cos(psi) * cos(phi) / (1 - sin(psi) * sin(phi))
    return beta * _n_c(degrees(atan(beta * tan(phi))))


def _fitted(angle: float, dilation: float) -> float:
    """Return N_c by the fit of Loukidis and Salgado."""
    phi, psi = radians(angle), radians(dilation)
    less = 1 - tan(phi) * tan(0.8 * (phi - psi)) ** 2.5
    n_q = exp(less * pi * tan(phi)) * (1 + sin(phi)) / (1 - sin(phi))
    return (n_q - 1) / tan(phi)


def beside(angle: float, dilation: float) -> tuple[Beside, ...]:
    """Return further values: what is published, and what Davis's strength carries."""
    return (
        Beside(
            "Loukidis and Salgado 2009",
            _fitted(angle, dilation),
            "fit to elasto-plastic finite elements: N_q = exp(F pi tan(phi)) tan(45 + phi/2)^2,"
            " F = 1 - tan(phi) tan(0.8 (phi - psi))^2.5, N_c = (N_q - 1) cot(phi)",
        ),
        Beside(
            "Davis's strength", _davis(angle, dilation), "Davis 1968 (T55), in Prandtl's formula"
        ),
        Beside("associated flow", _n_c(angle), "Prandtl 1920, above all (T54)"),
    )


def reference(angle: float, dilation: float) -> Reference:
    """Return the reference: between what Davis's strength carries and what associated flow does."""
    return Reference(
        _davis(angle, dilation),
        "from N_c with Davis's strength (T55) to N_c of associated flow",
        "Davis 1968, no bound, but below all that is published; Prandtl 1920, above all (T54)",
        "interval",
        up_to=_n_c(angle),
        associated=_n_c(angle),
    )


def band(elements: int, angle: float, dilation: float) -> Band:
    """Return the band: above by what the mesh errs by with associated flow."""
    upper = strip_footing.band(elements, angle, 0.0, 0.0)
    return Band(
        upper.below,
        upper.above,
        "Of the discrete problem: no state is above the associated one of its mesh, which errs by"
        f" what `strip-footing` does, at most. {upper.reason}",
    )


CASE = Case(
    id="footing-nonassociated",
    title="Strip footing on soil with non-associated flow",
    tags=("continuum", "soil", "not associated", "certified", "singular point"),
    unit="mean footing pressure / c",
    explanation=__doc__,
    hand_calculation="""\
phi = 30:            N_c = 30.139628
Davis, psi = 20:     beta = cos(20) cos(30)/(1 - sin(20) sin(30))
                          = 0.98167
                     tan(phi*) = 0.56677, c* = 0.98167 c:  28.537
Davis, psi = 0:      beta = cos(30), tan(phi*) = sin(30):  20.081
""",
    meshes=strip_footing.CASE.meshes,
    build=build,
    reference=reference,
    band=band,
    beside=beside,
    surfaces=True,
    bracket=None,
    first=First(meshes=("medium",)),
    variants=(
        Variant("psi-20", {"angle": 30.0, "dilation": 20.0}, ("coarse",), unfit=UNFIT),
        Variant("psi-0", {"angle": 30.0, "dilation": 0.0}, ("coarse",), unfit=UNFIT),
    ),
)
