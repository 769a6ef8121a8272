"""Objects print themselves: short for any content, true, and with a picture in notebooks."""

import inspect
import subprocess
import sys
from enum import Enum
from functools import cached_property
from html.parser import HTMLParser
from typing import get_type_hints

import numpy as np
import pytest

import lacore as la
from lacore.reporting.showing import Facts, Picture, Shown, cut, short
from lacore.solvers.backend import Backend
from tests.lacore import shown
from tests.lacore.models import punch

LONGEST, LINES = 600, 6


@pytest.fixture(scope="module")
def made():
    return shown.results()[0]


@pytest.fixture(scope="module")
def everything(made):
    return [*made, *shown.results()[1], *shown.values()]


def test_every_object_is_short(everything):
    for thing in everything:
        text = repr(thing)
        assert len(text) <= LONGEST, text
        assert text.count("\n") < LINES, text
        assert "object at 0x" not in text or isinstance(thing, la.SolverProcess), text


def test_so_is_all_that_they_hold(everything):
    seen = {}
    for thing in everything:
        for part in shown.inside(thing, seen):
            text = repr(part)
            assert len(text) <= LONGEST, text
            assert text.count("\n") < LINES, text


def test_no_public_class_is_missing(everything):
    """A new one belongs into `tests.lacore.shown`; so does what a new function returns."""
    public = [getattr(la, name) for name in la.__all__]
    classes = {thing for thing in public if inspect.isclass(thing)}
    classes |= {
        get_type_hints(thing).get("return") for thing in public if inspect.isfunction(thing)
    }
    ours = {kind for kind in classes if getattr(kind, "__module__", "").startswith("lacore")}
    assert len(ours) > 30
    words = (Enum, Exception)  # of a fixed text; of a message
    wanted = {kind for kind in ours if not issubclass(kind, words) and not inspect.isabstract(kind)}
    wanted.discard(Backend)  # of others: a protocol
    missing = sorted(map(str, wanted - {type(thing) for thing in everything}))
    assert not missing
    laws = {
        k for _, k in inspect.getmembers(la.hardening, inspect.isclass) if hasattr(k, "modulus")
    }
    laws.discard(la.hardening.HardeningLaw)
    assert not laws - {type(thing) for thing in everything}


def test_what_is_said_is_true():
    state = la.solve(punch(2, 2))
    text = repr(state)
    name, size = state.certificate.worst
    for part in (
        f"load factor {state.load_factor:.7g}",
        "strict upper bound",
        f"largest {size:.1e} ({name})",
        "auto, certified coupling",
        f"{state.discretisation.n_elements} elements, {state.discretisation.program.n} unknowns",
    ):
        assert part in text
    unsafe = la.solve(shown.unsafe())
    assert "load factor unknown, not certified" in repr(unsafe)
    assert "unsafe: no load factor keeps equilibrium" in repr(unsafe)


def test_printing_and_reading_a_result_solve_nothing(monkeypatch):
    """All properties and texts of a state and of a bracket, also those of an unsafe state."""
    results = (
        la.solve(punch(2, 2)),
        la.solve(shown.unsafe()),
        la.bracket(punch(2, 2), time_limit=1.0),
    )

    def refuse(*_):
        raise AssertionError("a solver is loaded")

    monkeypatch.setattr("lacore.solvers.registry.load_backend", refuse)
    with pytest.raises(AssertionError, match="a solver is loaded"):
        results[1].stability()
    for result in results:
        assert all([str(result), repr(result), str(result.facts())])
        for name, member in vars(type(result)).items():
            if isinstance(member, property | cached_property):
                getattr(result, name)


def test_numbers_have_at_most_seven_digits():
    assert short(1 / 3) == short(np.float64(1 / 3)) == "0.3333333"
    assert short(np.array([1 / 3, 1e-12])) == "[0.3333333, 1e-12]"
    assert short(np.zeros((3, 4))) == "array(3, 4)"
    assert repr(la.Coulomb(0.65)) == "Coulomb(mu=0.65, associated=False)"


def test_a_value_in_a_message_takes_one_line():
    with pytest.raises(la.InputError) as caught:
        la.solve(la.solve(punch(2, 2)))
    assert "\n" not in str(caught.value)


def test_no_repr_loads_matplotlib():
    code = (
        "import sys; from tests.lacore.models import punch; import lacore as la;"
        "state = la.solve(punch(2, 2)); repr(state); repr(state.discretisation.problem);"
        "assert 'matplotlib' not in sys.modules;"
        "assert 'data:image/png' in state._repr_html_();"
        "assert 'matplotlib' in sys.modules and 'matplotlib.pyplot' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


class Reader(HTMLParser):
    """What a page shows, and whether its tags close in order."""

    def __init__(self, page):
        super().__init__()
        self.open, self.text, self.images = [], [], []
        self.feed(page)
        self.close()

    def handle_starttag(self, tag, attrs):
        if tag == "img":
            self.images.append(dict(attrs))
        else:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text.append(data)


def shows(page, thing):
    """What a page has of an object: closed tags, escaped text, all facts, nothing to be loaded."""
    read, facts = Reader(page), thing.facts()
    assert not read.open
    text = "".join(read.text)
    assert cut(facts.title, 900) in text
    assert all(cut(fact, 900)[:-3] in text for fact in facts.told.values())
    for address in ("<b>", "http:", "https:", "<script"):  # `:` is not in base64
        assert address not in page
    return read


def test_facts_of_notebooks_are_those_of_the_text(everything):
    for thing in everything:
        if isinstance(thing, Shown):
            shows(f"<div>{thing.facts().html()}</div>", thing)


@pytest.mark.slow
def test_notebooks_show_every_result(made):
    pictured = set()
    for thing in made:
        if isinstance(thing, Shown):
            read = shows(thing._repr_html_(), thing)
            assert "no picture" not in "".join(read.text)
            for image in read.images:
                assert image["src"].startswith("data:image/png;base64,")
                pictured.add(type(thing))
    promised = {type(thing) for thing in made if isinstance(thing, Shown)}
    assert pictured == {own for own in promised if own.picture is not Shown.picture}
    assert {la.LimitState, la.Bracket, la.Path, la.Problem, la.CrushingBracket} <= pictured


def test_a_picture_that_fails_leaves_the_facts():
    class Broken(Shown):
        def facts(self):
            return Facts("Broken: <x>", {"why": "a & b"})

        def picture(self):
            raise ValueError("nothing <here>")

    page = Broken()._repr_html_()
    assert "Broken: &lt;x&gt;" in page
    assert "a &amp; b" in page
    assert "no picture: ValueError: nothing &lt;here&gt;" in page


def test_a_picture_says_what_it_shows_where_that_is_something_else():
    locked = la.solve(shown.locked())
    assert isinstance(locked.picture(), Picture)
    assert "there is no mechanism" in locked._repr_html_()


def test_formatters_of_notebooks_find_it():
    formatters = pytest.importorskip("IPython.core.formatters")
    told, _ = formatters.DisplayFormatter().format(punch(2, 2))
    assert told["text/plain"].startswith("Problem: 1 body, 3 supports, 1 reference load")
    assert "data:image/png;base64," in told["text/html"]
