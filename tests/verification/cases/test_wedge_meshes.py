"""Meshes of wedges that indent a body, and the path on those along the slip lines."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import shapely

import lacore as la
from lacore.model.meshes.curved import jacobians
from lacore.paths.ending import Ending
from lacore_verification.cases import wedge_notch
from lacore_verification.cases.shared.wedge_fans import Fan, _contact_end
from lacore_verification.cases.shared.wedge_meshes import (
    DEPTH,
    WIDTH,
    Hill,
    lip_error,
    surface,
)
from lacore_verification.cases.wedge_notch import per_depth

ROUND_OFF = 1e-12
FORCE, LIP, VOLUME = 0.02, 0.03, 1e-6  # required: relative, per depth, relative in a step


def test_the_surface_leaves_the_face_with_the_same_area() -> None:
    """Of an edge that is a parabola: two thirds of the way to its control point."""
    s = np.linspace(0.0, 1.0, 9)[1:, None]
    tip, vertex, control, foot = map(np.array, [(0, -1.0), (0.5, -0.5), (0.8, -0.2), (1.4, -0.1)])
    parabola = (1 - s) ** 2 * vertex + 2 * s * (1 - s) * control + s**2 * foot
    straight = tip + np.linspace(0.0, 1.0, 9)[:-1, None] * (vertex - tip)
    end, lip = _contact_end(np.concatenate([straight, [vertex], parabola]), 45.0)
    assert end == pytest.approx(vertex + (control - vertex) * 2 / 3, rel=ROUND_OFF)
    assert shapely.get_coordinates(lip) == pytest.approx(np.array([end, foot]), rel=ROUND_OFF)


@pytest.mark.parametrize("half_angle", [15.0, 30.0, 45.0])
def test_the_first_mesh_has_the_shape_of_the_solution(half_angle: float) -> None:
    mesh = Fan(half_angle, cells=4, step=0.02).first(0.5)
    assert jacobians(mesh).mean(axis=1).sum() / 2 == pytest.approx(WIDTH * DEPTH, rel=ROUND_OFF)
    tip, end, foot = np.array([0.0, -0.5]), *Hill(half_angle).lip(0.5).T
    exact = shapely.LineString([tip - [0, 0.02], tip, end, foot, (WIDTH, 0.0)])
    assert shapely.distance(shapely.points(surface(mesh)), exact).max() < ROUND_OFF


def test_the_force_on_the_first_mesh() -> None:
    """Of one step, which is solved where it begins."""
    given = stated(30.0, "explicit")
    path = followed(given, 1e-4, 1, 0.0)
    exact = Hill(30).force / 2 * wedge_notch.START
    assert path.history["force"].iloc[0] == pytest.approx(exact, rel=FORCE)


@pytest.mark.slow
def test_friction_is_certified_in_each_step() -> None:
    """Forces per depth lie between those without friction and with a wedge that sticks."""
    given = stated(45.0, "leapfrog")
    smooth, sticking = (per_depth(followed(given, 1e-4, 1, own)) for own in (0.0, la.STICK))
    step = wedge_notch.TRAVEL / given["steps"]
    some, more = (followed(given, 3 * step, 3, own) for own in (0.1, 0.3))
    for path in (some, more):
        assert path.status is Ending.REACHED, path.message
        assert path.history["gap"].max() < 1e-6
    assert smooth.max() < per_depth(some).min()
    assert per_depth(some).max() < per_depth(more).min()
    assert per_depth(more).max() < sticking.min()
    reading = wedge_notch.path(**{**given, "friction": 0.3}).reading
    assert reading is not None
    assert sticking.min() < reading.high * Hill(45).force / 2 < 1.02 * sticking.min()


def stated(half_angle: float, scheme: str) -> dict[str, Any]:
    """Parameters of a smooth wedge."""
    given = {"half_angle": half_angle, "friction": 0.0, "cells": 4, "steps": 40}
    return {**given, "scheme": scheme}


def followed(
    given: Mapping[str, Any], travel: float, steps: int, friction: float | la.Tresca
) -> la.Path:
    """The beginning of the path, with friction."""
    case = wedge_notch.path(**given)
    problem = case.problem(wedge_notch.build(**given))
    tools = {name: replace(tool, friction=friction) for name, tool in case.tools.items()}
    return la.sequential(
        problem, travel, steps, given["scheme"], case.control, tools=tools, remesh=case.remesh
    )


@pytest.mark.slow
@pytest.mark.parametrize("half_angle", [15.0, 30.0, 45.0])
def test_a_wedge_four_times_as_deep_as_its_notch(half_angle: float) -> None:
    """Force over the second half of the path, lip and volume of each step."""
    given = stated(half_angle, "leapfrog")
    assert any(own.parameters == given for own in wedge_notch.CASE.variants)
    case, problem = wedge_notch.path(**given), wedge_notch.build(**given)
    path = la.sequential(
        case.problem(problem),
        case.travel,
        case.steps,
        case.scheme,
        case.control,
        tools=case.tools,
        remesh=case.remesh,
    )
    assert path.status is Ending.REACHED, path.message
    assert len(path.later) == case.steps - 1
    late = path.history[path.history["travel"] >= case.travel / 2]
    exact = Hill(half_angle).force / 2 * (wedge_notch.START + late["travel"])
    assert late["force"].to_numpy() == pytest.approx(exact.to_numpy(), rel=FORCE)
    assert case.reading is not None
    assert lip_error(path, half_angle) <= case.reading.high <= LIP
    volumes = np.concatenate([[WIDTH * DEPTH], path.history["volume"]])
    assert np.abs(np.diff(volumes) / volumes[1:]).max() <= case.volume <= VOLUME
    assert path.history["gap"].max() < 1e-6
