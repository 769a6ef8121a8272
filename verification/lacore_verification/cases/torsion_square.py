r"""A bar of square section is twisted, its ends free to warp.

         from the end                         shear stress k, along contour lines
            +-----------------------+         of the heap of sand on the section
            | `.                 .' |
            |   `.    ---->    .'   |
            |     `.         .'     |
            |  |    `.     .'    |  |         alpha: torque
            |  |      `. .'      |  |
            |  V      .' `.      |  |         ridges of the heap: the diagonals
            |       .'     `.       |
            |     .'         `.     |
            |   .'   <----     `.   |
            | .'                 `. |
            +-----------------------+
            |<--------- a --------->|

One end is held along its section, the other one turned by a rigid plate that leaves it free to
warp: then stress and twist are those of a long bar, whatever the length. A mesh whose faces hold
the ridges has the exact solution in it, from either side; others cross them.
"""

import lacore as la
from lacore_verification.case import Band, Case, Convergence, Reference, Variant, exact_patch
from lacore_verification.cases.shared.tetrahedra import CLAY

SIDE = 2.0
_ACROSS = Convergence(
    1.36, 0.667, "24, 192, 648 tetrahedra: 16.4, 4.1, 1.8 % above, order 2 in their size"
)


def build(n: int, ridges: bool) -> "la.Problem":
    """Return the problem: a bar as long as half its side."""
    half = SIDE / 2
    mesh = la.meshes.box((-half, half), (-half, half), (0, half), 2 * n, 2 * n, n, ridges)
    return la.Problem(
        bodies={"bar": la.Body(mesh, CLAY, kinematics="3d")},
        supports=[la.Fix("bar", "bottom", axis) for axis in ("x", "y")],
        reference_loads=[la.Twist("bar", "top", (0, 0, 1))],
    )


def reference(ridges: bool) -> Reference:
    """Return the reference: twice the volume of the heap of sand, of slope k."""
    return Reference(
        SIDE**3 / 3,
        "k a^3/3",
        "Nadai, Theory of Flow and Fracture of Solids; analytically",
        "exact",
    )


def band(elements: int, ridges: bool) -> Band:
    """Return the band: strict; of second order where elements lie across the ridges."""
    if ridges:
        return exact_patch("warping is quadratic next to the ridges, which are faces of the mesh.")
    return _ACROSS.strict(elements)


CASE = Case(
    id="torsion-square",
    title="Square bar in torsion",
    tags=("continuum", "space", "torsion", "upper bound", "closed form"),
    unit="torque / (k m^3)",
    explanation=__doc__,
    hand_calculation="""\
heap:      a pyramid of slope k on the square, height k a/2
volume:    a^2 (k a/2)/3 = k a^3/6
torque:    2 volume = k a^3/3
a = 2:     8/3 = 2.666667
""",
    meshes={"coarse": {"n": 1}, "medium": {"n": 2}, "fine": {"n": 3}},
    build=build,
    reference=reference,
    band=band,
    bracket=None,
    variants=(
        Variant("ridges", {"ridges": True}, meshes=("coarse",)),
        Variant("across", {"ridges": False}, meshes=("coarse",)),
    ),
)
