"""Polygons in place of yield curves: inside they prove lower bounds, around them upper ones."""

from dataclasses import replace

import pytest

import lacore as la
from lacore.analyses.proven_values import proven

PRESS, HEIGHT = 0.3, 3.0
STRESS = 100.0 / 3.0  # M_p = f b h^2/4 = 1 of b = 1, h = 0.3464
SECTION = {"width": 1.0, "height": 0.12**0.5, "yield_stress": STRESS, "layers": 2}
SQUASH = STRESS * 0.12**0.5
EXACT = (1 - PRESS**2) / HEIGHT
"""A clamped column under N = 0.3 N_p, pushed at its top: M = M_p (1 - (N/N_p)^2)."""


def column(polygon, push=()):
    section = la.sections.rectangle(**SECTION, polygon=polygon)
    frame = la.Frame({"A": (0, 0), "B": (0, HEIGHT)}, [("A", "B")], sections=section)
    dead = [la.PointForce("column", "B", (0, -PRESS * SQUASH)), *push]
    side = la.PointForce("column", "B", (1, 0))
    return la.Problem(
        {"column": frame}, [side], [la.Fix("column", "A", "clamped")], dead_loads=dead
    )


def test_polygons_prove_bounds_of_sections():
    inner, outer = (la.solve(column(side)) for side in ("inner", "outer"))
    assert inner.load_factor < EXACT < outer.load_factor
    assert (inner.rigor, outer.rigor) == (la.Rigor.LOWER, la.Rigor.UPPER)
    assert "strict lower bound" in str(inner)
    assert "strict upper bound" in str(outer)
    for state in (inner, outer):
        low, high = proven(state)
        assert low < EXACT < high
    assert la.upper_bound(column("inner")).rigor is la.Rigor.DISCRETE
    assert la.upper_bound(column("outer")).rigor is la.Rigor.UPPER


def test_a_polygon_that_is_the_yield_surface_is_exact():
    exact = la.sections.polygon([(1, 0), (0, 1), (-1, 0), (0, -1)])
    problem = column("inner")
    frame = replace(problem.bodies["column"], sections=exact)
    dead = [la.PointForce("column", "B", (0, -0.5))]
    state = la.solve(replace(problem, bodies={"column": frame}, dead_loads=dead))
    assert state.rigor is la.Rigor.UPPER
    assert "exact" in str(state)


@pytest.mark.parametrize("polygon", ["inner", "outer"])
@pytest.mark.parametrize(("share", "stands"), [(0.8, True), (1.0, None), (1.2, False)])
def test_stability_of_sections_is_proven_by_the_polygon_on_the_safe_side(polygon, share, stands):
    """Near the exact load the polygon inside collapses and the one around stands: undecided."""
    problem = column(polygon, [la.PointForce("column", "B", (share * EXACT, 0))])
    assert la.stable(problem).stands is stands


def test_a_section_keeps_its_side_in_a_file(tmp_path):
    la.write_problem(column("inner"), tmp_path / "column.toml")
    again = la.solve(la.read_problem(tmp_path / "column.toml"))
    assert again.rigor is la.Rigor.LOWER
    assert again.load_factor == pytest.approx(la.solve(column("inner")).load_factor, rel=1e-12)
