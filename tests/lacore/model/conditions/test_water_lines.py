"""Piezometric lines, water tables that nearly meet vertices, and several boundaries at once."""

from itertools import pairwise

import numpy as np
import pytest

import lacore as la
from lacore.reporting.kinds import Kind

MESH = la.meshes.rectangle((0, 4), (-2, 0), 4, 4)
WEIGHT = 10e3


def strip(*dead, sides=("left", "right")):
    return la.Problem(
        {"soil": la.Body(MESH, la.MohrCoulomb(cohesion=10e3, friction_angle=20))},
        [la.Pressure("soil", la.Within(x=(0, 1), y=0), 1e3)],
        [la.Fix("soil", sides, "x"), la.Fix("soil", "bottom")],
        dead_loads=[la.BodyForce("soil", (0, -20e3)), *dead],
    )


def solved(*dead):
    return la.solve(strip(*dead))


def test_a_level_line_is_a_water_table():
    """Along a row of vertices both are the same pressure."""
    table = la.PorePressure("soil", la.WaterTable(-0.5, WEIGHT))
    line = la.PorePressure("soil", la.PiezometricLine([(0, -0.5), (1, -0.5)], WEIGHT))
    # Certified to 1e-6 each.
    assert solved(line).load_factor == pytest.approx(solved(table).load_factor, rel=5e-6)


def test_pressure_below_a_sloping_line():
    line = la.PiezometricLine([(0, 4), (10, 2), (12, 2)], WEIGHT)
    x = np.array([[-1, 0, 5, 11, 20, 5], [0, 1, 0, 0, 1, 3.5]])
    assert line(x) == pytest.approx(WEIGHT * np.array([4, 3, 3, 2, 1, 0]))


@pytest.mark.parametrize(
    "points", [[(0, 1)], [(0, 1), (0, 2)], [(1, 0), (0, 0)], [(0, np.nan), (1, 0)], [1, 2], "no"]
)
def test_lines_that_are_none(points):
    with pytest.raises(la.InputError, match=r"PiezometricLine\.points"):
        la.PiezometricLine(points)


@pytest.mark.parametrize(("off", "moved"), [(0.0, False), (2e-4, True), (-2e-4, True)])
def test_a_table_that_nearly_meets_vertices_lies_on_them(off, moved):
    """Two tenths of a millimetre are within 1e-4 of the size of 4.5 m."""
    table = la.WaterTable(-0.5 + off, WEIGHT)
    state = solved(la.PorePressure("soil", table))
    exact = solved(la.PorePressure("soil", la.WaterTable(-0.5, WEIGHT)))
    assert state.load_factor == pytest.approx(exact.load_factor, rel=5e-6)
    assert any(own.kind is Kind.TABLE_SNAPPED for own in state.findings) == moved


def test_a_table_through_elements_is_rejected():
    with pytest.raises(la.InputError, match="passes through"):
        strip(la.PorePressure("soil", la.WaterTable(-0.51, WEIGHT)))


def test_several_boundaries_are_one_support():
    one = la.solve(strip()).load_factor
    stated = la.Problem(
        strip().bodies,
        strip().reference_loads,
        [*(la.Fix("soil", side, "x") for side in ("left", "right")), la.Fix("soil", "bottom")],
        dead_loads=strip().dead_loads,
    )
    assert one == pytest.approx(la.solve(stated).load_factor, rel=5e-6)
    with pytest.raises(la.InputError, match=r"where\[1\].*'rihgt'.*right"):
        strip(sides=("left", "rihgt"))


def test_a_surveyed_surface_of_patches_is_exact():
    """Small turns to the same side look like an arc, and are meant as they are given."""
    tops = [(0, 0), (1, 0.10), (2, 0.18), (3, 0.24), (4, 0.28), (5, 0.3)]
    parts = [
        la.meshes.Patch([(a, -1), (c, -1), (c, d), (a, b)], nx=1, ny=1)
        for (a, b), (c, d) in pairwise(tops)
    ]
    mesh = la.meshes.patches(parts)
    assert la.Body(mesh, la.VonMises(1.0)).geometry == "exact"
    assert la.Body(mesh, la.VonMises(1.0), geometry="approximated").geometry == "approximated"
