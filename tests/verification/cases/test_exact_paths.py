"""Exact paths (T33): the printed tables, closed forms against quadrature, peaks, forces."""

from math import log, pi, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lacore as la
from lacore.model.materials.hardening import Linear, Perfect, Swift, Table, Voce
from lacore_verification.cases.shared import exact_paths as exact
from lacore_verification.cases.shared.exact_paths import cylinder, sphere

RADII = (1.0, 1.1, 1.25, 1.5, 2.0)
TABLE = [
    (cylinder(Perfect(1.0)), (0.80037742, 0.71986473, 0.61867909, 0.48918765, 0.32309433)),
    (cylinder(Linear(1.0, 1.0)), (0.80037742, 0.76360180, 0.70922800, 0.62493438, 0.48719201)),
    (cylinder(Linear(1.0, 3.0)), (0.80037742, 0.85107593, 0.89032582, 0.89642784, 0.81538736)),
    (
        cylinder(Voce(1.0, 3.0, 2 * sqrt(3))),
        (0.80037742, 0.98952032, 1.09929384, 1.07686593, 0.84668622),
    ),
    (sphere(Perfect(1.0)), (1.38629436, 1.22270197, 1.01504799, 0.74866916, 0.41907244)),
    (sphere(Linear(1.0, 3.0)), (1.38629436, 1.52404517, 1.62339370, 1.61828655, 1.35431148)),
    (sphere(Voce(1.0, 3.0, 3.0)), (1.38629436, 1.73973566, 1.88128810, 1.71957292, 1.14272985)),
]
POINTS = [(shell, a, p) for shell, row in TABLE for a, p in zip(RADII, row, strict=True)]
SHAPES = [cylinder, sphere]

CLOSED = st.one_of(
    st.builds(Perfect, st.floats(0.1, 10)),
    st.builds(Linear, st.floats(0.1, 10), st.floats(0, 30)),
)


@pytest.mark.parametrize(("shell", "bore", "pressure"), POINTS)
def test_printed_values(shell, bore, pressure):
    """Half a unit of the last digit."""
    assert exact.closed_form(shell, bore) == pytest.approx(pressure, abs=0.5001e-8)
    assert exact.quadrature(shell, bore) == pytest.approx(pressure, abs=0.5001e-8)


def ratios(shape):
    return st.builds(shape, CLOSED, st.floats(0.2, 2.0), st.floats(2.1, 8.0))


@given(ratios(cylinder) | ratios(sphere), st.floats(1.0, 3.0))
def test_closed_form_and_quadrature_agree(shell, growth):
    bore = shell.inner * growth
    assert exact.closed_form(shell, bore) == pytest.approx(exact.quadrature(shell, bore), rel=1e-10)


@given(st.sampled_from(SHAPES), st.integers(1, 12), st.floats(1.0, 3.0), st.floats(0, 9))
def test_closed_form_and_quadrature_agree_on_voce(shape, m, growth, rise):
    plain = shape(Perfect(1.0))
    shell = shape(Voce(1.0, 1.0 + rise, m * plain.dimension / plain.factor))
    assert exact.closed_form(shell, growth) == pytest.approx(
        exact.quadrature(shell, growth), rel=1e-10
    )


@pytest.mark.parametrize("shape", SHAPES)
def test_laws_without_a_closed_form_are_integrated(shape):
    """Between laws that have one: Voce of a broken exponent, and a power law of exponent 1."""
    for bore in RADII:
        assert exact.closed_form(shape(Swift(2.0, 0.5, 1.0)), bore) is None
        assert exact.closed_form(shape(Voce(1.0, 3.0, 3.1)), bore) is None
        assert exact.pressure(shape(Swift(2.0, 0.5, 1.0)), bore) == pytest.approx(
            exact.pressure(shape(Linear(1.0, 2.0)), bore), rel=1e-11
        )
        assert exact.pressure(shape(Table([0, 5], [1, 11])), bore) == pytest.approx(
            exact.pressure(shape(Linear(1.0, 2.0)), bore), rel=1e-11
        )


def test_a_table_that_ends_within_the_wall():
    """It bends where it ends: perfect inside r_1, linear outside, each integrated by itself."""
    shell = cylinder(Table([0, 0.2], [1, 2]))
    bore = 1.5
    b, swept = exact.outer_radius(shell, bore), bore**2 - 1
    edge = sqrt(swept / -np.expm1(-0.2 * sqrt(3)))  # where eb = 0.2
    assert bore < edge < b
    outside = cylinder(Linear(1.0, 5.0), sqrt(edge**2 - swept), 2.0)
    by_parts = exact.closed_form(outside, edge) + 2 / sqrt(3) * 2.0 * log(edge / bore)
    assert exact.pressure(shell, bore) == pytest.approx(by_parts, rel=1e-11)


@pytest.mark.parametrize(
    ("law", "radius", "pressure"),
    [
        (Linear(1.0, 3.0), 1.395740, 0.90039319),
        (Voce(1.0, 3.0, 2 * sqrt(3)), 1.329009, 1.11000853),
    ],
)
def test_printed_peaks(law, radius, pressure):
    found = exact.peak(cylinder(law))
    assert found.radius == pytest.approx(radius, abs=0.5001e-6)
    assert found.pressure == pytest.approx(pressure, abs=0.5001e-8)


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize(
    "law",
    [
        Linear(1.0, 3.0),
        Linear(1.0, 100.0),
        Voce(1.0, 3.0, 3.1),
        Swift(2.0, 1e-3, 0.3),
        Table([0, 0.2, 0.5], [1, 2, 2.2]),
    ],
)
def test_no_pressure_is_above_the_peak(shape, law):
    """To ten times the accuracy of the quadrature."""
    shell = shape(law)
    found = exact.peak(shell)
    around = found.radius * np.geomspace(1 / found.radius, 3, 60)
    pressures = [exact.pressure(shell, a) for a in np.maximum(around, 1.0)]
    assert max(pressures) <= found.pressure * (1 + 1e-11)
    assert found.radius > 1
    for side in (1 - 1e-3, 1 + 1e-3):
        assert exact.pressure(shell, found.radius * side) < found.pressure


@pytest.mark.parametrize(("shape", "bar"), [(cylinder, sqrt(3)), (sphere, 1.5)])
def test_weak_hardening_peaks_at_once(shape, bar):
    """Where the initial modulus is at most (n/f) s0."""
    assert exact.peak(shape(Perfect(1.0))).radius == pytest.approx(1.0, abs=0)
    assert exact.peak(shape(Linear(1.0, 0.99 * bar))).radius == pytest.approx(1.0, abs=0)
    assert exact.peak(shape(Linear(1.0, 1.01 * bar))).radius > 1.001


@pytest.mark.parametrize(("late", "low", "high"), [(9.0, 1.0, 1.2), (20.0, 3.0, 5.0)])
def test_the_higher_of_two_peaks_counts(late, low, high):
    """A table that hardens once more: the pressure falls in between, and rises again."""
    shell = cylinder(Table([0, 0.05, 0.9, 1.0, 1.5], [1, 1.5, 1.55, late, late]))
    found = exact.peak(shell)
    assert low < found.radius < high
    assert found.pressure >= max(exact.pressure(shell, a) for a in np.geomspace(1, 6, 60))
    assert exact.pressure(shell, 2.0) < found.pressure


@pytest.mark.parametrize("shape", SHAPES)
def test_geometry(shape):
    shell = shape(Perfect(1.0), 0.5, 1.5)
    n, bore = shell.dimension, 0.8
    b = exact.outer_radius(shell, bore)
    assert b**n - bore**n == pytest.approx(1.5**n - 0.5**n, rel=1e-14)
    ends = exact.strain(shell, bore, np.array([bore, b]))
    expected = shell.factor * np.log([bore / 0.5, b / 1.5])
    assert ends == pytest.approx(expected, rel=1e-13)
    assert exact.bore_strain(shell, bore) == pytest.approx(expected[0], rel=1e-14)


@pytest.mark.parametrize("shape", SHAPES)
def test_the_pressure_does_the_work_that_is_dissipated(shape):
    """int p dV of the bore is the plastic work: of a linear law s0 eb + H eb^2/2 a particle.

    Both integrals by the rule of Gauss on smooth functions: 40 points are round-off.
    """
    shell, end = shape(Linear(1.0, 3.0)), 1.5
    n = shell.dimension
    area = 2 * pi if n == 2 else 4 * pi
    points, weights = np.polynomial.legendre.leggauss(40)
    bores = 1 + (end - 1) * (1 + points) / 2
    work = (end - 1) / 2 * weights @ [exact.pressure(shell, a) * area * a ** (n - 1) for a in bores]
    b = exact.outer_radius(shell, end)
    radii = end + (b - end) * (1 + points) / 2
    eb = exact.strain(shell, end, radii)
    plastic = (b - end) / 2 * weights @ ((eb + 1.5 * eb**2) * area * radii ** (n - 1))
    assert work == pytest.approx(plastic, rel=1e-12)


def test_forces_by_hand():
    law, f = Linear(2.0, 3.0), 2 / sqrt(3)
    assert exact.strip_force(law, 0.5, 4.0) == pytest.approx(f * (2 + 3 * f * log(2)) * 8)
    assert exact.strip_force(law, 2.0, 4.0) == pytest.approx(f * (2 + 3 * f * log(2)) * 2)
    assert exact.bar_force(law, 0.5, 4.0) == pytest.approx((2 + 3 * log(2)) * 8)
    assert exact.strip_force(law, 1.0) == pytest.approx(f * 2.0)


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (lambda: cylinder(Perfect(1.0), 2.0, 1.0), r"Shell.outer = 1.0: not outside .*; give more"),
        (lambda: sphere(Perfect(1.0), 0.0), r"Shell.inner = 0.0: not a positive number; give"),
        (lambda: exact.Shell(Perfect(1.0), 1.0, 2.0, 4), r"Shell.dimension = 4: neither .*; give"),
        (lambda: exact.pressure(cylinder(Perfect(1.0)), 0.9), r"bore = 0.9: smaller than .*; give"),
        (lambda: exact.pressure(cylinder(Perfect(1.0)), np.nan), r"bore = nan: smaller .*; give"),
    ],
)
def test_bad_input(ask, message):
    with pytest.raises(la.InputError, match=message):
        ask()
