"""Numbers with units become SI; what does not fit is said."""

import pytest

from lacore.files.problem.units import Amount, WrongUnitError, amount, chosen
from lacore.reporting.units import Units


@pytest.mark.parametrize(
    ("text", "accepted", "value"),
    [
        ("18 kN/m3", ("N/m^3",), 18e3),
        ("18 kN/m³", ("N/m^3",), 18e3),
        ("18 kN/m**3", ("N/m^3",), 18e3),
        ("18kN / m^3", ("N/m^3",), 18e3),
        ("20 kPa", ("Pa",), 20e3),
        ("-2.5e1 N/mm2", ("Pa",), -25e6),
        ("40 cm", ("m",), 0.4),
        ("5 kNm", ("N m",), 5e3),
        ("5 kN·m/m", ("N m", "N"), 5e3),
        ("5 kN", ("N", "N/m"), 5e3),
        ("30°", ("deg",), 30.0),
        ("30 deg", ("deg",), 30.0),
        ("0.5235987755982988 rad", ("deg",), 30.0),
        ("3 ksf", ("Pa",), 3000 * 4.4482216152605 / 0.3048**2),
        ("110 pcf", ("N/m^3",), 110 * 4.4482216152605 / 0.3048**3),
        ("1 kip/ft", ("N/m",), 14593.902937206),  # 4448.2216152605 N over 0.3048 m
    ],
)
def test_amounts_are_converted(text, accepted, value):
    # A factor of pint's is rounded once, and the number to 14 digits.
    assert amount(text, accepted).value == pytest.approx(value, rel=1e-13)


@pytest.mark.parametrize(
    ("text", "accepted", "why"),
    [
        ("20 kN/m3", ("Pa",), "does not fit: this is in Pa"),
        ("2 t/m3", ("N/m^3",), "does not fit"),
        ("20", ("Pa",), "without its unit"),
        ("20 blub", ("Pa",), "not a known unit"),
        ("kPa", ("Pa",), "not a number"),
        ("1e400 Pa", ("Pa",), "not a finite number"),
        ("9**9**9 m", ("m",), "not a unit"),
        ("1 m^9^9", ("m",), "not a unit"),
        ("1 m^99", ("m",), "not a unit"),
        ("1 __import__('os')", ("m",), "not a unit"),
        ("30 Pa", ("deg",), "not a unit of angle"),
        ("0.5", (), "a text in place of a number"),
    ],
)
def test_what_does_not_fit_is_refused(text, accepted, why):
    with pytest.raises(WrongUnitError, match=why):
        amount(text, accepted)


@pytest.mark.parametrize(
    ("written", "units"),
    [
        ([], Units("kN", whole=True)),  # as fits the sizes of the problem
        ([3.0, "30 deg"], Units("kN", whole=True)),
        (["20 kPa", "18 kN/m3", "2 MPa"], Units("kN", whole=True)),
        (["250 N/mm2", "1 MPa"], Units("MN", whole=True)),
        (["250 N/mm2", "1 MPa", "3 kN"], Units("kN", own_stress="MPa", whole=True)),
        (["5 Pa"], Units("N", whole=True)),
        (["20 kPa", "2 m", "300 mm", 4.0], Units("kN", whole=True)),  # 4 is in m
        (["20 kPa", "2 m", "300 mm", "200 mm", 0.0], Units("kN", "mm", whole=True)),  # 0 in none
        (["2 ksf", "3 ft", "110 pcf"], Units("lbf", "ft", "ksf", whole=True)),
        (["36 ksi", "3 ft", "12 in", "8 in"], Units("kip", "in", whole=True)),
        (["2 klf", "50 kip ft"], Units("kip", whole=True)),
    ],
)
def test_answers_are_told_as_a_file_is_written(written, units):
    assert chosen(map(_read, written), [20000.0], {}) == units


def test_units_that_are_asked_for_have_the_last_word():
    amounts = [_read(own) for own in ("20 kPa", "3 m", "18 kN/m3")]
    asked = {"length": "mm", "stress": "MPa"}
    assert chosen(amounts, [], asked) == Units("kN", "mm", "MPa", whole=True)


def _read(given):
    """As a file that asks for any of these units reads it."""
    if not isinstance(given, str):
        return Amount(given, given, "m")
    return amount(given, ("deg",) if "deg" in given else ("m", "Pa", "N/m", "N/m^3", "N", "N m"))
