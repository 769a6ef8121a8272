"""Random paths of two deformable bodies, and of rigid tools that move.

A recipe with a ``fact`` has a load in closed form, see
`lacore_verification.fuzz.checks.path_facts`; only its meshes may be reduced.
"""

from typing import Any

import numpy as np

from lacore_verification.fuzz.drawn.draw import Rng, chosen, law, number
from lacore_verification.fuzz.drawn.recipe import Recipe

_SPACES = ("p2-gauss", "q2")
_MIDPOINT = "implicit-midpoint"


def _body(
    rng: Rng, x: tuple[float, float], y: tuple[float, float], strength: float, hardening: float
) -> dict[str, Any]:
    space = chosen(rng, _SPACES)
    cut = "quads" if space == "q2" else chosen(rng, ("crossed", "diagonal"))
    return {
        "kind": "continuum",
        "mesh": {
            "x": list(x),
            "y": list(y),
            "nx": int(rng.integers(1, 4)),
            "ny": int(rng.integers(1, 3)),
            "cut": cut,
            "map": [[1.0, 0.0], [0.0, 1.0]],
            "shift": [0.0, 0.0],
        },
        "strength": strength,
        "hardening": hardening,
        "kinematics": "plane_strain",
        "space": space,
    }


def _pair(rng: Rng, slave: list[str], master: list[str], friction: Any) -> dict[str, Any]:
    if rng.random() < 0.5:
        slave, master = master, slave
    return {"slave": slave, "master": master, "friction": friction}


def _fix(body: str, where: str, components: str = "normal") -> dict[str, Any]:
    return {"body": body, "where": where, "components": components}


def _footing(body: str, where: str, direction: list[float]) -> dict[str, Any]:
    return {"load": "RigidFooting", "body": body, "where": where, "direction": direction,
            "rough": False}  # fmt: skip


def pairs(rng: Rng) -> Recipe:
    """Return two deformable bodies.

    A stack, a narrow block on a wide one, a sled, or a weak one.
    """
    return chosen(rng, (_stack, _narrow, _sled, _yielding))(rng)  # type: ignore[no-any-return]


def _stack(rng: Rng) -> Recipe:
    """Return two blocks of one material and width, with any friction between them."""
    width, low, high = number(rng, 0.5, 2.0), number(rng, 0.3, 1.0), number(rng, 0.3, 1.0)
    metal = number(rng, 0.5, 2.0), number(rng, 0.2, 2.0)
    friction = law(rng, metal[0])
    if isinstance(friction, dict) and "associated" in friction:
        friction = friction["associated"]
    return {
        "bodies": {
            "lower": _body(rng, (0.0, width), (0.0, low), *metal),
            "upper": _body(rng, (0.0, width), (low, low + high), *metal),
        },
        "reference": [_footing("upper", "top", [0.0, -1.0])],
        "dead": [],
        "supports": [_fix("lower", "bottom"), _fix("lower", "left"), _fix("upper", "left")],
        "interfaces": [_pair(rng, ["upper", "bottom"], ["lower", "top"], friction)],
        "path": _steps(rng, (low + high) * number(rng, 0.02, 0.1)),
        "fact": "stack",
    }


def _narrow(rng: Rng) -> Recipe:
    """Return a soft block on a wide strong one, smooth: only the soft one flows."""
    width, low, high = number(rng, 0.5, 1.5), number(rng, 0.3, 1.0), number(rng, 0.3, 1.0)
    strength, hardening = number(rng, 0.5, 1.0), number(rng, 0.1, 1.0)
    wide = width * number(rng, 1.3, 2.0)
    return {
        "bodies": {
            "lower": _body(rng, (0.0, wide), (0.0, low), number(rng, 2.0, 4.0), hardening),
            "upper": _body(rng, (0.0, width), (low, low + high), strength, hardening),
        },
        "reference": [_footing("upper", "top", [0.0, -1.0])],
        "dead": [],
        "supports": [_fix("lower", "bottom"), _fix("lower", "left"), _fix("upper", "left")],
        "interfaces": [_pair(rng, ["upper", "bottom"], ["lower", "top"], "smooth")],
        "path": _steps(rng, high * number(rng, 0.02, 0.1)),
        "fact": "narrow",
    }


def _sled(rng: Rng) -> Recipe:
    """Return a strong block under pressure that is pushed along a wide one."""
    recipe = _yielding(rng)
    for body in recipe["bodies"].values():
        body["strength"] = number(rng, 5.0, 20.0)
    (pair,) = recipe["interfaces"]
    pair["friction"] = number(rng, 0.05, 0.8)
    recipe["path"]["travel"] = number(rng, 0.1, 0.8)
    recipe["fact"] = "sled"
    return recipe


def _yielding(rng: Rng) -> Recipe:
    """Return such a block of any strength: it slides, shears, or both."""
    left, long = number(rng, 0.0, 0.5), number(rng, 0.6, 1.5)
    strength = number(rng, 0.5, 2.0)
    friction = law(rng, strength)
    if isinstance(friction, dict) and "associated" in friction:
        friction = friction["associated"]
    if friction == "smooth":
        friction = 0.05  # Nothing else would hold the upper block.
    lower = _body(rng, (0.0, 3.0), (0.0, 0.5), strength, number(rng, 0.2, 2.0))
    upper = _body(rng, (left, left + long), (0.5, 0.5 + number(rng, 0.3, 0.6)), strength, 1.0)
    return {
        "bodies": {"lower": lower, "upper": upper},
        "reference": [_footing("upper", "left", [1.0, 0.0])],
        "dead": [
            {"load": "Pressure", "body": "upper", "where": "top", "value": number(rng, 0.1, 0.4)}
        ],
        "supports": [_fix("lower", "bottom", "xy")],
        "interfaces": [_pair(rng, ["upper", "bottom"], ["lower", "top"], friction)],
        "path": {
            **_steps(rng, number(rng, 0.01, 0.04)),
            "scheme": chosen(rng, (_MIDPOINT, "leapfrog")),
        },
    }


def tools(rng: Rng) -> Recipe:
    """Return a block between two rigid platens of given velocities, smooth or not."""
    width, high = number(rng, 0.5, 2.0), number(rng, 0.5, 1.5)
    closing, common = number(rng, 0.5, 2.0), number(rng, -1.0, 1.0)
    share = number(rng, 0.0, 1.0)
    smooth = rng.random() < 0.6
    friction: Any = "smooth" if smooth else law(rng, 1.0, 0.7)
    if isinstance(friction, dict) and "associated" in friction:
        friction = friction["associated"]

    def platen(low: float) -> dict[str, Any]:
        corners = [[-1.0, low], [4.0, low], [4.0, low + 0.3], [-1.0, low + 0.3]]
        return {"kind": "blocks", "polygons": {"block": corners}, "friction": 0.0, "joints": []}

    metal = number(rng, 0.5, 2.0), number(rng, 0.2, 2.0)
    recipe: Recipe = {
        "bodies": {
            "block": _body(rng, (0.0, width), (0.0, high), *metal),
            "up": platen(high),
            "low": platen(-0.3),
        },
        "reference": [
            {"load": "PointForce", "body": "up", "at": "block", "vector": [0.0, -1.0]},
            {"load": "PointForce", "body": "low", "at": "block", "vector": [0.0, 1.0]},
        ],
        "dead": [],
        "supports": [_fix("block", "left")],
        "interfaces": [
            _pair(rng, ["block", "top"], ["up", "block"], friction),
            _pair(rng, ["block", "bottom"], ["low", "block"], friction),
        ],
        "path": {
            **_steps(rng, high * number(rng, 0.02, 0.1) / closing),
            "tools": {"up": [0.0, common - closing * share],
                      "low": [0.0, common + closing * (1 - share)]},
        },
    }  # fmt: skip
    if smooth:
        recipe["fact"] = "platens"
    return recipe


def _steps(rng: Rng, travel: float) -> dict[str, Any]:
    return {"travel": float(np.round(travel, 6)), "steps": int(rng.integers(1, 3)),
            "scheme": _MIDPOINT}  # fmt: skip
