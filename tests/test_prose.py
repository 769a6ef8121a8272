"""No number of README and guide is typed: it is in code that runs, computed beside it, or says why.

How a page says it: `tests/test_guide.py`.
"""

import math
import re

import pytest

from tests.test_guide import BLOCK, MARK, NUMBER, PAGES, ROOT, agrees, marked

GENERATED = re.compile(r"<!-- (times|comparison) -->.*?<!-- end[ \w]* -->", flags=re.DOTALL)
YEAR = r"(?:18|19|20)\d\d"
SAID = re.compile(r"(?<![\w./^])\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w/])(?: ?%)?")
FORMULA = re.compile(rf"([^=]+) = ({NUMBER})(?: \w+)?")
NAMES = {name: getattr(math, name) for name in ("pi", "sqrt", "tan", "cos", "sin", "exp", "atan")}
NAMES |= {"ln": math.log, "degrees": math.pi / 180}


def prose(page):
    """Text of a page without code, links, marks and what `make readme` writes."""
    text = BLOCK.sub("", GENERATED.sub("", PAGES[page]))
    return re.sub(r"\]\([^)]*\)", "]", re.sub("<!--.*?-->", "", text, flags=re.DOTALL))


def meant(text):
    """Numbers that are no counts: with a point or a power of ten, from 10 on, or per cent."""
    for found in SAID.findall(re.sub(r"`[^`]*`", "", text)):
        number = found.rstrip("% ")
        few = number.isdecimal() and found == number and int(number) < 10
        if not (few or re.fullmatch(YEAR, number)):
            yield number


def told(page):
    """Numbers of a page that are in its code, or in marks."""
    code = " ".join(text for _, _, text in BLOCK.findall(PAGES[page]))
    marks = [said for _, numbers in MARK.findall(PAGES[page]) for said, _ in marked(numbers)]
    code += (ROOT / "pyproject.toml").read_text(encoding="utf-8").partition("classifiers")[0]
    return {*SAID.findall(code), *re.findall(NUMBER, code), *", ".join(marks).split(", ")}


@pytest.mark.parametrize("page", PAGES)
def test_numbers_of_prose_are_computed(page):
    assert sorted({*meant(prose(page))} - told(page)) == []


@pytest.mark.parametrize("page", PAGES)
def test_marks_are_of_numbers_that_are_there(page):
    there = {found.lstrip("+-") for found in re.findall(NUMBER, prose(page))}
    for _, numbers in MARK.findall(PAGES[page]):
        for said, how in marked(numbers):
            assert {*said.split(", ")} <= there, said
            assert how


def formulas(page):
    """Formulas with a value, and whether they are of numbers alone."""
    for code in re.findall("`([^`]*)`", prose(page)):
        if found := FORMULA.fullmatch(code):
            yield *found.groups(), set(re.findall(r"[^\W\d]\w*", found[1])) <= {*NAMES, "x"}


@pytest.mark.parametrize("page", PAGES)
def test_formulas_have_the_value_that_is_said(page):
    """`ln 2`, `3/2 x 4`, `tan(30 degrees - atan 0.4)` as one writes them."""
    for formula, value, evaluable in formulas(page):
        if evaluable:
            text = re.sub(r"(\d) (?=ln|sqrt)", r"\1*", formula)
            text = re.sub(r"\b(ln|atan) ([\d.]+)", r"\1(\2)", text)
            text = text.replace(" x ", "*").replace(" degrees", "*degrees").replace("^", "**")
            agrees(value, str(eval(text, dict(NAMES))))
        else:
            assert {*meant(value)} <= told(page), formula
