r"""A block of a von Mises material stands on a floor with Coulomb friction mu and is pushed.

A dead pressure p presses on its top, a uniform traction alpha pushes on its left face.

               p   p   p   p   p   p   p
               v   v   v   v   v   v   v
             +------.--------------------+
    alpha -> | ^   .                     |
    alpha -> | |  .  45 degrees          |  h = 1
    alpha -> |   .                       |
             +--.------------------------+
             //////////// mu /////////////
             |<--------- b = 4 --------->|

For little friction the whole block slides, without any deformation. For much friction it stays,
and its loaded end is crushed: a wedge cut off at 45 degrees slides upwards against p. The two
branches meet at mu = 0.75. The block is long enough (b/h = 4) that it does not topple
(alpha h^2 < p b^2).

This is the largest Coulomb load, and that of associated friction, but it is not the only one, also
in the continuum. The contact pressure t is not determined. Where mu t > k the block does not slip
on the floor but shears along it, for k instead of mu t. Every stress within yield whose shear
stress on the floor is min(mu t, k) is a Coulomb state with the velocity of rigid sliding. With the
pressures `STATES`, uniform on equal parts of the floor, the load is 1.95 for mu = 0.5, 2.65 for
mu = 0.75 and 2.67 for mu = 0.9. `admissible` states them as loads, and the strict lower bound of
these loads proves that the block carries them.

No load of rigid sliding is less than (p b/h)/(1/mu + 2 atan(mu)), as proven in
`lacore_verification.cases.shared.shear_zones`: 1.37, 1.53 and 1.55 for these mu. Associated
friction bounds all Coulomb loads from above. From below, all of them are bounded by friction 0
only.
"""

from functools import partial

import numpy as np

import lacore as la
from lacore.numerics.arrays import Bools, Floats
from lacore_verification.case import Band, Case, Reference, Variant, exact_patch
from lacore_verification.cases.shared.shear_zones import least_friction

LENGTH, HEIGHT, PRESSURE, K = 4.0, 1.0, 1.0, 1.0
STATES = {
    0.5: (0.61, 0.77, 0.7, 0.84, 2.2, 0.43, 0.89, 1.56),
    0.75: (0.6, 0.64, 0.58, 1.8, 0.22, 1.05, 1.8, 1.31),
    0.9: (  # 16 parts, else 8
        *(0.512, 0.56, 0.52, 0.43, 0.42, 1.8, 1.8, 0.0),
        *(1.8, 0.01, 0.68, 1.8, 1.8, 0.96, 1.8, 1.108),
    ),
}
"""Contact pressures of Coulomb states by friction coefficient, from the left end of the floor."""


def build(n: int, mu: float) -> "la.Problem":
    """Return the problem.

    The block on square cells, n over its height: their diagonals hold the 45-degree cut.
    """
    mesh = la.meshes.rectangle(x=(0, LENGTH), y=(0, HEIGHT), nx=int(LENGTH / HEIGHT) * n, ny=n)
    return la.Problem(
        bodies={"block": la.Body(mesh, la.VonMises(shear_strength=K))},
        interfaces=[la.Interface(("block", "bottom"), la.RigidObstacle((0, 0), (0, 1)), mu)],
        reference_loads=[la.Traction("block", "left", (1, 0))],
        dead_loads=[la.Traction("block", "top", (0, -PRESSURE))],
    )


def sliding_load(mu: float, pressures: Floats) -> float:
    """Return the load under contact pressures on equal parts of the floor.

    Slip, or shear where mu t > k.
    """
    return float(np.minimum(mu * pressures, K).mean() * LENGTH / HEIGHT)


def admissible(mu: float, pressures: Floats) -> "la.Problem":
    """Return the block under all tractions of a Coulomb state, those of the floor among the loads.

    A load factor of 1 proves that an equilibrium stress within yield has these tractions. More is
    impossible where the floor shears the block at k.
    """
    n = len(pressures)
    mesh = la.meshes.rectangle(x=(0, LENGTH), y=(0, HEIGHT), nx=n, ny=max(1, n // 4))
    ends = np.linspace(0, LENGTH, n + 1)
    floor = [
        la.Traction("block", partial(_on_floor, low, high), (-min(mu * t, K), t))
        for low, high, t in zip(ends[:-1], ends[1:], pressures.tolist(), strict=True)
    ]
    return la.Problem(
        bodies={"block": la.Body(mesh, la.VonMises(shear_strength=K))},
        reference_loads=[
            la.Traction("block", "left", (sliding_load(mu, pressures), 0)),
            la.Traction("block", "top", (0, -PRESSURE)),
            *floor,
        ],
    )


def _on_floor(low: float, high: float, x: Floats) -> Bools:
    return np.asarray((x[1] < 1e-9) & (x[0] > low - 1e-9) & (x[0] < high + 1e-9))


def reference(mu: float) -> Reference:
    """Return the reference.

    From the least load of rigid sliding to the smaller of sliding and crushing.
    """
    high = min(mu * PRESSURE * LENGTH / HEIGHT, PRESSURE + 2 * K)
    return Reference(
        least_friction(mu, PRESSURE) * LENGTH / HEIGHT,
        "from (p b/h)/(1/mu + 2 atan(mu)) to min(mu p b/h, p + 2 k)",
        "analytical: limits of rigid sliding with shear zones along the floor; the wedge mechanism",
        "interval of one mechanism",
        up_to=high,
        associated=high,
        complete=False,
    )


def band(elements: int, mu: float) -> Band:
    """Return the band: rigid sliding, or a cut along element edges."""
    return exact_patch(
        "sliding is a rigid motion, and the cut that frees the crushed wedge runs along element"
        " edges, where shear in one row of elements dissipates what a jump would."
    )


CASE = Case(
    id="deformable-block",
    title="Deformable block pushed along a rough floor",
    tags=("continuum", "contact", "Coulomb", "closed form"),
    unit="traction / k",
    explanation=__doc__,
    hand_calculation="""\
sliding:   total normal force N = p b, alpha h = mu N
           alpha = mu p b/h = 4 mu
crushing:  sigma_y = -p, yield in plane strain: sigma_x = -(p + 2 k)
           alpha = p + 2 k = 3, the 45-degree cut carries k
together:  alpha <= min(4 mu, 3)
           crossing at mu = (p + 2 k) h/(p b) = 0.75
shear:     where mu t > k the floor holds the lowest layer:
           alpha h = integral of min(mu t, k), N = p b
           t <= k T, T = 1/mu + 2 atan(mu), hence alpha >= 4/T
mu = 0.75: t = 1.8 on a quarter of the floor, elsewhere mu t < k:
           alpha = 4 mu - (1.8 mu - 1) = 2.65
""",
    meshes={"coarse": {"n": 1}, "medium": {"n": 6}, "fine": {"n": 17}},
    build=build,
    reference=reference,
    band=band,
    variants=(
        Variant("sliding", {"mu": 0.5}),
        Variant("crushing", {"mu": 0.9}),
        *(
            Variant(f"mu-{mu:g}", {"mu": mu}, meshes=("coarse",))
            for mu in (0.1, 0.2, 0.3, 0.4, 0.6, 0.7, 0.8)
        ),
    ),
    sweep="mu",
)
