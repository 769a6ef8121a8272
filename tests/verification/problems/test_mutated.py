"""Files with mistakes: an error with line and mend, or an answer; never a traceback."""

import json
import random
import re

import pytest

from lacore.errors import InputError
from lacore.files.problem.layout import toml
from lacore.files.problem.reading import read
from tests.verification.command_line import lacore
from verification.problems import starters

VALUES = (
    *(float("nan"), float("inf"), float("-inf"), 0, 0.0, -1, -2.5, 1e300, 1e-300, 10**30, 3),
    *("", "left", "20 kPa", "18 kN/m3", "30 deg", "5 m", "1e400 Pa", "a" * 400, "{x}", "%s", "\u2603"),
    *(True, False, [], [1], [1, 2], [1, 2, 3], ["a", "b"], [[0, 0], [1, 0], [0, 1]], {}),
    *({"x": 1}, {"mu": 0.5}, {"from": [0, 0], "to": [1, 1]}, {"shape": "rectangle"}),
    *("../../etc/passwd", "/dev/null", "\\u0000", "clarabel", "stick", "__import__('os')"),
)
PLAIN = dict(sorted((name, starters.text(name)) for name in starters.titles()))
ERROR = re.compile(r"Error: \S*my\.toml:\d+(: [^:]+|) ?[^:]*: .+; .+", re.DOTALL)


def parts(own, path=()):
    items = own.items() if isinstance(own, dict) else enumerate(own) if isinstance(own, list) else ()
    for key, value in items:
        yield (*path, key)
        yield from parts(value, (*path, key))


def around(data, path):
    for key in path[:-1]:
        data = data[key]
    return data, path[-1]


def mutated(draw, data):
    """The same with one mistake: a key renamed, left out or moved, a value of another kind."""
    table, key = around(data, draw.choice(list(parts(data))))
    kind = draw.choice(("value", "value", "value", "rename", "leave out", "scale", "double"))
    own = table[key]
    if kind == "rename" and isinstance(key, str):
        table[draw.choice((key[:-1] + "_", key.upper(), key[1:] or "q", "q"))] = table.pop(key)
    elif kind == "leave out":
        table.pop(key)
    elif kind == "scale" and isinstance(own, int | float) and not isinstance(own, bool):
        table[key] = own * draw.choice((-1, 0, 0.5, 1e-9, 1e9, 1e200))
    elif kind == "double" and isinstance(table, list):
        table.append(own)
    else:
        table[key] = draw.choice(VALUES)
    return data


def broken(draw, text):
    """The text with a letter less or more."""
    place = draw.randrange(len(text))
    return text[:place] + draw.choice(("", '"', "[", "]", "=", "\n", "#")) + text[place + 1 :]
