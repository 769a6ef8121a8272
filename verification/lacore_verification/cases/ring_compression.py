"""A ring is pressed to half of its height: its bore tells the friction of the platens.

        | axis           platen, at rest
        |             ///////// mu /////////
        |             +--------------------+
        |    bore     |  quarter section   |  outside
        |  <-  or ->  |                    |-->
        |             +--------------------+
        |            1.5                   3      half height 1
                       ^  ^  ^  ^  ^  ^  ^
                       smooth footing, moves up: alpha

The ring test, outside diameter : bore : height = 6 : 3 : 2. Without friction the ring spreads like
a disc and its bore grows as 1/sqrt(h/H). With friction a neutral radius moves into the ring: what
lies inside of it flows to the axis. With little friction the bore still grows, with more it
shrinks, and a bore that has been measured is a friction coefficient. The sides fold onto the
platen.
"""

from math import nan, sqrt

import numpy as np

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant
from lacore_verification.case.following import Following, Reading, last_load
from lacore_verification.cases.shared.exact_paths import bar_force
from lacore_verification.cases.shared.hardening_laws import LAWS

BORE, OUTSIDE, HEIGHT, TRAVEL = 1.5, 3.0, 1.0, 0.5  # height and travel of the half
_PLATEN = la.RigidObstacle((0, HEIGHT), (0, -1))
_STEPS = 0.08  # relative error of leapfrog loads and of the bore times the square of their number


def build(nr: int, nz: int, mu: float, law: str, steps: int, scheme: str) -> "la.Problem":
    """Return the problem: half of the height, in triangles; yield stress 1 at the beginning."""
    mesh = la.meshes.rectangle((BORE, OUTSIDE), (0, HEIGHT), nr, nz)
    body = la.Body(mesh, la.VonMises(hardening=LAWS[law]), "axisymmetric", "p2-gauss")
    return la.Problem(
        bodies={"ring": body},
        interfaces=[la.Interface(("ring", "top"), _PLATEN, mu)],
        reference_loads=[la.RigidFooting("ring", "bottom", (0, 1), rough=False)],
    )


def path(mu: float, law: str, steps: int, scheme: str) -> Following:
    """Return the path: to half of the height."""
    growth, allowed = 1 / sqrt(1 - TRAVEL / HEIGHT), 1.3 * _STEPS / steps**2
    low, high = (1.0, growth) if mu <= 0.05 else (0.0, 1.0)
    if mu == 0:
        low, high = growth * (1 - allowed), growth * (1 + allowed)
    return Following(
        TRAVEL,
        steps,
        scheme,
        la.FootingTravel(),
        exact=(lambda travel: _stress(law, travel)) if mu == 0 else None,
        approaching=[la.Interface(("ring", side), _PLATEN, mu) for side in ("left", "right")],
        reading=Reading("radius of the bore at mid-height, of the initial,", bore, low, high),
    )


def bore(path: "la.Path") -> float:
    """Return the present radius of the bore at mid-height, of the initial one."""
    before, after = (path.snapshots[n].configuration.nodes["ring"] for n in (0, -1))
    node = int(np.argmin(np.hypot(before[0] - BORE, before[1])))
    return float(after[0, node] / before[0, node])


def _stress(law: str, travel: float) -> float:
    height = 1 - travel / HEIGHT
    return bar_force(LAWS[law], height) * height


def reference(mu: float, law: str, steps: int, scheme: str) -> Reference:
    """Return the reference: exact without friction."""
    if mu == 0:
        return Reference(
            _stress(law, last_load(TRAVEL, steps, scheme)),
            "sigma_Y(ln(H/h))",
            "analytical: uniform compression",
            "exact",
        )
    return Reference(
        nan,
        "not known; the bore grows where there is little friction, and shrinks where there is more",
        "Male & Cockcroft, J. Inst. Metals 93 (1964) 38, the test; no figures are taken from it",
        "none",
        complete=False,
    )


def band(elements: int, mu: float, law: str, steps: int, scheme: str) -> Band:
    """Return the band: errors of the steps, without friction."""
    if mu > 0:
        return Band(0.0, 0.0, "The load at the end is not known.")
    allowed = 1.3 * _STEPS / steps**2
    return Band(
        allowed,
        allowed,
        f"Exact on every mesh. Largest error of leapfrog steps, 5 to 20: {_STEPS:g} steps^-2, that"
        " of the bore; allowed 1.3 times that.",
    )


CASE = Case(
    id="ring-compression",
    title="Ring pressed between platens, a gauge of friction",
    tags=("hardening", "continuum", "axisymmetric", "contact", "Coulomb", "path"),
    unit="mean pressure on the present face / s0",
    explanation=__doc__,
    hand_calculation="""\
no friction:  r = R/sqrt(h/H) for all particles
              alpha = sigma_Y(ln(H/h))
h = H/2:      bore = 1.414214 of the initial, eb = 0.693147
              linear-1: alpha = 1.693147 s0
""",
    meshes={
        "coarse": {"nr": 4, "nz": 2},
        "medium": {"nr": 6, "nz": 4},
        "fine": {"nr": 12, "nz": 8},
    },
    build=build,
    reference=reference,
    band=band,
    bracket=None,
    path=path,
    variants=tuple(
        Variant(
            f"mu-{mu:g}",
            {"mu": mu, "law": "linear-1", "steps": 10, "scheme": "leapfrog"},
            meshes=("coarse",),
        )
        for mu in (0.0, 0.05, 0.1, 0.2)
    ),
)
