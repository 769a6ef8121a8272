"""Numbers with units become SI; what does not fit is said."""

import pytest

from lacore.files.problem.units import WrongUnitError, in_units, stated_prefix


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
        ("1 kip/ft", ("N/m",), 14593.902937206),  # 4448.2216152605 N over 0.3048 m
    ],
)
def test_amounts_are_converted(text, accepted, value):
    # A factor of pint's is rounded once, and the number to 14 digits.
    assert in_units(text, accepted) == pytest.approx(value, rel=1e-13)


@pytest.mark.parametrize(
    ("text", "accepted", "why"),
    [
        ("20 kN/m3", ("Pa",), "does not fit: this is in Pa"),
        ("2 t/m3", ("N/m^3",), "does not fit"),
        ("20", ("Pa",), "without its unit"),
        ("20 blub", ("Pa",), "no unit that is known"),
        ("kPa", ("Pa",), "not a number"),
        ("1e400 Pa", ("Pa",), "no finite number"),
        ("9**9**9 m", ("m",), "no unit"),
        ("1 m^9^9", ("m",), "no unit"),
        ("1 m^99", ("m",), "no unit"),
        ("1 __import__('os')", ("m",), "no unit"),
        ("30 Pa", ("deg",), "no unit of angles"),
        ("0.5", (), "a text in place of a number"),
    ],
)
def test_what_does_not_fit_is_refused(text, accepted, why):
    with pytest.raises(WrongUnitError, match=why):
        in_units(text, accepted)


@pytest.mark.parametrize(
    ("data", "prefix"),
    [
        ({}, None),
        ({"a": 3, "title": "2 kN wall", "b": ["3 m", "30 deg", "5 blub"]}, None),
        ({"a": {"b": ["20 kPa", {"c": "18 kN/m3"}]}, "d": "2 MPa"}, "k"),
        ({"a": ["250 N/mm2", "1 MPa"], "b": "3 kN"}, "M"),
        ({"a": "1 kip/ft"}, None),
        ({"a": "5 Pa"}, ""),
    ],
)
def test_what_a_file_states_most_is_told_in(data, prefix):
    assert stated_prefix(data) == prefix
