"""Random continua in three kinematics and all spaces: one body, two, or with rigid ones."""

from functools import partial
from typing import Any

import numpy as np

from lacore_verification.fuzz.drawn.draw import Rng, chosen, decades, law, number, short, vector
from lacore_verification.fuzz.drawn.recipe import Recipe

SIDES = ("left", "right", "bottom", "top")
_TRIANGLES = ("p2-vertex", "p2-gauss", "p2-disc", "p1-disc", "p1")
_SPACES = {
    "plane_strain": (*_TRIANGLES, "q2"),
    "plane_stress": (*_TRIANGLES, "q2"),
    "axisymmetric": ("p2-gauss", "q2"),
}
_PLAIN = [[1.0, 0.0], [0.0, 1.0]]
_STEEPEST_CHORD = 0.6  # Radians, so that chords of the outer arc stay clear of the inner one.
_FAR = 3  # Decades by which strengths and loads may differ.


def _continuum(rng: Rng, kinematics: str, x: Any, y: Any, space: str = "") -> dict[str, Any]:
    space = space or chosen(rng, _SPACES[kinematics])
    cut = "quads" if space == "q2" else "crossed"
    if space in ("p2-vertex", "p2-gauss", "p1-disc") and rng.random() < 0.3:
        cut = "diagonal"
    return {
        "kind": "continuum",
        "mesh": {
            "x": list(x),
            "y": list(y),
            "nx": int(rng.integers(1, 4)),
            "ny": int(rng.integers(1, 4)),
            "cut": cut,
            "map": _PLAIN,
            "shift": [0.0, 0.0],
        },
        "strength": number(rng, 0.5, 2.0),
        "kinematics": kinematics,
        "space": space,
    }


def _slanted(rng: Rng) -> list[list[float]]:
    """Return a map that shears and stretches a body."""
    return [[1.0, number(rng, -0.5, 0.5)], [number(rng, -0.2, 0.2), number(rng, 0.5, 1.5)]]


def one_body(rng: Rng, kinematics: str) -> Recipe:
    """Return a block with random supports, obstacles and loads."""
    round_ = kinematics == "axisymmetric"
    inner = chosen(rng, (0.0, 0.5)) if round_ else 0.0
    size = number(rng, 0.5, 2.0)
    body = _continuum(rng, kinematics, (inner, inner + size), (0.0, 1.0))
    if not round_ and rng.random() < 0.4:
        body["mesh"]["map"] = _slanted(rng)
    sides = [side for side in rng.permutation(SIDES) if inner or not round_ or side != "left"]
    held, loaded, third, *rest = (str(side) for side in sides)
    supports, interfaces = [], []
    if rng.random() < 0.4:
        supports.append({"body": "block", "where": held, "components": _held(rng, round_, held)})
    else:
        interfaces.append(_obstacle(rng, held))
    if rng.random() < 0.4:
        if rng.random() < 0.5:
            supports.append({"body": "block", "where": third, "components": _guided(rng, round_)})
        else:
            interfaces.append(_obstacle(rng, third))
    dead: list[dict[str, Any]] = []
    if rng.random() < 0.5:
        push = (
            [0.0, -number(rng, 0.05, 0.5)] if round_ else vector(rng, float(rng.uniform(0.05, 0.4)))
        )
        dead.append({"load": "BodyForce", "body": "block", "vector": push})
    if rng.random() < 0.4:
        # Any side may be loaded, also one on supports or obstacles, which then take the load.
        where = chosen(rng, [loaded, *rest, *sides] if rng.random() < 0.5 else [loaded, *rest])
        where, pressure = str(where), number(rng, 0.1, 0.8)
        own: dict[str, Any] = {"load": "Pressure", "value": pressure}
        if not round_ and rng.random() < 0.3:
            own = {"load": "Traction", "vector": vector(rng, pressure)}
        dead.append({"body": "block", "where": where, **own})
    recipe = {
        "bodies": {"block": body},
        "reference": [_load(rng, "block", loaded, round_)],
        "dead": dead,
        "supports": supports,
        "interfaces": interfaces,
    }
    return _of_any_size(rng, recipe)


def _of_any_size(rng: Rng, recipe: Recipe) -> Recipe:
    """Return strengths and loads in random units: the load factor is a ratio of them."""
    if rng.random() < 0.3:
        factor = decades(rng, -_FAR, 2 * _FAR)
        for body in recipe["bodies"].values():
            body["strength"] = short(factor * body["strength"])
        for load in recipe["dead"]:
            _multiply(load, factor)
        for pair in recipe["interfaces"]:
            if isinstance(pair["friction"], dict) and "tresca" in pair["friction"]:
                pair["friction"]["tresca"] = short(factor * pair["friction"]["tresca"])
    return recipe


def _multiply(load: dict[str, Any], factor: float) -> None:
    for name in ("value", "pressure"):
        if name in load:
            load[name] = short(factor * load[name])
    if "vector" in load:
        load["vector"] = [short(factor * part) for part in load["vector"]]


def _held(rng: Rng, round_: bool, side: str) -> str:
    if round_:
        return "xy" if side in ("bottom", "top") and rng.random() < 0.5 else "normal"
    return str(chosen(rng, ("xy", "xy", "normal")))


def _guided(rng: Rng, round_: bool) -> str:
    return "normal" if round_ else str(chosen(rng, ("x", "y", "tangential", "normal")))


def _obstacle(rng: Rng, side: str) -> dict[str, Any]:
    return {"slave": ["block", side], "master": None, "friction": law(rng)}


def _load(rng: Rng, body: str, side: str, round_: bool) -> dict[str, Any]:
    kind = rng.integers(4)
    on = {"body": body, "where": side}
    if kind == 0:
        push = [0.0, chosen(rng, (-1.0, 1.0))] if round_ else vector(rng)
        return {"load": "Traction", **on, "vector": push}
    if kind == 1:
        return {"load": "Pressure", **on, "value": number(rng, 0.2, 1.0)}
    if kind == 2:
        push = [0.0, chosen(rng, (-1.0, 1.0))] if round_ else vector(rng)
        return {"load": "BodyForce", "body": body, "vector": push}
    push = [0.0, chosen(rng, (-1.0, 1.0))] if round_ else vector(rng)
    return {"load": "RigidFooting", **on, "direction": push, "rough": bool(rng.random() < 0.5)}


plane_strain = partial(one_body, kinematics="plane_strain")
plane_stress = partial(one_body, kinematics="plane_stress")
axisymmetric = partial(one_body, kinematics="axisymmetric")


def soils(rng: Rng) -> Recipe:
    """Return a soil with varying cohesion, angle, cut-offs and weight, and random loads."""
    recipe = one_body(rng, "plane_strain")
    block = recipe["bodies"]["block"]
    if not recipe["supports"] and rng.random() < 0.7:
        side = recipe["interfaces"].pop(0)["slave"][1]
        recipe["supports"].append({"body": "block", "where": side, "components": "xy"})
    if block["space"] == "q2":
        block["mesh"]["cut"] = "crossed"
    cut = rng.random() < 0.5
    # Velocity jumps do not support cut-offs, and all soils lock with constant strains.
    block["space"] = chosen(rng, _TRIANGLES[:2] if cut else _TRIANGLES[:4])
    block["soil"] = {
        "angle": number(rng, 5.0, 40.0),
        "tension": chosen(rng, (None, number(rng, 0.05, 1.0))) if cut else None,
        "crushing": chosen(rng, (None, number(rng, 3.0, 10.0))) if cut else None,
        "slopes": {name: _slope(rng) for name in ("cohesion", "angle", "tension", "crushing")},
    }
    for load in (*recipe["reference"], *recipe["dead"]):
        if load["load"] == "BodyForce" and rng.random() < 0.7:
            load.update(growth=_slope(rng), at=[0.0, 0.0])
    return recipe


def _slope(rng: Rng) -> list[float]:
    """Return a relative slope, or none, for a body that is at most 2 m long."""
    if rng.random() < 0.3:
        return [0.0, 0.0]
    return [number(rng, -0.2, 0.2), number(rng, -0.2, 0.2)]


def arcs(rng: Rng) -> Recipe:
    """Return a part of a ring that a rigid smooth or rough pile pushes along one of its arcs."""
    inner = number(rng, 0.5, 1.5)
    body = _continuum(rng, "plane_strain", (inner, inner + number(rng, 0.3, 1.5)), (0.0, 1.0),
                      chosen(rng, _TRIANGLES[:4]))  # fmt: skip
    angle = number(rng, 0.5, 3.0)
    cuts = int(np.ceil(angle / _STEEPEST_CHORD))
    body["mesh"].update(polar=True, y=[0.0, angle], ny=int(rng.integers(cuts, cuts + 3)))
    pile, other = ("left", "right") if rng.random() < 0.7 else ("right", "left")
    supports = [{"body": "block", "where": other, "components": "xy"}]
    interfaces = []
    for side in ("bottom", "top"):
        if rng.random() < 0.4:
            supports.append({"body": "block", "where": side, "components": "normal"})
        elif rng.random() < 0.2:
            interfaces.append(_obstacle(rng, side))
    dead = []
    if rng.random() < 0.3:
        dead.append({"load": "BodyForce", "body": "block", "vector": vector(rng, 0.3)})
    if rng.random() < 0.3:
        push = vector(rng, number(rng, 0.1, 0.6))
        where = chosen(rng, ("top", "bottom", pile, other))
        dead.append({"load": "Traction", "body": "block", "where": where, "vector": push})
    reference = [
        {"load": "RigidFooting", "body": "block", "where": pile, "direction": vector(rng),
         "rough": bool(rng.random() < 0.5)}
    ]  # fmt: skip
    recipe = {"bodies": {"block": body}, "reference": reference, "dead": dead}
    return _of_any_size(rng, {**recipe, "supports": supports, "interfaces": interfaces})


def two_bodies(rng: Rng) -> Recipe:
    """Return a body on another one, on meshes that need not match."""
    kinematics = chosen(rng, ("plane_strain", "plane_strain", "plane_stress"))
    wide = number(rng, 1.0, 2.0)
    left = number(rng, 0.0, 0.5) if rng.random() < 0.5 else 0.0
    right = left + number(rng, 0.3, 1.0) * (wide - left)
    lower = _continuum(rng, kinematics, (0.0, wide), (0.0, 1.0))
    upper = _continuum(rng, kinematics, (left, right), (1.0, number(rng, 1.3, 2.0)))
    sides = [["upper", "bottom"], ["lower", "top"]]
    if rng.random() < 0.5:
        sides = sides[::-1]
    # Obstacles and supports never meet the interface at a corner of the upper body.
    supports = [{"body": "lower", "where": "bottom", "components": chosen(rng, ("xy", "normal"))}]
    if supports[0]["components"] == "normal":
        supports.append({"body": "lower", "where": "left", "components": "xy"})
    load = _load(rng, "upper", chosen(rng, ("left", "right", "top")), round_=False)
    dead = []
    if rng.random() < 0.8:
        dead.append(
            {"load": "Pressure", "body": "upper", "where": "top", "value": number(rng, 0.1, 1.0)}
        )
    return {
        "bodies": {"lower": lower, "upper": upper},
        "reference": [load],
        "dead": dead,
        "supports": supports,
        "interfaces": [{"slave": sides[0], "master": sides[1], "friction": law(rng)}],
    }


def mixtures(rng: Rng) -> Recipe:
    """Return rigid blocks on a continuum that may yield under them."""
    soil = _continuum(rng, "plane_strain", (0.0, 3.0), (-1.0, 0.0), chosen(rng, _TRIANGLES[:4]))
    soil["strength"] = decades(rng, -1, 4)
    left, right = number(rng, 0.3, 1.2), number(rng, 1.8, 2.7)
    high = number(rng, 0.2, 1.5)
    block = [
        [left, 0.0],
        [right, 0.0],
        [number(rng, 1.6, 2.7), high],
        [number(rng, 0.3, 1.5), high],
    ]
    polygons = {"block": block}
    if rng.random() < 0.4:
        polygons["cap"] = [block[3], block[2], [2.0, high + 0.5], [1.0, high + 0.5]]
    face = [[left, 0.0], [right, 0.0]]
    top = chosen(rng, list(polygons))
    live: dict[str, Any] = {"load": "BodyForce", "body": "stone", "vector": vector(rng)}
    if rng.random() < 0.5:
        corner = [float(part) for part in chosen(rng, polygons[top])]
        live = {
            "load": "PointForce", "body": "stone", "at": corner, "vector": vector(rng),
            "where": top,
        }  # fmt: skip
    dead = [
        {"load": "BodyForce", "body": "stone", "vector": [0.0, -decades(rng, -2, 2)]},
    ]
    if rng.random() < 0.4:
        dead.append({"load": "BodyForce", "body": "soil", "vector": [0.0, -decades(rng, -3, 0)]})
    sides = [["stone", face], ["soil", "top"]]
    if rng.random() < 0.5:
        sides = sides[::-1]
    return {
        "bodies": {
            "soil": soil,
            "stone": {
                "kind": "blocks",
                "polygons": polygons,
                "friction": number(rng, 0.1, 1.0),
                "joints": [],
            },
        },
        "reference": [live],
        "dead": dead,
        "supports": [
            {"body": "soil", "where": "bottom", "components": "xy"},
            {"body": "soil", "where": "left", "components": "normal"},
            {"body": "soil", "where": "right", "components": "normal"},
        ],
        "interfaces": [
            {"slave": sides[0], "master": sides[1], "friction": law(rng, soil["strength"])}
        ],
    }


def paths(rng: Rng) -> Recipe:
    """Return a block pressed between smooth or rough platens, in a few steps."""
    kinematics = chosen(rng, ("plane_strain", "axisymmetric"))
    inner = chosen(rng, (0.0, 0.5)) if kinematics == "axisymmetric" else 0.0
    space = chosen(rng, ("p2-gauss", "q2"))
    size = number(rng, 0.5, 1.5)
    body = _continuum(rng, kinematics, (inner, inner + size), (0.0, 1.0), space)
    supports, interfaces = [{"body": "block", "where": "bottom", "components": "normal"}], []
    if rng.random() < 0.5:
        supports = []
        friction = chosen(
            rng, ("smooth", {"tresca": number(rng, 0.1, 0.5)}, number(rng, 0.05, 0.5))
        )
        interfaces = [{"slave": ["block", "bottom"], "master": None, "friction": friction}]
    if kinematics == "plane_strain":
        supports.append({"body": "block", "where": "left", "components": "normal"})
    direction = [0.0, chosen(rng, (-1.0, -1.0, 1.0)) if not interfaces else -1.0]
    rough = bool(rng.random() < 0.5)
    return {
        "bodies": {"block": body},
        "reference": [
            {"load": "RigidFooting", "body": "block", "where": "top", "direction": direction,
             "rough": rough}
        ],
        "dead": [],
        "supports": supports,
        "interfaces": interfaces,
        "path": {
            "travel": number(rng, 0.01, 0.05),
            "steps": int(rng.integers(2, 4)),
            "scheme": chosen(rng, ("leapfrog", "explicit")),
        },
    }  # fmt: skip


def cells(recipe: Recipe) -> int:
    """Return the number of cells of all meshes of a recipe."""
    meshes = [body["mesh"] for body in recipe["bodies"].values() if body["kind"] == "continuum"]
    return int(np.sum([mesh["nx"] * mesh["ny"] for mesh in meshes]))
