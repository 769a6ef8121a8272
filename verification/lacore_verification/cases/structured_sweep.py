r"""Eleven assemblies, each with friction 0.1, 0.2, ... 1.0: how far does a coupling loop get?

        incline      stack     three-blocks   arch-9, -15     wall-1 ... 3
              _        _         _______         _.-._          __.__.__
            .'_'.     |_|       |_______|      .' .-. '.       |__.__.__|
          .'.'  '     |_|        | | | |      / .'   '. \      |_.__.__.|
        .'.'          |_|        |_| |_|     /_/       \_\     |__.__.__|

        wedge, extraction: a wedge between two blocks.   frame: a portal with plastic hinges

Where no closed form is known, the certificate judges, which is computed afresh from velocity,
reactions and load factor. Where nothing holds, as arches with little friction, the status says so.
Run it by name, `lacore compare structured-sweep --backends clarabel --couplings certified,paper`:
its table says how many load factors each coupling certified, and in how many inner solves.
"""

import lacore as la
from lacore_verification.case import Band, Case, Reference, Variant
from lacore_verification.cases.shared.assemblies import ASSEMBLIES, FRICTIONS


def build(assembly: str, mu: float) -> "la.Problem":
    """Return the problem: one of the assemblies."""
    return ASSEMBLIES[assembly].build(mu)


def reference(assembly: str, mu: float) -> Reference:
    """Return the reference, if there is one."""
    return ASSEMBLIES[assembly].reference(mu)


def band(elements: int, assembly: str, mu: float) -> Band:
    """Return the band of the assembly."""
    return ASSEMBLIES[assembly].band(mu)


CASE = Case(
    id="structured-sweep",
    title="Eleven assemblies with friction from 0.1 to 1",
    tags=("blocks", "frames", "contact", "Coulomb", "couplings"),
    unit="of each assembly",
    explanation=__doc__,
    hand_calculation="""\
incline, stack, wedge, extraction, frame: as in the cases
block-incline-horizontal, stack-n, symmetric-wedge,
wedge-extraction and portal-sway; the others: none
""",
    build=build,
    reference=reference,
    band=band,
    variants=tuple(
        Variant(f"{assembly}-mu-{mu:g}", {"assembly": assembly, "mu": mu})
        for assembly in ASSEMBLIES
        for mu in FRICTIONS
    ),
    on_demand=True,
)
