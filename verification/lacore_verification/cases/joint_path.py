r"""A prism that is cut by an inclined joint is compressed between smooth platens.

                 smooth footing, moves down: alpha
                  v  v  v  v  v  v
                 +----------------+
              -> |     upper      | <-
            q -> |                | <- q
              -> |\               | <-      Coulomb friction mu in the joint,
    u_x = 0     o|  \             | <-      under theta to the horizontal
    (lower      o|    \           | <-
     body)      o|      \         | <-
                o|        \       | <-
                o|  lower   \     | <-
                o|            \   | <-
                o|              \ | <-
                o|               \| <-
                 +----------------+
                  o  o  o  o  o  o   u_y = 0

Where the joint holds, the prism yields all over, and grows wider as it becomes shorter. Its angle
becomes flatter. Where the joint slips, the upper body slides down as it is: nothing deforms, and
the lateral pressure on it has the same resultant however far it has come. Each step carries the
smaller of the two loads. The elements of the two bodies do not match.
"""

from math import atan, degrees, log, radians, sqrt, tan

import numpy as np

import lacore as la
from lacore.numerics.arrays import Floats
from lacore_verification.case import SOLVER, Band, Case, Reference, Variant
from lacore_verification.case.following import Following, last_load
from lacore_verification.cases.shared.exact_paths import strip_force
from lacore_verification.cases.shared.hardening_laws import LAWS

WIDTH, LOW, HIGH = 1.0, 0.5, 0.5  # m: of the prism, of the lower body at the right, upper left
TRAVEL, _FRICTION = 0.2, 0.4
# Of the force: certificates hold to 1e-6 of each of four steps.
_ALLOWED = 1e-5


def build(
    nx: int, ny: int, law: str, theta: float, q: float, slave: str, steps: int, scheme: str
) -> "la.Problem":
    """Yield stress 1 at the beginning; theta in degrees; one column more in the upper body."""
    height, drop = _height(theta), WIDTH * tan(radians(theta))

    def joint(x: Floats) -> Floats:
        return np.asarray(LOW + drop * (1 - x / WIDTH))

    def body(columns: int, upper: bool) -> "la.Body":
        square = la.meshes.quadrilaterals((0, WIDTH), (0, 1), columns, ny)
        x, share = square.p
        low, high = (joint(x), height) if upper else (0.0, joint(x))
        places = np.array([x, (1 - share) * low + share * high])
        mesh = type(square)(places, square.t).with_boundaries(dict(square.boundaries))
        return la.Body(mesh, la.VonMises(hardening=LAWS[law]), space="q2")

    sides = [("upper", "bottom"), ("lower", "top")]
    one, other = sides if slave == "upper" else sides[::-1]
    return la.Problem(
        bodies={"lower": body(nx, upper=False), "upper": body(nx + 1, upper=True)},
        supports=[la.Fix("lower", "bottom", "y"), la.Fix("lower", "left", "x")],
        interfaces=[la.Interface(one, other, _FRICTION)],
        reference_loads=[la.RigidFooting("upper", "top", (0, -1), rough=False)],
        dead_loads=[
            la.Pressure("upper", "left", q),
            la.Pressure("upper", "right", q),
            la.Pressure("lower", "right", q),
        ],
    )


def _height(theta: float) -> float:
    return LOW + WIDTH * tan(radians(theta)) + HIGH


def slip_force(theta: float, q: float, length: float) -> float:
    """Return the force for slip after uniform compression to a length, initially 1."""
    angle = atan(length**2 * tan(radians(theta)))
    return q * tan(angle) / tan(angle - atan(_FRICTION)) * WIDTH / length


def yield_force(law: str, q: float, length: float) -> float:
    """Return the force for yielding after uniform compression to a length, initially 1."""
    return q * WIDTH / length + strip_force(LAWS[law], length, WIDTH)


def force(law: str, theta: float, q: float, travel: float) -> float:
    """Return the smaller of the two loads: slip leaves the shape of the bodies as it is."""
    first = slip_force(theta, q, 1.0)
    if first <= yield_force(law, q, 1.0):
        return first
    length = 1 - travel / _height(theta)
    return min(yield_force(law, q, length), slip_force(theta, q, length))


def path(law: str, theta: float, q: float, slave: str, steps: int, scheme: str) -> Following:
    """Return the path: the upper platen moves down."""
    return Following(
        TRAVEL,
        steps,
        scheme,
        la.FootingTravel(),
        exact=lambda travel: force(law, theta, q, travel),
        load="force",
        volume=SOLVER,
    )


def reference(law: str, theta: float, q: float, slave: str, steps: int, scheme: str) -> Reference:
    """Return the yielding or slip."""
    return Reference(
        force(law, theta, q, last_load(TRAVEL, steps, scheme)),
        "w min(q + 2 k, q tan t/tan(t - phi))",
        "equilibrium, analytically: uniform stress, or two rigid bodies",
        "exact",
    )


def band(
    elements: int, law: str, theta: float, q: float, slave: str, steps: int, scheme: str
) -> Band:
    """Return the band: exact in space and time."""
    return Band(
        _ALLOWED,
        _ALLOWED,
        "Exact for any step of the implicit midpoint (T30), and for any element: the"
        " certificates of each step allow errors of 1e-6.",
    )


def _line(law: str, theta: float, q: float) -> str:
    length = 1 - TRAVEL / _height(theta)
    return (
        f"theta = {theta:g}, q = {q:g} s0, {law}:\n"
        f"  at the beginning:  yield {yield_force(law, q, 1.0):.6f}, "
        f"slip {slip_force(theta, q, 1.0):.6f}\n"
        f"  h = {length:.6f} H:  yield {yield_force(law, q, length):.6f}, "
        f"slip {slip_force(theta, q, length):.6f}"
    )


_SLIPS, _YIELDS = (60.0, 0.25), (70.0, 1.0)  # theta, q
_PRESSED = 1 - TRAVEL / _height(_YIELDS[0])

CASE = Case(
    id="joint-path",
    title="Prism with an inclined joint, compressed between smooth platens",
    tags=("hardening", "continuum", "contact", "Coulomb", "path", "closed form"),
    unit="force / (initial width s0)",
    explanation=__doc__,
    hand_calculation=f"""\
yield: s1 = q + 2 k everywhere, F = s1 w
       w = W H/h, 2 k = (2/sqrt3) sigma_Y, tan t = tan theta (h/H)^2
slip:  resultant of q on the upper body: Q = q w tan t
       N sin t - mu N cos t = Q, F = N cos t + mu N sin t
       F = Q/tan(t - phi), phi = atan(mu) = {degrees(atan(_FRICTION)):.4f} degrees
{_line("perfect", *_SLIPS)}
  it slips all the way: the first slip load
{_line("linear-1", *_YIELDS)}
  it yields all the way, eb = {-2 / sqrt(3) * log(_PRESSED):.6f}
""",
    meshes={
        "coarse": {"nx": 2, "ny": 2},
        "medium": {"nx": 4, "ny": 4},
        "fine": {"nx": 8, "ny": 8},
    },
    build=build,
    reference=reference,
    band=band,
    bracket=None,
    path=path,
    variants=tuple(
        Variant(
            f"{name}-{slave}",
            {
                "law": law,
                "theta": theta,
                "q": q,
                "slave": slave,
                "steps": 4,
                "scheme": "implicit-midpoint",
            },
            meshes=("coarse",),
        )
        for name, law, (theta, q), slave in (
            ("slips", "perfect", _SLIPS, "upper"),
            ("slips", "perfect", _SLIPS, "lower"),
            ("yields", "linear-1", _YIELDS, "upper"),
            ("yields", "linear-1", _YIELDS, "lower"),
        )
    ),
)
