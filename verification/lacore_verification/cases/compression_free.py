r"""A block between two smooth rigid platens yields in uniaxial compression: tetrahedra.

               alpha (mean pressure)
            +-----------------------+   platen, smooth
           /|                      /|
          / |        free sides   / |
         +-----------------------+  |
         |  |                    |  |
         |  o - - - - - - - - - -|- o   u_z = 0, smooth
         | /                     | /
         +-----------------------+

A quarter of the block is modelled, its planes of symmetry smooth walls. Stress and strain rate are
uniform: exact on any mesh, in every velocity space of tetrahedra.
"""

from math import sqrt

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, exact_patch
from lacore_verification.cases.shared.tetrahedra import CLAY


def build(n: int, space: str) -> "la.Problem":
    """Return the problem: a unit cube, in n^3 cells of six tetrahedra."""
    mesh = la.meshes.box((0, 1), (0, 1), (0, 1), n, n, n)
    return la.Problem(
        bodies={"block": la.Body(mesh, CLAY, kinematics="3d", space=space)},
        supports=[la.Fix("block", side, "normal") for side in ("left", "front", "bottom")],
        reference_loads=[la.RigidFooting("block", "top", (0, 0, -1), rough=False)],
    )


def reference(space: str) -> Reference:
    """Return the reference: uniaxial compression: J2 = sigma^2/3 = k^2."""
    return Reference(sqrt(3), "sqrt(3) k", "yield criterion, analytically", "exact")


def band(elements: int, space: str) -> Band:
    """Return the band: uniform strain rates are in every space."""
    return exact_patch("the strain rate is uniform.")


CASE = Case(
    id="compression-free",
    title="Block between smooth platens in three dimensions",
    tags=("continuum", "space", "upper bound", "closed form"),
    unit="mean pressure / k",
    explanation=__doc__,
    hand_calculation="""\
uniaxial:  sigma_z = -alpha,  all others 0
J2:        alpha^2/3 = k^2
           alpha = sqrt(3) k = 1.7320508 k
""",
    meshes={"coarse": {"n": 1}, "medium": {"n": 3}, "fine": {"n": 5}},
    build=build,
    reference=reference,
    band=band,
    variants=tuple(
        Variant(space, {"space": space}, meshes=("coarse",))
        for space in ("p2-vertex", "p1-disc", "p2-disc")
    ),
)
