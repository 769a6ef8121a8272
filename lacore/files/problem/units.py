"""Numbers with units, as texts: ``18 kN/m3``, ``30 deg``."""

import re
from collections import Counter
from collections.abc import Iterator
from functools import cache
from math import degrees, isfinite
from typing import TYPE_CHECKING

from lacore.numerics.quantities import PREFIXES

if TYPE_CHECKING:
    import pint

DEGREES = "deg"
"""Of angles, with or without a unit."""
_AMOUNT = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?)\s*(\S.*?)?\s*")
_ONE = r"([A-Za-zµμ_]+)(?:\^?(-?\d))?"  # kN, m3, m^3, s-1: what is raised further has no end
_TAKEN = re.compile(rf"{_ONE}(?:\s*[*/ ]\s*{_ONE})*")
_LONGEST = 40
_FORCES = ("Pa", "N/m^3", "N/m", "N", "N m")
_SIGNS = str.maketrans({"²": "^2", "³": "^3", "·": "*"})
_ANGLES = {
    **dict.fromkeys(("deg", "degree", "degrees", "°"), 1.0),
    **dict.fromkeys(("rad", "radian", "radians"), degrees(1.0)),
}
_EXAMPLES = {
    "m": "'2.5 m' or '40 cm'",
    "Pa": "'20 kPa' or '1.5 MPa'",
    "N/m^3": "'18 kN/m3'",
    "N/m^4": "'2 kN/m4'",
    "N/m": "'50 kN/m'",
    "kg/m^3": "'2400 kg/m3' or '2.4 t/m3'",
    "Pa/m": "'2 kPa/m'",
    "deg/m": "'2 deg/m'",
    "N": "'50 kN'",
    "N m": "'120 kN m'",
    DEGREES: "'30 deg' or '0.5 rad'",
}


class WrongUnitError(ValueError):
    """A text that is no amount of what is asked for.

    Attributes:
        why, mend: as of `lacore.errors.InputError`.
    """

    def __init__(self, why: str, mend: str) -> None:
        self.why, self.mend = why, mend
        super().__init__(f"{why}; {mend}")


def in_units(text: str, accepted: tuple[str, ...]) -> float:
    """The number that a text is in the first unit that has its dimension.

    Args:
        text: a number and a unit; without unit a number in the first one.
        accepted: units, as of `pint`; ``deg`` alone for angles; none where only numbers are taken.

    Raises:
        WrongUnitError: no number, an unknown unit, one of another dimension.
    """
    mend = _mend(accepted)
    match = _AMOUNT.fullmatch(text)
    if match is None or not accepted:
        raise WrongUnitError("not a number" if accepted else "a text in place of a number", mend)
    number, unit = float(match[1]), match[2]
    if not isfinite(number):
        raise WrongUnitError("no finite number", mend)
    if unit is None:
        raise WrongUnitError("a number in quotes, without its unit", mend)
    if accepted == (DEGREES,):
        if unit not in _ANGLES:
            raise WrongUnitError(f"{unit!r} is no unit of angles", mend)
        return number * _ANGLES[unit]
    registry, given = _registry(), _parsed(unit, mend)
    for own in accepted:
        if given.dimensionality == registry.Unit(own).dimensionality:
            return _rounded(number * float(registry.Quantity(1.0, given).to(own).magnitude))
    named = " or ".join(accepted)
    raise WrongUnitError(f"{unit!r} does not fit: this is in {named}", mend)


def stated_prefix(data: object) -> str | None:
    """The prefix that most forces and stresses of a file are given with; None: none has a unit.

    Args:
        data: tables of a file, as they are read.
    """
    found = Counter(own for text in _texts(data) for own in _prefix(text))
    return max(found, key=found.__getitem__, default=None)


def _texts(data: object) -> Iterator[str]:
    if isinstance(data, str):
        yield data
    elif isinstance(data, dict | list):
        for own in data.values() if isinstance(data, dict) else data:
            yield from _texts(own)


def _prefix(text: str) -> Iterator[str]:
    """Of a force, a stress or a moment; ``N/mm2`` is as good as MPa."""
    match = _AMOUNT.fullmatch(text)
    if match is None or not match[2]:
        return
    try:
        given = _parsed(match[2], "")
    except WrongUnitError:
        return
    registry = _registry()
    for own in _FORCES:
        if given.dimensionality == registry.Unit(own).dimensionality:
            size = _rounded(float(registry.Quantity(1.0, given).to(own).magnitude))
            yield from (prefix for prefix, one in PREFIXES.items() if one == size)


def _parsed(unit: str, mend: str) -> "pint.Unit":
    plain = unit.translate(_SIGNS).replace("**", "^")
    plain = re.sub(r"\b([kMG]?N)m\b", r"\1 m", plain)  # to pint kNm is a length
    if len(plain) > _LONGEST or _TAKEN.fullmatch(plain) is None:
        raise WrongUnitError(f"{unit!r} is no unit", mend)
    try:
        return _registry().Unit(re.sub(_ONE, _raised, plain))
    except Exception as error:  # pint has no common one
        raise WrongUnitError(f"{unit!r} is no unit that is known", mend) from error


def _raised(match: re.Match[str]) -> str:
    return match[1] if match[2] is None else f"{match[1]}^{match[2]}"


def _mend(accepted: tuple[str, ...]) -> str:
    if not accepted:
        return "give a number without quotes"
    if accepted == (DEGREES,):
        return f"give a number in degrees, or with its unit {_EXAMPLES[DEGREES]}"
    named = " or ".join(accepted)
    return f"give a number in {named}, or with its unit as {_EXAMPLES[accepted[0]]}"


def _rounded(value: float) -> float:
    """Without the last two digits: 20 kPa are 20000 Pa, whatever the factor was."""
    return float(f"{value:.14g}")


@cache
def _registry() -> "pint.UnitRegistry[float]":
    import pint  # here: it takes half a second to load, and files without units have no use for it

    return pint.UnitRegistry(cache_folder=None)
