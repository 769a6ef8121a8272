"""Sizes are told in one choice of units."""

import pytest

from lacore.reporting.units import Units, fitting


@pytest.mark.parametrize(
    ("units", "framed", "text", "told"),
    [
        (Units("kN"), False, "pressure 10000 Pa on fill.top", "pressure 10 kPa on fill.top"),
        (Units("kN"), False, "(0, -18000) N/m^3 in ground", "(0, -18) kN/m^3 in ground"),
        (Units("kN"), False, "k = 1e+04 to 1.6e+04 Pa", "k = 10 to 16 kPa"),
        (Units("MN"), False, "576 triangles, k = 1.443e+08 Pa", "576 triangles, k = 144.3 MPa"),
        (Units("kN"), True, "(0, -1e5) N/m at (3, 4) of f", "(0, -100) kN/m at (3, 4) of f"),
        (Units("kN", whole=True), True, "(0, -1e5) N/m at (3, 4)", "(0, -100) kN at (3, 4)"),
        (Units("kN", whole=True), False, "(0, -1e5) N/m at (3, 4)", "(0, -100) kN/m at (3, 4)"),
        (Units("kN"), False, "c2000 Pa, 5 Pascal, 7 N2, 3 m", "c2000 Pa, 5 Pascal, 7 N2, 3 m"),
        (Units(), False, "-0.5 Pa", "-0.5 Pa"),
        (Units(length="mm"), False, "at (3, 0.04) m, 2 m2", "at (3000, 40) mm, 2 m2"),
        (Units(length="cm"), False, "(x = -inf to 1 m, y = 0 m)", "(x = -inf to 100 cm, y = 0 cm)"),
        (
            Units(length="mm"),
            False,
            "(from (0, 1) to (2, 3) m)",
            "(from (0, 1000) to (2000, 3000) mm)",
        ),
        (Units("kN"), False, "(varies, -18000) N/m^3", "(varies, -18) kN/m^3"),
        (Units("kip", "ft"), False, "1e6 Pa, 0.3048 m", "20.88543 ksf, 1 ft"),
    ],
)
def test_texts_are_rewritten(units, framed, text, told):
    assert units.rewritten(text, framed) == told


def test_sizes_have_labels():
    assert Units("kN").told(20e3, "Pa") == "20 kPa"
    assert Units("kN", whole=True).told(120e3, "N", framed=True) == "120 kN m"
    assert Units("MN").label("N/m") == "MN/m"
    assert Units("MN", "mm").label("N/m^3") == "MN/m^3"
    assert Units("kN", "mm", "MPa").told(235e6, "Pa") == "235 MPa"
    assert Units("kip", "in").label("Pa") == "ksi"
    assert Units("kN").label("deg") == "deg"
    assert Units(length="mm").place(0.52, -0.0736) == "(520, -73.6) mm"


@pytest.mark.parametrize(
    ("unit", "framed", "units", "size"),  # by the pound of 0.45359237 kg and g = 9.80665 m/s2
    [
        ("N", False, Units("lbf"), 0.45359237 * 9.80665),
        ("Pa", False, Units("lbf", "in"), 0.45359237 * 9.80665 / 0.0254**2),
        ("N/m^3", False, Units("kip", "ft"), 453.59237 * 9.80665 / 0.3048**3),
        ("Pa/m", False, Units("kip", "ft"), 453.59237 * 9.80665 / 0.3048**3),
        ("N", True, Units("kip", "ft", whole=True), 453.59237 * 9.80665 * 0.3048),
        ("N/m", True, Units("kip", "ft", whole=True), 453.59237 * 9.80665),
    ],
)
def test_units_have_sizes(unit, framed, units, size):
    assert units.size(unit, framed) == pytest.approx(size, rel=1e-12)  # 14 digits of a product


@pytest.mark.parametrize(
    ("texts", "force"),
    [
        ([], "N"),
        (["nothing", "0 Pa"], "N"),
        (["1 Pa", "(0, 3) N/m"], "N"),
        (["k = 2e+04 Pa", "(0, -18000) N/m^3"], "kN"),
        (["1000000 Pa", "k = 1.443e+08 Pa", "3 m"], "MN"),
        (["900 kPa is text, 900 Pa is not"], "N"),  # three digits before the point, not .9 kPa
        (["999000 N/m"], "kN"),
        (["1e20 Pa"], "MN"),
        (["1e-20 Pa"], "N"),
    ],
)
def test_the_unit_of_forces_fits_most(texts, force):
    assert fitting(texts) == force
