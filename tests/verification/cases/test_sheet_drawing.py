"""Drawing and extrusion: the balance of power at each step, with new meshes too."""

from math import pi

import numpy as np
import pytest

import lacore as la
from lacore_verification.cases import sheet_drawing
from tests.lacore.paths.test_path_remesh import require_gmsh

BALANCE = 1e-6  # of the power of the load


def drawn(process, steps, angle=30.0, **more):
    scheme = "leapfrog"
    problem = sheet_drawing.build(3, process, angle, steps, scheme)
    stated = sheet_drawing.path(process, angle, steps, scheme)
    control, facing = stated.control, stated.approaching
    return la.sequential(problem, stated.travel, steps, scheme, control, approaching=facing, **more)


def assert_balanced(path):
    """The load moves at 1: its power is plastic, but for that of pressures on gaps that close."""
    yield_stress = np.sqrt(3) * sheet_drawing.STRENGTH
    for snapshot in path.snapshots[1:]:
        dofs = path.stage_of(snapshot).dofs_at(snapshot.moment.at)["sheet"]
        plastic = np.sum(dofs.weights * snapshot.strain_rate["sheet"]) * yield_stress
        state = path.state(snapshot.step)
        contact = state.discretisation.full.contact
        closing = np.sum(contact.weights * state.point.normal_reaction * contact.lead)
        load = path.history["load_factor"][snapshot.step - 1]
        assert plastic + closing == pytest.approx(load, rel=BALANCE)


@pytest.mark.parametrize(
    ("process", "angle"), [("drawing", 30.0), ("drawing", 10.0), ("extrusion", 30.0)]
)
def test_power_is_balanced(process, angle):
    assert_balanced(drawn(process, 3, angle))


@pytest.mark.slow
def test_new_meshes_keep_the_balance():
    """Contact with the die is kept: the load stays close to the exact one."""
    require_gmsh()
    path = drawn("drawing", 8, remesh=la.Remeshing(quality=0.6))
    assert path.status.name == "REACHED", path.message
    assert len(path.later) >= 1
    assert_balanced(path)
    exact = sheet_drawing.force("drawing", 30.0)
    assert path.history["force"].iloc[-1] == pytest.approx(exact, rel=0.1)


def test_the_reference():
    """Of a square die the formula has the reduction 2/3."""
    assert sheet_drawing.reduction(90) == pytest.approx(2 / 3)
    assert sheet_drawing.force("extrusion", 90) == pytest.approx(2 * 2 / 3 * (1 + pi / 2))


@pytest.mark.slow
def test_the_load_of_extrusion_is_that_of_the_sheet_as_it_leaves():
    """It leaves thinner than the die: the load is higher by the logarithm of the thickness."""
    given = {"process": "extrusion", "angle": 30.0, "steps": 12, "scheme": "leapfrog"}
    stated = sheet_drawing.path(**given)
    path = la.sequential(
        sheet_drawing.build(8, **given), stated.travel, 12, approaching=stated.approaching
    )
    last = path.snapshots[-1]
    mesh = path.stage_of(last).meshes_at(last.configuration)["sheet"]
    top = np.asarray(mesh.boundaries["top"])
    nodes = np.unique([*mesh.facets[:, top].ravel(), *(mesh.nvertices + top)])
    x, y = mesh.doflocs[:, nodes][:, np.argsort(mesh.doflocs[0, nodes])]
    die, low = sheet_drawing.die_length(30.0), 1 - sheet_drawing.reduction(30.0)
    left = (x > die) & (x < die + stated.travel / low)
    thickness = np.trapezoid(y[left], x[left]) / np.ptp(x[left])
    assert 0.95 * low < thickness < 0.98 * low
    ratio = sheet_drawing.steady_force(path) / sheet_drawing.force("extrusion", 30.0)
    assert ratio == pytest.approx(np.log(thickness) / np.log(low), rel=5e-3)
    assert ratio < 1.05
