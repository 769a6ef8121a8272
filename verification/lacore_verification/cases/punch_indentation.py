r"""A rigid punch is driven into a half space until the elements at its edge are distorted.

             alpha
             | | |
             v v v  punch, half width 1
         o-----------+
    u_x=0o            \ _ heave _______________+
         o                                     |
         o        hardening or perfect         |  u = 0
         o                                     |
         o-------------------------------------+
                          u = 0

The right half, as in the case prandtl-punch: the path begins at its load, between strict bounds.
Then the material piles up next to the punch, and is drawn around its edge. There one element after
the other folds: the step that would turn the first inside out is not taken, and the path ends by
its name, `inversion`, long before the requested travel. Smaller steps would not help, a new mesh
would. How deep a punch comes is a matter of the mesh, and no finding on the material.
"""

from dataclasses import replace
from math import nan

import lacore as la
from lacore.paths.ending import Ending
from lacore_verification.case import Band, Case, Reference, Variant
from lacore_verification.case.following import Following
from lacore_verification.cases import prandtl_punch
from lacore_verification.cases.shared.hardening_laws import LAWS

_TRAVEL = 1.0


def build(
    nx: int, ny: int, ratio_x: float, ratio_y: float, law: str, rough: bool, steps: int, scheme: str
) -> "la.Problem":
    """Return the problem: the half of the static case; yield stress 1 at the beginning."""
    static = prandtl_punch.build(nx, ny, ratio_x, ratio_y, rough)
    soil = static.bodies["soil"]
    assert isinstance(soil, la.Body)
    return replace(
        static, bodies={"soil": replace(soil, criterion=la.VonMises(hardening=LAWS[law]))}
    )


def path(law: str, rough: bool, steps: int, scheme: str) -> Following:
    """Return the path: to half of its width, a depth that the elements do not reach."""
    return Following(
        _TRAVEL, steps, scheme, la.FootingTravel(), ending=Ending.INVERSION, bounded=True
    )


def reference(law: str, rough: bool, steps: int, scheme: str) -> Reference:
    """Return no reference, as the elements determine where the path ends."""
    return Reference(
        nan,
        "not known; that with which the path begins lies between strict bounds",
        "bounds of (2 + pi) k on the same mesh; Prandtl 1920",
        "none",
        complete=False,
    )


def band(elements: int, law: str, rough: bool, steps: int, scheme: str) -> Band:
    """Return the band, which is not used."""
    return Band(0.0, 0.0, "The load at the end is not known.")


CASE = Case(
    id="punch-indentation",
    title="Punch driven into a half space until elements fold",
    tags=("hardening", "continuum", "singular point", "path"),
    unit="mean pressure under the punch / s0",
    explanation=__doc__,
    hand_calculation="""\
at the beginning: alpha = (2 + pi) k = 2.968300 s0, k = s0/sqrt3
from there on:    no closed form
""",
    meshes={
        "coarse": {"nx": 4, "ny": 2, "ratio_x": 12.0, "ratio_y": 4.0},
        "medium": {"nx": 8, "ny": 4, "ratio_x": 12.0, "ratio_y": 4.0},
        "fine": {"nx": 16, "ny": 8, "ratio_x": 12.0, "ratio_y": 4.0},
    },
    build=build,
    reference=reference,
    band=band,
    bracket=None,
    path=path,
    variants=tuple(
        Variant(
            f"{law}-{'rough' if rough else 'smooth'}",
            {"law": law, "rough": rough, "steps": 50, "scheme": "leapfrog"},
            meshes=("coarse",),
        )
        for law, rough in (("perfect", True), ("linear-1", True), ("linear-1", False))
    ),
)
