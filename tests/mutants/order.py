"""Which tests may notice an error: those of the files that run its statement, quickest first."""

import ast
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Ran:
    """A test that has run without an error.

    Attributes:
        test: Its name in pytest.
        seconds: Its time with its fixtures, s.
        lines: Lines that it runs, by path of the file.
    """

    test: str
    seconds: float
    lines: Mapping[str, frozenset[int]]

    @property
    def file(self) -> str:
        """Path of the file of the test."""
        return self.test.partition("::")[0]

    @classmethod
    def of_row(cls, row: Mapping[str, Any]) -> "Ran":
        """Return the test of a row that `tests.mutants.coverage` writes."""
        lines = {path: frozenset(own) for path, own in row["lines"].items()}
        return cls(row["test"], row["seconds"], lines)


def ordered(tests: Sequence[Ran], path: str, original: bytes, source: bytes) -> list[Ran]:
    """Return the tests of the files that run a changed statement, and first those that run it.

    A statement that no test runs is run by the import of its file, or not at all: then the tests
    that run anything of its file, or else all tests.
    """
    statement = frozenset(changed_lines(original, source))
    exact = {own.test for own in tests if own.lines.get(path, frozenset()) & statement}
    first = exact or {own.test for own in tests if path in own.lines}
    files = {own.file for own in tests if own.test in first} or {own.file for own in tests}
    chosen = [own for own in tests if own.file in files]
    return sorted(chosen, key=lambda own: (own.test not in first, own.seconds))


def changed_lines(original: bytes, source: bytes) -> range:
    """Return the lines of the innermost statement of a source that contains a change.

    Only those before its body, where it has one.
    """
    start = _common(original, source)
    most = min(len(original), len(source)) - start
    end = len(original) - min(_common(original[::-1], source[::-1]), most)
    first, last = (original.count(b"\n", 0, place) + 1 for place in (start, max(start, end - 1)))
    statements = [own for own in ast.walk(ast.parse(original)) if isinstance(own, ast.stmt)]
    around = [own for own in statements if own.lineno <= first and last <= _last(own)]
    if not around:
        return range(first, last + 1)
    inner = max(around, key=lambda own: (own.lineno, -_last(own)))
    body = getattr(inner, "body", None)
    stop = body[0].lineno if body else _last(inner) + 1
    head = range(inner.lineno, max(stop, inner.lineno + 1))
    return head if first in head else range(first, last + 1)


def _common(one: bytes, other: bytes) -> int:
    """Return the number of bytes with which both begin."""
    pairs = zip(one, other, strict=False)
    return next((k for k, (a, b) in enumerate(pairs) if a != b), min(len(one), len(other)))


def _last(statement: ast.stmt) -> int:
    return statement.end_lineno or statement.lineno
