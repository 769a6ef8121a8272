"""The example in the docstring of each public function and class runs, and shows what it says."""

import doctest
import inspect
from enum import Enum
from types import ModuleType

import numpy as np
import pytest

import lacore as la

MADE = {
    *("Bracket", "Certificate", "Critical", "Crossing"),
    *("CarriedLoads", "CrushingBracket", "DeadCollapse", "Discretisation"),
    *("Envelope", "GapIdentity", "Interval", "LimitState", "LoadCases", "LockingRay"),
    *("LoadFactorRange", "LowerBound", "Path"),
    *("SafetyFactor", "Sensitivity", "Stability", "Stable", "Thrust", "UpperBound"),
    *("WorstPosition", "masonry.DrawnBlocks"),
}
"""What nobody calls: functions return it, and their examples show it."""
PROTOCOLS = {"hardening.HardeningLaw"}


def called():
    """Functions and classes that one calls, by the name that one gives after ``la.``."""
    for name in la.__all__:
        thing = getattr(la, name)
        if thing is la.types:
            continue  # of annotations
        if isinstance(thing, ModuleType):
            own = getattr(thing, "__all__", None) or [
                part
                for part, found in vars(thing).items()
                if getattr(found, "__module__", "") == thing.__name__ and part[0] != "_"
            ]
            yield from ((f"{name}.{part}", getattr(thing, part)) for part in own)
        else:
            yield name, thing


def needs_one(name, thing):
    if isinstance(thing, type):
        return not issubclass(thing, Enum | Exception) and name not in MADE | PROTOCOLS
    return callable(thing)


EXAMPLES = {name: thing for name, thing in called() if needs_one(name, thing)}


def test_names_of_what_has_none_are_still_there():
    assert len(EXAMPLES) > 110
    assert dict(called()).keys() >= MADE | PROTOCOLS


@pytest.mark.parametrize("name", EXAMPLES)
def test_example_shows_what_it_says(name, tmp_path, monkeypatch, capsys):
    """As printed: an example rounds, to digits that do not hang on a solver or a processor."""
    monkeypatch.chdir(tmp_path)
    text = inspect.getdoc(EXAMPLES[name])
    example = doctest.DocTestParser().get_doctest(text, {"la": la, "np": np}, name, None, None)
    assert example.examples, "no example"
    assert any(f"la.{name}" in one.source for one in example.examples)
    doctest.DocTestRunner(verbose=False).run(example, clear_globs=True)
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize("name", EXAMPLES)
def test_signature_speaks_of_names(name):
    """`help` shows `Where` and `Friction`, as the file has them, not what they are unions of."""
    shown = str(inspect.signature(EXAMPLES[name]))
    assert "numpy" not in shown, "from __future__ import annotations"
    assert "lacore." not in shown.partition(" = ")[0]
