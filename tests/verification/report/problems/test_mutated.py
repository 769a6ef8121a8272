"""Files with mistakes: an error with line and fix, or an answer; never a traceback."""

import json
import random
import re
import tomllib
from collections import Counter

import pytest

from lacore.files.problem.reading import read
from lacore.files.problem.source import Source, written
from lacore.files.problem.writing import toml
from lacore.reporting.errors import InputError
from lacore_verification.report.problems import starters
from tests.verification.command_line import lacore
from tests.verification.report.problems import others

VALUES = (
    *(float("nan"), float("inf"), float("-inf"), 0, 0.0, -1, -2.5, 1e300, 1e-300, 10**30, 3),
    *("", "left", "20 kPa", "18 kN/m3", "30 deg", "5 m", "1e400 Pa", "a" * 400, "{x}", "%s"),
    *(True, False, [], [1], [1, 2], [1, 2, 3], ["a", "b"], [[0, 0], [1, 0], [0, 1]], {}),
    *({"x": 1}, {"mu": 0.5}, {"from": [0, 0], "to": [1, 1]}, {"shape": "rectangle"}),
    *("../../etc/passwd", "/dev/null", "\u2603", "clarabel", "stick", "__import__('os')"),
)
PLAIN = dict(sorted((name, starters.text(name)) for name in starters.titles())) | others.TEXTS
LINE = re.compile(r".*my\.toml:\d+(?:: |$)")


def parts(own, path=()):
    own = dict(enumerate(own)) if isinstance(own, list) else own
    for key, value in own.items() if isinstance(own, dict) else ():
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


def drawn(number):
    """A starter with a mistake, by a number."""
    draw = random.Random(number)
    text = PLAIN[draw.choice(list(PLAIN))]
    if draw.random() < 0.15:
        return broken(draw, text)
    return toml(mutated(draw, tomllib.loads(text)))


def test_mistakes_are_said_with_line_and_mend(tmp_path):
    """Numbers of starters that are read, and of errors: neither is empty."""
    file = tmp_path / "my.toml"
    others.draw(tmp_path)
    refused, total = {}, 100
    for number in range(total):
        file.write_text(drawn(number), encoding="utf-8")
        try:
            read(file)
        except InputError as error:
            refused[number] = error
    assert 5 < len(refused) < total - 5
    for number, error in refused.items():
        assert LINE.match(error.field), (number, error)
        assert error.reason, number
        assert error.fix, number


def varied(draw, text):
    """A number of a text, or none, with a range, or none: as `--vary` takes them."""
    numbers = [
        (written(path), own)
        for path in parts(tomllib.loads(text))
        if path[0] not in ("solve", "title")
        for own in [value(tomllib.loads(text), path)]
        if (isinstance(own, int | float) and not isinstance(own, bool)) or isinstance(own, str)
    ]
    name, own = draw.choice(numbers)
    number, _, unit = own.partition(" ") if isinstance(own, str) else (str(own), "", "")
    try:
        middle = float(number)
    except ValueError:
        middle = 1.0
    low, high = sorted((middle * draw.choice((0.5, 0.8, -1, 0)), middle * 1.5 + 0.01))
    unit = draw.choice((unit, unit, unit, "", "kPa", "mm", "deg", "blub"))
    name = draw.choice((name, name, name, name.rpartition(".")[2], name[:-1], ""))
    return f"{name}={low:g} {unit}:{high:g} {unit}"


def value(data, path):
    table, key = around(data, path)
    return table[key]


def test_ranges_are_taken_or_refused_with_a_mend(tmp_path):
    """Numbers of starters and ranges: what is taken makes a problem, or says why."""
    from lacore.files.problem.varied import read_varied  # here: pydantic takes a while to load

    others.draw(tmp_path)
    refused = {}
    for number in range(40):
        draw = random.Random(number)
        file = tmp_path / "my.toml"
        text = PLAIN[draw.choice(list(PLAIN))]
        file.write_text(text, encoding="utf-8")
        asked = varied(draw, text)
        try:
            found = read_varied(Source.of(file), asked, "--vary")
            found.problem((found.low + found.high) / 2)
        except InputError as error:
            refused[asked] = error
    assert 5 < len(refused) < 38
    for asked, error in refused.items():
        assert error.field == "--vary" or LINE.match(error.field), (asked, error)
        assert error.reason, asked
        assert error.fix, asked


@pytest.mark.slow
def test_ranges_are_answered_or_refused(tmp_path):
    """40 of them by the command: a document, or a sentence."""
    others.draw(tmp_path)
    file, count = tmp_path / "my.toml", Counter()
    for number in range(2000, 2040):
        draw = random.Random(number)
        text = PLAIN[draw.choice(("arch", "block", "frame", "vault"))]
        file.write_text(text, encoding="utf-8")
        asked = ("--vary", varied(draw, text), draw.choice(("--critical", "--limit", "--worst")))
        result = lacore("solve", file, "--json", "--out", tmp_path / "out", *asked)
        assert isinstance(result.exception, SystemExit | None), (number, asked, result.exception)
        count[result.exit_code] += 1
        if result.exit_code == 2:
            assert result.stdout == "", (number, asked)
            assert "; " in result.stderr, (number, asked)
            continue
        found = json.loads(result.stdout)[asked[2].removeprefix("--")]
        assert "failure" in found or found["table"], (number, asked)
    assert set(count) == {0, 1, 2}


@pytest.mark.slow
def test_commands_answer_or_say_why_not(tmp_path):
    """200 files: one document with a certified number, or a named status, or a sentence."""
    file = tmp_path / "my.toml"
    others.draw(tmp_path)
    count = Counter()
    for number in range(1000, 1200):
        file.write_text(drawn(number), encoding="utf-8")
        result = lacore("solve", file, "--json", "--out", tmp_path / "out")
        assert isinstance(result.exception, SystemExit | None), (number, result.exception)
        count[result.exit_code] += 1
        if result.exit_code == 2:
            assert result.stdout == "", number
            assert LINE.match(result.stderr.partition(" = ")[0]), (number, result.stderr)
            continue
        found = json.loads(result.stdout)
        if result.exit_code == 0:
            assert max(found["certificate"].values()) <= found["tolerance"], number
        else:
            assert found["status"] != "solved", number
            assert found["message"], number
    assert set(count) <= {0, 1, 2}
    assert min(count[0], count[2]) > 10
