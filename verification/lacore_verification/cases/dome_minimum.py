r"""A hemisphere of stone under its own weight: how thin may it be?

              .-- oculus --.
          .-'  |        |  `-.
        .' \   |        |   / '.        R: middle of the thickness t
       /    `. |        | .'    \
      |-------`+--------+'-------|
      |   plain meridians        |      smallest t/R = 0.042
      +--+                    +--+
      ///                      ///

Heyman's dome: meridians from base to oculus do not carry hoop tension, so that each slice between
two of them is an arch that leans on its opposite. Below t/R = 0.042 no thrust stays inside, however
large the friction is. Cut into rings of blocks with chords for circles the limit is a little below,
[0.0417, 0.0419] of 8 rings, and hardly depends on the number of meridians. To have a load factor
the dome is shaken, too: one that is too thin is unsafe before, any other stands some of it.
"""

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant, rigid
from lacore_verification.cases.shared.solids import HYPERSTATIC, named, shaken

LEAST = 0.0417, 0.0419
_OCULUS = 0.05  # rad
ASSOCIATED = {0.0428: 0.1860382}  # by thickness: no Coulomb load is above it


def build(t: float, meridians: int, rings: int, mu: float) -> "la.Problem":
    """Return the problem: a dome of radius 1 m on a ring of fixed blocks."""
    dome = la.masonry3d.dome(meridians, rings, 1.0, t, _OCULUS, mu)
    return shaken(dome, named(dome, "base"))


def reference(t: float, meridians: int, rings: int, mu: float) -> Reference:
    """Return the reference: unsafe below, and some load above."""
    low, high = LEAST
    source = "Heyman 1967, 0.042; of 8 rings by bisection of associated programs"
    if t < low:
        return Reference(float("-inf"), "t/R < 0.042", source, "status", status=la.Status.UNSAFE)
    if t <= high:
        raise LookupError(f"t = {t} lies between what falls and what stands")
    most = ASSOCIATED[t]
    return Reference(0.0, "t/R > 0.042", source, "interval", up_to=most, associated=most)


def band(elements: int, t: float, meridians: int, rings: int, mu: float) -> Band:
    """Return the band: rigid; alpha is in weights."""
    return rigid(1.0)


def _variant(name: str, t: float, mu: float) -> Variant:
    return Variant(name, {"t": t, "meridians": 8, "rings": 8, "mu": mu}, unfit=HYPERSTATIC)


CASE = Case(
    id="dome-minimum",
    title="The thinnest hemispherical dome",
    tags=("blocks", "space", "contact", "Coulomb", "masonry", "status"),
    unit="W",
    explanation=__doc__,
    hand_calculation="""\
Two opposite slices of a dome are an arch
whose width grows from the crown outwards.
Its thinnest line of thrust, that of a wedge
of own weight, needs t/R = 0.042 (Heyman);
an arch of even width needs 0.107.
""",
    build=build,
    reference=reference,
    band=band,
    variants=(
        _variant("too-thin", 0.0415, 0.7),
        _variant("stands", 0.0428, 0.7),
    ),
)
