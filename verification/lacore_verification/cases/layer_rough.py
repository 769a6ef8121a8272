r"""A rough rigid footing squeezes a thin layer of soil on a rough rigid base.

              alpha
              | | |
              v v v  footing, rough, half width 1
          o============+--------------------------------o
    u_x=0 o   1      .   .  '   2                       o  H
          o      .    '       .   '  .                  o  u = 0
          o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o
                              u = 0
          |<--- 1 ---->|<------------- 3 -------------->|

The right half is modelled, the footing is B = 2 wide. In a thick layer the load is Prandtl's; a
layer thinner than about B/1.41 has no room for his fan. Soil is then squeezed out between two rough
planes, from the footing (1) to the side (2), and carries the more the thinner the layer is. The
edge of the footing is a singular point, and the stress jumps along both rough planes.
"""

import numpy as np

import lacore as la
from lacore.numerics.arrays import Bools, Floats
from lacore_verification.case import Band, Case, Convergence, First, Reference, Variant

WIDTH = 2.0  # of the footing
_BOUNDS = {2.0: (5.2159, 5.3391), 4.0: (6.1562, 6.2771)}  # by B/H
_PUBLISHED = {2.0: 5.24, 4.0: 6.22}
_ERRORS = {
    2.0: Convergence(
        2.65,
        0.644,
        "32 to 4800 elements: 33.6, 9.38, 3.82, 2.36, 1.31 % above the middle of the bracket",
    ),
    4.0: Convergence(
        3.02,
        0.628,
        "32 to 4800 elements: 40.7, 11.6, 4.72, 3.00, 1.73 % above the middle of the bracket",
    ),
}


def build(nx: int, ny: int, ratio: float, slenderness: float) -> "la.Problem":
    """Return the problem.

    The right half, graded towards the edge of the footing; `slenderness` is B/H.
    """
    depth = WIDTH / slenderness
    mesh = la.meshes.rectangle(
        x=(0, 4),
        y=(-depth, 0),
        nx=nx,
        ny=ny,
        grade_x=(1.0, 3 * ratio),
        grade_y=(0.0, depth * ratio),
    )
    return la.Problem(
        bodies={"layer": la.Body(mesh, la.VonMises(shear_strength=1.0))},
        supports=[
            la.Fix("layer", "left", "x"),
            la.Fix("layer", "bottom"),
            la.Fix("layer", "right"),
        ],
        reference_loads=[la.RigidFooting("layer", _under_footing, (0, -1), rough=True)],
    )


def _under_footing(x: Floats) -> Bools:
    return np.asarray((x[1] > -1e-9) & (x[0] < WIDTH / 2 + 1e-9))


def reference(slenderness: float) -> Reference:
    """Return the reference: bounds from both sides."""
    low, high = _BOUNDS[slenderness]
    return Reference(
        (low + high) / 2,
        "limit analysis from both sides",
        f"strict bounds [{low}, {high}], an independent computation; published"
        f" {_PUBLISHED[slenderness]} after Mandel & Salencon 1972",
        "bracket",
        half_width=(high - low) / 2,
    )


def band(elements: int, slenderness: float) -> Band:
    """Return the band: strict upper bound."""
    return _ERRORS[slenderness].strict(elements)


CASE = Case(
    id="layer-rough",
    title="Rough footing on a thin layer over a rough base",
    tags=("continuum", "singular point", "upper bound", "bracket"),
    unit="mean footing pressure / k",
    explanation=__doc__,
    hand_calculation="""\
thick layer:     (2 + pi) k = 5.14 k, fan of radius B/sqrt2 at
                 the edge of a rough footing: H > B/1.41
thin layer:      two rough planes: dp/dx = 2 k/H, which adds
                 B/(2 H) k to the mean pressure over B
                 from B/H = 2 to 4 the load grows by about 1 k
                 (published: 5.24 and 6.22)
""",
    meshes={
        "coarse": {"nx": 4, "ny": 2, "ratio": 4.0},
        "medium": {"nx": 18, "ny": 8, "ratio": 10.0},
        "fine": {"nx": 50, "ny": 24, "ratio": 30.0},
    },
    build=build,
    reference=reference,
    band=band,
    first=First(meshes=("medium",), bracket=0.03),
    variants=(
        Variant("B-H-2", {"slenderness": 2.0}),
        Variant("B-H-4", {"slenderness": 4.0}),
    ),
)
