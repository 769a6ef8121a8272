"""Copies of recipes with a known load factor: moved, rescaled, renamed, reordered.

Each function returns a new recipe.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from lacore.numerics.arrays import Floats
from lacore_verification.fuzz.drawn.draw import Rng
from lacore_verification.fuzz.drawn.recipe import Recipe, copied

_SWAPPED = {"x": "y", "y": "x"}
_AXES = ("x", "y")
_ROUGHER = 3.0  # Factor on a coefficient of friction.


@dataclass(frozen=True)
class Motion:
    """A similarity: points go to ``length (turn x + shift)``, vectors are rotated."""

    turn: Floats
    shift: Floats
    length: float = 1.0

    def point(self, place: Any) -> list[float]:
        """Return the image of a point."""
        return [float(c) for c in self.length * (self.turn @ np.array(place) + self.shift)]

    def vector(self, given: Any) -> list[float]:
        """Return a rotated vector."""
        return [float(c) for c in self.turn @ np.array(given)]

    def boundary(self, where: Any) -> Any:
        """Return a line between two points that moves, or a name that stays."""
        points = isinstance(where, list) and isinstance(where[0], list)
        return [self.point(end) for end in where] if points else where

    @property
    def swaps_axes(self) -> bool:
        """Whether x becomes y, of turns by quarters."""
        return bool(abs(self.turn[0, 1]) > 0.5)


def moved(recipe: Recipe, motion: Motion) -> Recipe:
    """Return a recipe whose points and vectors have moved.

    Stresses stay: forces per volume are divided by the length, forces multiplied by it.
    """
    made = copied(recipe)
    for body in made["bodies"].values():
        _move_body(body, motion)
    for load in (*made["reference"], *made["dead"]):
        _move_load(load, motion)
    for support in made["supports"]:
        support["where"] = motion.boundary(support["where"])
        if motion.swaps_axes and support.get("components") in _AXES:
            support["components"] = _SWAPPED[support["components"]]
    for pair in made["interfaces"]:
        _move_interface(pair, motion, made["bodies"][pair["slave"][0]]["kind"] == "frame")
    if "path" in made:
        made["path"]["travel"] *= motion.length
        tools = made["path"].get("tools", {})
        made["path"]["tools"] = {name: motion.vector(speed) for name, speed in tools.items()}
    return made


def _move_load(load: dict[str, Any], motion: Motion) -> None:
    """Move a load of a copied recipe."""
    for name in ("vector", "direction"):
        if name in load:
            load[name] = motion.vector(load[name])
    if isinstance(load.get("at"), list):
        load["at"] = motion.point(load["at"])
    if "growth" in load:
        load["growth"] = [part / motion.length for part in motion.vector(load["growth"])]
    if "where" in load:
        load["where"] = motion.boundary(load["where"])
    length = motion.length
    factor = {"BodyForce": 1 / length, "PointForce": length}.get(load["load"], 1.0)
    if factor != 1.0:
        load["vector"] = [factor * part for part in load["vector"]]


def _move_interface(pair: dict[str, Any], motion: Motion, of_frame: bool) -> None:
    """Move an interface of a copied recipe; that of a frame is a node of 1 m."""
    law, master = pair["friction"], pair["master"]
    if of_frame and isinstance(law, Mapping) and "tresca" in law:
        pair["friction"] = {"tresca": motion.length * law["tresca"]}  # The limit is a force here.
    pair["slave"] = [pair["slave"][0], motion.boundary(pair["slave"][1])]
    if isinstance(master, list):
        pair["master"] = [master[0], motion.boundary(master[1])]
    elif master:
        pair["master"] = {
            "point": motion.point(master["point"]),
            "normal": motion.vector(master["normal"]),
        }


def _move_body(body: dict[str, Any], motion: Motion) -> None:
    """Move the points of a body of a copied recipe."""
    if body["kind"] == "continuum":
        mesh = body["mesh"]
        mesh["shift"] = motion.point(mesh["shift"])
        mesh["map"] = (motion.length * motion.turn @ np.array(mesh["map"])).tolist()
    elif body["kind"] == "blocks":
        body["polygons"] = {n: [motion.point(p) for p in ps] for n, ps in body["polygons"].items()}
    else:
        body["nodes"] = {name: motion.point(place) for name, place in body["nodes"].items()}
        body["plastic_moment"] = {
            name: motion.length**2 * moment for name, moment in body["plastic_moment"].items()
        }


def round_one(recipe: Recipe) -> bool:
    """Return whether a body is axisymmetric."""
    return any(body.get("kinematics") == "axisymmetric" for body in recipe["bodies"].values())


def turned(recipe: Recipe, rng: Rng) -> Recipe:
    """Return a recipe rotated about some point; by right angles if supports refer to axes."""
    if round_one(recipe):
        return moved(recipe, Motion(np.eye(2), np.array([0.0, rng.uniform(-10, 10)])))
    named = any(support.get("components") in _AXES for support in recipe["supports"])
    quarters = [(0, 1), (-1, 0), (0, -1)]
    angle = rng.uniform(0, 2 * np.pi)
    c, s = quarters[rng.integers(3)] if named else (np.cos(angle), np.sin(angle))
    turn = np.array([[c, -s], [s, c]], dtype=float)
    return moved(recipe, Motion(turn, rng.uniform(-10, 10, 2)))


def mirrored(recipe: Recipe, rng: Rng) -> Recipe:
    """Return a recipe with left and right exchanged; for axisymmetric bodies top and bottom."""
    signs = np.diag([1.0, -1.0] if round_one(recipe) else [-1.0, 1.0])
    return moved(recipe, Motion(signs, np.zeros(2)))


def resized(recipe: Recipe, rng: Rng) -> Recipe:
    """Return a recipe of another length, with the same stresses."""
    return moved(recipe, Motion(np.eye(2), np.zeros(2), float(10.0 ** rng.uniform(-3, 3))))


@dataclass(frozen=True)
class _NewNames:
    """New names of bodies, and of blocks by body and name."""

    bodies: Mapping[str, str]
    blocks: Mapping[tuple[str, str], str]

    def block(self, body: str, name: Any) -> Any:
        """Return the new name of a block; other boundaries are unchanged."""
        return self.blocks.get((body, name), name) if isinstance(name, str) else name

    def inside(self, name: str, body: dict[str, Any]) -> dict[str, Any]:
        """Return a body with the new names of its blocks."""
        if body["kind"] != "blocks":
            return body
        return body | {
            "polygons": {self.block(name, b): p for b, p in body["polygons"].items()},
            "joints": [
                [self.block(name, a), self.block(name, b), law] for a, b, law in body["joints"]
            ],
        }

    @classmethod
    def of(cls, recipe: Recipe) -> "_NewNames":
        """Return names that sort in reverse order."""
        names = list(recipe["bodies"])
        blocks = {
            (name, block): f"b{len(body['polygons']) - n}"
            for name, body in recipe["bodies"].items()
            if body["kind"] == "blocks"
            for n, block in enumerate(body["polygons"])
        }
        return cls({name: f"z{len(names) - n}" for n, name in enumerate(names)}, blocks)


def renamed(recipe: Recipe, rng: Rng) -> Recipe:
    """Return a recipe with bodies and blocks under other names, which sort in reverse order."""
    new, made = _NewNames.of(recipe), copied(recipe)
    made["bodies"] = {
        new.bodies[name]: new.inside(name, body) for name, body in made["bodies"].items()
    }
    if "path" in made:
        tools = made["path"].get("tools", {})
        made["path"]["tools"] = {new.bodies[name]: speed for name, speed in tools.items()}
    for part in (*made["reference"], *made["dead"], *made["supports"]):
        for key in ("where", "at"):
            if key in part:
                part[key] = new.block(part["body"], part[key])
        part["body"] = new.bodies[part["body"]]
    for pair in made["interfaces"]:
        for side in ("slave", "master"):
            if isinstance(pair[side], list):
                pair[side] = [new.bodies[pair[side][0]], new.block(*pair[side])]
    return made


def reordered(recipe: Recipe, rng: Rng) -> Recipe:
    """Return bodies, blocks, loads and supports in reverse order, with slaves as masters."""
    made = copied(recipe)
    for body in made["bodies"].values():
        for key in ("polygons", "members", "nodes"):
            if key in body:
                body[key] = dict(reversed(body[key].items()))
    made["bodies"] = dict(reversed(made["bodies"].items()))
    for name in ("reference", "dead", "supports", "interfaces"):
        made[name].reverse()
    for pair in made["interfaces"]:
        if isinstance(pair["master"], list):
            pair["slave"], pair["master"] = pair["master"], pair["slave"]
    return made


def stronger(recipe: Recipe, factor: float) -> Recipe:
    """Return strengths, limits of friction and dead loads in other units."""
    made = copied(recipe)
    for body in made["bodies"].values():
        for name in ("strength", "hardening"):
            if name in body:
                body[name] *= factor
        if "plastic_moment" in body:
            body["plastic_moment"] = {n: factor * m for n, m in body["plastic_moment"].items()}
        if body["kind"] == "blocks":
            body["friction"] = _law_times(body["friction"], factor)
            body["joints"] = [[a, b, _law_times(law, factor)] for a, b, law in body["joints"]]
    for pair in made["interfaces"]:
        pair["friction"] = _law_times(pair["friction"], factor)
    for load in made["dead"]:
        _multiply(load, factor)
    return made


def _law_times(law: Any, factor: float) -> Any:
    if isinstance(law, Mapping) and "tresca" in law:
        return {"tresca": factor * law["tresca"]}
    return law


def _multiply(load: dict[str, Any], factor: float) -> None:
    for name in ("value", "pressure"):
        if name in load:
            load[name] *= factor
    if "vector" in load:
        load["vector"] = [factor * part for part in load["vector"]]
    if load["load"] == "RigidFooting" and "pressure" not in load:
        load["pressure"] = factor


def in_units(recipe: Recipe, rng: Rng) -> Recipe:
    """Return stresses, dead and reference loads in other units of pressure."""
    factor = float(10.0 ** rng.uniform(-3, 6))
    made = stronger(recipe, factor)
    for load in made["reference"]:
        _multiply(load, factor)
    return made


COPIES: Mapping[str, Callable[[Recipe, Rng], Recipe]] = {
    "turned": turned,
    "mirrored": mirrored,
    "resized": resized,
    "renamed": renamed,
    "reordered": reordered,
    "in other units": in_units,
}
"""Copies that have the same load factors."""


def with_law(recipe: Recipe, kind: str) -> Recipe:
    """Replace Coulomb's law by ``associated``, ``rougher`` (too), ``smooth`` or ``stick``."""
    made = copied(recipe)

    def other(law: Any) -> Any:
        if isinstance(law, str | Mapping):
            return law
        factor = {"associated": 1.0, "rougher": _ROUGHER}.get(kind)
        return kind if factor is None else {"associated": factor * law}

    for body in made["bodies"].values():
        if body["kind"] == "blocks":
            body["friction"] = other(body["friction"])
            body["joints"] = [[a, b, other(law)] for a, b, law in body["joints"]]
    for pair in made["interfaces"]:
        pair["friction"] = other(pair["friction"])
    return made


def has_coulomb(recipe: Recipe) -> bool:
    """Return whether Coulomb's law is used: else the load factor is unique."""
    laws = [pair["friction"] for pair in recipe["interfaces"]]
    for body in recipe["bodies"].values():
        if body["kind"] == "blocks" and len(body["polygons"]) > 1:
            laws += [body["friction"], *(law for _, _, law in body["joints"])]
    return any(isinstance(law, float | int) for law in laws)


def weakened(recipe: Recipe, factor: float, interfaces: bool) -> Recipe:
    """Return every strength divided by a factor, with all loads as reference loads."""
    made = copied(recipe)
    for body in made["bodies"].values():
        if "soil" in body:
            body["soil"]["divisor"] = factor
        elif "strength" in body:
            body["strength"] /= factor
    for pair in made["interfaces"] if interfaces else ():
        pair["friction"] = _divided(pair["friction"], factor)
    made["reference"] += made["dead"]
    made["dead"] = []
    return made


def _divided(law: Any, factor: float) -> Any:
    """Return a friction law with its strength divided; stick is unchanged."""
    if isinstance(law, Mapping):
        return {kind: value / factor for kind, value in law.items()}
    return law if isinstance(law, str) else law / factor


def strengthened(recipe: Recipe) -> Recipe:
    """Return all strengths times 1.5, with the same loads: the load factor must not decrease."""
    made = copied(recipe)
    for body in made["bodies"].values():
        if "strength" in body:
            body["strength"] *= 1.5
        if "plastic_moment" in body:
            body["plastic_moment"] = {n: 1.5 * m for n, m in body["plastic_moment"].items()}
    return made
