"""Texts that keep their quantities and names as values until they are rendered for a reader."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from math import isnan
from typing import Any, Protocol

from lacore.reporting.units import Units


def number(value: Any, form: str = "") -> str:
    """Return a value in a format: the only place where numbers of sentences are written.

    NaN is never printed: it stands for a number that is not known.
    """
    return "unknown" if isinstance(value, float) and isnan(value) else format(value, form)


@dataclass(frozen=True)
class Quantity:
    """Numbers with a unit: a single one, a vector or an interval.

    Attributes:
        numbers: Values in SI; a text such as "varies" for an unknown number.
        unit: Unit of SI, see `Units.size`.
        form: Format of a number in SI.
        pattern: Format of the numbers; by default ``{}`` for one and ``({}, {})`` for several.
        framed: Whether it belongs to a frame, see `Units.size`.
    """

    numbers: float | tuple[float | str, ...]
    unit: str
    form: str = "g"
    pattern: str = ""
    framed: bool = False

    @property
    def values(self) -> tuple[float, ...]:
        """The numbers without texts."""
        return tuple(own for own in self._all if not isinstance(own, str))

    @property
    def _all(self) -> tuple[float | str, ...]:
        return self.numbers if isinstance(self.numbers, tuple) else (self.numbers,)

    def rendered(
        self, units: Units | None = None, framed: bool = False, mathtext: bool = False
    ) -> str:
        """Return the numbers with their unit, in SI where no units are given."""
        of_frame = framed or self.framed
        size = 1.0 if units is None else units.size(self.unit, of_frame)
        label = self.unit if units is None else units.label(self.unit, of_frame)
        shown = [self._number(own, size, units is None, mathtext) for own in self._all]
        pattern = self.pattern or (
            "{}" if len(shown) == 1 else f"({', '.join('{}' for _ in shown)})"
        )
        gap = "" if label in ("", "°") else " "
        return f"{pattern.format(*shown)}{gap}{label}"

    def _number(self, own: float | str, size: float, in_si: bool, mathtext: bool) -> str:
        if isinstance(own, str):
            return own
        # Rounded in SI first, so that all readers see the same digits.
        shown = number(own, self.form)
        if not (in_si or isnan(own)):
            shown = f"{float(shown) / size:.7g}"
        elif isinstance(own, int):
            shown = str(own)
        return f"${typeset(shown)}$" if mathtext and "e" in shown else shown

    def text_for(self, reader: Reader) -> str:
        """Return the numbers in the units of a reader."""
        return self.rendered(reader.units, reader.framed, reader.mathtext)

    def __str__(self) -> str:
        return self.rendered()


def interval(low: float, high: float, unit: str, form: str = "g") -> Quantity:
    """Return ``1 to 2 Pa``, or ``1 Pa`` where both ends are written alike."""
    if f"{low:{form}}" == f"{high:{form}}":
        return Quantity(low, unit, form)
    return Quantity((low, high), unit, form, "{} to {}")


def typeset(number: str) -> str:
    r"""Return a number in mathtext with its power of ten: ``5.2 \times 10^{-5}``."""
    digits, _, power = number.partition("e")
    return rf"{digits} \times 10^{{{int(power)}}}" if power else digits


@dataclass(frozen=True)
class Symbol:
    """Symbol of a quantity, which is set in italics in pictures."""

    name: str

    def text_for(self, reader: Reader) -> str:
        """Return the symbol, in mathtext for those that take it."""
        return f"${self.name}$" if reader.mathtext else self.name

    def __str__(self) -> str:
        return self.name


@dataclass(frozen=True)
class Term:
    """Name or expression that differs between Python and problem files.

    Attributes:
        python: Form in Python.
        file: Form in a problem file, or as an option of the command line.
    """

    python: str
    file: str

    def text_for(self, reader: Reader) -> str:
        """Return the name that a reader uses."""
        return self.file if reader.files else self.python

    def __str__(self) -> str:
        return self.python


@dataclass(frozen=True)
class Reader:
    """Reader of a text.

    Attributes:
        units: Units of the quantities; None: those of SI, with the given digits.
        files: Whether names are those of problem files rather than of Python.
        framed: Whether the text is about a frame, see `Units.size`.
        mathtext: Whether symbols and powers of ten are in the mathtext of Matplotlib.
    """

    units: Units | None = None
    files: bool = False
    framed: bool = False
    mathtext: bool = False


PYTHON = Reader()
"""Users of the Python library, with everything in SI."""


class Rendered(Protocol):
    """Value whose text depends on the reader: a quantity, a term, a finding."""

    def text_for(self, reader: Reader) -> str:
        """Return its text for a reader; `str` of it is that for `PYTHON`."""


Part = str | Rendered


class Text(str):
    """Text for Python users that stores its parts, so that it can be rendered for others.

    It is made by `text` and rendered by `render`. An f-string that contains it is plain text for
    Python users; compose texts by `text` and `join` to keep the parts.

    Attributes:
        parts: Plain text, and quantities, terms and other values with a `text_for`, in order.
    """

    parts: tuple[Part, ...]

    def __new__(cls, *parts: Part) -> Text:
        """Join parts."""
        own = super().__new__(cls, "".join(map(str, parts)))
        own.parts = parts
        return own

    def __reduce__(self) -> tuple[type[Text], tuple[Part, ...]]:
        """Pickle by the parts."""
        return Text, self.parts


def text(template: str, *values: object) -> Text:
    """Return a template with values in place of each ``{}``: quantities, terms, texts, others."""
    first, *rest = template.split("{}")
    if len(rest) != len(values):
        raise TypeError(f"{len(values)} values for the template {template!r}")
    parts: list[Part] = [first]
    for value, after in zip(values, rest, strict=True):
        parts += [*_parts(value), after]
    return Text(*_merged(parts))


def join(separator: str, texts: Iterable[str]) -> Text:
    """Return texts with a separator between them."""
    parts: list[Part] = []
    for own in texts:
        parts += [separator, *_parts(own)] if parts else _parts(own)
    return Text(*_merged(parts))


def render(own: str, reader: Reader = PYTHON) -> str:
    """Return a text with the quantities and names of a reader; plain text unchanged."""
    if not isinstance(own, Text):
        return own
    return "".join(_rendered(part, reader) for part in own.parts)


def quantities(own: str) -> Iterator[Quantity]:
    """Yield the quantities of a text."""
    yield from (part for part in getattr(own, "parts", ()) if isinstance(part, Quantity))


def sizes(texts: Iterable[str]) -> list[float]:
    """Return the forces, moments and stresses of texts in SI, from which `fitting` chooses."""
    known = {"Pa", "Pa/m", "N", "N/m", "N/m per m", "N/m^3", "N m"}
    found = [one for own in texts for one in quantities(own) if one.unit in known]
    return [value for one in found for value in one.values]


def _rendered(part: Part, reader: Reader) -> str:
    return part if isinstance(part, str) else part.text_for(reader)


def _parts(value: object) -> tuple[Part, ...]:
    if isinstance(value, Text):
        return value.parts
    return (value,) if hasattr(value, "text_for") else (str(value),)


def _merged(parts: Iterable[Part]) -> Iterator[Part]:
    """Join plain texts that follow each other."""
    plain = ""
    for part in parts:
        if isinstance(part, str):
            plain += part
            continue
        if plain:
            yield plain
        plain = ""
        yield part
    if plain:
        yield plain
