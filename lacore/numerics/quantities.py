"""Sizes told in one choice of units: Pa or kPa, N or kN, the same all over a page or a picture."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import floor, log10

PREFIXES = {"": 1.0, "k": 1e3, "M": 1e6}
_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?"
_AMOUNT = re.compile(
    rf"(?P<numbers>\({_NUMBER}, {_NUMBER}\)|{_NUMBER} to {_NUMBER}|(?<![\w.]){_NUMBER})"
    r" (?P<unit>Pa/m|Pa|N/m\^3|N/m per m|N/m|N m|N)(?![\w^/])"
)
_OF_FRAMES = {"N/m": "N", "N": "N m", "N/m per m": "N/m"}


@dataclass(frozen=True)
class Units:
    """A prefix of all units of force and stress.

    Attributes:
        prefix: one of `PREFIXES`; lengths stay in m.
        whole: whether forces of frames are those of a whole frame: N for N/m, N m for N.
    """

    prefix: str = ""
    whole: bool = False

    @property
    def size(self) -> float:
        """Of the unit, in that without a prefix."""
        return PREFIXES[self.prefix]

    def label(self, unit: str, framed: bool = False) -> str:
        """A unit such as ``Pa`` or ``N/m`` with the prefix.

        Args:
            unit: of SI, per unit thickness.
            framed: whether it is of a frame.
        """
        own = _OF_FRAMES.get(unit, unit) if framed and self.whole else unit
        return f"{self.prefix}{own}"

    def told(self, size: float, unit: str, framed: bool = False, digits: int = 4) -> str:
        """``20 kPa`` of 20000 Pa."""
        return f"{size / self.size:.{digits}g} {self.label(unit, framed)}"

    def rewritten(self, text: str, framed: bool = False) -> str:
        """A text of lacore in these units: ``(0, -100 kN)`` of ``(0, -100000) N``, up to 7 digits.

        Args:
            text: that says sizes in SI, as descriptions of loads and of strengths do.
            framed: whether they are of a frame.
        """

        def own(match: re.Match[str]) -> str:
            numbers = re.sub(_NUMBER, self._divided, match["numbers"])
            return f"{numbers} {self.label(match['unit'], framed)}"

        return _AMOUNT.sub(own, text)

    def _divided(self, match: re.Match[str]) -> str:
        return f"{float(match[0]) / self.size:.7g}"


def fitting(texts: Iterable[str]) -> str:
    """The prefix in which the sizes that texts say are mostly between 1 and 1000."""
    sizes = [size for text in texts for size in _sizes(text)]
    if not sizes:
        return ""
    middle = sum(map(log10, sizes)) / len(sizes)
    thousands = min(max(floor(middle / 3), 0), len(PREFIXES) - 1)
    return list(PREFIXES)[thousands]


def _sizes(text: str) -> Sequence[float]:
    found = [
        abs(float(number))
        for match in _AMOUNT.finditer(text)
        for number in re.findall(_NUMBER, match["numbers"])
    ]
    return [size for size in found if size > 0]
