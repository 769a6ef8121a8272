"""Verification cases: a problem, its reference, and the allowed error of results.

Files of cases import all names from here.
"""

from lacore_verification.case.band import (
    BRACKET,
    EXACT,
    SOLVER,
    Band,
    Bracketing,
    Convergence,
    Order,
    exact_patch,
    rigid,
)
from lacore_verification.case.case import (
    BLOCKS,
    CLAMPED,
    CLOSE,
    JAM,
    KINDS,
    RANGE,
    Beside,
    Case,
    First,
    Variant,
    is_of_lacore,
)
from lacore_verification.case.following import Following
from lacore_verification.case.reference import UNKNOWN, UNKNOWN_KINDS, Reference

__all__ = [
    "BLOCKS",
    "BRACKET",
    "CLAMPED",
    "CLOSE",
    "EXACT",
    "JAM",
    "KINDS",
    "RANGE",
    "SOLVER",
    "UNKNOWN",
    "UNKNOWN_KINDS",
    "Band",
    "Beside",
    "Bracketing",
    "Case",
    "Convergence",
    "First",
    "Following",
    "Order",
    "Reference",
    "Variant",
    "exact_patch",
    "is_of_lacore",
    "rigid",
]
