"""Messages and values as problem files write them."""

import re
from collections.abc import Sequence
from numbers import Real
from typing import Any

from lacore.files.problem.statements import plain

_L = r"(?:lacore|la)\."
_WORDS: Sequence[tuple[str, str]] = (
    (rf"{_L}meshes\.(layered|fan|rectangle|patches)", r'shape = "\1"'),
    (rf"{_L}BOND", '"bond"'),
    (rf"`?{_L}stable`?", "--stable"),
    (rf"{_L}(?:coulomb|soil)_range", "--range"),
    (rf"ask {_L}lower_bound", "ask for --bracket"),
)


def in_words_of_files(text: str) -> str:
    """Return a message of a state with the keys of problem files in place of Python names."""
    for python, own in _WORDS:
        text = re.sub(python, own, text)
    return text


def value_of_files(value: Any) -> Any:
    """Return a value as files write it, and None for a value that no file contains."""
    if isinstance(value, str | bool | None):
        return value
    if isinstance(value, Real):
        return plain(value)
    if isinstance(value, list | tuple):
        inner = [value_of_files(own) for own in value]
        return None if None in inner else inner
    return None
