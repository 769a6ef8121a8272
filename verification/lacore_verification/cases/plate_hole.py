r"""A square plate with a round hole is pulled in one direction until it yields, in plane stress.

        +-----------------+                    +------------------+
        |                 |              u_x=0 o                  |
      <-|      ,-.        |->                  o                  | --> alpha
      <-|     (   )       |->                  o _                |
      <-|      `-'        |->           r = 0.2    ` .            |
        |                 |                          \            |
        +-----------------+                           o-o-o-o-o-o-o
                                                         u_y = 0

Half the side is 1, the hole has a radius of 0.2; a quarter is modelled. The plate is
thin: stresses across it vanish, and it becomes thinner where it yields.
The ligaments above and below the hole carry the yield stress and the hole nothing, so that the
plate loses one fifth of its strength. In the mechanism it necks along bands that leave the hole at
an angle.

The mesh replaces the circle by a polygon, so its value is not a bound.
"""

from dataclasses import replace
from math import cos, pi
from typing import Any

import numpy as np
from skfem import MeshQuad, MeshTri

import lacore as la
from lacore.model.meshes.structured import graded
from lacore_verification.case import Band, Case, Convergence, Reference, Variant
from lacore_verification.case.band import Bracketing

RADIUS = 0.2  # half the side is 1
_MESHES: dict[str, dict[str, Any]] = {
    "coarse": {"n_radial": 2, "n_angular": 4, "ratio": 3.0},
    "medium": {"n_radial": 9, "n_angular": 16, "ratio": 5.0},
    "fine": {"n_radial": 27, "n_angular": 44, "ratio": 5.0},
}
_BOUNDS = (0.7997, 0.8009)
_ERROR = Convergence(
    0.193, 0.676, "32 to 4752 elements: 2.07, 0.57, 0.24, 0.10, 0.069 % above the published 0.8"
)


def build(n_radial: int, n_angular: int, ratio: float) -> "la.Problem":
    """Return the problem: the quarter, yield stress 1: load factors are in units of s0."""
    body = la.Body(
        _quarter(n_radial, n_angular, ratio),
        la.VonMises(yield_stress=1.0),
        kinematics="plane_stress",
        geometry="approximated",
    )
    return la.Problem(
        bodies={"plate": body},
        supports=[la.Fix("plate", "y_axis", "x"), la.Fix("plate", "x_axis", "y")],
        reference_loads=[la.Traction("plate", "end", (1, 0))],
    )


def _quarter(n_radial: int, n_angular: int, ratio: float) -> MeshTri:
    """Return the crossed cells on rays from the hole to the sides.

    `n_angular` is even, for the corner.
    """
    cells = MeshQuad.init_tensor(
        graded(0.0, 1.0, n_radial, (0.0, ratio)), np.linspace(0.0, pi / 2, n_angular + 1)
    )
    share, angle = cells.p
    ray = np.stack([np.cos(angle), np.sin(angle)])
    ray[0, angle == pi / 2] = 0.0
    side = ray / np.abs(ray).max(axis=0)
    points = (1 - share) * RADIUS * ray + share * side
    mesh: MeshTri = replace(cells, doflocs=points).to_meshtri(style="x")
    return mesh.with_boundaries(
        {
            "x_axis": lambda x: x[1] < 1e-9,
            "y_axis": lambda x: x[0] < 1e-9,
            "end": lambda x: x[0] > 1 - 1e-9,
        }
    )


def reference() -> Reference:
    """Return the reference: bounds around the published value."""
    low, high = _BOUNDS
    return Reference(
        (low + high) / 2,
        "s0 (1 - r), published",
        f"Gaydon & McCrum 1954: 0.8; strict bounds [{low}, {high}], an independent computation",
        "bracket",
        half_width=(high - low) / 2,
    )


def band(elements: int) -> Band:
    """Return the band: straight edges on the hole."""
    return _ERROR.two_sided(elements, "straight edges replace the circle.")


def _bracketing(mesh: str) -> Bracketing:
    """Return the polygon lies in the circle, so that the plate is no weaker.

    And around a smaller one.
    """
    turn = pi / 2 / _MESHES[mesh]["n_angular"]
    off = RADIUS * (1 - cos(turn / 2)) / (1 - RADIUS)
    return Bracketing(
        target_width=0.005,
        mesh=mesh,
        above=off,
        reason="the polygon lies between circles of r and r cos(turn/2), turn the angle of an"
        f" edge, whose load factors s0 (1 - r) differ by {off:.3%}",
    )


CASE = Case(
    id="plate-hole",
    title="Plate with a round hole in tension, plane stress",
    tags=("continuum", "plane stress", "curved boundary", "bracket"),
    unit="mean traction / s0",
    explanation=__doc__,
    hand_calculation="""\
ligaments:   sigma_x = s0 for |y| > r, nothing in between: rigid
             grips at the ends put up with it
             alpha = s0 (1 - r) = 0.8 s0
             whether uniform traction may reach the same is not
             shown by this, but by the bounds, to 0.1 %
""",
    meshes=_MESHES,
    build=build,
    reference=reference,
    band=band,
    bracket=_bracketing("medium"),
    variants=(Variant("uniaxial", {}),),
)
