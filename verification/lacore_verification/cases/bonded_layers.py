r"""A rough strip footing on two layers of clay that are bonded to each other.

              alpha
              | | |
              v v v  footing, rough, half width 1/2
          o============+--------------------------------o
    u_x=0 o            .    k = 1              .        o  1/2
          o--------------------- bond ------------------o
          o               .          .                  o  u = 0
          o                  k = 2 or 1/2               o  3/2
          o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o-o
                              u = 0
          |<-- 1/2 --->|<------------- 3 -------------->|

The right half is modelled, each layer a body of its own. The bond transfers tension as well as
shear, all that the weaker layer can carry. Over stiff ground the soft layer is squeezed aside as on
a rough rigid base; a stiff layer over soft ground is punched through. Both edges of the footing are
singular points; where strengths jump, so do the stresses along the bond.
"""

import numpy as np

import lacore as la
from lacore.numerics.arrays import Bools, Floats
from lacore_verification.case import Band, Case, Convergence, First, Reference, Variant
from lacore_verification.case.band import Bracketing

_TOP = 0.5  # thickness of the upper layer, half a width of the footing
_DEPTH, _WIDTH = 2.0, 3.5
_BOUNDS = {2.0: (5.2657, 5.2831), 0.5: (3.6882, 3.7012)}  # by the strength below
_ERRORS = {
    2.0: Convergence(
        3.11,
        0.613,
        "60 to 6912 elements: 25.0, 12.1, 4.75, 2.45, 1.44 % above the middle of the bracket",
    ),
    0.5: Convergence(
        3.69,
        0.693,
        "60 to 6912 elements: 20.6, 9.38, 3.49, 1.57, 0.80 % above the middle of the bracket",
    ),
}


def build(nx: int, ny: int, ratio: float, below: float) -> "la.Problem":
    """Return the problem.

    The right half, graded towards the edge of the footing; `below` is the strength there.
    """

    def layer(low: float, high: float, rows: int, strength: float) -> "la.Body":
        mesh = la.meshes.rectangle(
            x=(0, _WIDTH),
            y=(low, high),
            nx=nx,
            ny=rows,
            grade_x=(_TOP, 3 * ratio),
            grade_y=(high, ratio),
        )
        return la.Body(mesh, la.VonMises(shear_strength=strength))

    return la.Problem(
        bodies={
            "top": layer(-_TOP, 0.0, ny, 1.0),
            "ground": layer(-_DEPTH, -_TOP, ny // 2, below),
        },
        supports=[
            *(la.Fix(name, "left", "x") for name in ("top", "ground")),
            *(la.Fix(name, "right") for name in ("top", "ground")),
            la.Fix("ground", "bottom"),
        ],
        reference_loads=[la.RigidFooting("top", _under_footing, (0, -1), rough=True)],
        interfaces=[la.Interface(("top", "bottom"), ("ground", "top"), la.BOND)],
    )


def _under_footing(x: Floats) -> Bools:
    return np.asarray((x[1] > -1e-9) & (x[0] < _TOP + 1e-9))


def reference(below: float) -> Reference:
    """Return the reference: bounds from both sides."""
    low, high = _BOUNDS[below]
    return Reference(
        (low + high) / 2,
        "limit analysis from both sides",
        f"strict bounds [{low}, {high}], an independent computation on one mesh of both layers;"
        " charts of such cases in Merifield, Sloan & Yu 1999",
        "bracket",
        half_width=(high - low) / 2,
    )


def band(elements: int, below: float) -> Band:
    """Return the band: strict upper bound."""
    return _ERRORS[below].strict(elements)


CASE = Case(
    id="bonded-layers",
    title="Rough footing on two bonded layers of clay",
    tags=("continuum", "contact", "singular point", "upper bound", "bracket", "several bodies"),
    unit="mean footing pressure / k of the upper layer",
    explanation=__doc__,
    hand_calculation="""\
k = 1 everywhere:      (2 + pi) k = 5.14 k
stiff ground, k = 2:   as over a rough rigid base, B/H = 2:
                       5.27 k, next to Prandtl
soft ground, k = 1/2:  Prandtl there, 5.14/2 k, and two vertical
                       planes through the layer, 2 H/B k: 3.57 k;
                       the adjacent layer has to bend up, too: 3.7 k
""",
    meshes={
        "coarse": {"nx": 5, "ny": 2, "ratio": 3.0},
        "medium": {"nx": 18, "ny": 8, "ratio": 6.0},
        "fine": {"nx": 48, "ny": 24, "ratio": 20.0},
    },
    build=build,
    reference=reference,
    band=band,
    bracket=Bracketing(mesh="medium"),
    first=First(meshes=("medium",)),
    variants=(
        Variant("stiff-below", {"below": 2.0}),
        Variant("soft-below", {"below": 0.5}),
    ),
)
