"""The protocol of criteria whose strength can be divided: what a factor of safety asks for."""

from typing import Protocol, runtime_checkable

from lacore.materials.criterion import Criterion


@runtime_checkable
class Weakening(Protocol):
    """A criterion that has a weaker one beside it."""

    @property
    def strength(self) -> float:
        """Shear stress that it carries without pressure, Pa."""
        ...

    @property
    def label(self) -> str:
        """What it is worth."""
        ...

    def weakened(self, factor: float) -> Criterion:
        """With cohesion, ``tan(phi)``, strengths and cut-offs divided by a factor > 0."""
        ...
