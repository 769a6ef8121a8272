"""Numbers with units, as texts: ``18 kN/m3``, ``30 deg``."""

import re
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from math import degrees, isclose, isfinite
from typing import TYPE_CHECKING

from lacore.reporting.units import FORCES, LENGTHS, STRESSES, Units, fitting

if TYPE_CHECKING:
    import pint

DEGREES = "deg"
"""Unit of angles, which may be left out."""
_AMOUNT = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,3})?)\s*(\S.*?)?\s*")
_COMMA = re.compile(r"\s*[+-]?\d+,\d")
_ONE = r"([A-Za-zµμ_]+)(?:\^?(-?\d))?"  # kN, m3, m^3, s-1: higher powers do not occur
_TAKEN = re.compile(rf"{_ONE}(?:\s*[*/ ]\s*{_ONE})*")
_LONGEST = 40
_KINDS = {"m": "length", "Pa": "stress"}
_FORCE_OF = {
    **{"Pa": "N", "kPa": "kN", "MPa": "MN"},
    **{"psf": "lbf", "psi": "lbf", "ksf": "kip", "ksi": "kip"},
}
_PAIRS = (
    *(("N", "m"), ("kN", "m"), ("MN", "m")),
    *(("lbf", "ft"), ("lbf", "in"), ("kip", "ft"), ("kip", "in")),
)
_POWERS = {"N": 0, "N m": -1, "N/m": 1, "N/m^3": 3}  # power of the length that divides a force
_WRITTEN: Mapping[str, Sequence[tuple[str, float]]] = {
    "m": [*LENGTHS.items()],
    "Pa": [*STRESSES.items()],
    **{
        own: [(force, FORCES[force] / LENGTHS[per] ** power) for force, per in _PAIRS]
        for own, power in _POWERS.items()
    },
}
_OWN = (
    "psf = lbf / ft^2",
    "ksf = kip / ft^2",
    "pcf = lbf / ft^3",
    "plf = lbf / ft",
    "klf = kip / ft",
)
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
    "s": "'2 s'",
    DEGREES: "'30 deg' or '0.5 rad'",
}


class WrongUnitError(ValueError):
    """Text that is not an amount of the required kind.

    Attributes:
        reason, fix: see `lacore.reporting.errors.InputError`.
    """

    def __init__(self, why: str, fix: str) -> None:
        self.reason, self.fix = why, fix
        super().__init__(f"{why}; {fix}")


@dataclass(frozen=True)
class Amount:
    """Number of a file.

    Attributes:
        given: number or text in the file.
        value: value in the resulting unit.
        own: that unit, of SI; ``deg`` for angles, empty without a unit.
        size: size of the given unit in that unit; 1 without one.
    """

    given: object
    value: float
    own: str
    size: float = 1.0


def amount(text: str, accepted: tuple[str, ...]) -> Amount:
    """Return a text in the first unit that has its dimension.

    Args:
        text: a number and a unit.
        accepted: units of `pint`; ``deg`` alone for angles; empty for plain numbers.

    Raises:
        WrongUnitError: no number, no or an unknown unit, or one of another dimension.
    """
    fix = _fix(accepted)
    if accepted and _COMMA.match(text):
        raise WrongUnitError("a comma in a number", "write a point: 20.5")
    match = _AMOUNT.fullmatch(text)
    if match is None or not accepted:
        raise WrongUnitError("not a number" if accepted else "a text in place of a number", fix)
    number, unit = float(match[1]), match[2]
    if not isfinite(number):
        raise WrongUnitError("not a finite number", fix)
    if unit is None:
        raise WrongUnitError("a number in quotes, without its unit", fix)
    if accepted == (DEGREES,):
        if unit not in _ANGLES:
            raise WrongUnitError(f"{unit!r} is not a unit of angle", fix)
        return Amount(text, number * _ANGLES[unit], DEGREES, _ANGLES[unit])
    registry, given = _registry(), _parsed(unit, fix)
    for own in accepted:
        if given.dimensionality == registry.Unit(own).dimensionality:
            size = float(registry.Quantity(1.0, given).to(own).magnitude)
            return Amount(text, _rounded(number * size), own, size)
    named = " or ".join(accepted)
    raise WrongUnitError(f"{unit!r} does not fit: this is in {named}", fix)


def chosen(
    amounts: Iterable[Amount], sizes: Iterable[float], requested: Mapping[str, str]
) -> Units:
    """Return the units of results: the most frequent units of forces, lengths and stresses.

    Args:
        amounts: all numbers of the file. Lengths without a unit are in m, and 0 has none. If no
            force has a unit, that of stresses determines it, and vice versa.
        sizes: values in SI, which determine the unit of forces if the file has none at all.
        requested: a unit for ``force``, ``length``, ``stress`` that takes precedence.
    """
    found: dict[str, Counter[str]] = {kind: Counter() for kind in ("force", "length", "stress")}
    for one in amounts:
        kind = _KINDS.get(one.own, "force")
        if one.value and (kind == "length" or isinstance(one.given, str)):
            known = _WRITTEN.get(one.own, ())
            found[kind].update(name for name, size in known if isclose(size, one.size))
    most = {kind: max(own, key=own.__getitem__) for kind, own in found.items() if own} | dict(
        requested
    )
    stress = most.get("stress", "")
    force = most.get("force") or _FORCE_OF.get(stress) or fitting(sizes)
    units = Units(force, most.get("length", "m"), whole=True)
    return units if stress in ("", units.stress) else replace(units, own_stress=stress)


def _parsed(unit: str, fix: str) -> "pint.Unit":
    plain = unit.translate(_SIGNS).replace("**", "^")
    plain = re.sub(r"\b([kMG]?N)m\b", r"\1 m", plain)  # pint reads kNm as a length.
    if len(plain) > _LONGEST or _TAKEN.fullmatch(plain) is None:
        raise WrongUnitError(f"{unit!r} is not a unit", fix)
    try:
        return _registry().Unit(re.sub(_ONE, _raised, plain))
    except Exception as error:  # pint has no common exception
        raise WrongUnitError(f"{unit!r} is not a known unit", fix) from error


def _raised(match: re.Match[str]) -> str:
    return match[1] if match[2] is None else f"{match[1]}^{match[2]}"


def _fix(accepted: tuple[str, ...]) -> str:
    if not accepted:
        return "give a number without quotes"
    if accepted == (DEGREES,):
        return f"give a number in degrees, or with its unit {_EXAMPLES[DEGREES]}"
    named = " or ".join(accepted)
    return f"give a number in {named}, or with its unit as {_EXAMPLES[accepted[0]]}"


def _rounded(value: float) -> float:
    """Round off the last two digits: 20 kPa are 20000 Pa for any conversion factor."""
    return float(f"{value:.14g}")


@cache
def _registry() -> "pint.UnitRegistry[float]":
    # imported here because it takes half a second to load, and files without units do not need it
    import pint

    registry: pint.UnitRegistry[float] = pint.UnitRegistry(cache_folder=None)
    for definition in _OWN:
        registry.define(definition)
    return registry
