"""Sizes are told in one choice of units."""

import pytest

from lacore.numerics.quantities import Units, fitting


@pytest.mark.parametrize(
    ("units", "framed", "text", "told"),
    [
        (Units("k"), False, "pressure 10000 Pa on fill.top", "pressure 10 kPa on fill.top"),
        (Units("k"), False, "(0, -18000) N/m^3 in ground", "(0, -18) kN/m^3 in ground"),
        (Units("k"), False, "k = 1e+04 to 1.6e+04 Pa", "k = 10 to 16 kPa"),
        (Units("M"), False, "576 triangles, k = 1.443e+08 Pa", "576 triangles, k = 144.3 MPa"),
        (Units("k"), True, "(0, -1e5) N/m at (3, 4) of f", "(0, -100) kN/m at (3, 4) of f"),
        (Units("k", True), True, "(0, -1e5) N/m at (3, 4)", "(0, -100) kN at (3, 4)"),
        (Units("k", True), False, "(0, -1e5) N/m at (3, 4)", "(0, -100) kN/m at (3, 4)"),
        (Units("k"), False, "c2000 Pa, 5 Pascal, 7 N2, 3 m", "c2000 Pa, 5 Pascal, 7 N2, 3 m"),
        (Units(), False, "-0.5 Pa", "-0.5 Pa"),
    ],
)
def test_texts_are_rewritten(units, framed, text, told):
    assert units.rewritten(text, framed) == told


def test_sizes_have_labels():
    assert Units("k").told(20e3, "Pa") == "20 kPa"
    assert Units("k", whole=True).told(120e3, "N", framed=True) == "120 kN m"
    assert Units("M").label("N/m") == "MN/m"


@pytest.mark.parametrize(
    ("texts", "prefix"),
    [
        ([], ""),
        (["nothing", "0 Pa"], ""),
        (["1 Pa", "(0, 3) N/m"], ""),
        (["k = 2e+04 Pa", "(0, -18000) N/m^3"], "k"),
        (["1000000 Pa", "k = 1.443e+08 Pa"], "M"),
        (["1e20 Pa"], "M"),
        (["1e-20 Pa"], ""),
    ],
)
def test_the_prefix_fits_most(texts, prefix):
    assert fitting(texts) == prefix
