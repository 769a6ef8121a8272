"""Parameters shared out between the fast tests and the slow ones."""

from collections.abc import Iterable
from typing import Any

import pytest


def one_in(every: int, values: Iterable[Any]) -> list[Any]:
    """Values for `parametrize` (tuples, or made by `pytest.param`): one in `every` is fast."""
    return [_marked(value, number % every > 0) for number, value in enumerate(values)]


def _marked(value: Any, slow: bool) -> Any:
    marks = [pytest.mark.slow] if slow else []
    if hasattr(value, "marks"):
        return pytest.param(*value.values, marks=[*value.marks, *marks], id=value.id)
    return pytest.param(*(value if isinstance(value, tuple) else (value,)), marks=marks)
