r"""A vertical cut of height H = 1 in soil that carries no tension: the largest gamma H / c.

              free
          +------+----------------o
          |      |                o
          |      | crack          o  u = 0    gamma
        H |   1  |                o             |
          |    . |                o             v
          |  .   |                o
          +.-----o-o-o-o-o-o-o-o-o-
         toe          u = 0
          |<--------- 1 --------->|

A crack opens behind the face, all the way down, and a column of no width shears off at its foot
(1). Vertical stresses alone carry as much, so that the load is known exactly: half of what a plane
wedge gives where tension is carried. On a mesh the column is one element wide.

Soil that nothing presses, next to the face, has no stress to spare, and no bound from below can be
stated exactly. On the finest mesh, where strain rates grow with the thinness of the column, no
solver reaches the tolerance of the certificate: residuals of 1e-6 to 1e-5 remain, which lacore
reports.
"""

from math import pi, radians, tan

import lacore as la
from lacore_verification.case import Band, Case, Convergence, First, Order, Reference, Variant

_ERROR = Convergence(
    1.5,
    0.44,
    "20 degrees, 36 to 1024 elements: 32.1, 23.8, 15.7, 12.1, 8.7, 7.0 % above; without"
    " friction 1/(2 n - 1), half a cell of n",
)
_GRADED = Convergence(
    0.425, 0.473, "20 degrees, ratio 30, 36 to 256 elements: 7.8, 5.8, 4.8, 4.1, 3.1 % above"
)
_UNFIT = {
    "clarabel-regularised": "on cells this thin residuals of its states stay above the tolerance"
}


def build(n: int, angle: float, ratio: float = 0.0) -> "la.Problem":
    """Return soil next to the face; even cells, as graded ones exceed the tolerance sooner.

    With a `ratio` cells are graded towards the toe.
    """
    grade = (0.0, ratio) if ratio else None
    mesh = la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=n, ny=n, grade_x=grade, grade_y=grade)
    return la.Problem(
        bodies={"soil": la.Body(mesh, la.MohrCoulomb(1.0, angle, tension_cutoff=0.0))},
        supports=[la.Fix("soil", "bottom"), la.Fix("soil", "right")],
        reference_loads=[la.BodyForce("soil", (0, -1))],
    )


def reference(angle: float, ratio: float = 0.0) -> Reference:
    """Return the reference: the column, and vertical stresses that carry as much."""
    return Reference(
        2 * tan(pi / 4 + radians(angle) / 2),
        "2 tan(45 + phi/2)",
        "Drucker 1953, Chen 1975; analytically",
        "exact",
    )


def band(elements: int, angle: float, ratio: float = 0.0) -> Band:
    """Return the band: strict upper bound."""
    return (_GRADED if ratio else _ERROR).strict(elements)


def order(angle: float, ratio: float = 0.0) -> Order | None:
    """Return the order of convergence.

    That of the width of the column; none of graded meshes, whose cells differ in shape.
    """
    if ratio:
        return None
    return Order(
        tuple({"n": n} for n in (3, 4, 6, 8, 12)),
        0.5,
        0.08,
        "The column is half a cell wide: 1/2, that of mesh sizes. Measured: 0.47 at 20 degrees,"
        " 0.55 without friction, whose error is 1/(2 n - 1) with n cells in the height.",
    )


CASE = Case(
    id="no-tension-cut",
    title="Vertical cut in soil without tension",
    tags=("continuum", "soil", "singular point", "body force", "upper bound", "closed form"),
    unit="gamma H/c",
    explanation=__doc__,
    hand_calculation="""\
from below:   sigma_y = -gamma (1 - y), all else zero: no tension
              largest at the toe: gamma H = 2 c tan(45 + phi/2)
from above:   a column of width d slides off at 45 + phi/2, its crack
              costs nothing; with d -> 0 its weight is gamma H d
              alpha = 2 tan(45 + phi/2)
phi = 0:      alpha = 2
phi = 20:     alpha = 2.856296
""",
    meshes={
        "coarse": {"n": 3},
        "moderate": {"n": 6},
        "medium": {"n": 12},
        "fine": {"n": 34},
    },
    build=build,
    reference=reference,
    band=band,
    order=order,
    surfaces=True,
    bracket=None,
    first=First(variant="phi-20-graded"),
    variants=(
        Variant("phi-20", {"angle": 20.0}, ("coarse",)),
        Variant("phi-0", {"angle": 0.0}, ("coarse",)),
        Variant("phi-20-graded", {"angle": 20.0, "ratio": 30.0}, ("moderate",), unfit=_UNFIT),
    ),
)
