"""Options of coupling loops."""

from dataclasses import dataclass
from numbers import Integral

from lacore.coupling.constants import LOOSEST_TOLERANCE
from lacore.reporting.errors import (
    InputError,
    is_number,
    require_count,
    require_known,
    require_positive,
)
from lacore.reporting.showing import Compact

STARTS = ("associated", "zero")


@dataclass(frozen=True, repr=False)
class CouplingOptions(Compact):
    """Options of a coupling loop.

    Attributes:
        start: First reactions: ``associated`` (those of the associated problem) or ``zero`` (as in
            the original publication).
        damping: Share w of the new values in the next ones, 0 < w <= 1.
        anderson: Depth of Anderson acceleration, 0 for none.
        tolerance: Tolerance for the residuals of the certificate.
        max_iterations: Largest number of iterations of the loop, not counting the start.
        accepted: Larger tolerance that is accepted for soils with non-associated flow if
            `tolerance` is not reached soon, because their residuals may decrease slowly (T58). None
            accepts no larger tolerance.
    """

    start: str = "associated"
    damping: float = 0.7
    anderson: int = 10
    tolerance: float = 1e-6
    max_iterations: int = 100
    accepted: float | None = None

    def __post_init__(self) -> None:
        require_known("start", self.start, STARTS)
        if not (is_number(self.damping) and 0 < self.damping <= 1):
            raise InputError("damping", self.damping, "outside (0, 1]", "1 is no damping")
        if not (isinstance(self.anderson, Integral) and self.anderson >= 0):
            raise InputError(
                "anderson", self.anderson, "not a depth", "give a whole number, 0 for none"
            )
        require_positive("tolerance", self.tolerance)
        require_count("max_iterations", self.max_iterations)
        if self.tolerance > LOOSEST_TOLERANCE:
            raise InputError(
                "tolerance", self.tolerance, "proves nothing", f"give at most {LOOSEST_TOLERANCE:g}"
            )
