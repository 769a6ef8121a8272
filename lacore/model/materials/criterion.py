"""The protocol of yield criteria: all that the rest of lacore asks of a material."""

from typing import Protocol, runtime_checkable

from lacore.model.materials.conic_form import ConicForm
from lacore.model.materials.hardening import HardeningLaw


@runtime_checkable
class Criterion(Protocol):
    """A yield criterion. One of your own has these; bodies, bounds and pictures ask for no more."""

    @property
    def strength(self) -> float:
        """Largest shear stress that it carries anywhere, initial where it hardens, Pa."""
        ...

    @property
    def label(self) -> str:
        """Its strengths as text, for pictures and tables: ``k = 1 Pa``."""
        ...

    @property
    def law(self) -> HardeningLaw | None:
        """Yield stress in tension over the equivalent plastic strain; None: it does not harden.

        One whose strength depends on pressure has none.
        """
        ...

    def conic_form(self, kinematics: str) -> ConicForm:
        """Cone of the dissipation (T1) in one of `lacore.model.materials.conic_form.KINEMATICS`."""
        ...
