r"""A square block is pressed between two rigid platens: friction does not matter.

             alpha
          v  v  v  v                   platen, at rest
        +-----------+                 /////// mu //////
        | \       / |                 +---------------+
        |   \   /   |                 o             / |
        |     X     |                 o          /    |
        |   /   \   |           u_x=0 o       /       |  free
        | /       \ |                 o    /  45 deg  |
        +-----------+                 o /             |
          ^  ^  ^  ^                  +---------------+
                                        ^  ^  ^  ^  ^
                                      smooth footing, moves up

Four rigid wedges slide along the two diagonals; the upper and lower ones move with the platens and
stick to them, so no friction at all is needed or used. This holds for w/h <= 1. The quarter model
is that of `platens-coulomb`.

Continuous velocities cannot follow the cut into the corner where the axes of symmetry meet: the
shear band has a width there. The error vanishes with the mesh. Uniform compression without shear on
the platens is admissible for any frozen friction, so every discrete value lies above 2 k, and the
load of the continuum is unique.
"""

from typing import TYPE_CHECKING

import lacore as la
from lacore_verification.case import Band, Case, Convergence, Order, Reference, Variant

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SIDE = 0.5  # of the quarter
_ERROR = Convergence(
    0.557, 0.913, "mu = 0.5, the worst; 36 to 4624 elements: 1.96, 0.83, 0.36, 0.10, 0.024 % above"
)


def build(n: int, mu: float) -> "la.Problem":
    """Return the problem: the quarter on n x n square cells."""
    mesh = la.meshes.rectangle(x=(0, SIDE), y=(0, SIDE), nx=n, ny=n)
    return la.Problem(
        bodies={"block": la.Body(mesh, la.VonMises(shear_strength=1.0))},
        supports=[la.Fix("block", "left", "x")],
        interfaces=[la.Interface(("block", "top"), la.RigidObstacle((0, SIDE), (0, -1)), mu)],
        reference_loads=[la.RigidFooting("block", "bottom", (0, 1), rough=False)],
    )


def reference(mu: float) -> Reference:
    """Return the reference: uniform compression."""
    return Reference(2.0, "2 k", "uniform stress and the mechanism of diagonal cuts", "exact")


def band(elements: int, mu: float) -> Band:
    """Return the band: strict for every friction: uniform stress needs none on the platens."""
    return _ERROR.strict(elements)


def order(mu: float) -> Order | None:
    """Return the order of convergence.

    What was measured; with still less friction it grows along the whole ladder.
    """
    meshes = tuple({"n": n} for n in (4, 6, 8, 12, 16))
    if mu >= 0.3:
        reason = (
            "Measured over 64 to 1024 elements: 0.87 +- 0.03 at mu = 0.3, 0.897 +- 0.023 at 0.5,"
            " 0.902 +- 0.021 at 1 and 2 (95 %), growing towards 1: the cut becomes a shear band,"
            " whose width follows the mesh."
        )
        return Order(meshes, 0.89, 0.08, reason)
    if mu >= 0.1:
        reason = (
            "Measured over 64 to 1024 elements: 0.74 +- 0.06 at mu = 0.1, 0.83 +- 0.04 at 0.2"
            " (95 %), growing along the ladder, while platens still slip on coarse meshes; errors"
            " are smaller than with more friction."
        )
        return Order(meshes, 0.79, 0.1, reason)
    return None


def sketch(axes: "Axes", problem: "la.Problem") -> None:
    """Draw the cut."""
    axes.plot([0, SIDE], [0, SIDE], color="#7a6a3a", lw=1.0, ls=(0, (5, 3)), zorder=3.5)


CASE = Case(
    id="platens-square",
    title="Square block between platens: 2 k at any friction",
    tags=("continuum", "contact", "Coulomb", "closed form", "invariance"),
    unit="F/(w k)",
    explanation=__doc__,
    hand_calculation="""\
from below:  uniform sigma_y = -2 k, sigma_x = 0, no shear at
             the platens; Mohr's circle has radius k
from above:  platens close at rate 2 v, four cuts of length
             w/sqrt2 with a velocity jump sqrt2 v dissipate
             D = 4 k (w/sqrt2) (sqrt2 v) = 4 k w v
             power of F is 2 v F   ->   F/w = 2 k
""",
    meshes={"coarse": {"n": 3}, "medium": {"n": 12}, "fine": {"n": 34}},
    build=build,
    reference=reference,
    band=band,
    order=order,
    sketch=sketch,
    variants=(
        Variant("mu-0.1", {"mu": 0.1}, meshes=("coarse",)),
        Variant("mu-0.5", {"mu": 0.5}),
    ),
)
