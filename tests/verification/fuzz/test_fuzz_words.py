"""Words and existence: what `lacore fuzz` knows of problems that have no number."""

import numpy as np
import pytest

import lacore as la
from lacore_verification.fuzz.checks.existence import carries
from lacore_verification.fuzz.checks.rigid_motions import refuted_words
from lacore_verification.fuzz.drawn.recipe import build

SQUARE = [[1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0]]


def soil(strength=1.0, space="p2-vertex"):
    return {
        "kind": "continuum",
        "mesh": {
            **{"x": [0.0, 3.0], "y": [-1.0, 0.0], "nx": 3, "ny": 1, "cut": "crossed"},
            **{"map": [[1.0, 0.0], [0.0, 1.0]], "shift": [0.0, 0.0]},
        },
        "strength": strength,
        "kinematics": "plane_strain",
        "space": space,
    }


def on_soil(friction, push=(1.0, 0.0), strength=1.0):
    """A stone of weight one that stands on soil, and is pushed."""
    stone = {"kind": "blocks", "polygons": {"s": SQUARE}, "friction": 0.5, "joints": []}
    return {
        "bodies": {"soil": soil(strength), "stone": stone},
        "reference": [{"load": "BodyForce", "body": "stone", "vector": list(push)}],
        "dead": [{"load": "BodyForce", "body": "stone", "vector": [0.0, -1.0]}],
        "supports": [{"body": "soil", "where": "bottom", "components": "xy"}],
        "interfaces": [
            {"slave": ["stone", SQUARE[:2]], "master": ["soil", "top"], "friction": friction}
        ],
    }


def resting(friction, load, supports=()):
    """A continuum on an obstacle below it."""
    return {
        "bodies": {"block": soil()},
        "reference": [{"body": "block", **load}],
        "dead": [],
        "supports": list(supports),
        "interfaces": [{"slave": ["block", "bottom"], "master": None, "friction": friction}],
    }


def refuted(recipe, status):
    return [wrong.check for wrong in refuted_words(recipe, build(recipe), status)]


@pytest.mark.parametrize("friction", ["smooth", 0.3, {"tresca": 0.1}])
def test_what_slides_is_not_locked(friction):
    assert refuted(on_soil(friction), la.Status.LOCKED) == ["word locked"]
    push = {"load": "Traction", "where": "left", "vector": [1.0, 0.0]}
    assert refuted(resting(friction, push), la.Status.LOCKED) == ["word locked"]


def test_what_sticks_is_not_free():
    """Under a guide that keeps it from tilting about a corner, which would cost nothing."""
    push = {"load": "Traction", "where": "left", "vector": [1.0, 0.0]}
    guide = [{"body": "block", "where": "top", "components": "normal"}]
    assert refuted(resting({"tresca": 0.1}, push, guide), la.Status.FREE) == ["word free"]
    assert refuted(resting("stick", push, guide), la.Status.FREE) == ["word free"]
    assert not refuted(resting("smooth", push, guide), la.Status.FREE)
    assert not refuted(resting({"tresca": 0.1}, push), la.Status.FREE)


def test_what_is_pressed_against_an_obstacle_is_neither_free_nor_known_to_move():
    press = {"load": "Pressure", "where": "top", "value": 1.0}
    assert refuted(resting("smooth", press), la.Status.FREE) == ["word free"]
    assert not refuted(resting("smooth", press), la.Status.LOCKED)


def test_what_dead_loads_hold_down_is_not_free():
    """Lifted: it moves as a whole, and takes from the dead load what keeps it."""
    assert refuted(on_soil("smooth", (0.0, 1.0)), la.Status.FREE) == ["word free"]
    assert la.solve(build(on_soil("smooth", (0.0, 1.0)))).load_factor == pytest.approx(1.0)


def test_a_footing_moves_what_is_not_held():
    push = {"load": "RigidFooting", "where": "left", "direction": [1.0, 0.0], "rough": True}
    assert refuted(resting("smooth", push), la.Status.LOCKED) == ["word locked"]
    held = [{"body": "block", "where": "right", "components": "xy"}]
    assert not refuted(resting("smooth", push, held), la.Status.LOCKED)
    assert refuted(resting("smooth", push, held), la.Status.FREE) == ["word free"]


def test_a_stone_on_soil_has_a_load_whatever_the_soil_is_worth():
    rng = np.random.default_rng(0)
    assert carries(on_soil(0.3, strength=1e5), rng)
    hanging = on_soil(0.3)
    hanging["dead"][0]["vector"] = [0.0, 1.0]
    assert carries(hanging, rng) is False  # it falls off, upwards
    assert carries(resting("smooth", {"load": "Pressure", "where": "top"}), rng) is None
