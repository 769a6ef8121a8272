"""Bounds of joints that crush meet in closed forms, and enclose cells that are not cut (T95)."""

from math import log, pi, sqrt

import numpy as np
import pytest

import lacore as la
from tests.coulomb_checker_3d import accepts, residuals
from tests.lacore.model.bodies.blocks3d.solids import box
from tests.lacore.whole.test_crushing import PIER, PRESSED, B, H, corner, pier, shaken
from tests.statements_3d import stated

TOLERANCE = 2e-6  # each bound is certified to 1e-6


@pytest.mark.parametrize("stronger", [4.0, 300.0, 1e6])
def test_the_toe_of_a_pier_is_exact_at_any_strength(stronger):
    found = la.crushing_bracket(pier(la.Crushing(stronger * PRESSED, 1)), target_width=1e-6)
    exact = B * (1 - 1 / stronger) / H
    assert found.status is la.Status.SOLVED
    assert found.low == pytest.approx(exact, rel=TOLERANCE)
    assert found.high == pytest.approx(exact, rel=TOLERANCE)


def test_a_corner_that_crushes_on_a_triangle_is_enclosed():
    # As in test_crushing: N = f s^2/2, alpha h/(2 sqrt 2) = b/2 - s/3 about both axes.
    square = {"floor": box((0, 0, -1), (1, 1, 0)), "pier": box((0, 0, 0), (1, 1, 2))}
    law = la.Crushing(2 * 20e3 / (0.5 * 0.6**2), 1)
    own = la.BlockAssembly3D(square, la.Coulomb(5.0), crushing=law)
    way = np.array([1, 1, 0]) / sqrt(2)
    found = la.crushing_bracket(shaken(own, "floor", way), target_width=2e-3)
    exact = sqrt(2) * (0.5 - 0.6 / 3)
    assert found.low <= exact * (1 + TOLERANCE)
    assert found.high >= exact * (1 - TOLERANCE)
    assert found.width <= 2e-3


def test_a_torque_on_a_joint_that_crushes_almost_everywhere_is_enclosed():
    """Pressure is the strength but for a disc about the axis: ``mu f (int r dA - 2 pi R^3/3)``."""
    mu, stronger = 0.5, 1.02
    square = {"floor": box((0, 0, -1), (1, 1, 0)), "block": box((0, 0, 0), (1, 1, 1))}
    own = la.BlockAssembly3D(square, mu, crushing=la.Crushing(stronger, 1))
    couple = [
        la.PointForce("blocks", (0.5, y, 0.5), (way, 0, 0)) for y, way in ((0.0, 1), (1.0, -1))
    ]
    problem = la.Problem(
        bodies={"blocks": own},
        supports=[la.Fix("blocks", "floor")],
        dead_loads=[la.BodyForce("blocks", (0, 0, -1))],
        reference_loads=couple,
    )
    found = la.crushing_bracket(problem, target_width=0.02)
    radius = sqrt((1 - 1 / stronger) / pi)
    whole = (sqrt(2) + log(1 + sqrt(2))) / 6
    exact = mu * stronger * (whole - 2 * pi * radius**3 / 3)
    assert found.low <= exact <= found.high
    assert found.width <= 0.02


@pytest.mark.slow
def test_bounds_enclose_what_cells_that_are_not_cut_carry():
    law = la.Crushing(3e4, 1)
    found = la.crushing_bracket(corner(law), target_width=0.01)
    assert found.status is la.Status.SOLVED
    assert found.width <= 0.01
    for side, sign in (("below", 1), ("above", -1)):
        fixed = corner(la.Crushing(3e4, 3, side=side))
        load = la.solve(fixed, coupling="associated", throw=True).load_factor
        assert sign * load <= sign * (found.high if sign > 0 else found.low) + TOLERANCE

    state = la.solve(found.problem, throw=True)  # a Coulomb state in the cells of the last round
    s = stated(found.problem, state)
    assert accepts(s), residuals(s)
    assert state.load_factor <= found.high + TOLERANCE

    area = la.BlockAssembly3D(found.problem.bodies["blocks"].polyhedra, 0.6).joints.area
    joints = found.problem.bodies["blocks"].joints
    # Nothing of a joint is lost where cells are cut, but for round-off of its corners.
    assert np.bincount(joints.joint, joints.weight) == pytest.approx(area, rel=1e-9)


def test_a_weight_that_crushes_its_joint_is_unsafe():
    found = la.crushing_bracket(pier(la.Crushing(0.9 * PRESSED, 1)))
    assert found.status is la.Status.UNSAFE
    assert np.isnan([found.low, found.high]).all()
    assert len(found.rounds) == 1


def test_what_does_not_crush_is_refused():
    with pytest.raises(la.InputError, match="crushes"):
        la.crushing_bracket(shaken(la.BlockAssembly3D(PIER, 0.5), "floor"))


@pytest.mark.parametrize(("lean", "stands"), [(0.25, True), (0.45, False)])
def test_dead_loads_that_crush_cells_need_not_crush_their_joint(lean, stands):
    """A pier of 0.4 m x 0.2 m x 1 m: its weight, off by lean/2, may be off by (0.4 m - 0.08 m)/2.

    Of one cell a corner it crushes some at 0.2 m/2.
    """
    stone = {"block": (0.4, 0.2, 1.0), "crushing": la.Crushing(1e5, divisions=1)}
    problem = la.Problem(
        {"pier": la.masonry3d.wall([[1]], friction=0.7, **stone)},
        [la.BodyForce("pier", (0, 20e3, 0))],
        [la.Fix("pier", "base")],
        dead_loads=[la.BodyForce("pier", (lean * 20e3, 0, -20e3))],
    )
    state = la.solve(problem)
    assert state.status is la.Status.UNSAFE
    assert "cells of joints that crush" in state.message
    assert "cells of joints that crush" in str(state.stability())
    found = la.stable(problem)
    assert found.stands is (None if stands else False)
    once = la.crushing_bracket(problem, rounds=1)
    assert once.status is (la.Status.NOT_CERTIFIED if stands else la.Status.UNSAFE)
