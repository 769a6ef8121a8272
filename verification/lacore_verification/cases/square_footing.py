r"""A square footing on ground of a von Mises material, smooth or rough.

                     alpha
                   +-------+
                  /|/ | / /          from above:   y
          +------/--V----/--------+                |     .' x = y
         /      +-------+        /|                |   .'
        +-----------------------+ |                +--' 1
        |                       | |                |.'|
        |                       | +                o--+------ x
        |                       |/                    1
        +-----------------------+
        |<------- 5.2 --------->|   depth 1.3, held there and at its sides

An eighth is modelled, y <= x from the centre of the footing, whose half-side is 1: two planes of
symmetry. The ground ends where no mechanism of the half space reaches by much: of a half space the
upper bound alone is one. Velocities are unbounded along the edges of the footing.

No closed form is known: the reference is an interval of two strict bounds.
"""

import lacore as la
from lacore_verification.case import Band, Case, Convergence, First, Reference, Variant
from lacore_verification.cases.shared.tetrahedra import (
    CLAY,
    DEPTH,
    WIDTH,
    bounded,
    eighth,
    on_diagonal,
    under_footing,
)

KNOWN = {False: (5.129, 5.291), True: (5.3869, 5.6071)}


def build(
    n: int, rough: bool, width: float = WIDTH, depth: float = DEPTH, ratio: float = 1.0
) -> "la.Problem":
    """Return the problem.

    The eighth; an even n, half of it in depth, graded towards the edges of the footing.
    """
    edge = (1.0, ratio)
    mesh = la.meshes.box((0, width), (0, width), (-depth, 0), n, n, n // 2, False, edge, edge)
    return la.Problem(
        bodies={"clay": la.Body(eighth(mesh), CLAY, kinematics="3d", space="p2-disc")},
        supports=[
            *(la.Fix("clay", where, "normal") for where in ("front", on_diagonal)),
            *(la.Fix("clay", side, "xyz") for side in ("right", "bottom")),
        ],
        reference_loads=[la.RigidFooting("clay", under_footing, (0, 0, -1), rough=rough)],
    )


def reference(rough: bool) -> Reference:
    """Return the reference: the interval of strict bounds."""
    return bounded(
        *KNOWN[rough],
        "k",
        "strict bounds of our own on meshes that were adapted, judged by an independent checker"
        " from mesh, stresses and velocities alone; of Tresca's material [5.523, 6.221] k: Salgado,"
        " Lyamin, Sloan and Yu, Geotechnique 54, 2004",
    )


_ERRORS = {
    False: Convergence(0.237, 0.228, "12, 96, 324 tetrahedra: 13.4, 8.12, 6.34 % above"),
    True: Convergence(0.276, 0.2735, "12, 96, 324 tetrahedra: 14.0, 8.14, 5.68 % above"),
}


def band(elements: int, rough: bool) -> Band:
    """Return the band: strict; errors are those from the middle of the interval."""
    return _ERRORS[rough].strict(elements)


CASE = Case(
    id="square-footing",
    title="Square footing",
    tags=("continuum", "space", "singular point", "upper bound"),
    unit="mean footing pressure / k",
    explanation=__doc__,
    hand_calculation="""\
smooth, below and above:  5.129 k <= alpha <= 5.291 k
rough:                    5.387 k <= alpha <= 5.607 k
strip footing (Prandtl):  5.1416 k
""",
    meshes={
        "coarse": {"n": 2},
        "moderate": {"n": 4, "width": 1.9, "depth": 0.8, "ratio": 1.5},
        "medium": {"n": 4},
        "fine": {"n": 6},
    },
    first=First(meshes=("moderate",)),
    build=build,
    reference=reference,
    band=band,
    bracket=None,
    variants=tuple(
        Variant(name, {"rough": rough}, meshes=("coarse",))
        for name, rough in (("smooth", False), ("rough", True))
    ),
)
