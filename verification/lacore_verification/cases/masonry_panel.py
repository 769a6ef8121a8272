r"""A panel of masonry without tension, 1 wide and h high, is pushed sideways at its top.

              | N                 /////// floor ////////
              v                   +----------------+-->
    alpha +-------+-------+       |\`.             | alpha
      --> +-----.---.-----+       |  \ ` .         |
          |      \   \    |       |    \   ` .     |
          |       \   \   | h     |      ` .   \   |
          |        \   \  |       |          ` . \ |
          |         \   \ |       |             `.\|
       ///+----------+---+///  ///+----------------+///
          |<---- 1 ----->| toe

Rocking (left): a beam on top carries N = f/10 in its middle. Without crushing the panel overturns
about its toe, and does so at any strength of its bed joints in shear. With crushing, thrust comes
down in a strut that needs a width at its foot, and the toe crushes. Guided (right): floors keep
their distance, as between stiff slabs, so that the panel cannot open without being pressed; N is
whatever they give. A strut runs from corner to corner, and a crack along it.

Bed joints above and below the rocking panel stick and open; the ground is one, too. Masonry is a
continuum: cracks are strains that cost nothing, crushing is paid for. Plane stress. Without any
tension no stress is inside the criterion, and no lower bound can be proven in floating point.
"""

from math import hypot, sqrt

import numpy as np

import lacore as la
from lacore.numerics.arrays import Bools, Floats
from lacore_verification.case import (
    Band,
    Case,
    Convergence,
    First,
    Order,
    Reference,
    Variant,
    exact_patch,
)

LOAD = 0.1  # N, on a width of 1, per strength
_BEAM = 0.1  # its height

_GUIDED = Convergence(
    1.19, 0.546, "h = 1, 36 to 1024 elements: 16.8, 12.0, 7.6, 5.6, 3.7, 2.7 % above; h = 2 less"
)
_CRUSHED = Convergence(
    1.4, 0.63, "h = 1, 37 to 577 elements: 12.3, 10.7, 5.7, 3.5, 2.2 % above the middle"
)


def build(n: int, height: float, guided: bool, crushing: bool) -> "la.Problem":
    """Return the problem: even cells, n in the width."""
    mesh = la.meshes.rectangle(x=(0, 1), y=(0, height), nx=n, ny=round(n * height))
    panel = la.Body(mesh, la.NoTension(1.0 if crushing else None), kinematics="plane_stress")
    bed = la.Interface(("panel", "bottom"), la.RigidObstacle((0, 0), (0, 1)), la.STICK)
    if guided:
        return la.Problem(
            bodies={"panel": panel},
            interfaces=[bed],
            reference_loads=[la.RigidFooting("panel", "top", (1, 0))],
        )

    def underside(x: Floats) -> Bools:
        return np.asarray(x[1] < height + 1e-9)

    crest = height + _BEAM
    beam = la.RigidBlock([(0, height), (1, height), (1, crest), (0.5, crest), (0, crest)])
    return la.Problem(
        bodies={"panel": panel, "beam": beam},
        interfaces=[bed, la.Interface(("panel", "top"), ("beam", underside), la.STICK)],
        reference_loads=[la.PointForce("beam", (0, height), (LOAD, 0))],
        dead_loads=[la.PointForce("beam", (0.5, crest), (0, -LOAD))],
    )


def reference(height: float, guided: bool, crushing: bool) -> Reference:
    """Return the reference: a strut from below, a crack or a rocking block from above."""
    by_hand = "a strut from below, a mechanism from above; analytically"
    if guided:
        return Reference(
            (hypot(1, height) - height) / 2,
            "(sqrt(b^2 + h^2) - h)/(2 b)",
            f"{by_hand}; Nielsen 1984, in concrete",
            "exact",
        )
    if not crushing:
        return Reference(1 / (2 * height), "b/(2 h)", by_hand, "exact")
    # Of width x and slope s: x = n (1 + s^2), s = (1 - x)/(2 h).
    slope = (sqrt(height**2 + LOAD * (1 - LOAD)) - height) / LOAD
    most = (1 - LOAD) / (2 * height)
    return Reference(
        (slope + most) / 2,
        "strut of width x < alpha < (b - N/f)/(2 h)",
        by_hand,
        "bracket",
        half_width=(most - slope) / 2,
    )


def valid(height: float, guided: bool, crushing: bool) -> bool:
    """Return whether the parameters are valid.

    Between floors nothing bounds the load but crushing.
    """
    return crushing or not guided


def band(elements: int, height: float, guided: bool, crushing: bool) -> Band:
    """Return the band: strict upper bound; what does not crush turns as a rigid block."""
    if not crushing:
        return exact_patch("a block that turns about its toe is in every space.")
    return (_GUIDED if guided else _CRUSHED).strict(elements)


def order(height: float, guided: bool, crushing: bool) -> Order | None:
    """Return the order of convergence: that of a crack across even cells."""
    if not guided or height != 1:
        return None
    return Order(
        tuple({"n": n} for n in (3, 4, 6, 8, 12)),
        0.54,
        0.08,
        "A crack is as wide as a cell: 1/2, that of mesh sizes, and a little more on coarse meshes."
        " Measured: 0.55 over 36 to 576 elements.",
    )


def _variant(
    name: str,
    meshes: tuple[str, ...] = (),
    height: float = 1.0,
    guided: bool = False,
    crushing: bool = True,
) -> Variant:
    parameters = {"height": height, "guided": guided, "crushing": crushing}
    return Variant(name, parameters, meshes)


CASE = Case(
    id="masonry-panel",
    title="Masonry panel without tension, pushed sideways",
    tags=("continuum", "masonry", "plane stress", "blocks", "contact", "upper bound"),
    unit="V/N rocking, V/(f b) guided",
    explanation=__doc__,
    hand_calculation="""\
guided, b = 1, n = N/f given first:
 strut:    uniform, width x, slope s = (1 - x)/h
           N = f x/(1 + s^2), V = N s
           V/f = (sqrt(h^2 + 4 n (1 - n)) - h)/2
 crack:    corner to corner, L = sqrt(1 + h^2),
           moved by (u, -w), v = sqrt(u^2 + w^2):
           f/2 (L v - h u + w) = V u + N w
           least over w: the same V, so both are exact
 floors:   n as they like: n = 1/2, V/f = (L - h)/2
           h = 1: 0.207107,  h = 2: 0.118034
rocking:   about the toe, V h = N b/2: alpha = b/(2 h)
 crushing: about b - n, a toe of width n = N/f:
           V h = N (b/2 - n) + f n^2/2
           alpha < (b - n)/(2 h)
 strut:    s = (b - x)/(2 h), x = n (1 + s^2): alpha > s
           h = 1, n = 0.1: 0.440307 < alpha < 0.45
""",
    meshes={"coarse": {"n": 3}, "medium": {"n": 12}, "fine": {"n": 34}},
    build=build,
    reference=reference,
    valid=valid,
    band=band,
    order=order,
    surfaces=True,
    bracket=None,
    first=First(meshes=("medium",)),
    variants=(
        _variant("guided", guided=True),
        _variant("guided-tall", ("coarse",), height=2.0, guided=True),
        _variant("rocking", ("coarse",), crushing=False),
        _variant("rocking-crushing", ("medium",)),
    ),
)
