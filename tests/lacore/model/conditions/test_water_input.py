"""What is no water is refused, with its field, its value and a fix."""

import pickle

import numpy as np
import pytest

import lacore as la
from lacore.paths.stage import staged
from tests.lacore.models import square

SOIL = la.MohrCoulomb(1.0, 30)
TABLE = la.WaterTable(0.5, 1.0)


def ground(load, kinematics="plane_strain", **more):
    mesh = la.meshes.rectangle((0, 1), (0, 1), 2, 2)
    return la.Problem(
        bodies={"soil": la.Body(mesh, SOIL, kinematics)},
        supports=[la.Fix("soil", "bottom")],
        reference_loads=[la.Pressure("soil", "top")],
        dead_loads=[load],
        **more,
    )


def stacked():
    """Two blocks, the lower one with water."""
    bodies = {
        "soil": la.Body(la.meshes.rectangle((0, 1), (0, 1), 1, 1), SOIL),
        "block": la.Body(la.meshes.rectangle((0, 1), (1, 2), 1, 1), SOIL),
    }
    return la.Problem(
        bodies=bodies,
        supports=[la.Fix("soil", "bottom")],
        interfaces=[la.Interface(("block", "bottom"), ("soil", "top"), 0.3)],
        reference_loads=[la.Pressure("block", "top")],
        dead_loads=[la.PorePressure("soil", 1.0)],
    )


def squared(x, y):
    return x * y


@pytest.mark.parametrize(
    ("given", "field", "fix"),
    [
        (lambda: la.WaterTable(np.nan), "WaterTable.height", "give the y"),
        (lambda: la.WaterTable(1.0, -9.81e3), "WaterTable.unit_weight", "> 0"),
        (lambda: la.PorePressure("soil", -5.0), "PorePressure.pressure = -5", "np.maximum"),
        (lambda: la.PorePressure("soil", [1.0, -5.0]), "pressure = -5", "cohesion"),
        (lambda: la.PorePressure("soil", np.nan), "PorePressure.pressure = nan", "WaterTable"),
        (lambda: la.PorePressure("soil", [1.0, np.inf]), "pressure = .*inf", "finite"),
        (lambda: la.PorePressure("soil", "hydrostatic"), "PorePressure.pressure", "WaterTable"),
        (lambda: la.PorePressure("soil", ["a"]), "PorePressure.pressure", "in Pa"),
        (lambda: la.PorePressure("soil", 1e80), "PorePressure.pressure", "other units"),
        (lambda: la.StandingWater("soil", "top", 5.0), "StandingWater.pressure", "lacore.Pressure"),
        (lambda: ground(la.PorePressure("soil", [1.0, 2.0])), r"dead_loads\[0\].pressure", "13 pl"),
        (lambda: ground(la.PorePressure("soil", lambda x: -x[1])), "pressure = -1", "suction"),
        (lambda: ground(la.PorePressure("soil", lambda x: x * np.nan)), "pressure", "13 places"),
        (lambda: ground(la.PorePressure("soil", lambda x: 0 / x[0])), "nan", "finite"),
        (lambda: ground(la.PorePressure("soil", squared)), "fails", r"rows are x\[0\] and x\[1\]"),
        (lambda: ground(la.PorePressure("sand", TABLE)), "no such body", "did you mean|soil"),
        (lambda: ground(la.PorePressure("soil", TABLE), "plane_stress"), "plane stress", "strain"),
        (lambda: ground(la.PorePressure("soil", la.WaterTable(0.4))), "0.4", "y = 0 and 0.5 are"),
        (lambda: ground(la.StandingWater("soil", "left", la.WaterTable(0.4))), "0.4", "y = 0 and"),
        (lambda: ground(la.StandingWater("soil", "botom", TABLE)), "where", "did you mean"),
        (lambda: stacked(), r"dead_loads\[0\].body", "give the interface lacore.STICK"),
    ],
)
@pytest.mark.filterwarnings("ignore:invalid value")
def test_wrong_water(given, field, fix):
    with pytest.raises(la.InputError, match=field) as caught:
        given()
    assert caught.match(fix)


@pytest.mark.parametrize(
    "load", [la.PorePressure("rigid", 1.0), la.StandingWater("rigid", "0", TABLE)]
)
@pytest.mark.parametrize(
    "body",
    [
        la.RigidBlock([(0, 0), (1, 0), (1, 1), (0, 1)]),
        la.Frame({"A": (0, 0), "B": (0, 1)}, [("A", "B")], plastic_moment=1.0),
    ],
)
def test_rigid_bodies_take_none(body, load):
    push = la.PointForce("rigid", "B" if isinstance(body, la.Frame) else (0, 0), (1, 0))
    with pytest.raises(la.InputError, match="rigid"):
        la.Problem({"rigid": body}, [push], dead_loads=[load])


def test_a_path_takes_none():
    problem = la.Problem(
        bodies={"block": square()},
        supports=[la.Fix("block", "bottom", "y")],
        reference_loads=[la.Pressure("block", "top")],
        dead_loads=[la.PorePressure("block", 1.0)],
    )
    with pytest.raises(la.InputError, match="flows far"):
        staged(problem, [])


def test_water_in_a_sentence():
    told = [
        la.PorePressure("soil", TABLE).told,
        la.PorePressure("soil", [1.0, 3.0]).told,
        la.PorePressure("soil", 2.0).told,
        la.StandingWater("soil", "bed", lambda x: x[0]).told,
    ]
    assert told == [
        "water at rest below y = 0.5 m in the pores of soil",
        "water of up to 3 Pa in the pores of soil",
        "water of 2 Pa in the pores of soil",
        "water pressure of a function on soil.bed",
    ]


def test_water_goes_to_other_processes():
    for load in (la.PorePressure("soil", [1.0, 2.0]), la.StandingWater("soil", "bed", TABLE)):
        assert pickle.loads(pickle.dumps(load)) == load
        assert hash(load) == hash(pickle.loads(pickle.dumps(load)))


def test_no_water_table_is_below_all_of_the_body():
    """A dry body, as in a sweep of its height."""
    load = la.PorePressure("soil", la.WaterTable(-3.0))
    assert not la.discretise(ground(load)).full.dead_load.any()
