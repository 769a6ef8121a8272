r"""A strip footing of half width 1 on a slab of ground between two smooth walls.

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
                |<------------ 2.5 --------------->|   depth 1.25

One cell thick, in plane strain by its walls: tetrahedra have to find the load of Prandtl, which is
that of the plane, for smooth and rough footings. Velocities jump between tetrahedra in two spaces.
A mesh along the slip lines of Hill's mechanism needs fewer elements than a box.
"""

from math import pi

import lacore as la
from lacore_verification.case import Band, Case, Convergence, First, Reference, Variant
from lacore_verification.case.band import Bracketing
from lacore_verification.cases.shared.fitted import fitted_slab
from lacore_verification.cases.shared.tetrahedra import CLAY, slab

_ERRORS = {
    ("p2-vertex", False): Convergence(
        1.4, 0.42, "36, 72, 120, 252 tetrahedra: 27.8, 26.7, 17.0, 12.3 % above"
    ),
    ("p2-disc", False): Convergence(
        0.221, 0.391, "36, 72, 120, 252 tetrahedra: 5.44, 4.11, 3.45, 2.54 % above"
    ),
    ("p2-vertex", True): Convergence(
        1.7, 0.391, "36, 72, 120, 252 tetrahedra: 38.3, 34.3, 23.7, 17.9 % above"
    ),
}
_FITTED = Convergence(
    1700.0, 3.0, "36, 45, 54, 63, 72, 90 tetrahedra: 3.1, 1.4, 0.80, 0.51, 0.35, 0.20 % above"
)


def build(n: int, rough: bool, space: str, mesh: str = "box") -> "la.Problem":
    """Return the problem: half of the slab, with a vertex row under the edge of the footing.

    A fitted mesh, of a smooth footing, has n sectors in its fan.
    """
    if mesh == "fitted":
        return fitted_slab(CLAY, n, 0.0, space)
    return slab(CLAY, (2.5, 1.25), n, rough, space)


def reference(rough: bool, space: str, mesh: str = "box") -> Reference:
    """Return the reference: Prandtl's solution, for either footing."""
    return Reference(
        2 + pi, "(2 + pi) k", "Prandtl 1920; Hill, The Mathematical Theory of Plasticity", "exact"
    )


def band(elements: int, rough: bool, space: str, mesh: str = "box") -> Band:
    """Return the band.

    Strict; the box holds the mechanism of a smooth footing, which is one of a rough one, too.
    """
    return (_FITTED if mesh == "fitted" else _ERRORS[space, rough]).strict(elements)


CASE = Case(
    id="slab-punch",
    title="Strip footing on a slab of tetrahedra",
    tags=("continuum", "space", "singular point", "upper bound"),
    unit="mean footing pressure / k",
    explanation=__doc__,
    hand_calculation="""\
smooth walls:   no shear stress on them, no motion across: plane strain
Prandtl:        alpha = (2 + pi) k = 5.141593 k
""",
    meshes={"coarse": {"n": 2}, "medium": {"n": 5}, "fine": {"n": 8}},
    build=build,
    reference=reference,
    band=band,
    bracket=Bracketing(target_width=0.25),
    first=First(variant="smooth-fitted"),
    variants=(
        *(
            Variant(
                f"{'rough' if rough else 'smooth'}-{space}",
                {"rough": rough, "space": space},
                ("coarse",),
            )
            for rough, space in ((False, "p2-vertex"), (False, "p2-disc"), (True, "p2-vertex"))
        ),
        Variant(
            "smooth-fitted",
            {"rough": False, "space": "p2-disc", "mesh": "fitted"},
            ("medium",),
            unfit={"slsqp": "it is dense, and this mesh has 967 unknowns"},
        ),
    ),
)
