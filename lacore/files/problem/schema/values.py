"""Numbers of a problem file: with their units, finite, and never plain texts."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite, isinf, pi
from typing import Annotated, Any, Literal

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from lacore.files.problem.units import DEGREES, Amount, WrongUnitError, amount
from lacore.reporting.errors import is_number

FORCES = "forces"
"""Key of a validation context: the unit of forces on each body with special units."""
AMOUNTS = "amounts"
"""Key of that context: the list of all `Amount` that are read."""
_MOST = 1_000_000


def refused(why: str, fix: str, *more: str) -> PydanticCustomError:
    """Return an error of a value: what is wrong, the fix, and the part it concerns."""
    # The texts are arguments, because braces in a message would be placeholders.
    return PydanticCustomError("refused", "refused", {"why": why, "fix": fix, "more": more})


class _Read(ABC):
    """Number that pydantic reads by `read`."""

    @abstractmethod
    def read(self, given: object, info: ValidationInfo) -> float:
        """Return the number."""

    def __get_pydantic_core_schema__(
        self, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Return the schema for pydantic, which calls `read`."""
        return core_schema.with_info_plain_validator_function(self.read)


@dataclass(frozen=True)
class Measure(_Read):
    """Number in a unit; a text has its own unit, and is converted.

    Attributes:
        unit: unit of plain numbers; empty without a unit.
        whole: unit for bodies that are not per thickness: frames.
        endless: whether it may be infinite.
        radians: for angles in degrees, the largest value in radians: no plain number is smaller.
    """

    unit: str = ""
    whole: str = ""
    endless: bool = False
    radians: float = 0.0

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Return its JSON schema."""
        if not self.unit:
            return {"type": "number"}
        said = f"in {self.unit}, or a text with its unit"
        return {"anyOf": [{"type": "number"}, {"type": "string"}], "description": said}

    def read(self, given: object, info: ValidationInfo) -> float:
        """Return the number in the unit of the field."""
        found = self._amount(given, self._accepted(info))
        if info.context is not None:
            info.context[AMOUNTS].append(found)
        return found.value

    def _amount(self, given: object, accepted: tuple[str, ...]) -> Amount:
        if isinstance(given, str):
            try:
                return amount(given, accepted)
            except WrongUnitError as error:
                raise refused(error.reason, error.fix) from error
        own = accepted[0] if accepted else ""
        if self.endless and isinstance(given, float) and isinf(given):
            return Amount(given, given, own)
        if not is_number(given):
            least = isinstance(given, float) and not isfinite(given)
            unit = f" in {' or '.join(accepted)}" if accepted else ""
            raise refused("not finite" if least else "not a number", f"give a finite number{unit}")
        if isinstance(given, float) and 0 < given <= self.radians:
            said = f"'{given:g} rad', or '{given:g} deg' if that is meant"
            raise refused("this looks like radians, but angles are in degrees", f"give {said}")
        return Amount(given, float(given), own)  # type: ignore[arg-type]  # a real number

    def _accepted(self, info: ValidationInfo) -> tuple[str, ...]:
        if self.whole:
            context: Mapping[str, Any] = info.context or {}
            body = (info.data or {}).get("body")
            if isinstance(body, str) and body in context.get(FORCES, ()):
                return tuple(dict.fromkeys((self.whole, self.unit)))
        return (self.unit,) if self.unit else ()


@dataclass(frozen=True)
class Whole(_Read):
    """Whole number from `least` on."""

    least: int = 1
    most: int = _MOST

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        """Return its JSON schema."""
        return {"type": "integer", "minimum": self.least, "maximum": self.most}

    def read(self, given: object, info: ValidationInfo) -> int:
        """Return the number."""
        if isinstance(given, bool) or not isinstance(given, int):
            raise refused("not a whole number", f"give a whole number from {self.least} on")
        if not self.least <= given <= self.most:
            raise refused("out of range", f"give a whole number from {self.least} to {self.most}")
        return given


Number = Annotated[float, Measure()]
Length = Annotated[float, Measure("m")]
End = Annotated[float, Measure("m", endless=True)]
Angle = Annotated[float, Measure(DEGREES)]
Steep = Annotated[float, Measure(DEGREES, radians=pi / 2)]
"""Friction angle: a value of 1.5 degrees is rejected as radians."""
Turn = Annotated[float, Measure(DEGREES, radians=2 * pi)]
"""Angle of an arch."""
MassDensity = Annotated[float, Measure("kg/m^3")]
Stress = Annotated[float, Measure("Pa")]
UnitWeight = Annotated[float, Measure("N/m^3")]
Force = Annotated[float, Measure("N/m", whole="N")]
LineLoad = Annotated[float, Measure("Pa", whole="N/m")]
Slope = Annotated[float, Measure("Pa/m")]
AngleSlope = Annotated[float, Measure("deg/m")]
WeightSlope = Annotated[float, Measure("N/m^4")]
Axial = Annotated[float, Measure("N")]
Strut = Annotated[float, Measure("N", endless=True)]
Moment = Annotated[float, Measure("N m")]
Count = Annotated[int, Whole()]
Point = tuple[Length, Length]
FileUnit = Literal["m", "dm", "cm", "mm", "km", "in", "ft", "yd"]
Interval = tuple[Length, Length]
