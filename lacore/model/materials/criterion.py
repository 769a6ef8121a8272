"""Protocol of yield criteria, all that lacore requires of a material."""

from typing import Protocol, runtime_checkable

from lacore.model.materials.conic_form import ConicForm
from lacore.model.materials.hardening import HardeningLaw


@runtime_checkable
class Criterion(Protocol):
    """Yield criterion. A user-defined criterion needs these members."""

    @property
    def strength(self) -> float:
        """Largest shear stress anywhere, Pa; the initial one with hardening."""
        ...

    @property
    def label(self) -> str:
        """Strengths as text, for pictures and tables: ``k = 1 Pa``."""
        ...

    @property
    def law(self) -> HardeningLaw | None:
        """Yield stress in tension over the equivalent plastic strain; None without hardening.

        Pressure-dependent criteria have none.
        """
        ...

    def conic_form(self, kinematics: str) -> ConicForm:
        """Return the cone of the dissipation (T1) for one of the `KINEMATICS` of conic forms."""
        ...
