r"""A block of soil between smooth platens, pressed or pulled from above, a pressure on its sides.

                   alpha
                 | | | | |
                 v v v v v
               +-----------+
         q --> |           | <-- q      (cohesion c = 1, friction angle phi)
         q --> |           | <-- q
               +-----------+
               o  o  o  o  o   u_y = 0

Its stress is the same everywhere, so every mesh has the exact load, and what differs is the solver
alone. Pressed, the sides help by the ratio of Rankine's passive pressure; pulled, they hinder. Cut
off, the largest principal stress is 0.3 before anything shears; crushed, the least is -2. In a
plate, no stress across it, the sides cannot help.
"""

from math import cos, radians, sin

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant

C, CUT_OFF, CRUSHING = 1.0, 0.3, 2.0
_PRECISE = 1e-7  # relative: exact backends solve to 1e-8 and better


def build(nx: int, ny: int, angle: float, lateral: float, state: str) -> "la.Problem":
    """Return the problem.

    The block; `state` is ``pressed``, ``pulled``, ``cut off``, ``crushed`` or ``plate``.
    """
    soil = la.MohrCoulomb(
        C,
        angle,
        tension_cutoff=CUT_OFF if state == "cut off" else None,
        crushing=CRUSHING if state == "crushed" else None,
    )
    kinematics = "plane_stress" if state == "plate" else "plane_strain"
    mesh = la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=nx, ny=ny)
    return la.Problem(
        bodies={"block": la.Body(mesh, soil, kinematics=kinematics)},
        supports=[la.Fix("block", "bottom", "y")],
        reference_loads=[la.Traction("block", "top", (0, 1 if _pulled(state) else -1))],
        dead_loads=[la.Pressure("block", side, lateral) for side in ("left", "right") if lateral],
    )


def _pulled(state: str) -> bool:
    return state in ("pulled", "cut off")


def reference(angle: float, lateral: float, state: str) -> Reference:
    """Return the reference: the first of shear, tension and crushing."""
    phi = radians(angle)
    cohesive = 2 * C * cos(phi)
    ratio = (1 + sin(phi)) / (1 - sin(phi))
    if _pulled(state):
        shear = cohesive / (1 + sin(phi)) - lateral / ratio
        value = min(shear, CUT_OFF) if state == "cut off" else shear
        text = "2 c cos(phi)/(1 + sin(phi)) - q (1 - sin(phi))/(1 + sin(phi)), T if that is less"
    else:
        shear = cohesive / (1 - sin(phi)) + (0.0 if state == "plate" else lateral * ratio)
        value = min(shear, CRUSHING) if state == "crushed" else shear
        text = "2 c cos(phi)/(1 - sin(phi)) + q (1 + sin(phi))/(1 - sin(phi)), f_c if that is less"
    return Reference(value, text, "uniform stress and Mohr's circle, analytically", "exact")


def valid(angle: float, lateral: float, state: str) -> bool:
    """Return whether the parameters are valid.

    The sides alone break nothing, and in a plate they carry less than its top.
    """
    phi = radians(angle)
    most = 2 * C * cos(phi) / (1 - sin(phi))
    return 0 <= lateral < (min(most, CRUSHING) if state == "crushed" else most)


def band(elements: int, angle: float, lateral: float, state: str) -> Band:
    """Return the band: the solver alone."""
    return Band(
        below=_PRECISE,
        above=_PRECISE,
        reason="Exact on every mesh: strains are the same everywhere. The remaining error is that"
        f" of the solver, which is required to reach 1e-8 or better: {_PRECISE:g}.",
    )


CASE = Case(
    id="biaxial",
    title="Block of soil under biaxial stress",
    tags=("continuum", "soil", "patch test", "closed form"),
    unit="pressure / c",
    explanation=__doc__,
    hand_calculation="""\
Mohr's circle:  (s1 - s3)/2 = c cos(phi) - (s1 + s3)/2 sin(phi)
pressed:        s1 = -q, s3 = -alpha
                alpha = (2 c cos(phi) + q (1 + sin(phi)))/(1 - sin(phi))
pulled:         s1 = alpha, s3 = -q
                alpha = (2 c cos(phi) - q (1 - sin(phi)))/(1 + sin(phi))
phi = 30:       q = c/2: 4.964102 c,  pulled at q = 0: 1.154701 c
plate:          s1 = 0 across it: q drops out, 3.464102 c
""",
    meshes={
        "coarse": {"nx": 2, "ny": 2},
        "medium": {"nx": 12, "ny": 12},
        "fine": {"nx": 34, "ny": 34},
    },
    build=build,
    reference=reference,
    band=band,
    valid=valid,
    sweep="angle",
    surfaces=True,
    bracket=None,
    variants=(
        Variant("phi-30", {"angle": 30.0, "lateral": 0.5, "state": "pressed"}, ("coarse",)),
        Variant("phi-1", {"angle": 1.0, "lateral": 0.5, "state": "pressed"}, ("coarse",)),
        Variant("phi-0", {"angle": 0.0, "lateral": 0.5, "state": "pressed"}, ("coarse",)),
        Variant("tension", {"angle": 30.0, "lateral": 0.0, "state": "pulled"}, ("coarse",)),
        Variant("cut-off", {"angle": 30.0, "lateral": 0.0, "state": "cut off"}, ("coarse",)),
        Variant("crushing", {"angle": 30.0, "lateral": 0.0, "state": "crushed"}, ("coarse",)),
        Variant("plate", {"angle": 30.0, "lateral": 0.5, "state": "plate"}, ("coarse",)),
    ),
)
