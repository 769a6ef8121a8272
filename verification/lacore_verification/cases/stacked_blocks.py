"""Two blocks of one hardening material, one on the other, are pressed flat between smooth platens.

                smooth footing, moves down: alpha
                 |  |  |  |  |  |  |  |
                 v  v  v  v  v  v  v  v
      u_x = 0   o+--------------------+    0.4 high
    (symmetry)  o|        upper       |-->
                o+====================+    contact: smooth, or Coulomb friction
                o|        lower       |-->
                o|                    |    0.6 high
                o+--------------------+
                 o  o  o  o  o  o  o  o    u_y = 0

Both carry the same force on the same width, so that they strain alike and stay as wide as each
other: no point slips, whatever the friction between them. The closed form is that of one block. The
elements of the two do not match, and their vertices pass each other along the path.
"""

from math import log, nan, sqrt

import lacore as la
from lacore_verification.case import Band, Case, First, Reference, Variant
from lacore_verification.case.following import Following, Reading, last_load
from lacore_verification.cases.shared.exact_paths import strip_force
from lacore_verification.cases.shared.hardening_laws import LAWS

WIDTH, LOWER, UPPER = 1.0, 0.6, 0.4  # m
HEIGHT, TRAVEL = LOWER + UPPER, 0.4
# Of the force: certificates hold to 1e-6, and errors of a step carry on.
_ALLOWED = 1e-5
_UNIFORM = 1e-3  # of the mean strain: velocities are known to the root of what loads are


def build(nx: int, law: str, mu: float, slave: str, steps: int, scheme: str) -> "la.Problem":
    """Return the problem.

    Half of the stack; yield stress 1 at the beginning; three columns for two of the lower.
    """

    def block(low: float, high: float, columns: int) -> "la.Body":
        mesh = la.meshes.quadrilaterals((0, WIDTH), (low, high), columns, 1)
        return la.Body(mesh, la.VonMises(hardening=LAWS[law]), space="q2")

    bodies = {"lower": block(0, LOWER, nx), "upper": block(LOWER, HEIGHT, 3 * nx // 2)}
    sides = [("lower", "top"), ("upper", "bottom")]
    one, other = sides if slave == "lower" else sides[::-1]
    return la.Problem(
        bodies=bodies,
        supports=[
            la.Fix("lower", "bottom", "y"),
            *(la.Fix(name, "left", "x") for name in bodies),
        ],
        interfaces=[la.Interface(one, other, mu)],
        reference_loads=[la.RigidFooting("upper", "top", (0, -1), rough=False)],
    )


def spread(path: "la.Path") -> float:
    """Return the largest less least strain in both blocks at the end, of their mean."""
    strains = path.snapshots[-1].configuration.strain
    low = min(float(own.min()) for own in strains.values())
    high = max(float(own.max()) for own in strains.values())
    return 2 * (high - low) / (high + low) if high > 0 else nan


def path(law: str, mu: float, slave: str, steps: int, scheme: str) -> Following:
    """Return the path: a travel of two fifths of the height."""
    return Following(
        TRAVEL,
        steps,
        scheme,
        la.FootingTravel(),
        exact=lambda travel: strip_force(LAWS[law], 1 - travel / HEIGHT, WIDTH),
        load="force",
        volume=1e-6,
        reading=Reading("spread of strains, of their mean,", spread, 0.0, _UNIFORM),
    )


def reference(law: str, mu: float, slave: str, steps: int, scheme: str) -> Reference:
    """Return the reference of one block."""
    at = last_load(TRAVEL, steps, scheme)
    return Reference(
        strip_force(LAWS[law], 1 - at / HEIGHT, WIDTH),
        "(2/sqrt3) sigma_Y((2/sqrt3) ln(H/h)) W H/h",
        "analytical: uniform compression in plane strain",
        "exact",
    )


def band(elements: int, law: str, mu: float, slave: str, steps: int, scheme: str) -> Band:
    """Return the band: exact in space and time."""
    return Band(
        _ALLOWED,
        _ALLOWED,
        "Exact for any step of the implicit midpoint (T30), and for any element: the"
        " certificates of each step allow errors of 1e-6.",
    )


_PRESSED = 1 - TRAVEL / HEIGHT

CASE = Case(
    id="stacked-blocks",
    title="Two hardening blocks, stacked and pressed flat",
    tags=("hardening", "continuum", "contact", "Coulomb", "path", "closed form"),
    unit="force / (initial width s0)",
    explanation=__doc__,
    hand_calculation=f"""\
equilibrium: F = (2/sqrt3) sigma_Y(eb_1) w_1
               = (2/sqrt3) sigma_Y(eb_2) w_2
volume:      w_i = W H_i/h_i, eb_i = (2/sqrt3) ln(H_i/h_i)
so           H_1/h_1 = H_2/h_2 = H/h, and the widths stay equal: no slip
             F = (2/sqrt3) sigma_Y(eb) W H/h
h = {_PRESSED:g} H:   eb = {-2 / sqrt(3) * log(_PRESSED):.6f}
             linear-3: {strip_force(LAWS["linear-3"], _PRESSED, WIDTH):.6f}
""",
    meshes={"coarse": {"nx": 2}, "medium": {"nx": 4}, "fine": {"nx": 8}},
    build=build,
    reference=reference,
    band=band,
    bracket=None,
    path=path,
    variants=tuple(
        Variant(
            name,
            {"law": law, "mu": mu, "slave": slave, "steps": steps, "scheme": "implicit-midpoint"},
            meshes=("coarse",),
        )
        for name, law, mu, slave, steps in (
            ("linear-3-mu-0-lower", "linear-3", 0.0, "lower", 4),
            ("linear-3-mu-0.2-lower", "linear-3", 0.2, "lower", 4),
            ("linear-3-mu-0.2-upper", "linear-3", 0.2, "upper", 4),
            ("voce-mu-0.2-upper", "voce", 0.2, "upper", 4),
            ("1-step", "linear-3", 0.0, "lower", 1),
        )
    ),
    first=First(variant="1-step"),
)
