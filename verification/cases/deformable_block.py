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
branches meet at mu = 0.75. The block is long enough (b/h = 4) that it neither topples
(alpha h^2 < p b^2) nor crushes at its toe, where the closed form would not hold.
"""

import lacore as la
from verification.case import Band, Case, Reference, Variant, exact_patch

LENGTH, HEIGHT, PRESSURE, K = 4.0, 1.0, 1.0, 1.0


def build(n: int, mu: float) -> la.Problem:
    """The block on square cells, n over its height: their diagonals hold the 45-degree cut."""
    mesh = la.meshes.rectangle(x=(0, LENGTH), y=(0, HEIGHT), nx=int(LENGTH / HEIGHT) * n, ny=n)
    return la.Problem(
        bodies={"block": la.Body(mesh, la.VonMises(shear_strength=K))},
        interfaces=[la.Interface(("block", "bottom"), la.RigidObstacle((0, 0), (0, 1)), mu)],
        reference_loads=[la.Traction("block", "left", (1, 0))],
        dead_loads=[la.Traction("block", "top", (0, -PRESSURE))],
    )


def reference(mu: float) -> Reference:
    """The smaller of sliding and crushing."""
    return Reference(
        min(mu * PRESSURE * LENGTH / HEIGHT, PRESSURE + 2 * K),
        "min(mu p b/h, p + 2 k)",
        "equilibrium and the wedge mechanism, by hand",
        "exact",
    )


def band(elements: int, mu: float) -> Band:
    """Rigid sliding, or a cut along element edges."""
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
together:  alpha = min(4 mu, 3)
           crossing at mu = (p + 2 k) h/(p b) = 0.75
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
