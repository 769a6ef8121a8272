r"""A block is pressed flat between two smooth platens that move: rigid tools of given velocity.

           upper platen, moves down
        +------------------------------+
        |//////////////////////////////|
        +--+------------------+--------+
          o|                  |-->
    u_x=0 o|    half model    |   free side
          o|     1 x 1        |-->
        +--+------------------+--------+
        |//////////////////////////////|
        +------------------------------+
           lower platen, moves up, or is at rest

The platens are tools with plane faces, and move by their velocities alone. The force on each of
them is that of the case upsetting, where a quarter of the block is pushed against an obstacle at
rest; it depends on their relative motion only. The power that drives both is the force times the
speed at which they close.
"""

from math import log, sqrt

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant
from lacore_verification.case.following import Following, last_load
from lacore_verification.cases.shared.exact_paths import strip_force
from lacore_verification.cases.shared.hardening_laws import LAWS

WIDTH, HEIGHT, TRAVEL = 1.0, 1.0, 0.25
_CLOSING = 2.0  # m of height per m of travel
_MOTIONS = {"both": (-1.0, 1.0), "upper": (-2.0, 0.0)}  # of the upper and of the lower platen
_VOLUME = 1e-9  # of a step: exact backends leave up to 3e-10 of the strain of a step, a half
_ALLOWED = 1e-7  # a case of one body asks for 1e-8; tools add unknowns and tolerances


def build(nx: int, law: str, moving: str, steps: int, scheme: str) -> "la.Problem":
    """Return the problem: half of the block in triangles; yield stress 1 at the beginning."""
    half = HEIGHT / 2
    mesh = la.meshes.rectangle((0, WIDTH), (-half, half), nx, nx)
    return la.Problem(
        bodies={"block": la.Body(mesh, la.VonMises(hardening=LAWS[law]), space="p2-gauss")},
        supports=[la.Fix("block", "left", "x")],
        reference_loads=[
            la.RigidFooting("block", "top", (0, -1), rough=False),
            la.RigidFooting("block", "bottom", (0, 1), rough=False),
        ],
    )


def path(law: str, moving: str, steps: int, scheme: str) -> Following:
    """Return the path: the platens close by half of the height."""
    upper, lower = _MOTIONS[moving]
    half = HEIGHT / 2
    above, below = la.shapes.plane((0, half), (0, -1)), la.shapes.plane((0, -half), (0, 1))
    return Following(
        TRAVEL,
        steps,
        scheme,
        la.ToolTravel({"upper": (0, upper), "lower": (0, lower)}),
        exact=lambda travel: _force(law, travel),
        load="force",
        volume=_VOLUME,
        tools={
            "upper": la.Tool(above, ("block", "top"), (0, upper)),
            "lower": la.Tool(below, ("block", "bottom"), (0, lower)),
        },
    )


def _force(law: str, travel: float) -> float:
    """Return the power per travel: the force on a platen times the speed at which they close."""
    return _CLOSING * strip_force(LAWS[law], 1 - _CLOSING * travel / HEIGHT, WIDTH)


def reference(law: str, moving: str, steps: int, scheme: str) -> Reference:
    """Return the reference: exact without friction."""
    return Reference(
        _force(law, last_load(TRAVEL, steps, scheme)),
        "2 (2/sqrt3) sigma_Y((2/sqrt3) ln(H/h)) W H/h",
        "analytical: uniform compression in plane strain",
        "exact",
    )


def band(elements: int, law: str, moving: str, steps: int, scheme: str) -> Band:
    """Return the band: exact in space and time."""
    return Band(
        _ALLOWED, _ALLOWED, "Exact for any step (T30): the remaining error is that of the solver."
    )


_LEFT = 1 - _CLOSING * TRAVEL / HEIGHT

CASE = Case(
    id="upsetting-tools",
    title="Block of hardening material pressed flat by two tools that move",
    tags=("hardening", "continuum", "contact", "path", "closed form"),
    unit="power per travel / (initial width s0)",
    explanation=__doc__,
    hand_calculation=f"""\
force on a platen: F = (2/sqrt3) sigma_Y(eb) W H/h
                   eb = (2/sqrt3) ln(H/h)
power per travel:  F (v_lower - v_upper) = 2 F
h = {_LEFT:g} H:         eb = {-2 / sqrt(3) * log(_LEFT):.6f}
                   perfect: {_force("perfect", TRAVEL):.6f}
                   linear-3: {_force("linear-3", TRAVEL):.6f}
""",
    meshes={"coarse": {"nx": 2}, "medium": {"nx": 4}, "fine": {"nx": 8}},
    build=build,
    reference=reference,
    band=band,
    bracket=None,
    path=path,
    variants=tuple(
        Variant(
            f"{law}-{moving}",
            {"law": law, "moving": moving, "steps": 2, "scheme": "implicit-midpoint"},
            meshes=("coarse",),
            unfit={
                "regularised": "penalised contact lets tools 2e-5 to 4e-5 m into the block, and the"
                " load at the end of a step feels them per its length, an eighth of a metre"
            },
        )
        for law, moving in (("perfect", "both"), ("linear-3", "both"), ("linear-3", "upper"))
    ),
)
