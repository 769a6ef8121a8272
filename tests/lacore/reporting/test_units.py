"""Sizes are told in one choice of units."""

import pytest

from lacore.reporting.units import Units, fitting


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
    ("sizes", "force"),
    [
        ([], "N"),
        ([0.0, float("inf"), float("nan")], "N"),
        ([1.0, 0.0, -3.0], "N"),
        ([2e4, -18000.0], "kN"),
        ([1e6, 1.443e8], "MN"),
        ([900.0], "N"),  # three digits before the point, not 0.9 kPa
        ([999000.0], "kN"),
        ([1e20], "MN"),
        ([1e-20], "N"),
    ],
)
def test_the_unit_of_forces_fits_most(sizes, force):
    assert fitting(sizes) == force
