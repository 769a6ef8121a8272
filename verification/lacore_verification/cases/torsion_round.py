r"""A round bar is twisted, its ends free to warp.

         from the end     _ - - _
                       .'   |    `.        shear stress k along circles
                      /  .--+--.   \
                     |  /   |   \   |
                     | |----o----|--|      alpha: torque
                     |  \   |   /   |
                      \  `--+--'   /
                       `.   |    .'
                         ` - - '  |<- R ->|

The section of the mesh is a regular polygon of N corners on the circle. Its heap of sand has
ridges on the rays to these corners, and its warping bends anew at the rays to the middles of its
sides. Both are faces of the mesh: the torque of the polygon is found exactly, less than that of
the circle by what is cut off.
"""

from math import cos, pi, sin

import lacore as la
from lacore_verification.case import EXACT, Band, Case, First, Reference, Variant
from lacore_verification.cases.shared.tetrahedra import CLAY, disc


def build(sides: int, rings: int) -> "la.Problem":
    """Return the problem: a bar of radius 1 m, half as long."""
    mesh = la.meshes.extruded(disc(sides, rings), (0, 0.5), 1)
    return la.Problem(
        bodies={"bar": la.Body(mesh, CLAY, kinematics="3d", geometry="approximated")},
        supports=[la.Fix("bar", "start", axis) for axis in ("x", "y")],
        reference_loads=[la.Twist("bar", "end", (0, 0, 1))],
    )


def of_polygon(sides: float) -> float:
    """Return the torque of a regular polygon per that of its circle.

    Area times distance of its sides.
    """
    return sides / (2 * pi) * sin(2 * pi / sides) * cos(pi / sides)


def reference() -> Reference:
    """Return the reference: twice the volume of a cone of slope k."""
    return Reference(
        2 * pi / 3,
        "2 pi k R^3/3",
        "Nadai, Theory of Flow and Fracture of Solids; analytically",
        "exact",
    )


def band(elements: int) -> Band:
    """Return the band: flat sides cut off what a polygon says; the polygon itself is exact.

    Levels have 8 sides and 48 tetrahedra, 16 and 288.
    """
    sides = 8 if elements < 100 else 16
    below = 1 - of_polygon(sides)
    return Band(
        below=below + EXACT,
        above=EXACT,
        reason=f"A polygon of {sides} sides within the circle: its own heap of sand has"
        f" {100 * below:.3g} % less volume, and is found exactly. The remaining error is that of"
        f" the solver, {EXACT:g}.",
    )


CASE = Case(
    id="torsion-round",
    title="Round bar in torsion",
    tags=("continuum", "space", "torsion", "closed form"),
    unit="torque / (k m^3)",
    explanation=__doc__,
    hand_calculation="""\
heap:      a cone of slope k on the circle, height k R
volume:    pi R^2 k R/3
torque:    2 volume = 2 pi k R^3/3
R = 1:     2.094395
polygon:   N sin(2 pi/N) cos(pi/N) / (2 pi) of it; N = 8: 0.831833
""",
    meshes={
        "coarse": {"sides": 8, "rings": 1},
        "medium": {"sides": 16, "rings": 2},
        "fine": {"sides": 24, "rings": 3},
    },
    build=build,
    reference=reference,
    band=band,
    bracket=None,
    first=First(meshes=("medium",)),
    variants=(Variant("twisted", {}, meshes=("coarse",)),),
)
