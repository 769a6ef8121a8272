"""Lines of the keys and values of a TOML text.

`tomllib` reads the values and detects errors, but does not report places. Texts that it accepts are
well formed, so a second pass over them is sufficient.
"""

import re
from collections.abc import Mapping

Path = tuple[str | int, ...]

_BLANK = re.compile(r"(?:[\s]|#[^\n]*)*")
_STRING = re.compile(
    r'"""(?:\\.|[^\\])*?"{3,5}' r"|'''.*?'{3,5}" r'|"(?:\\.|[^"\\\n])*"' r"|'[^'\n]*'", re.DOTALL
)
_BARE = re.compile(r"[A-Za-z0-9_-]+")
_OTHER = re.compile(r"[^,\]}#\n]+")  # numbers, dates, true and false
_ESCAPE = re.compile(r"\\(?:u([0-9a-fA-F]{4})|U([0-9a-fA-F]{8})|(.))", re.DOTALL)
_LETTERS = {"b": "\b", "t": "\t", "n": "\n", "f": "\f", "r": "\r"}


def lines(text: str) -> Mapping[Path, int]:
    """Return the line of each key, table and entry of an array, from 1, by its path.

    Args:
        text: TOML that `tomllib` has read.
    """
    return _Walk(text.replace("\r\n", "\n")).found


class _Walk:
    """One pass over a text, from its beginning."""

    def __init__(self, text: str) -> None:
        self._text, self._at = text, 0
        self._last: dict[Path, int] = {}  # latest entry of each array of tables
        self.found: dict[Path, int] = {}
        here: Path = ()
        while self._more():
            if self._text[self._at] == "[":
                here = self._header()
            else:
                self._pair(here)

    def _more(self) -> bool:
        """Move to the next key or value; return whether there is one."""
        blank = _BLANK.match(self._text, self._at)
        self._at = blank.end() if blank else self._at
        return self._at < len(self._text)

    def _note(self, path: Path) -> None:
        self.found.setdefault(path, self._text.count("\n", 0, self._at) + 1)

    def _header(self) -> Path:
        repeated = self._text.startswith("[[", self._at)
        begin = self._at
        self._at += 2 if repeated else 1
        names = self._names()
        end, self._at = self._at, begin
        path: Path = ()
        for place, name in enumerate(names):
            path = (*path, name)
            self._note(path)
            if repeated and place == len(names) - 1:
                self._last[path] = self._last.get(path, -1) + 1
            if path in self._last:
                path = (*path, self._last[path])
                self._note(path)
        self._at = end + (2 if repeated else 1)
        return path

    def _names(self) -> list[str]:
        """Return a key, dotted or not, and move behind it."""
        names = []
        while True:
            self._more()
            quoted, bare = (kind.match(self._text, self._at) for kind in (_STRING, _BARE))
            match = quoted or bare
            assert match is not None  # It is valid TOML.
            names.append(_unquoted(match[0]) if quoted else match[0])
            self._at = match.end()
            self._more()
            if not self._text.startswith(".", self._at):
                return names
            self._at += 1

    def _pair(self, here: Path) -> None:
        begin = self._at
        names = self._names()
        end, self._at = self._at, begin
        path = here
        for name in names:
            path = (*path, name)
            self._note(path)
        self._at = end + 1  # behind the =
        self._value(path)

    def _value(self, path: Path) -> None:
        self._more()
        self._note(path)
        if self._text[self._at] in "[{":
            self._inside(path, "]" if self._text[self._at] == "[" else "}")
            return
        match = _STRING.match(self._text, self._at) or _OTHER.match(self._text, self._at)
        assert match is not None
        self._at = match.end()

    def _inside(self, path: Path, end: str) -> None:
        self._at += 1
        number = 0
        while self._more() and self._text[self._at] != end:
            if end == "]":
                self._value((*path, number))
            else:
                self._pair(path)
            number += 1
            self._more()
            if self._text[self._at] == ",":
                self._at += 1
        self._at += 1


def _unquoted(text: str) -> str:
    if text[0] == "'":
        return text[1:-1]
    return _ESCAPE.sub(_letter, text[1:-1])


def _letter(match: re.Match[str]) -> str:
    code = match[1] or match[2]
    return chr(int(code, 16)) if code else _LETTERS.get(match[3], match[3])
