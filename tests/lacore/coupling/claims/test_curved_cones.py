"""Loads that friction in three dimensions or soil locks: closed forms of when, and their proof."""

from dataclasses import replace
from math import cos, hypot, radians, sin, tan

import numpy as np
import pytest

import lacore as la
from lacore.coupling.claims import proving
from lacore.reporting.status import Status

ROUND_OFF = 1e-12  # of all forces, and of the largest stress
HALF, TILT = 0.6, np.arctan(0.75)  # rad: half the opening of a groove, and its slope


def wedge(friction, half=HALF, tilt=TILT):
    """A unit prism in a groove that descends by `tilt`, whose faces are `half` from its plane."""
    up, side = np.array([0, sin(tilt), cos(tilt)]), np.array([1.0, 0, 0])
    line = np.array([0, cos(tilt), -sin(tilt)])
    normals = [tuple(s * cos(half) * side + sin(half) * up) for s in (1, -1)]
    d = [-s * sin(half) * side + cos(half) * up for s in (1, -1)]
    corners = np.array([0 * up, d[0], d[1], line, line + d[0], line + d[1]])
    faces = [(0, 1, 2), (3, 5, 4), (0, 3, 4, 1), (0, 2, 5, 3), (1, 4, 5, 2)]
    block = la.Polyhedron(corners, faces)

    def on(normal):
        return lambda x: np.abs(np.tensordot(normal, x, 1)) < 1e-9

    return la.Problem(
        {"w": la.BlockAssembly3D({"w": block}, friction)},
        [la.BodyForce("w", tuple(line))],
        dead_loads=[la.BodyForce("w", (0, 0, -1))],
        interfaces=[
            la.Interface(("w", on(n)), la.RigidObstacle((0, 0, 0), n), friction) for n in normals
        ],
    )


@pytest.mark.parametrize("half", [0.3, HALF, 0.9])
@pytest.mark.parametrize("share", [0.9, 0.999, 1.001, 1.01, 1.5])
def test_associated_friction_locks_a_wedge_from_the_slope_of_its_faces_on(half, share):
    """Slip by 1 along and z off the bottom: ``z sin a >= mu sqrt(1 + (z cos a)^2)``, mu < tan a."""
    state = la.solve(wedge(share * tan(half), half), coupling="associated")
    assert state.status is (Status.LOCKED if share > 1 else Status.SOLVED)
    if share > 1:
        assert max(state.ray.residual, state.ray.beyond) <= ROUND_OFF


@pytest.mark.parametrize(
    ("highest", "proven"), [(0.685, True), (0.691, False), (1.5, True), (1.5, False)]
)
def test_the_limiting_friction_of_a_wedge_does_not_depend_on_the_range(
    highest, proven, monkeypatch
):
    """``T sin(a)/sqrt(1 + (T cos(a))^2)`` for the slope T, whatever the solve at the upper end.

    Lateral friction g on both faces adds to N: ``N sin(a) = c + g cos(a)``, ``mu N = |(s, g)|``
    with the halves s and c of the weight along the groove and off it; g is where mu is least.
    """
    if not proven:
        monkeypatch.setattr(proving, "locking_ray", lambda *given: None)
    exact = 0.75 * sin(HALF) / hypot(1.0, 0.75 * cos(HALF))
    assert exact == pytest.approx(0.360079, abs=1e-6)
    found = la.limit_thickness(wedge, (0.3, highest), tolerance=1e-3)
    assert found.low < exact < found.high


def sand(friction_angle, cells=1, space="p2-vertex"):
    """Sand at a slope of 1 in 2 on a layer of it, under its own weight only."""
    parts = [
        la.meshes.Patch([(0, -5), (40, -5), (40, 0), (0, 0)], 5 * cells, cells),
        la.meshes.Patch([(0, 0), (40, 0), (40, 10), (20, 10)], 5 * cells, 2 * cells),
    ]
    soil = la.Body(la.meshes.patches(parts), la.MohrCoulomb(100, friction_angle), space=space)
    return la.Problem(
        {"s": soil},
        [la.BodyForce("s", (0, -19.5e3))],
        [la.Fix("s", "bottom"), la.Fix("s", "left", "x"), la.Fix("s", "right", "x")],
    )


@pytest.mark.parametrize(
    ("angle", "cells", "space"),
    [
        (38, 1, "p2-vertex"),
        (38, 1, "p2-disc"),
        (32, 1, "p2-vertex"),
        pytest.param(38, 4, "p2-vertex", marks=pytest.mark.slow),
    ],
)
def test_no_weight_brings_down_sand_above_its_slope(angle, cells, space):
    """Sand locks where ``tan(phi) > 1/2``; its stresses are in ``q <= -sin(phi) P``."""
    state = la.solve(sand(angle, cells, space))
    assert state.status is Status.LOCKED
    assert max(state.ray.residual, state.ray.beyond) <= ROUND_OFF
    stress = replace(state, point=state.ray.point).effective_stress["s"]
    xx, yy, _, xy = np.moveaxis(stress, -1, 0)
    beyond = np.hypot((xx - yy) / 2, xy) + sin(radians(angle)) * (xx + yy) / 2
    assert beyond.max() <= ROUND_OFF * np.abs(stress).max()


def test_a_weight_brings_down_sand_below_its_slope():
    state = la.solve(sand(20, cells=2))
    assert state.status is Status.SOLVED
    assert state.load_factor > 0
