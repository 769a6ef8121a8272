"""Findings: reports of an analysis in addition to its numbers, as values instead of text.

A finding is made where it is detected, stored in the result, and rendered for its reader, with the
reader's names and units. Nothing is ever read from a rendered text.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from enum import Enum
from string import Formatter
from typing import Any

from lacore.reporting import terms
from lacore.reporting.kinds import FILES, Kind
from lacore.reporting.text import PYTHON, Quantity, Reader, Term, Text, number, render

_SHOWN = 400  # characters of a text in `repr`


class Severity(Enum):
    """The role of a finding in its result."""

    DETAIL = "what the text of the status is about, such as a place; stands before that text"
    REASON = "why the result has its status; takes the place of the general text of the status"
    WARNING = "the numbers may not mean what the user expects"
    NOTE = "further information"


@dataclass(frozen=True, repr=False)
class Finding:
    """One report of an analysis.

    Attributes:
        kind: kind of the finding.
        where: names of the parts of the problem that it concerns, such as ``soil.bottom``.
        values: values by name for the text of the kind: texts, numbers, quantities, terms,
            findings, messages, and tuples of these.
        severity: its role in the result.
    """

    kind: Kind
    where: tuple[str, ...] = ()
    values: Mapping[str, Any] = field(default_factory=dict)
    severity: Severity = Severity.NOTE

    def text_for(self, reader: Reader) -> str:
        """Return the text for a reader."""
        text = FILES.get(self.kind, self.kind.value) if reader.files else self.kind.value
        return fill(text, {"where": self.where, **self.values}, reader)

    def __str__(self) -> str:
        return self.text_for(PYTHON)

    def __repr__(self) -> str:
        return f"Finding({self.kind.name}: {self!s:.{_SHOWN}})"

    def record(self) -> dict[str, Any]:
        """Return plain values, as JSON has them."""
        return {
            "kind": self.kind.name,
            "where": _plain(self.where),
            "values": {name: _plain(value) for name, value in self.values.items()},
            "severity": self.severity.name,
        }


@dataclass(frozen=True, repr=False)
class Message:
    """The text of a status, with the findings of its result.

    Attributes:
        label: label of the status.
        general: text of the status if no finding gives the reason.
        findings: findings of the result, in the order of the text.
        plain: Whether the label is sufficient if no finding gives a reason: ``solved``.
    """

    label: str
    general: str
    findings: tuple[Finding, ...] = ()
    plain: bool = False

    def text_for(self, reader: Reader) -> str:
        """Return the whole text: ``solved: to the tolerance; a note``."""
        details = texts(self.findings, reader, (Severity.DETAIL,))
        reasons = texts(self.findings, reader, (Severity.REASON,)) or self.general
        head = ": ".join(filter(None, (self.label, details, reasons)))
        return "; ".join(filter(None, (head, self.notes_for(reader))))

    def summary_for(self, reader: Reader) -> str:
        """Return the text, of a plain status without its general text: ``solved; a note``."""
        if not self.plain or texts(self.findings, reader, (Severity.REASON,)):
            return self.text_for(reader)
        return "; ".join(filter(None, (self.label, self.notes_for(reader))))

    def notes_for(self, reader: Reader) -> str:
        """Return the texts of the findings that do not explain the status."""
        return texts(self.findings, reader, (Severity.WARNING, Severity.NOTE))

    def __str__(self) -> str:
        return self.text_for(PYTHON)

    def __repr__(self) -> str:
        return f"Message({self!s:.{_SHOWN}})"


def fill(template: str, values: Mapping[str, Any], reader: Reader = PYTHON) -> str:
    """Return a template with its values, formatted as by `str.format`.

    Args:
        template: ``{name}`` stands for a value and ``{terms.BOND}`` for a name of
            `lacore.reporting.terms`; a tuple is written as ``a, b and c``.
        values: Values by name.
        reader: Reader of the quantities and names.
    """
    return _Filling(reader).vformat(template, (), {"terms": terms, **values})


class _Filling(Formatter):
    def __init__(self, reader: Reader) -> None:
        self._reader = reader

    def convert_field(self, value: Any, conversion: Any) -> Any:
        if isinstance(value, tuple):
            return tuple(self.convert_field(own, conversion) for own in value)
        return super().convert_field(value, conversion)

    def format_field(self, value: Any, format_spec: str) -> str:
        if isinstance(value, tuple):
            *first, last = (self.format_field(own, format_spec) for own in value)
            return " and ".join(filter(None, (", ".join(first), last)))
        if isinstance(value, Text):
            return render(value, self._reader)
        if hasattr(value, "text_for"):
            return str(value.text_for(self._reader))
        return number(value, format_spec)


def texts(
    findings: Iterable[Finding],
    reader: Reader = PYTHON,
    severities: Sequence[Severity] = tuple(Severity),
) -> str:
    """Return the texts of findings of some severities, one after the other."""
    return "; ".join(own.text_for(reader) for own in findings if own.severity in severities)


def records(findings: Iterable[Finding], reader: Reader) -> list[dict[str, Any]]:
    """Return findings as plain values for other programs, with their texts for a reader."""
    return [{**own.record(), "text": own.text_for(reader)} for own in findings]


def stored(findings: Iterable[Finding]) -> str:
    """Return findings as text that `restored` reads; empty without any."""
    plain = [own.record() for own in findings]
    return json.dumps(plain) if plain else ""


def restored(text: str) -> tuple[Finding, ...]:
    """Return the findings of a text written by `stored`.

    Raises:
        ValueError: It is not such a text.
    """
    try:
        return tuple(map(_finding, json.loads(text))) if text else ()
    except (KeyError, TypeError, AttributeError) as error:
        raise ValueError(f"no findings: {error}") from error


def _finding(record: Mapping[str, Any]) -> Finding:
    return Finding(
        Kind[record["kind"]],
        tuple(map(_value, record["where"])),
        {name: _value(value) for name, value in record["values"].items()},
        Severity[record["severity"]],
    )


def _plain(value: Any) -> Any:
    if isinstance(value, tuple):
        return [_plain(own) for own in value]
    if isinstance(value, Finding):
        return {"finding": value.record()}
    if isinstance(value, Message):
        records = [own.record() for own in value.findings]
        return {"message": [value.label, value.general, records, value.plain]}
    if isinstance(value, Text):
        return {"text": [_plain(part) for part in value.parts]}
    if isinstance(value, Quantity | Term):
        parts = [_plain(getattr(value, entry.name)) for entry in fields(value)]
        return {type(value).__name__.lower(): parts}
    return value.item() if hasattr(value, "item") else value


def _value(plain: Any) -> Any:
    if isinstance(plain, list):
        return tuple(map(_value, plain))
    if not isinstance(plain, Mapping):
        return plain
    ((kind, parts),) = plain.items()
    if kind == "finding":
        return _finding(parts)
    if kind == "message":
        label, general, records, plain = parts
        return Message(label, general, tuple(map(_finding, records)), plain)
    return _CLASSES[kind](*map(_value, parts))


_CLASSES: Mapping[str, Callable[..., Any]] = {"text": Text, "quantity": Quantity, "term": Term}
