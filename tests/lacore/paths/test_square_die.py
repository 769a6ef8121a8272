"""Extrusion of half of a bar through a square die, with tools and new meshes, to the steady state.

Without friction the pressure on the billet is ``k (1 + pi/2)`` at a reduction of 1/2 (Hill). A dead
zone fills the corner between container and die; the velocity jumps along its edge, along the arc
of a fan about the corner of the die, and where the bar leaves the fan.
"""

from math import pi

import numpy as np
import pytest
import shapely
from skfem import MeshTri

import lacore as la
from lacore.paths.ending import Ending
from tests.lacore.paths.test_path_remesh import require_gmsh
from tests.verification.cases.test_sheet_drawing import assert_balanced

EXACT = 1 + pi / 2  # per k and half of the height of the billet, which are 1
LENGTH, BEYOND, FAR = 1.2, 0.2, 5.0  # m
SIDES = {
    "axis": lambda x: x[1] < 1e-9,
    "ram": lambda x: x[0] < 1e-9 - LENGTH,
    "wall": lambda x: x[1] > 1 - 1e-9,
    "face": lambda x: (abs(x[0]) < 1e-9) & (x[1] > 0.5),
    "free": lambda x: (abs(x[1] - 0.5) < 1e-9) & (x[0] > 0),
}


def billet(least):
    """Elements of a least size where the velocity jumps, and larger ones elsewhere."""
    angle = np.radians(np.linspace(135, 225, 41))
    arc = np.stack([0.0 + np.cos(angle) / np.sqrt(2), 0.5 + np.sin(angle) / np.sqrt(2)], axis=1)
    jumps = shapely.LineString([(0, 0.5), *arc, (0, 0.5)])

    def size(points):
        away = shapely.distance(jumps, shapely.points(points.T))
        return np.minimum(least + 0.5 * away, 0.2)

    parts = [
        (x, y, nx)
        for x, y, nx in (
            ((-LENGTH, 0), (0, 0.5), 10),
            ((-LENGTH, 0), (0.5, 1), 10),
            ((0, BEYOND), (0, 0.5), 2),
        )
    ]
    patches = [
        la.meshes.Patch([(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])], nx, 4)
        for x, y, nx in parts
    ]
    return la.meshes.remeshed(la.meshes.patches(patches).with_boundaries(SIDES), size)


def steel(mesh, space):
    return {"sheet": la.Body(mesh, la.VonMises(shear_strength=1.0), space=space)}


@pytest.mark.slow
def test_extrusion_through_a_square_die_becomes_steady():
    """An upper bound, too high by the width over which continuous velocities spread the jumps."""
    require_gmsh()
    die = la.shapes.outline(
        [(0, 0.5), (FAR, 0.5), (FAR, 1 + FAR), (-FAR, 1 + FAR), (-FAR, 1), (0, 1)]
    )
    tools = {
        "ram": la.Tool(la.shapes.plane((-LENGTH, 0), (1, 0)), ("sheet", "ram"), (1, 0)),
        "die": la.Tool(die, [("sheet", side) for side in ("wall", "face", "free")]),
    }
    problem = la.Problem(steel(billet(0.1), "p2-gauss"), supports=[la.Fix("sheet", "axis", "y")])
    remesh, until = la.Remeshing(), la.Steady()
    path = la.sequential(problem, 0.12, 24, tools=tools, remesh=remesh, until=until)
    assert path.status is Ending.STEADY, path.message
    assert len(path.later) >= 1
    assert 1 < path.steady().force / EXACT < 1.13
    assert path.history.volume.iloc[-1] == pytest.approx(path.history.volume.iloc[0], rel=1e-4)
    assert_balanced(path)


@pytest.mark.slow
@pytest.mark.parametrize(("least", "continuous"), [(0.1, 0.13), (0.05, 0.07), (0.03, 0.052)])
def test_why_the_load_of_a_path_is_too_high(least, continuous):
    """On the same mesh, velocities that may jump give a load within 2.5 % of the exact one."""
    require_gmsh()
    curved = billet(least)
    straight = MeshTri(curved.p[:, : curved.nvertices], curved.t[:3])
    named = {name: np.asarray(own) for name, own in curved.boundaries.items()}
    loads = {}
    for space in ("p2-gauss", "p2-disc"):
        problem = la.Problem(
            steel(straight.with_boundaries(named), space),
            [la.RigidFooting("sheet", "ram", (1, 0), rough=False)],
            [
                la.Fix("sheet", "axis", "y"),
                la.Fix("sheet", "wall", "y"),
                la.Fix("sheet", "face", "x"),
            ],
        )
        loads[space] = la.solve(problem, backend="clarabel").load_factor / EXACT - 1
    assert 0 < loads["p2-disc"] < 0.025
    assert 0.75 * continuous < loads["p2-gauss"] < continuous
    assert loads["p2-disc"] < 0.25 * loads["p2-gauss"]
