"""Contact points of a state, with laws and parts of the recipe.

Only the table `LimitState.reactions` of lacore is read.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import inf
from typing import Any

import numpy as np

import lacore as la
from lacore.numerics.arrays import Bools, Floats
from lacore_verification.fuzz.drawn.recipe import Recipe

Part = tuple[str, str]
"""A body and, of an assembly, a block; ``("", "")`` is an obstacle."""
OBSTACLE: Part = ("", "")
_NEAR = 1e-6  # Relative to the distance between two points.
_RESTS = 1e-6  # Relative to the largest velocity: below it a sticking point is at rest.
_WORDS = {"smooth": (0.0, 0.0, 0.0), "stick": (0.0, inf, 0.0)}


@dataclass(frozen=True)
class Touches:
    """Contact points, arrays of shape (m,) or (m, 2).

    Attributes:
        slave, master: parts in contact.
        place, normal: m, the normal from master into slave.
        length: share of the edge, m (m^2).
        force_n, force_t: on the slave, N/m; the tangent is the normal rotated by +90 degrees.
        opening, slip: from the table, m/s.
        mu, limit, dilatancy: of the law, limit as a force, N/m.
        half: from a control value in the middle of an edge to one of its ends, else 0, m.
    """

    slave: tuple[Part, ...]
    master: tuple[Part, ...]
    place: Floats
    normal: Floats
    length: Floats
    force_n: Floats
    force_t: Floats
    opening: Floats
    slip: Floats
    mu: Floats
    limit: Floats
    dilatancy: Floats
    half: Floats

    @property
    def tangent(self) -> Floats:
        """Normals turned by +90 degrees."""
        return np.stack([-self.normal[:, 1], self.normal[:, 0]], axis=1)

    @property
    def force(self) -> Floats:
        """On the slave, (m, 2)."""
        return self.force_n[:, None] * self.normal + self.force_t[:, None] * self.tangent

    def of(self, part: Part) -> Floats:
        """Return +1 where a part is the slave, -1 where it is the master, else 0."""
        sign = [(s == part) - (m == part) for s, m in zip(self.slave, self.master, strict=True)]
        return np.array(sign, dtype=float)

    def control_values(self, field: Callable[[Floats], Floats]) -> Floats:
        """Return Bernstein control values of a field of places (2, n), quadratic along edges.

        The shape is (m, 2).
        """
        ends = field((self.place + self.half).T) + field((self.place - self.half).T)
        return np.asarray(2 * field(self.place.T) - ends / 2).T


def touches(recipe: Recipe, problem: la.Problem, state: la.LimitState) -> Touches:
    """Return the contact points of a state."""
    table = state.reactions
    sides = _sides(recipe, problem)
    names = [str(name).split("#")[0] for name in table["interface"]]
    known = [sides[name] for name in names]
    length = table["length"].to_numpy()
    mu, limit, dilatancy = np.array([law for _, _, law in known]).reshape(-1, 3).T
    place = table[["x", "y"]].to_numpy()
    normal = table[["n_x", "n_y"]].to_numpy()
    speed = max(float(np.abs(part[:2]).max(initial=0.0)) for part in state.velocity.values())
    slips = np.abs(table["u_t"].to_numpy()) > _RESTS * speed
    limit = _yielding(recipe, known, limit, slips)
    return Touches(
        slave=tuple(slave for slave, _, _ in known),
        master=tuple(master for _, master, _ in known),
        place=place,
        normal=normal,
        length=length,
        force_n=table["t_n"].to_numpy() * length,
        force_t=table["t_t"].to_numpy() * length,
        opening=table["u_n"].to_numpy(),
        slip=table["u_t"].to_numpy(),
        mu=mu,
        limit=np.where(limit > 0, limit * length, 0.0),
        dilatancy=dilatancy,
        half=_half_edges(recipe, problem, [(s, m) for s, m, _ in known], place, normal),
    )


def law_terms(law: Any) -> tuple[float, float, float]:
    """Return coefficient, limit (Pa) and dilatancy of a law of a recipe."""
    if isinstance(law, str):
        return _WORDS[law]
    if isinstance(law, Mapping):
        ((kind, value),) = law.items()
        return (0.0, value, 0.0) if kind == "tresca" else (value, 0.0, value)
    return (float(law), 0.0, 0.0)


def _sides(
    recipe: Recipe, problem: la.Problem
) -> dict[str, tuple[Part, Part, tuple[float, float, float]]]:
    """Return slave, master and law by the interface name in the table."""
    known = {}
    for data, interface in zip(recipe["interfaces"], problem.interfaces, strict=True):
        master = data["master"]
        other = part_of(recipe, master) if isinstance(master, list) else OBSTACLE
        known[interface.name] = (part_of(recipe, data["slave"]), other, law_terms(data["friction"]))
    for body, data in recipe["bodies"].items():
        if data["kind"] == "blocks":
            names = list(data["polygons"])
            own = {frozenset(pair): law for *pair, law in data["joints"]}
            for one in names:
                for other_name in names:
                    law = own.get(frozenset((one, other_name)), data["friction"])
                    known[f"{body}: {one}|{other_name}"] = (
                        (body, other_name),
                        (body, one),
                        law_terms(law),
                    )
    return known


def part_of(recipe: Recipe, side: list[Any]) -> Part:
    """Return the part with a boundary: a body, or the block that has both ends of a line."""
    body, where = side
    data = recipe["bodies"][body]
    if data["kind"] != "blocks":
        return body, ""
    if isinstance(where, str):
        return body, where
    for name, polygon in data["polygons"].items():
        away = np.linalg.norm(np.array(polygon)[:, None] - np.array(where)[None], axis=2)
        if np.all(away.min(axis=0) <= _NEAR * np.ptp(np.array(polygon))):
            return body, str(name)
    raise AssertionError(f"no block of {body!r} has the edge {where}")


def _yielding(
    recipe: Recipe, known: list[tuple[Part, Part, Any]], limit: Floats, slips: Bools
) -> Floats:
    """Return limits where sticking contact may slip, as bodies yield at their own strength."""
    strength = np.array(
        [
            min(
                (recipe["bodies"][body].get("strength", inf) for body, _ in pair if body),
                default=inf,
            )
            for *pair, _ in known
        ]
    )
    return np.where(np.isinf(limit) & slips, strength, limit)


def _half_edges(
    recipe: Recipe,
    problem: la.Problem,
    parts: list[tuple[Part, Part]],
    place: Floats,
    normal: Floats,
) -> Floats:
    """Return vectors from points in the middle of an edge to one end, 0 for points at ends.

    The shape is (m, 2).

    A point that is no vertex of either side is in the middle, and the nearest vertices on its line
    are the ends: edges of two bodies are cut where the other has a vertex.
    """
    half = np.zeros_like(place)
    for number, pair in enumerate(parts):
        corners = np.concatenate([_corners(recipe, problem, part) for part in pair])
        away = corners - place[number]
        size = np.ptp(corners, axis=0).max()
        on = away[np.abs(away @ normal[number]) <= _NEAR * size]
        nearest = on[np.argmin(np.hypot(*on.T))] if len(on) else np.zeros(2)
        if np.hypot(*nearest) > _NEAR * size:
            half[number] = nearest
    return half


def _corners(recipe: Recipe, problem: la.Problem, part: Part) -> Floats:
    """Return the vertices of a part, (k, 2)."""
    body, block = part
    if not body:
        return np.zeros((0, 2))
    data = recipe["bodies"][body]
    if data["kind"] == "continuum":
        return np.asarray(problem.bodies[body].mesh.p.T)  # type: ignore[union-attr]
    if data["kind"] == "blocks":
        return np.array(data["polygons"][block], dtype=float)
    return np.array(list(data["nodes"].values()), dtype=float)
