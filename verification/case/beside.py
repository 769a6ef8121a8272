"""What stands beside the load factors of a case: what others say, and a range of our own."""

from dataclasses import dataclass

RANGE = "range"
"""What stands for a coupling in runs that search for low and high load factors (T59)."""


@dataclass(frozen=True)
class Beside:
    """A load factor that others give, shown on the page of a case; nothing is judged by it.

    Attributes:
        name: what it is, such as ``Davis's strength``.
        value: in units of the case.
        source: where it comes from, and what it is worth.
        half_width: they say ``value +- half_width``.
    """

    name: str
    value: float
    source: str
    half_width: float = 0.0
