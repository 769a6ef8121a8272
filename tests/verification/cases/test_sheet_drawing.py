"""Drawing and extrusion: the balance of power at each step, with new meshes too."""

from math import pi

import numpy as np
import pytest

import lacore as la
from tests.lacore.paths.test_path_remesh import require_gmsh
from verification.cases import sheet_drawing

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
