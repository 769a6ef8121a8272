r"""A bridge of hooked stones between two piers, loaded by five stones that lie on it.

                    +--+  13
             14 +--+|  |+--+ 12
     15 +--+    |  ||  ||  |    +--+ 11           16 blocks, 0.5 m deep, mu = 0.9
    ____|  |____|__||__||__|____|  |____
    \/------.___ 10 ___8___ 9 ___.------\/        alpha W along x
     |   `-.____7______/ \____6____.-'   |
     |  /  3                         2 \ |
     | 1                               0 |
     +--+                             +--+
     ////                             ////

Published as a problem that a penalty on equilibrium judges, without a load factor. All stones are
prisms between two planes, so that it is a test of detected joints with many short faces, some of
them at acute angles: 37 joints, 148 contact points. Its coordinates have single precision. The
holes of the piers are left out: these are fixed, and nothing touches there. The hooks hold: what
gives way is the slender stone in the middle, which topples alone. The load of this mechanism is
unique, as it follows from moments. That the hyperstatic stones below have no mechanism with a lower
Coulomb load is not proven.
"""

import numpy as np

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid
from lacore_verification.cases.shared.solids import HYPERSTATIC, shaken

VALUE = 0.567207
MU = 0.9
_DEPTH = 0.5  # m
_TOLERANCE = 2e-6  # m: of coordinates in single precision
_DECK = 1.54999995
# x and z of the right half, m; the left one is its mirror image.
_HALVES = {
    ("0", "1"): (
        *((1.93333328, 1.54999983), (1.96930134, 1.65314865), (2.23403502, 1.65314865)),
        *((2.35641789, -0.00052339), (1.98097277, -0.00003937), (1.97248721, 1.10885191)),
        *((2.09999990, 1.04999983), (1.96564972, 1.45305049), (2.09999990, 1.54999983)),
    ),
    ("2", "3"): (
        *((1.44713974, 1.45305049), (1.47845542, 1.45305049), (2.04999995, 1.20000005)),
        *((2.09999990, 1.04999995), (1.97248721, 1.10885191), (1.39663839, 1.39369738)),
        *((1.20229435, 1.41691291), (1.36773646, 1.46038961), (1.40210235, 1.48862481)),
    ),
    ("4", "5"): (
        *((1.96564972, 1.45305049), (1.44713974, 1.45305049), (1.40210235, 1.48862481)),
        *((1.36773646, 1.46038961), (1.22205007, 1.49230492), (0.94999999, 1.50440907)),
        *((0.96460432, _DECK), (2.09999990, _DECK)),
    ),
    ("6", "7"): (
        *((1.36773646, 1.46038961), (1.20229435, 1.41691291), (0.53059846, 1.47148216)),
        *((0.53901720, 1.51001406), (0.88695163, 1.50526893), (0.89567596, _DECK)),
        *((0.96460432, _DECK), (0.94999999, 1.50440907), (1.22205007, 1.49230492)),
    ),
    ("9", "10"): (
        *((0.53901720, 1.51001406), (0.25089362, 1.51735592), (0.25596985, _DECK)),
        *((0.89567596, _DECK), (0.88695163, 1.50526893)),
    ),
    ("11", "15"): (
        *((1.25888824, _DECK), (1.59573019, _DECK)),
        *((1.59573019, 1.79215479), (1.25888824, 1.79215479)),
    ),
    ("12", "14"): (
        *((0.45273110, _DECK), (0.78957307, _DECK)),
        *((0.78957307, 1.85118771), (0.45273110, 1.85118771)),
    ),
}
_MIDDLE = {  # the right half of an outline that is its own mirror image, from the axis on
    "8": ((0.25596985, _DECK), (0.25089362, 1.51735592), (0.5390172, 1.51001406)),
    "13": ((0.17520164, 2.16776991), (0.17520164, _DECK)),
}
_KEY = ((0.53059846, 1.47148216), (0.0, 1.5), (-0.53059846, 1.47148216))  # block 8, below


def build(mu: float) -> "la.Problem":
    """Return the problem: the bridge; its piers are held."""
    mirror = np.array([-1.0, 1.0])
    outlines = {}
    for (right, left), points in _HALVES.items():
        outlines[right], outlines[left] = np.array(points), np.array(points) * mirror
    for name, points in _MIDDLE.items():
        half = np.array(points)
        below = np.array(_KEY) if name == "8" else np.zeros((0, 2))
        outlines[name] = np.concatenate([half, below, (half * mirror)[::-1]])
    plane = la.BlockAssembly(outlines, mu, tolerance=_TOLERANCE)
    return shaken(la.masonry3d.extruded(plane, _DEPTH), ("0", "1"))


def reference(mu: float) -> Reference:
    """Return the reference: tabulated."""
    value = {MU: VALUE}[mu]
    return Reference(
        value,
        "b/h of stone 13, and no less by any other mechanism",
        "moments, and independent programs; geometry: sample `bridge` of compas_cra (Kao et al.,"
        " Computer-Aided Design 2022, MIT licence)",
        "exact, numerical",
        half_width=5e-7,
        associated=value,
    )


def band(elements: int, mu: float) -> Band:
    """Return the band: rigid; alpha is in weights."""
    return rigid(1.0)


CASE = Case(
    id="cra-bridge",
    title="Bridge of hooked stones",
    tags=("blocks", "space", "contact", "Coulomb", "masonry"),
    unit="W",
    explanation=__doc__,
    hand_calculation="""\
stone 13:  b = 0.3504033, h = 0.6177700
topples:   alpha = b/h = 0.567207 < mu
the rest:  carries that, by a certified state
""",
    build=build,
    reference=reference,
    band=band,
    variants=(Variant("mu-0.9", {"mu": MU}, unfit=HYPERSTATIC),),
)
