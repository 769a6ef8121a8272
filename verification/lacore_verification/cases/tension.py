"""A bar is drawn out to one and a half times its length, in plane strain, without friction.

       u_y free
    o--------------------------+
    o  quarter of the bar      |--> alpha  rigid, smooth
    o                          |
    o--o--o--o--o--o--o--o--o--o   2 x 0.5 at the beginning
    u_x = 0, u_y = 0 below

As it is now a bar has infinitely many mechanisms: any pattern of slip lines carries the same load.
Hardening takes the uniform one, if a step knows of it: the quadratic term of (T29). Explicit steps
do not, and draw the bar out in one place and then in another.
"""

from math import inf, nan, sqrt

import numpy as np

import lacore as la
from lacore.paths.ending import Ending
from lacore_verification.case import SOLVER, Band, Case, Reference, Variant
from lacore_verification.case.following import Following, Reading, last_load
from lacore_verification.cases.shared.exact_paths import strip_force
from lacore_verification.cases.shared.hardening_laws import LAWS

LENGTH, HEIGHT, TRAVEL = 2.0, 0.5, 1.0
_UNIFORM = 1e-4
_STEPS = 0.185  # relative error of leapfrog forces times the square of their number
_ROUND_OFF = 1e-8


def build(nx: int, ny: int, law: str, steps: int, scheme: str) -> "la.Problem":
    """Return the problem: a quarter of the bar in triangles; yield stress 1 at the beginning."""
    mesh = la.meshes.rectangle((0, LENGTH), (0, HEIGHT), nx, ny, crossed=False)
    return la.Problem(
        bodies={"bar": la.Body(mesh, la.VonMises(hardening=LAWS[law]), space="p2-gauss")},
        supports=[la.Fix("bar", "left", "x"), la.Fix("bar", "bottom", "y")],
        reference_loads=[la.RigidFooting("bar", "right", (1, 0), rough=False)],
    )


def path(law: str, steps: int, scheme: str) -> Following:
    """Return the path.

    The end moves by half of the length; explicit steps must not stay uniform.
    """
    seen = scheme != "explicit"
    return Following(
        TRAVEL,
        steps,
        scheme,
        la.FootingTravel(),
        exact=(lambda travel: strip_force(LAWS[law], 1 + travel / LENGTH, HEIGHT))
        if seen
        else None,
        load="force",
        ending=Ending.REACHED if seen else None,
        volume=1e-10 if scheme == "implicit-midpoint" else inf,
        reading=Reading(
            "spread of strains, of their mean,",
            spread,
            low=0.0 if seen else 0.01,
            high=_UNIFORM if seen else inf,
        ),
    )


def spread(path: "la.Path") -> float:
    """Return the largest less smallest equivalent strain at the end, per mean."""
    strains = path.snapshots[-1].configuration.strain.values()
    values = np.concatenate([each.ravel() for each in strains])
    return float(np.ptp(values) / values.mean())


def reference(law: str, steps: int, scheme: str) -> Reference:
    """Return the reference: uniform tension at the last load."""
    if scheme == "explicit":
        return Reference(
            nan, "whatever mechanisms the solver finds", "none of them is the right one", "none"
        )
    length = 1 + last_load(TRAVEL, steps, scheme) / LENGTH
    return Reference(
        strip_force(LAWS[law], length, HEIGHT),
        "(2/sqrt3) sigma_Y((2/sqrt3) ln(l/L)) H L/l",
        "analytical: uniform stretching in plane strain",
        "exact",
    )


def band(elements: int, law: str, steps: int, scheme: str) -> Band:
    """Return the band: of the steps; uniform stretching lies in the space of every mesh."""
    if scheme == "implicit-midpoint":
        return Band(
            _ROUND_OFF,
            _ROUND_OFF,
            "Exact for any step (T30): the remaining error is that of the solver.",
        )
    allowed = 1.3 * _STEPS / steps**2 + SOLVER
    return Band(
        allowed,
        allowed,
        f"Exact on every mesh. Largest error of all laws, 5 to 40 leapfrog steps: {_STEPS:g}"
        " steps^-2; allowed 1.3 times that, and the solver's.",
    )


CASE = Case(
    id="tension",
    title="Bar of hardening material in tension, plane strain",
    tags=("hardening", "continuum", "path", "closed form"),
    unit="force on half of the section / (1 m s0)",
    explanation=__doc__,
    hand_calculation=f"""\
strain:   eb = (2/sqrt3) ln(l/L)        (plane strain)
force:    F = (2/sqrt3) sigma_Y(eb) H L/l, H = 0.5
l/L=1.5:  eb = {2 / sqrt(3) * np.log(1.5):.6f}
          linear-1: F = {(1 + 2 / sqrt(3) * np.log(1.5)) / sqrt(3) / 1.5:.6f}
""",
    meshes={
        "coarse": {"nx": 6, "ny": 2},
        "medium": {"nx": 12, "ny": 4},
        "fine": {"nx": 24, "ny": 8},
    },
    build=build,
    reference=reference,
    band=band,
    bracket=None,
    path=path,
    variants=(
        *(
            Variant(law, {"law": law, "steps": 10, "scheme": "leapfrog"}, meshes=("coarse",))
            for law in ("linear-1", "linear-3", "voce")
        ),
        Variant(
            "voce-implicit-midpoint",
            {"law": "voce", "steps": 2, "scheme": "implicit-midpoint"},
            meshes=("coarse",),
            unfit={"regularised": "velocities of penalised programs are not exact to 1e-8"},
        ),
        Variant(
            "linear-1-explicit",
            {"law": "linear-1", "steps": 10, "scheme": "explicit"},
            meshes=("coarse",),
            unfit={"regularised": "viscosity makes the flow uniform, as hardening does"},
        ),
    ),
)
