r"""A hollow sphere of soil, radii a = 1 and b = 2, driven apart by pressure in it.

        z
        | axis
        o - _
        o     ` .
        o         `.
        o _         `
          ` .  <-    \    a = 1, b = 2, cohesion 1, friction angle phi
       alpha  `.       \
          -->   \       |
                 |      |
    ------------ o oo o o ---- r
                  u_z = 0

Axisymmetric, a quarter of a meridian section modelled; u_r = 0 on the axis by itself. Two hoop
stresses are equal, at an edge of the surface of yield: all of its planes are enforced, and no
hypothesis about the third stress is made. The pressure is the same whatever the soil dilates by: in
one variant that is by less than its friction, and each load factor is that of a certified state.

Edges are curved: the nodes of a rectangle of radii and angles, on circles.
"""

import lacore as la
from lacore_verification.case import Band, Case, Convergence, Order, Reference, Variant
from lacore_verification.cases.shared.cavities import MESHES, expansion, quarter, smooth
from lacore_verification.cases.shared.friction_inside import UNFIT

_ERROR = Convergence(
    0.023,
    1.18,
    "32 to 1296 elements, the largest of four angles: 3.5e-4, 1.8e-4, 1.0e-4, 4.6e-5, 2.5e-5,"
    " 9.9e-6, 4.3e-6",
)


def build(n_radial: int, n_angular: int, angle: float, dilation: float) -> "la.Problem":
    """Return the problem: the quarter; cohesion 1."""
    return quarter(n_radial, n_angular, angle, dilation, "axisymmetric")


def reference(angle: float, dilation: float) -> Reference:
    """Return the reference: the sphere that yields everywhere."""
    return expansion(angle, 2)


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
        1.15,
        0.1,
        "The solution is smooth: order 2 in the size of elements, 1 in their number, and more on"
        " coarse meshes. Measured: 1.16 over 32 to 512 elements.",
    )


CASE = Case(
    id="cavity-sphere",
    title="Hollow sphere of soil under internal pressure",
    tags=("continuum", "soil", "axisymmetric", "curved boundary", "closed form"),
    unit="pressure / c",
    explanation=__doc__,
    hand_calculation="""\
equilibrium:  d s_r/dr = 2 (s_t - s_r)/r
yield:        s_t - s_r = 2 c cos(phi) - (s_t + s_r) sin(phi)
with H = c cot(phi), x = H - s_r:  dx/dr = -m x/r
              m = 4 sin(phi)/(1 + sin(phi))
integrate:    x = H at b, H + alpha at a:  alpha = H ((b/a)^m - 1)
phi = 0:      alpha = 4 c ln(b/a)
b/a = 2:      2.772589, 2.876194, 2.821940, 2.632444 c
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
