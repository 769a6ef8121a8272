"""Texts keep their quantities and names until they are rendered for a reader."""

import pickle

import pytest

from lacore.reporting.text import (
    PYTHON,
    Quantity,
    Reader,
    Term,
    Text,
    interval,
    join,
    quantities,
    render,
    text,
)
from lacore.reporting.units import Units

GAP = text("a gap of {} on {}", Quantity(0.04, "m", ".3g"), Term("lacore.STICK", '"stick"'))


def test_a_text_is_that_of_python_users():
    assert GAP == "a gap of 0.04 m on lacore.STICK"
    assert render(GAP) == render(GAP, PYTHON) == GAP


def test_a_text_is_rendered_for_readers_of_files_in_their_units():
    assert render(GAP, Reader(Units(length="mm"), files=True)) == 'a gap of 40 mm on "stick"'


def test_texts_within_texts_keep_their_parts():
    whole = join("; ", [GAP, "plain", text("in {}: {}", "soil", GAP)])
    shown = "a gap of 4 cm on lacore.STICK"
    assert render(whole, Reader(Units(length="cm"))) == f"{shown}; plain; in soil: {shown}"
    assert [own.numbers for own in quantities(whole)] == [0.04, 0.04]


def test_texts_are_pickled_with_their_parts():
    again = pickle.loads(pickle.dumps(GAP))
    assert isinstance(again, Text)
    assert again == GAP
    assert again.parts == GAP.parts


def test_a_template_takes_as_many_values_as_it_has_places():
    with pytest.raises(TypeError, match="2 values"):
        text("{}", 1, 2)


@pytest.mark.parametrize(
    ("units", "quantity", "shown"),
    [
        (Units("kN"), Quantity(10000.0, "Pa"), "10 kPa"),
        (Units("kN"), Quantity((0, -18000.0), "N/m^3"), "(0, -18) kN/m^3"),
        (Units("kN"), interval(1e4, 1.6e4, "Pa", ".4g"), "10 to 16 kPa"),
        (Units("kN"), interval(1e4, 1e4, "Pa", ".4g"), "10 kPa"),
        (Units("MN"), Quantity(1.4433e8, "Pa", ".4g"), "144.3 MPa"),
        (Units("kN"), Quantity((0, -1e5), "N/m", framed=True), "(0, -100) kN/m"),
        (Units("kN", whole=True), Quantity((0, -1e5), "N/m", framed=True), "(0, -100) kN"),
        (Units("kN"), Quantity(("varies", -18000.0), "N/m^3"), "(varies, -18) kN/m^3"),
        (Units(length="cm"), interval(float("-inf"), 1, "m"), "-inf to 100 cm"),
        (Units("kip", "ft"), Quantity(1e6, "Pa"), "20.88543 ksf"),
        (None, Quantity(1.4433e8, "Pa", ".4g"), "1.443e+08 Pa"),
        (Units("kN"), Quantity(0.5, ""), "0.5"),
        (Units("kN"), Quantity(30.0, "°"), "30°"),
    ],
)
def test_quantities_are_rendered_in_units(units, quantity, shown):
    assert quantity.rendered(units) == shown
