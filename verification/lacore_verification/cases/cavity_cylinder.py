r"""A thick tube of soil, radii a = 1 and b = 2, driven apart by pressure in its bore.

          o - _
          o     ` .
    u_x=0 o         `.
          o _         `
            ` .  <-    \    a = 1, b = 2, cohesion 1, friction angle phi
        alpha  `.       \
           -->   \       |
                  |      |
                  o oo o o
                   u_y = 0

Plane strain, a quarter modelled. The stresses follow from equilibrium and yield alone, so that the
pressure is the same whatever the soil dilates by, in one variant by less than its friction. As it
grows with the friction angle inside, hoop stresses fall behind: with more friction less pressure
drives it apart.

Edges are curved: the nodes of a rectangle of radii and angles, on circles.
"""

import lacore as la
from lacore_verification.case import Band, Case, Convergence, Order, Reference, Variant
from lacore_verification.cases.shared.cavities import MESHES, expansion, quarter, smooth
from lacore_verification.cases.shared.friction_inside import UNFIT

_ERROR = Convergence(
    5.0e-3,
    1.15,
    "32 to 1296 elements, the largest of four angles: 8.2e-5, 4.5e-5, 2.7e-5, 1.2e-5, 6.6e-6,"
    " 2.6e-6, 1.2e-6",
)


def build(n_radial: int, n_angular: int, angle: float, dilation: float) -> "la.Problem":
    """Return the problem: the quarter; cohesion 1."""
    return quarter(n_radial, n_angular, angle, dilation, "plane_strain")


def reference(angle: float, dilation: float) -> Reference:
    """Return the reference: the tube that yields everywhere."""
    return expansion(angle, 1)


def band(elements: int, angle: float, dilation: float) -> Band:
    """Return the band: interior strain points, curved edges."""
    return smooth(_ERROR, elements)


def order(angle: float, dilation: float) -> Order | None:
    """Return the order of convergence.

    Smooth; with less friction coarse meshes fall faster, without any to the solver at once.
    """
    if angle < 30 or dilation < angle:
        return None
    return Order(
        tuple({"n_radial": n, "n_angular": 2 * n} for n in (2, 3, 4, 6, 8)),
        1.1,
        0.1,
        "The solution is smooth: order 2 in the size of elements, 1 in their number, and more on"
        " coarse meshes. Measured: 1.09 over 32 to 512 elements.",
    )


CASE = Case(
    id="cavity-cylinder",
    title="Thick tube of soil under internal pressure",
    tags=("continuum", "soil", "curved boundary", "closed form"),
    unit="pressure / c",
    explanation=__doc__,
    hand_calculation="""\
equilibrium:  d s_r/dr = (s_t - s_r)/r
yield:        s_t - s_r = 2 c cos(phi) - (s_t + s_r) sin(phi)
with H = c cot(phi), x = H - s_r:  dx/dr = -m x/r
              m = 2 sin(phi)/(1 + sin(phi))
integrate:    x = H at b, H + alpha at a:  alpha = H ((b/a)^m - 1)
phi = 0:      alpha = 2 c ln(b/a)
b/a = 2:      1.386294, 1.291128, 1.164280, 1.017409 c
              at phi = 0, 10, 20, 30
""",
    meshes=MESHES,
    build=build,
    reference=reference,
    band=band,
    order=order,
    sweep="angle",
    surfaces=True,
    bracket=None,
    variants=(
        Variant("phi-30", {"angle": 30.0, "dilation": 30.0}, ("coarse",)),
        Variant("psi-10", {"angle": 30.0, "dilation": 10.0}, ("coarse",), unfit=UNFIT),
        Variant("phi-20", {"angle": 20.0, "dilation": 20.0}, ("coarse",)),
        Variant("phi-10", {"angle": 10.0, "dilation": 10.0}, ("coarse",)),
        Variant("phi-0", {"angle": 0.0, "dilation": 0.0}, ("coarse",)),
    ),
)
