"""Printing of objects: a few short lines, never an array; with a picture in notebooks."""

from abc import ABC, abstractmethod
from base64 import b64encode
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields
from decimal import ROUND_FLOOR, Context
from html import escape
from io import BytesIO
from reprlib import Repr
from typing import TYPE_CHECKING, Any

from lacore.reporting.text import Quantity, Text, join, text

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_WIDTH = 98  # characters of a line: six of them stay below 600
_LONGEST = 1000  # characters of a fact in a notebook, which wraps them
_VALUE, _WHOLE = 72, 480  # characters of one value of an object, and of all of them
_DPI = 110.0
# The colours are those of the page, light or dark; pictures have a white background.
_BOX = "margin:.3em 0;line-height:1.4"
_NAME = (
    "text-align:left;vertical-align:top;font-weight:normal;opacity:.65;padding:0 1em 0 0;"
    "white-space:nowrap"
)
_TEXT = "text-align:left;vertical-align:top;padding:0;white-space:pre-wrap;overflow-wrap:anywhere"
_PAPER = "display:block;max-width:100%;height:auto;background:#fff;margin:.4em 0 0"


@dataclass(frozen=True)
class Facts:
    """Summary of an object.

    Attributes:
        title: The result, in one line.
        told: Up to five more facts, by name.
        kind: Name of the class, which precedes the title.
    """

    title: str
    told: Mapping[str, str]
    kind: str = ""

    @property
    def heading(self) -> str:
        """The first line: kind and title."""
        return ": ".join(filter(None, (self.kind, self.title)))

    def __str__(self) -> str:
        """Return one line per fact."""
        column = max(map(len, self.told), default=0)
        lines = [self.heading, *(f"  {name:<{column}}  {text}" for name, text in self.told.items())]
        return "\n".join(cut(line, _WIDTH) for line in lines)

    def html(self) -> str:
        """Return the summary for a notebook, where lines are longer."""
        rows = "".join(
            f'<tr style="background:none"><th scope="row" style="{_NAME}">{escape(name)}</th>'
            f'<td style="{_TEXT}">{escape(cut(text, _LONGEST))}</td></tr>'
            for name, text in self.told.items()
        )
        head = f'<div style="font-weight:bold">{escape(cut(self.heading, _LONGEST))}</div>'
        return f'{head}<table style="border:none;margin:0">{rows}</table>'


@dataclass(frozen=True)
class Picture:
    """A figure, with a caption if it does not show the object itself."""

    figure: "Figure"
    caption: str = ""

    def html(self) -> str:
        """Return an image that needs no file."""
        buffer = BytesIO()
        # sharp on high-resolution screens, too
        self.figure.savefig(buffer, format="png", dpi=2 * _DPI)
        width = round(self.figure.get_figwidth() * _DPI)
        data = b64encode(buffer.getvalue()).decode()
        shown = escape(self.caption)
        image = f'<img alt="{shown or "picture"}" width="{width}" style="{_PAPER}"'
        note = f'<div style="opacity:.65">{shown}</div>' if shown else ""
        return f'{image} src="data:image/png;base64,{data}">{note}'


class Shown(ABC):
    """A result that prints itself."""

    @abstractmethod
    def facts(self) -> Facts:
        """Return a summary, without solving or drawing anything."""

    def picture(self) -> Picture | None:
        """Return the picture below the summary in a notebook; None without one."""
        return None

    def __repr__(self) -> str:
        return str(self.facts())

    def _repr_html_(self) -> str:
        try:
            picture = self.picture()
            drawn = "" if picture is None else picture.html()
        except Exception as error:  # The summary is shown even if the picture fails.
            drawn = f"<div>no picture: {escape(f'{type(error).__name__}: {error}')}</div>"
        return f'<div style="{_BOX}">{self.facts().html()}{drawn}</div>'


class Compact:
    """A dataclass whose `repr` has sizes instead of arrays, and shortens long values."""

    def __repr__(self) -> str:
        given = (entry.name for entry in fields(self) if entry.repr)  # type: ignore[arg-type]
        told = ", ".join(f"{name}={short(getattr(self, name))}" for name in given)
        return f"{type(self).__name__}({cut(told, _WHOLE)})"


def short(value: object) -> str:
    """Return the `repr` of a value if that is short; numbers have at most 7 digits."""
    return cut(_SHORT.repr(value), _VALUE)


def cut(text: str, longest: int) -> str:
    """Return a text on one line, shortened if it is too long."""
    line = " ".join(text.split()) if "\n" in text else text
    return line if len(line) <= longest else f"{line[: longest - 3]}..."


def rounded_down(value: float) -> float:
    """Return a number > 0 rounded down to six digits, for upper limits."""
    least = Context(prec=6, rounding=ROUND_FLOOR).create_decimal_from_float(value)
    return float(least)


def counted(number: int, what: str) -> str:
    """Return a count with its noun: ``1 element``, ``12 elements``."""
    return f"{number} {what}{'' if number == 1 else 's'}"


def placed(place: Iterable[float]) -> str:
    """Return a place as text: ``(1.25, 0.4)``, ``(1.25, 0.4, 2)``."""
    return f"({', '.join(f'{value:.6g}' for value in place)})"


def spanned(low: Iterable[float], high: Iterable[float]) -> Text:
    """Return a box as text, ``x = 0 to 5 m, y = -2 to 0 m``, by two of its corners."""
    sides = zip("xyz", low, high, strict=False)
    spans = ((axis, Quantity((a, b), "m", ".6g", "{} to {}")) for axis, a, b in sides)
    return join(", ", (text("{} = {}", *own) for own in spans))


def sized(elements: int, unknowns: int, points: int) -> str:
    """Return sizes as text: ``576 elements, 2401 unknowns, 12 contact points``."""
    return ", ".join(
        (
            counted(elements, "element"),
            counted(unknowns, "unknown"),
            counted(points, "contact point"),
        )
    )


def listed(names: "Mapping[str, Any] | tuple[str, ...] | list[str]", most: int = 6) -> str:
    """Return the first of some names, and the number of the others."""
    own = list(names)
    rest = f" and {len(own) - most} more" if len(own) > most else ""
    return ", ".join(cut(str(name), 60) for name in own[:most]) + rest


class _Short(Repr):
    """`reprlib` formatters by type name, which avoids importing the types."""

    def repr_float(self, value: float, level: int) -> str:
        return f"{value:.7g}"

    def repr_ndarray(self, value: Any, level: int) -> str:
        return f"array{value.shape}" if value.size > 4 else self.repr1(value.tolist(), level)

    def repr_csr_matrix(self, value: Any, level: int) -> str:
        return f"sparse{value.shape}"

    def repr_DataFrame(self, value: Any, level: int) -> str:  # noqa: N802  # name of the type
        return f"table{value.shape}"

    def repr_mappingproxy(self, value: Any, level: int) -> str:
        return self.repr_dict(dict(value), level)

    def repr_function(self, value: Any, level: int) -> str:
        return str(value.__name__)

    def repr_instance(self, value: Any, level: int) -> str:
        first, _, more = repr(value).partition("\n")
        return f"<{first}>" if more and not first.startswith("<") else first

    repr_float64 = repr_float32 = repr_float


_SHORT = _Short()
_SHORT.maxstring = _SHORT.maxlong = _SHORT.maxother = 40
_SHORT.maxtuple = _SHORT.maxlist = _SHORT.maxdict = 4
_SHORT.maxlevel = 3
