r"""A rough rigid strip footing of half width 1/2 on two layers of clay.

The right half is modelled; the upper layer, half a width thick, has a shear strength k1 = 1.

              alpha
              | | | |
              v v v v footing            free
          o-----------+-------------------------------o
    u_x=0 o                    k1 = 1                 o
          o                                           o
          o-------------------------------------------o   u = 0
          o                                           o
          o                    k2                     o
          o                                           o
          o-------------------------------------------o
                              u = 0
          |<-- 1/2 -->|

On stiffer ground the mechanism of the punch would reach into it; it stays above, and the load rises
by a fortieth, whether the ground is twice or four times as strong: to the layer it is a rigid rough
base. On softer ground the footing punches through: the upper layer shears off along the edges, and
spreads the load over ground that carries half as much.

There is no closed form: the reference is a strict bracket. The two layers are regions of one mesh,
whose edges follow their interface; each element has the strength of its own.
"""

import numpy as np

import lacore as la
from lacore.numerics.arrays import Bools, Floats
from lacore_verification.case import Band, Bracketing, Case, Convergence, First, Reference, Variant

_BRACKETS = {2.0: (5.274, 0.009), 0.5: (3.695, 0.007)}
"""By k2/k1 (k1 = 1): middle and half width of a bracket of the load."""
_BOX = {2.0: (2.5, 1.5), 0.5: (3.5, 2.5)}
"""Width and depth: larger boxes carry the same to 1e-4."""
_CONVERGENCE = {
    2.0: Convergence(3.47, 0.534, "k2 = 2, 240 to 3168 elements: 18.6, 11.7, 6.7, 4.7 % above"),
    0.5: Convergence(
        2.28, 0.578, "k2 = 1/2, 96 to 3168 elements: 17.6, 9.6, 5.6, 3.5, 2.2 % above"
    ),
}


def build(nx: int, ny: int, ratio: float, below: float) -> "la.Problem":
    """Return the problem: the right half, cells graded towards the edge of the footing."""
    width, depth = _BOX[below]
    layers = {"upper": (-0.5, 0.0), "lower": (-depth, -0.5)}
    mesh = la.meshes.layered((0, width), layers, nx, ny, grade_x=(0.5, ratio))
    clay = {"upper": la.VonMises(1.0), "lower": la.VonMises(below)}
    return la.Problem(
        bodies={"clay": la.Body(mesh.with_boundaries({"under": _under}), clay)},
        supports=[
            la.Fix("clay", "left", "x"),
            la.Fix("clay", "bottom"),
            la.Fix("clay", "right"),
        ],
        reference_loads=[la.RigidFooting("clay", "under", (0, -1))],
    )


def _under(x: Floats) -> Bools:
    return np.asarray((x[1] > -1e-9) & (x[0] < 0.5))


def reference(below: float) -> Reference:
    """Return the reference.

    A strict bracket of both bounds, on meshes refined where they differ.
    """
    value, half = _BRACKETS[below]
    return Reference(
        value,
        "layered clay: no closed form",
        "strict lower and upper bounds on refined meshes, 4 600 to 10 000 triangles, of box and"
        " unbounded ground; another program, apart, agrees to its mesh",
        "bracket",
        half_width=half,
    )


def band(elements: int, below: float) -> Band:
    """Return the band: strict upper bound."""
    return _CONVERGENCE[below].strict(elements)


CASE = Case(
    id="layered-clay",
    title="Strip footing on two layers of clay",
    tags=("continuum", "regions", "singular point", "upper bound", "bracket"),
    unit="mean footing pressure / k1",
    explanation=__doc__,
    hand_calculation="""\
one clay, k1 all through:        2 + pi = 5.141593,
                                 reaches 0.354 to 0.707 deep
stiff below, a mechanism of the upper layer alone is as good as before:
                                 at least 5.141593 where smooth,
                                 more where rough
soft below, a footing as wide as it is:
  sides shear off, 2 H/B k1:     1.000000
  ground at the base, 2 + pi:    2.570796 (k2 = 1/2)
  together                       3.570796; it is carried a little wider
""",
    meshes={
        "coarse": {"nx": 5, "ny": 2, "ratio": 4.0},
        "medium": {"nx": 16, "ny": 9, "ratio": 4.5},
        "fine": {"nx": 44, "ny": 26, "ratio": 6.0},
    },
    build=build,
    reference=reference,
    band=band,
    bracket=Bracketing(target_width=0.01),
    first=First(meshes=(), bracket=0.02),
    variants=(
        Variant("stiff-below", {"below": 2.0}),
        Variant("soft-below", {"below": 0.5}),
    ),
)
