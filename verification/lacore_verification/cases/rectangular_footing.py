r"""A rough rectangular footing, twice as long as wide, on ground of a von Mises material.

         from above
              y
              +------------------------+   held sides
              |                        |
              |                        |
            2 +-----------+            |
              |           |            |
              |  footing  |            |      alpha: mean pressure
              |           |            |
              +-----------+------------+-- x
                          1           2.6     depth 1.3

A quarter is modelled from the centre of the footing, of half-width 1 and half-length 2: two
planes of symmetry. No closed form is known: the reference is an interval of two strict bounds.
"""

import numpy as np

import lacore as la
from lacore.numerics.arrays import Bools, Floats
from lacore_verification.case import Band, Case, Convergence, First, Reference, Variant
from lacore_verification.cases.shared.tetrahedra import CLAY, DEPTH, WIDTH, bounded

LENGTH = 2.0
LOW, HIGH = 5.1562, 5.5852
_ERROR = Convergence(0.397, 0.299, "48, 288, 864 tetrahedra: 12.5, 7.71, 5.24 % above")


def build(n: int, layers: int = 0, width: float = WIDTH, depth: float = DEPTH) -> "la.Problem":
    """Return the problem.

    The quarter; an even n, half of it in depth or `layers`, two more along its length.
    """
    mesh = la.meshes.box(
        *((0, width), (0, LENGTH + width - 1), (-depth, 0)),
        *(n, n + 2, layers or n // 2),
        grade_x=(1.0, 1.0),
        grade_y=(LENGTH, 1.0),
    )
    return la.Problem(
        bodies={"clay": la.Body(mesh, CLAY, kinematics="3d", space="p2-disc")},
        supports=[
            *(la.Fix("clay", side, "normal") for side in ("left", "front")),
            *(la.Fix("clay", side, "xyz") for side in ("right", "back", "bottom")),
        ],
        reference_loads=[la.RigidFooting("clay", under_footing, (0, 0, -1))],
    )


def under_footing(x: Floats) -> Bools:
    """Return whether places are under the footing."""
    return np.asarray((x[2] == 0) & (x[0] <= 1) & (x[1] <= LENGTH))


def reference() -> Reference:
    """Return the reference: the interval of strict bounds."""
    return bounded(LOW, HIGH, "k", "strict bounds of our own on meshes that were adapted")


def band(elements: int) -> Band:
    """Return the band: strict; errors are those from the middle of the interval."""
    return _ERROR.strict(elements)


CASE = Case(
    id="rectangular-footing",
    title="Rectangular footing, twice as long as wide",
    tags=("continuum", "space", "singular point", "upper bound"),
    unit="mean footing pressure / k",
    explanation=__doc__,
    hand_calculation="""\
below and above:          5.156 k <= alpha <= 5.585 k
square, strip (Prandtl):  5.387 ... 5.607 k, 5.1416 k
""",
    meshes={
        "coarse": {"n": 2},
        "moderate": {"n": 3, "layers": 2, "width": 2.4, "depth": 1.2},
        "medium": {"n": 4},
        "fine": {"n": 6},
    },
    first=First(meshes=("moderate",)),
    build=build,
    reference=reference,
    band=band,
    bracket=None,
    variants=(Variant("rough", {}, meshes=("coarse",)),),
)
