"""Contents of a drawing from any file, and names of its parts in messages."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from lacore.numerics.arrays import Floats
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact
from lacore.reporting.text import Quantity
from lacore.reporting.units import METRES


@dataclass(frozen=True, eq=False, repr=False)
class Stroke(Compact):
    """A line of a drawing, straight from vertex to vertex.

    Attributes:
        layer: its layer.
        handle: its handle in the drawing program.
        points: vertices, (k, 2); the first is not repeated if closed.
        closed: whether the last vertex is joined to the first.
    """

    layer: str
    handle: str
    points: Floats
    closed: bool

    @property
    def told(self) -> str:
        """``layer 'stone', handle 2F``."""
        return f"layer {self.layer!r}, handle {self.handle}"


@dataclass(frozen=True)
class Drawing:
    """Lines of a file.

    Attributes:
        strokes: strokes of the requested layers, in the units of the drawing.
        layers: all layers with contents, in any order.
        unit: unit of the file, one of `METRES`; None without one.
        skipped: numbers of other entities in those layers (texts, dimensions), by kind.
    """

    strokes: tuple[Stroke, ...]
    layers: tuple[str, ...]
    unit: str | None
    skipped: Mapping[str, int]


def refused(path: str, what: str, why: str, fix: str) -> InputError:
    """Return an error about a part of a drawing."""
    return InputError("path", path, f"{what}: {why}", fix)


def place_told(place: Floats | Sequence[float]) -> Quantity:
    """Return a place for messages, such as ``(1.25, 0.4) m``."""
    return Quantity(tuple(place), "m", ".6g")


def metres(path: str, said: str | None, unit: str | None) -> tuple[str, float]:
    """Return the unit of a drawing, and its length in m.

    Args:
        path: path of the file, for messages.
        said: unit of the file.
        unit: unit of the user, which takes precedence.

    Raises:
        InputError: an unknown unit, or none at all.
    """
    known = ", ".join(METRES)
    if unit is not None:
        if not isinstance(unit, str) or unit not in METRES:
            raise InputError("unit", unit, "no unit of drawings", f"give one of {known}")
        return unit, METRES[unit]
    if said is None:
        raise InputError("unit", None, f"{path!r} says no unit of length", f"give one of {known}")
    return said, METRES[said]
