"""Scales of length, stress and velocity: in them quantities of a program are of order one (T20)."""

from dataclasses import dataclass

from lacore.showing import Compact


@dataclass(frozen=True, repr=False)
class Scales(Compact):
    """Units in which a program is written: SI value = scale * program value.

    Attributes:
        length: m.
        stress: Pa.
        velocity: m/s.
        thickness: m; 1 where everything is per unit thickness.
    """

    length: float = 1.0
    stress: float = 1.0
    velocity: float = 1.0
    thickness: float = 1.0

    @property
    def force(self) -> float:
        """Force, N; per unit thickness N/m."""
        return self.stress * self.length * self.thickness

    @property
    def load_factor(self) -> float:
        """Load factor: that of a power at ``F0.U = 1``."""
        return self.force * self.velocity


SI = Scales()
"""Nothing is scaled."""
