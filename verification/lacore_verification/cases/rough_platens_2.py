r"""A block twice as wide as high is pressed between two rigid platens to which it sticks.

           alpha
        v  v  v  v  v                   v  v  v  v  v
      +===============+               +===============+  rigid, sticks
      |       :       |         u_x=0 o    1    . '   |
      | - - - : - - - |               o      . '   2  |  free
      |       :       |               o   . '         |
      +===============+               o-o-o-o-o-o-o-o-o
        ^  ^  ^  ^  ^                      u_y = 0

By symmetry a quarter is modelled: the upper platen comes down, the mid-plane stays. A zone under
the platen (1) sticks to it and goes down with it, the side (2) is squeezed out; between them slip
lines fan out around the edge of the platen, which is a singular point. The case `platens-coulomb`
has the same block with friction instead.
"""

import lacore as la
from lacore_verification.case import Band, Case, Convergence, First, Order, Reference, Variant
from lacore_verification.case.band import Bracketing

WIDTH, HEIGHT = 1.0, 0.5  # of the quarter
_ERROR = Convergence(0.862, 0.715, "32 to 4640 elements: 7.74, 2.22, 0.86, 0.42, 0.23 % above")


def build(nx: int, ny: int, ratio: float) -> "la.Problem":
    """Return the problem: the quarter, graded towards the edge of the platen."""
    mesh = la.meshes.rectangle(
        x=(0, WIDTH), y=(0, HEIGHT), nx=nx, ny=ny, grade_x=(WIDTH, ratio), grade_y=(HEIGHT, ratio)
    )
    return la.Problem(
        bodies={"block": la.Body(mesh, la.VonMises(shear_strength=1.0))},
        supports=[la.Fix("block", "left", "x"), la.Fix("block", "bottom", "y")],
        reference_loads=[la.RigidFooting("block", "top", (0, -1), rough=True)],
    )


def reference() -> Reference:
    """Return the reference: the slip-line net."""
    return Reference(
        2.427658,
        "slip-line net of sticking platens",
        "net integrated to 6 digits; bracket [2.4152, 2.4569] by independent bounds;"
        " after Salencon",
        "exact, numerical",
        half_width=5e-7,
    )


def band(elements: int) -> Band:
    """Return the band: strict upper bound."""
    return _ERROR.strict(elements)


def order() -> Order:
    """Return the order of convergence.

    Between 1/2, that of the edge of the platen without grading, and 1.
    """
    sizes = ((4, 3, 4.0), (6, 4, 6.0), (9, 6, 9.0), (12, 9, 12.0), (16, 12, 18.0))
    return Order(
        tuple({"nx": nx, "ny": ny, "ratio": ratio} for nx, ny, ratio in sizes),
        0.7,
        0.08,
        "Measured: 0.70 +- 0.04 (95 %) over 48 to 768 elements, 0.698 +- 0.026 up to 1408. Grading"
        " as far as this wins back a part of what the edge costs; without it 1/2.",
    )


CASE = Case(
    id="rough-platens-2",
    title="Block between sticking platens, w/h = 2",
    tags=("continuum", "singular point", "upper bound"),
    unit="F/(w k)",
    explanation=__doc__,
    hand_calculation="""\
from below:  uniform sigma_y = -2 k           alpha > 2
from above:  cuts along both diagonals; platens close at rate
             2 v, the sides slide out at speed w/h v = 2 v
             jump sqrt5 v, length of all cuts 2 sqrt5 h
             D = 10 k h v, power of F is 2 v F
             alpha = F/(w k) < 2.5 = w/h + h/w
net:         alpha = 2.427658
""",
    meshes={
        "coarse": {"nx": 4, "ny": 2, "ratio": 4.0},
        "medium": {"nx": 14, "ny": 10, "ratio": 16.0},
        "fine": {"nx": 40, "ny": 29, "ratio": 60.0},
    },
    build=build,
    reference=reference,
    band=band,
    order=order,
    bracket=Bracketing(target_width=0.005),
    first=First(meshes=("medium",), bracket=0.02),
    variants=(Variant("sticking", {}),),
)
