"""A block twice as wide as high is pressed flat between two platens with Coulomb friction mu.

                         platen, at rest
                      ///////// mu /////////
                      +--------------------+-->
    u_x = 0 (symmetry)o   quarter model    |    free side:
                      o   1 x 0.5          |--> it folds onto
                      +--------------------+-->   the platen
                       ^  ^  ^  ^  ^  ^  ^
                       smooth footing, moves up: alpha

The quarter is seen by an observer on the platen. Without friction the block stays a rectangle: two
steps of the implicit midpoint with the Hencky increment are exact for any law. Friction holds it
back at the platen: it bulges, its side folds onto the platen, and the force rises the more the
flatter the block is. The whole path is not known then; the load with which it begins lies
between strict bounds. Loads are forces: what a testing machine reads.
"""

from math import inf, log, nan, sqrt

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant
from lacore_verification.case.following import Following, Reading, last_load
from lacore_verification.cases.shared.exact_paths import strip_force
from lacore_verification.cases.shared.hardening_laws import LAWS
from lacore_verification.cases.tension import spread

WIDTH, HEIGHT = 1.0, 0.5  # of the quarter
ROUGH = -1.0  # stands for platens that stick
_ROUND_OFF = 1e-8
_PLATEN = la.RigidObstacle((0, HEIGHT), (0, -1))
_TRAVEL, _ROUGH_TRAVEL = 0.25, 0.1


def build(nx: int, ny: int, mu: float, law: str, steps: int, scheme: str) -> "la.Problem":
    """Return the problem.

    The quarter, graded towards the edge of the platen; yield stress 1 at the beginning.
    """
    mesh = la.meshes.rectangle(
        (0, WIDTH), (0, HEIGHT), nx, ny, grade_x=(WIDTH, 3.0), grade_y=(HEIGHT, 3.0)
    )
    return la.Problem(
        bodies={"block": la.Body(mesh, la.VonMises(hardening=LAWS[law]), space="p2-gauss")},
        supports=[la.Fix("block", "left", "x")],
        interfaces=[la.Interface(("block", "top"), _PLATEN, _friction(mu))],
        reference_loads=[la.RigidFooting("block", "bottom", (0, 1), rough=False)],
    )


def path(mu: float, law: str, steps: int, scheme: str) -> Following:
    """Return the path: to half of the height; where platens stick to four fifths."""
    smooth = mu == 0
    return Following(
        _travel(mu),
        steps,
        scheme,
        la.FootingTravel(),
        exact=(lambda travel: _force(law, travel)) if smooth else None,
        load="force",
        approaching=[la.Interface(("block", "right"), _PLATEN, _friction(mu))],
        volume=1e-10 if smooth else inf,
        reading=Reading("spread of strains, of their mean,", spread, 0.0, _spread(mu, law)),
        bounded=True,
    )


def _spread(mu: float, law: str) -> float:
    """Return the spread that is required: only hardening keeps the strain uniform."""
    return 1e-4 if mu == 0 and law != "perfect" else inf


def _travel(mu: float) -> float:
    return _ROUGH_TRAVEL if mu < 0 else _TRAVEL


def _friction(mu: float) -> "float | la.Tresca":
    return la.STICK if mu < 0 else mu


def _force(law: str, travel: float) -> float:
    """Return the force without friction."""
    return strip_force(LAWS[law], 1 - travel / HEIGHT, WIDTH)


def reference(mu: float, law: str, steps: int, scheme: str) -> Reference:
    """Return the reference: exact without friction."""
    if mu == 0:
        return Reference(
            _force(law, last_load(_TRAVEL, steps, scheme)),
            "(2/sqrt3) sigma_Y((2/sqrt3) ln(H/h)) W H/h",
            "analytical: uniform compression in plane strain",
            "exact",
        )
    return Reference(
        nan,
        "not known; that with which the path begins lies between strict bounds",
        "lower bound without friction, upper bound with associated friction",
        "none",
        complete=False,
    )


def band(elements: int, mu: float, law: str, steps: int, scheme: str) -> Band:
    """Return the band: exact without friction; not used with friction."""
    if mu == 0:
        return Band(
            _ROUND_OFF,
            _ROUND_OFF,
            "Exact for any step (T30): the remaining error is that of the solver.",
        )
    return Band(0.0, 0.0, "The load at the end is not known.")


_HALVED = {law: strip_force(LAWS[law], 0.5, WIDTH) for law in ("perfect", "linear-3")}

CASE = Case(
    id="upsetting",
    title="Block of hardening material pressed flat, w/h = 2",
    tags=("hardening", "continuum", "contact", "Coulomb", "path", "closed form"),
    unit="force / (initial width s0)",
    explanation=__doc__,
    hand_calculation=f"""\
no friction: eb = (2/sqrt3) ln(H/h)     (plane strain)
             F = (2/sqrt3) sigma_Y(eb) W H/h
h = H/2:     eb = {2 / sqrt(3) * log(2):.6f}
             perfect: {_HALVED["perfect"]:.6f}, linear-3: {_HALVED["linear-3"]:.6f}
friction at the beginning: 2 k < alpha < 2.43 k, k = s0/sqrt3:
             see the case platens-coulomb
""",
    meshes={
        "coarse": {"nx": 4, "ny": 2},
        "medium": {"nx": 8, "ny": 4},
        "fine": {"nx": 16, "ny": 8},
    },
    build=build,
    reference=reference,
    band=band,
    bracket=None,
    path=path,
    variants=(
        *(
            Variant(
                f"smooth-{law}",
                {"mu": 0.0, "law": law, "steps": 2, "scheme": "implicit-midpoint"},
                meshes=("coarse",),
                unfit={"regularised": "velocities of penalised programs are not exact to 1e-8"},
            )
            for law in ("perfect", "linear-3", "voce")
        ),
        *(
            Variant(
                f"mu-{mu:g}",
                {"mu": mu, "law": "linear-1", "steps": 10, "scheme": "leapfrog"},
                meshes=("coarse",),
            )
            for mu in (0.05, 0.1, 0.2)
        ),
        Variant(
            "rough",
            {"mu": ROUGH, "law": "linear-1", "steps": 10, "scheme": "leapfrog"},
            meshes=("coarse",),
        ),
    ),
)
