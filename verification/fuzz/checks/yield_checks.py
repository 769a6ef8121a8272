"""Stresses of continua within yield, and the power of plastic flow, from tables of a state."""

from collections.abc import Iterator

import numpy as np

import lacore as la
from lacore.arrays import Floats
from verification.fuzz.checks.power import edges_of
from verification.fuzz.checks.verdict import Wrong, beyond
from verification.fuzz.drawn.recipe import Recipe


def check_yield(recipe: Recipe, problem: la.Problem, state: la.LimitState) -> Iterator[Wrong]:
    """That no stress is beyond the strength, by the formula of each kinematics."""
    for name, stress in state.stress.items():
        data = recipe["bodies"][name]
        shear = shear_stress(stress, data["kinematics"])
        yield from beyond("yield", f"stress of {name!r} beyond", shear - data["strength"],
                          data["strength"])  # fmt: skip
    if len(recipe["reference"]) == 1 and recipe["reference"][0]["load"] == "RigidFooting":
        yield from _check_footing(recipe, problem, state)


def shear_stress(stress: Floats, kinematics: str) -> Floats:
    """What von Mises compares with the strength in shear; stress (..., 4)."""
    xx, yy, zz, xy = np.moveaxis(stress, -1, 0)
    if kinematics == "plane_strain":
        return np.asarray(np.hypot((xx - yy) / 2, xy))
    squares = (xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2
    return np.asarray(np.sqrt(squares / 6 + xy**2))


def _check_footing(recipe: Recipe, problem: la.Problem, state: la.LimitState) -> Iterator[Wrong]:
    """That the forces under a footing come to its load, where nothing else holds its nodes."""
    load = recipe["reference"][0]
    body = problem.bodies[load["body"]]
    assert isinstance(body, la.Body)
    start, end, _ = edges_of(body, load["where"])
    held = [s for s in recipe["supports"] if s["body"] == load["body"]]
    dead = [d for d in recipe["dead"] if d["load"] == "RigidFooting"]
    if held or dead:
        return
    table = state.support_reactions
    own = table[table["body"] == load["body"]]
    length = np.linalg.norm(end - start, axis=0)
    if body.axisymmetric:
        length = length * np.pi * (start[0] + end[0])
    direction = np.array(load["direction"]) / np.hypot(*load["direction"])
    force = own[["force_x", "force_y"]].to_numpy()
    asked = state.load_factor * load.get("pressure", 1.0) * length.sum()
    size = np.hypot(*force.T).sum() + abs(asked)
    yield from beyond("load of a footing", "off by", abs((force @ direction).sum() - asked), size)
