"""Brackets of cases: what a case says of its own, and what a proven one must be."""

from dataclasses import dataclass

BRACKET = "bracket"
"""What stands for a coupling in runs that put a case between two proven load factors."""

PROVEN = 1e-9
"""Relative: what round-off leaves of a proven load factor, with two digits in hand.

Residuals are at 1e-12 of all loads, and round-off in elements is some ten times that in sums.
"""


@dataclass(frozen=True)
class Bracketing:
    """How a case is put between a proven lower and a proven upper load factor.

    Attributes:
        target_width: of ``(upper - lower)/mean``, to be reached.
        max_elements: of each mesh.
        mesh: level to start from; empty for the first one.
        below, above: how far straight edges instead of curved ones may move the load factor
            from the reference, relative; both 0 with exact geometry.
        reason: where these come from; must be given where one is not 0.
    """

    target_width: float = 0.01
    max_elements: int = 6000
    mesh: str = ""
    below: float = 0.0
    above: float = 0.0
    reason: str = ""

    @property
    def straightened(self) -> bool:
        """Whether it is said what straight edges do."""
        return self.below > 0 or self.above > 0
