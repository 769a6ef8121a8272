r"""A strip footing on a slab of soil with friction between two smooth walls.

                      alpha
                      | | |
                      v v v  footing
                  +-----------+----------------------+
                 /           /                      /|
                +-----------+----------------------+ |
        u_x=0 o |                                  | |
              o |          smooth walls            | |  u = 0
              o |          in front and behind     | +
                |                                  |/
                +----------------------------------+
                              u = 0
                |<--- 1 --->|
                |<--------- 4, or 6.6 ------------>|   depth 1.6, or 3.2

The cone of Drucker and Prager, matched to plane strain, is Mohr and Coulomb's there: by its walls
the slab of tetrahedra has to find the load of Prandtl, for smooth and rough footings. Where
velocities jump they open as they slip, past what holds the soil, too. The box holds the mechanism
of a smooth footing, which extends to 3.53 from the middle. It is one of a rough footing, too, but
that of Prandtl, which coarse meshes find, extends to 6.06, and down to 2.32, for which the other
box is large enough.

Boxes of tetrahedra follow curved slip lines badly. A mesh along the slip lines of Hill's mechanism
needs few elements.
"""

from math import exp, pi, radians, tan

import lacore as la
from lacore_verification.case import Band, Case, Convergence, First, Reference, Variant
from lacore_verification.case.band import Bracketing
from lacore_verification.cases.shared.fitted import fitted_slab
from lacore_verification.cases.shared.tetrahedra import slab

ANGLE = 20.0
_ERRORS = {
    ("p2-vertex", False): Convergence(
        8.01, 0.585, "36, 72, 180, 432 tetrahedra: 98.3, 54.3, 36.7, 21.6 % above"
    ),
    ("p2-disc", False): Convergence(
        0.866, 0.381, "36, 72, 180, 432 tetrahedra: 20.6, 15.5, 12.0, 7.74 % above"
    ),
    ("p2-disc", True): Convergence(
        1.26, 0.403, "36, 72, 180, 432 tetrahedra: 27.0, 16.8, 15.6, 8.93 % above"
    ),
}


_FITTED = Convergence(
    3480.0, 3.0, "36, 45, 54, 72, 90 tetrahedra: 8.2, 3.7, 2.0, 0.89, 0.50 % above"
)
_BOX = {False: (4.0, 1.6), True: (6.6, 3.2)}  # length and depth: rough footings take the larger


def build(n: int, rough: bool, space: str, mesh: str = "box") -> "la.Problem":
    """Return the problem.

    Half of the slab, with a vertex row under the edge of the footing; cohesion 1.

    A fitted mesh, of a smooth footing, has n sectors in its fan.
    """
    soil = la.DruckerPrager(1.0, ANGLE)
    if mesh == "fitted":
        return fitted_slab(soil, n, ANGLE, space)
    return slab(soil, _BOX[rough], n, rough, space)


def reference(rough: bool, space: str, mesh: str = "box") -> Reference:
    """Return the reference: Prandtl's solution, for either footing."""
    angle = radians(ANGLE)
    passive = tan(pi / 4 + angle / 2) ** 2
    return Reference(
        (passive * exp(pi * tan(angle)) - 1) / tan(angle),
        "c cot(phi) (K e^(pi tan(phi)) - 1),  K = tan^2(45 + phi/2)",
        "Prandtl 1920; Reissner 1924",
        "exact",
    )


def band(elements: int, rough: bool, space: str, mesh: str = "box") -> Band:
    """Return the band: strict."""
    return (_FITTED if mesh == "fitted" else _ERRORS[space, rough]).strict(elements)


CASE = Case(
    id="slab-soil",
    title="Strip footing on a slab of soil, of tetrahedra",
    tags=("continuum", "space", "soil", "singular point", "upper bound"),
    unit="mean footing pressure / c",
    explanation=__doc__,
    hand_calculation="""\
smooth walls:   no shear stress on them, no motion across: plane strain
a cone that     a = sqrt(3) sin(phi)/sqrt(3 + sin^2(phi)),
meets there:    k = a c cot(phi): jumps open by tan(phi) of their slip
K = tan^2(55):  2.039607
e^(pi tan 20):  3.137562
Prandtl:        alpha = (2.039607 * 3.137562 - 1)/0.363970 = 14.83471
""",
    meshes={"coarse": {"n": 2}, "medium": {"n": 4}, "fine": {"n": 6}},
    build=build,
    reference=reference,
    band=band,
    surfaces=True,
    bracket=Bracketing(target_width=0.6),
    first=First(variant="smooth-fitted"),
    variants=(
        *(
            Variant(
                f"{'rough' if rough else 'smooth'}-{space}",
                {"rough": rough, "space": space},
                ("coarse",),
            )
            for space, rough in _ERRORS
        ),
        Variant(
            "smooth-fitted",
            {"rough": False, "space": "p2-disc", "mesh": "fitted"},
            ("fine",),
        ),
    ),
)
