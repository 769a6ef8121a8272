r"""A block on a Coulomb floor in simple shear, under a dead pressure p0 on its top.

Tractions of one size alpha shear it: along the top, and up and down its sides, so that its stress
is uniform whatever alpha is.

               p0  v     v     v     v
      alpha  --->  --->  --->  --->  --->
              +-------------------------+
           |  |  .                      |  ^
    alpha  |  |      .   slip lines     |  |  alpha
           v  |          .  tan = 1/2   |  |
              |              .          |
              +-------------------------+
              /////////// mu ////////////

Either the block slides on the floor, or it yields: its upper part slides down along slip lines
inclined by psi, sin(2 psi) = p0/(2 k). The default p0 = 1.6 k gives tan(psi) = 1/2; the cells of
the mesh are drawn with that slope, so that their diagonals are slip lines.

This is the largest Coulomb load, and that of associated friction. It is the only one if the contact
pressure is uniform, which equilibrium does not require. Where the pressure rises above k/mu the
patch shears along the floor instead of slipping, for less. No load of rigid sliding is less than
p0/(1/mu + 2 atan(mu)), as proven in `lacore_verification.cases.shared.shear_zones`. Whether there
are loads below the largest one is not known: no search has found any.
"""

from math import asin, sqrt, tan

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, exact_patch
from lacore_verification.cases.shared.shear_zones import least_friction

WIDTH, K = 2.0, 1.0


def build(nx: int, ny: int, mu: float, p0: float) -> "la.Problem":
    """Return the problem: the block, its cells as steep as the slip lines."""
    slope = tan(asin(p0 / (2 * K)) / 2)
    mesh = la.meshes.rectangle(x=(0, WIDTH), y=(0, WIDTH / nx * slope * ny), nx=nx, ny=ny)
    return la.Problem(
        bodies={"patch": la.Body(mesh, la.VonMises(shear_strength=K))},
        interfaces=[la.Interface(("patch", "bottom"), la.RigidObstacle((0, 0), (0, 1)), mu)],
        reference_loads=[
            la.Traction("patch", "top", (1, 0)),
            la.Traction("patch", "right", (0, 1)),
            la.Traction("patch", "left", (0, -1)),
        ],
        dead_loads=[la.Traction("patch", "top", (0, -p0))],
    )


def reference(mu: float, p0: float) -> Reference:
    """Return the reference.

    From the least load of rigid sliding to the smaller of sliding and yielding.
    """
    high = min(mu * p0, sqrt(K**2 - p0**2 / 4))
    return Reference(
        min(least_friction(mu, p0), high),
        "from p0/(1/mu + 2 atan(mu)) to min(mu p0, sqrt(k^2 - p0^2/4))",
        "analytical: limits of rigid sliding with shear zones along the floor; uniform stress and"
        " Mohr's circle",
        "interval of one mechanism",
        up_to=high,
        associated=high,
        complete=False,
    )


def band(elements: int, mu: float, p0: float) -> Band:
    """Return the band: rigid sliding, or shear along the diagonals of the cells."""
    return exact_patch("the slip lines are element edges, or the whole block slides.")


CASE = Case(
    id="shear-patch",
    title="Simple shear on a Coulomb floor",
    tags=("continuum", "contact", "Coulomb", "patch test", "closed form"),
    unit="shear traction / k",
    explanation=__doc__,
    hand_calculation="""\
uniform stress:  sigma_x = 0, sigma_y = -p0, tau = alpha
                 so on the floor t_n = p0, t_t = alpha
sliding:         alpha = mu p0
yield:           (p0/2)^2 + alpha^2 = k^2   (Mohr's circle)
p0 = 1.6 k:      alpha <= min(1.6 mu, 0.6) k, crossing at mu = 0.375
shear:           where mu t > k the patch shears along the floor:
                 alpha is the mean of min(mu t, k), t <= k T,
                 T = 1/mu + 2 atan(mu), hence alpha >= p0/T
""",
    meshes={
        "coarse": {"nx": 2, "ny": 3},
        "medium": {"nx": 10, "ny": 15},
        "fine": {"nx": 28, "ny": 42},
    },
    build=build,
    reference=reference,
    band=band,
    variants=(
        Variant("sliding", {"mu": 0.2, "p0": 1.6}),
        Variant("yielding", {"mu": 0.5, "p0": 1.6}),
    ),
)
