r"""A vertical cut of finite length stands by its cohesion; its ends are held.

                        W
               +-------------------+
              /                   /|      gamma = alpha: unit weight
             /                   / |
            +-------------------+  |
            |                   |  |  H = 1
       free |    soil           |  |
       face |                   |  +
            |                   | /   L: length of the cut
            +-------------------+/
                  held base, back and far end

Half of its length is modelled. A mechanism of the plane, which carries 3.7765 k at any length,
tears off the ends, too: a short cut stands higher. No closed form is known: the reference is an
interval of two strict bounds, of this block, whose base is held at the toe.
"""

import lacore as la
from lacore_verification.case import Band, Case, Convergence, First, Reference, Variant
from lacore_verification.cases.shared.tetrahedra import CLAY, bounded

WIDTH = 1.25
KNOWN = {2.0: (4.4742, 4.7371)}
_ERROR = Convergence(0.284, 0.246, "6, 48, 162, 750 tetrahedra: 18.3, 13.3, 10.0, 5.56 % above")


def build(
    n: int,
    length: float,
    rows: int = 0,
    layers: int = 0,
    width: float = WIDTH,
    ratio: float = 0.0,
) -> "la.Problem":
    """Return the problem.

    Half of the length, in cells of six tetrahedra; graded by `ratio` towards the end.

    Along all edges there are n cells, or `rows` along the length and `layers` in height.
    """
    grade = (length / 2, ratio) if ratio else None
    cells = n, rows or n, layers or n
    mesh = la.meshes.box((0, width), (0, length / 2), (0, 1), *cells, grade_y=grade)
    return la.Problem(
        bodies={"soil": la.Body(mesh, CLAY, kinematics="3d", space="p2-disc")},
        supports=[
            la.Fix("soil", "front", "normal"),
            *(la.Fix("soil", side, "xyz") for side in ("bottom", "right", "back")),
        ],
        reference_loads=[la.BodyForce("soil", (0, 0, -1))],
    )


def reference(length: float) -> Reference:
    """Return the reference: the interval of strict bounds."""
    return bounded(
        *KNOWN[length],
        "k/H",
        "strict bounds of our own on meshes that were adapted; of the plane 3.7764978",
    )


def band(elements: int, length: float) -> Band:
    """Return the band: strict; errors are those from the middle of the interval."""
    return _ERROR.strict(elements)


CASE = Case(
    id="vertical-cut-finite",
    title="Vertical cut of finite length",
    tags=("continuum", "space", "upper bound"),
    unit="gamma H / k",
    explanation=__doc__,
    hand_calculation="""\
plane:    gamma H = 3.7765 k, whatever the length
ends:     tear at k, and add to what is dissipated: more than that
""",
    meshes={
        "coarse": {"n": 2},
        "moderate": {"n": 4, "rows": 2, "layers": 3, "width": 1.0, "ratio": 3.0},
        "medium": {"n": 3},
        "fine": {"n": 5},
    },
    first=First(meshes=("moderate",)),
    build=build,
    reference=reference,
    band=band,
    bracket=None,
    variants=(Variant("twice-its-height", {"length": 2.0}, meshes=("coarse",)),),
)
