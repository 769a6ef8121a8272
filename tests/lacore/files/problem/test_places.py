"""Lines of keys and values, however TOML writes them."""

import tomllib

from hypothesis import given
from hypothesis import strategies as st

from lacore.files.problem.places import lines

TEXT = '''\
# a comment with a = 1
title = "a # b"
"k\\u0041 y".b = 3
[bodies.clay]  # of a table
mesh = { x = [
  1, # one
  [2, 3],
], y = 'q' }
[[loads]]
text = """x
= [ \\""" " """
[[loads]]
date = 1979-05-27 07:32:00
[[loads.sub]]
f = [ {a = 1}, {b = [1,
2]} ]
'''


def test_each_is_found_on_its_line():
    found = lines(TEXT)
    at = {
        ("title",): 2,
        ("kA y", "b"): 3,
        ("bodies", "clay"): 4,
        ("bodies", "clay", "mesh", "x", 0): 6,
        ("bodies", "clay", "mesh", "x", 1, 1): 7,
        ("bodies", "clay", "mesh", "y"): 8,
        ("loads", 0, "text"): 10,
        ("loads", 1, "date"): 13,
        ("loads", 1, "sub", 0, "f", 1, "b", 1): 16,
    }
    assert {path: found[path] for path in at} == at


def test_what_windows_writes_has_the_same_lines():
    assert lines(TEXT.replace("\n", "\r\n")) == lines(TEXT)


def paths(own, path=()):
    yield path
    items = (
        own.items() if isinstance(own, dict) else enumerate(own) if isinstance(own, list) else ()
    )
    for key, value in items:
        yield from paths(value, (*path, key))


_PIECES = st.sampled_from(
    ["a", "b", '"c d"', "=", "[", "]", "{", "}", ",", ".", "\n", " ", "#", '"', "'", '"""', "1"]
)


@given(st.lists(_PIECES, max_size=25).map("".join))
def test_all_that_tomllib_reads_is_found(text):
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        return
    assert set(lines(text)) == set(paths(data)) - {()}
