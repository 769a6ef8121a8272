r"""Two opposed smooth punches press a strip between them, until it is squeezed apart.

           alpha
           v v v  punch
       ----+-+-+----------            +---1---+----------------.
           |   |                u_x=0 o      . \               |
      - - -| - |- - - - -             o    .   .\   2          | free
           |   |                      o  .   .                 |
       ----+-+-+----------            o-o-o-o-o-o-o-o-o-o-o-o-o
           ^ ^ ^                             u_y = 0
                                      |<- 1 ->|<---- 1 + h --->|

Punches have half width 1, half the strip is h thick; a quarter is modelled. Slip lines fan out
around the edges of the punches and meet on the mid-plane; the ends of the strip (2) move apart as
rigid bodies. With h = 1 there is no fan: wedges slide along cuts under 45 degrees, and the load is
that of a free block, 2 k. The thicker the strip, the wider the fan; from h = 8.7115 on each punch
presses in by itself, at (2 + pi) k.

The edge of the punch is a singular point: meshes are graded towards it.
"""

import numpy as np

import lacore as la
from lacore.numerics.arrays import Bools, Floats
from lacore_verification.case import Band, Case, Convergence, First, Order, Reference, Variant
from lacore_verification.case.band import Bracketing

_NETS = {1.0: 2.0, 2.0: 2.427658, 4.0: 3.505757}  # by h
_ERRORS = {
    1.0: Convergence(2.92, 0.768, "32 to 4600 elements: 21.7, 5.92, 2.19, 1.11, 0.46 % above"),
    2.0: Convergence(1.04, 0.637, "32 to 4600 elements: 13.0, 3.93, 1.67, 0.96, 0.55 % above"),
    4.0: Convergence(0.563, 0.560, "32 to 4600 elements: 9.03, 3.24, 1.42, 0.92, 0.57 % above"),
}


def build(nx: int, ny: int, ratio: float, h: float) -> "la.Problem":
    """Return the problem.

    A quarter, graded towards the edge of the punch; beyond it 1 + h of the strip.
    """
    mesh = la.meshes.rectangle(
        x=(0, 2 + h), y=(0, h), nx=nx, ny=ny, grade_x=(1.0, ratio * (1 + h)), grade_y=(h, ratio * h)
    )

    def punch(x: Floats) -> Bools:
        return np.asarray((x[1] > h - 1e-9) & (x[0] < 1 + 1e-9))

    return la.Problem(
        bodies={"strip": la.Body(mesh, la.VonMises(shear_strength=1.0))},
        supports=[la.Fix("strip", "left", "x"), la.Fix("strip", "bottom", "y")],
        reference_loads=[la.RigidFooting("strip", punch, (0, -1), rough=False)],
    )


def reference(h: float) -> Reference:
    """Return the reference: straight cuts, or the slip-line net."""
    if h <= 1:
        return Reference(_NETS[1.0], "2 k", "analytical: uniform stress and straight cuts", "exact")
    return Reference(
        _NETS[h],
        "slip-line net between opposed punches",
        "net integrated to 6 digits; Hill, The Mathematical Theory of Plasticity",
        "exact, numerical",
        half_width=5e-7,
    )


def band(elements: int, h: float) -> Band:
    """Return the band: strict upper bound."""
    return _ERRORS[h].strict(elements)


_ORDERS = {1.0: (0.755, 0.044), 2.0: (0.68, 0.054), 4.0: (0.61, 0.069)}  # with 95 % intervals


def order(h: float) -> Order:
    """Return the order of convergence.

    Between 1/2, that of a fan without grading, and 1: the wider the fan, the lower.
    """
    measured, interval = _ORDERS[h]
    sizes = ((6, 3, 5.0), (8, 4, 7.0), (12, 6, 10.0), (16, 8, 14.0), (22, 11, 20.0))
    return Order(
        tuple({"nx": nx, "ny": ny, "ratio": ratio} for nx, ny, ratio in sizes),
        measured,
        0.1,
        f"Measured: {measured:g} +- {interval:g} (95 %) over 72 to 968 elements. Grading towards"
        " the edge wins back a part of what the fan costs, and more of what straight cuts do.",
    )


CASE = Case(
    id="opposed-punches",
    title="Strip squeezed between opposed punches",
    tags=("continuum", "singular point", "upper bound"),
    unit="mean pressure / k",
    explanation=__doc__,
    hand_calculation="""\
h = 1, from below:  sigma_y = -2 k between the punches, else 0
h = 1, from above:  punches close at rate 2 v; four cuts of
                    length sqrt2 with a velocity jump sqrt2 v
                    D = 8 k v, power of both 4 alpha v
                    alpha = 2 k
h > 1:              fans at the edges, net integrated
                    h = 2: 2.427658 k, h = 4: 3.505757 k
h >= 8.7115:        (2 + pi) k (Prandtl)
""",
    meshes={
        "coarse": {"nx": 4, "ny": 2, "ratio": 3.0},
        "medium": {"nx": 18, "ny": 8, "ratio": 16.0},
        "fine": {"nx": 50, "ny": 23, "ratio": 45.0},
    },
    build=build,
    reference=reference,
    band=band,
    order=order,
    bracket=Bracketing(target_width=0.005),
    first=First(meshes=("medium",), bracket=0.02),
    variants=tuple(Variant(f"h-{h:g}", {"h": h}) for h in _NETS),
    sweep="h",
)
