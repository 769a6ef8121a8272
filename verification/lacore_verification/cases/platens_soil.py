r"""A block of soil twice as wide as high is pressed between two sticking platens.

           alpha                       alpha, moves down
        v  v  v  v  v                v  v  v  v  v  v  v
      +---------------+              +--------------------+
      |       :       |        u_x=0 o                    |  free
      | - - - : - - - |              o   quarter model    |
      |       :       |              +--------------------+
      +---------------+                o  o  o  o  o  o  u_y=0
        ^  ^  ^  ^  ^

The platens confine the soil, and a soil with friction is the stronger for it: at 30 degrees four
times as strong as without platens. If it dilates by all of its friction the load is enclosed by
strict bounds. With a smaller dilation angle it pushes less against the platens: with 20 degrees the
load is 2 % lower on the same mesh, and all searches give the same value; without dilation 10 to 20
% lower, and what is certified depends on where one starts.
"""

import lacore as la
from lacore_verification.case import Band, Beside, Case, Convergence, First, Reference, Variant
from lacore_verification.case.band import Bracketing
from lacore_verification.cases.shared.friction_inside import UNFIT

ANGLE = 30.0
_ASSOCIATED = (13.3497, 13.5874)
"""Proven by `lacore.bracket`, 2 600 and 2 000 triangles, 1.8 % wide."""
_DAVIS = {20.0: 12.4155, 0.0: 8.17611}
"""Strict lower bounds of the block with Davis's strength, by dilation angle."""
_ERROR = Convergence(2.97, 0.68, "32 to 512 elements: 29.3, 15.5, 10.5, 6.3, 4.4 % above 13.47")


def build(nx: int, ny: int, ratio: float, dilation: float) -> "la.Problem":
    """Return the problem: the quarter, graded towards the edge of the platen."""
    mesh = la.meshes.rectangle(
        x=(0, 1), y=(0, 0.5), nx=nx, ny=ny, grade_x=(1.0, ratio), grade_y=(0.5, ratio)
    )
    associated = dilation == ANGLE
    soil = la.MohrCoulomb(1.0, ANGLE, dilation_angle=None if associated else dilation)
    space = "p2-vertex" if associated else "p2-gauss"
    return la.Problem(
        bodies={"block": la.Body(mesh, soil, space=space)},
        supports=[la.Fix("block", "left", "x"), la.Fix("block", "bottom", "y")],
        reference_loads=[la.RigidFooting("block", "top", (0, -1))],
    )


def reference(dilation: float) -> Reference:
    """Return the reference.

    Between strict bounds; with less dilation from Davis's strength to them.
    """
    low, high = _ASSOCIATED
    if dilation == ANGLE:
        return Reference(
            (low + high) / 2,
            "strict bounds of the continuum",
            "`lacore.bracket`, independent of this mesh",
            "bracket",
            half_width=(high - low) / 2,
        )
    return Reference(
        _DAVIS[dilation],
        "from a lower bound with Davis's strength (T55) to an upper one of associated flow (T54)",
        "`lacore.bracket` of both; the upper end is proven, the lower one is what Davis held safe",
        "interval",
        up_to=high,
    )


def beside(dilation: float) -> tuple[Beside, ...]:
    """Return further values.

    What Davis's strength carries of the continuum, and associated flow.
    """
    low, high = _ASSOCIATED
    if dilation == ANGLE:
        return ()
    source = "strict lower bound of the continuum by `lacore.bracket`"
    proven = f"Davis 1968 (T55): {source}"
    return (
        Beside("Davis's strength, at least", _DAVIS[dilation], proven),
        Beside("associated flow, at least", low, source),
        Beside("associated flow, at most", high, "an upper bound of all load factors (T54)"),
    )


def band(elements: int, dilation: float) -> Band:
    """Return the band.

    Strict upper bound; of other flow never above the associated load of the mesh.
    """
    return _ERROR.strict(elements)


CASE = Case(
    id="platens-soil",
    title="Block of soil between sticking platens, w/h = 2",
    tags=("continuum", "soil", "not associated", "certified", "singular point", "bracket"),
    unit="F/(w c)",
    explanation=__doc__,
    hand_calculation="""\
from below:  without platens the stress is uniform
             alpha > 2 c cos(phi)/(1 - sin(phi)) = 3.464102 c
bracket:     13.3497 <= alpha <= 13.5874, associated
Davis:       psi = 20: c* = 0.981674 c, phi* = 29.543 degrees,
                       alpha* >= 12.4155
             psi =  0: c* = 0.866025 c, phi* = 26.565 degrees,
                       alpha* >= 8.1761
""",
    meshes={
        "coarse": {"nx": 4, "ny": 2, "ratio": 3.0},
        "medium": {"nx": 18, "ny": 8, "ratio": 6.0},
        "fine": {"nx": 49, "ny": 24, "ratio": 12.0},
    },
    build=build,
    reference=reference,
    band=band,
    beside=beside,
    surfaces=True,
    bracket=Bracketing(target_width=0.15),
    first=First(meshes=("medium",)),
    variants=(
        Variant("associated", {"dilation": ANGLE}, ("coarse",)),
        Variant("psi-20", {"dilation": 20.0}, ("coarse",), unfit=UNFIT),
        Variant("psi-0", {"dilation": 0.0}, ("coarse",), unfit=UNFIT),
    ),
)
