"""Rigid-body motions that refute LOCKED and FREE: linear programs of few unknowns.

Every plane space contains them, and they dissipate nothing inside. One that supports and contacts
admit and on which the reference load has power refutes LOCKED. Without dissipation bodies move
rigidly: if no such motion gets as much from the dead loads as it gives them, FREE is refuted.
"""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

import lacore as la
from lacore.numerics.arrays import Floats
from lacore_verification.fuzz.checks.block_program import joints_of
from lacore_verification.fuzz.checks.linear_program import Program, maximum
from lacore_verification.fuzz.checks.rigid_checks import rigid_blocks
from lacore_verification.fuzz.checks.verdict import Wrong
from lacore_verification.fuzz.continua.power import edges_of
from lacore_verification.fuzz.continua.quadrature import in_cells
from lacore_verification.fuzz.drawn.recipe import Recipe, force_density
from lacore_verification.fuzz.drawn.touches import law_terms, part_of

_FELT = 1e-6  # Relative to the size of the reference load: smaller power counts as zero.
_UNFELT = 1e-9
_AXES: Mapping[str, Any] = {"x": [[1.0, 0.0]], "y": [[0.0, 1.0]], "xy": [[1.0, 0.0], [0.0, 1.0]]}


def refuted_words(recipe: Recipe, problem: la.Problem, status: la.Status) -> Iterator[Wrong]:
    """Yield rigid-body motions that refute LOCKED or FREE; nothing for other statuses."""
    kinds = [body["kind"] for body in recipe["bodies"].values()]
    if any(body.get("mesh", {}).get("polar") for body in recipe["bodies"].values()):
        return  # Sides are straight here.
    round_ = any(body.get("kinematics") == "axisymmetric" for body in recipe["bodies"].values())
    if round_ or "frame" in kinds or status not in (la.Status.LOCKED, la.Status.FREE):
        return
    free = status is la.Status.FREE
    motions = Wholes(recipe, problem, without_dissipation=free)
    live, dead = motions.loads("reference"), motions.loads("dead")
    largest = motions.largest(live, [dead] if free else [])
    size = float(np.abs(live).sum())
    if status is la.Status.LOCKED and largest > _FELT * size:
        yield Wrong("word locked", f"bodies that move as wholes feel {largest:.3g} of {size:.3g}")
    if free and largest < _UNFELT * size:
        yield Wrong("word free", "no motion of whole bodies feels the load")


class Wholes:
    """Linear conditions on u_x, u_y of the middle and size times rotation rate of each part.

    The speed of each footing follows the parts. Rows are collected as conditions are added.
    """

    def __init__(self, recipe: Recipe, problem: la.Problem, without_dissipation: bool) -> None:
        self._recipe, self._problem = recipe, problem
        blocks = rigid_blocks(recipe)
        self._middle = dict(zip(blocks.parts, blocks.centroid, strict=True))
        points = [
            np.array(p) for d in recipe["bodies"].values() for p in d.get("polygons", {}).values()
        ]
        for name, body in problem.bodies.items():
            if isinstance(body, la.Body):
                self._middle[name, ""] = body.mesh.p.mean(axis=1)
                points.append(body.mesh.p.T)
        self._parts = list(self._middle)
        self._size = float(np.ptp(np.concatenate(points), axis=0).max())
        self._footings = [
            load
            for key in ("reference", "dead")
            for load in recipe[key]
            if load["load"] == "RigidFooting"
        ]
        self._strict = without_dissipation
        self._equal: list[Floats] = []
        self._least: list[Floats] = []
        self._support()
        self._push()
        self._touch()

    def _row(self, part: tuple[str, str], place: Floats, along: Any) -> Floats:
        """Velocity of a place along a direction; zero of an obstacle."""
        row = np.zeros(3 * len(self._parts) + len(self._footings))
        if part in self._middle:
            first = 3 * self._parts.index(part)
            arm = (place - self._middle[part]) / self._size
            row[first : first + 3] = [*along, arm[0] * along[1] - arm[1] * along[0]]
        return row

    def _ends(self, body: str, where: Any) -> tuple[Floats, Floats]:
        """Return the ends (2, 2) of a straight side, and its outward normal."""
        whole = self._problem.bodies[body]
        if isinstance(whole, la.Body):
            start, end, outward = edges_of(whole, where)
            places, normal = np.concatenate([start, end], axis=1).T, outward[:, 0]
        else:
            places = np.array(where, dtype=float)
            along = places[1] - places[0]
            normal = np.array([along[1], -along[0]]) / np.hypot(*along)
            inside = self._middle[part_of(self._recipe, [body, where])] - places[0]
            normal = -np.sign(normal @ inside) * normal
        share = places @ np.array([-normal[1], normal[0]])
        return places[[np.argmin(share), np.argmax(share)]], normal

    def _support(self) -> None:
        for support in self._recipe["supports"]:
            body, where = support["body"], support["where"]
            if not isinstance(self._problem.bodies[body], la.Body):
                place = self._middle[body, where] + self._size * np.eye(2)
                for at in (*place, self._middle[body, where]):
                    self._equal += [self._row((body, where), at, axis) for axis in np.eye(2)]
                continue
            ends, normal = self._ends(body, where)
            turned = [-normal[1], normal[0]]
            axes = {**_AXES, "normal": [normal], "tangential": [turned]}
            for axis in axes[support.get("components", "xy")]:
                self._equal += [self._row((body, ""), end, axis) for end in ends]

    def _push(self) -> None:
        for number, load in enumerate(self._footings):
            ends, normal = self._ends(load["body"], load["where"])
            direction = np.array(load["direction"]) / np.hypot(*load["direction"])
            for end in ends:
                for axis in np.eye(2) if load["rough"] else [normal]:
                    row = self._row((load["body"], ""), end, axis)
                    row[3 * len(self._parts) + number] = -(direction @ axis)
                    self._equal.append(row)

    def _touch(self) -> None:
        for name, data in self._recipe["bodies"].items():
            if data["kind"] == "blocks":
                names = [(name, block) for block in data["polygons"]]
                found = joints_of(data)
                for place, normal, slave, master, law in zip(
                    found.place, found.normal, found.slave, found.master, found.law, strict=True
                ):
                    self._contact(names[int(slave)], names[int(master)], place, normal, law)
        for pair in self._recipe["interfaces"]:
            slave = part_of(self._recipe, pair["slave"])
            ends, normal = self._ends(*pair["slave"])
            master = ("", "")
            if isinstance(pair["master"], list):
                master = part_of(self._recipe, pair["master"])
                ends = _overlap(ends, self._ends(*pair["master"])[0])
            for end in ends:
                self._contact(slave, master, end, -normal, law_terms(pair["friction"]))

    def _contact(self, slave: Any, master: Any, place: Floats, normal: Floats, law: Any) -> None:
        """Add no penetration, and no slip if forbidden, or if it dissipates and must not."""
        mu, limit, dilatancy = law
        tangent = np.array([-normal[1], normal[0]])
        opening, slip = (
            self._row(slave, place, axis) - self._row(master, place, axis)
            for axis in (normal, tangent)
        )
        if dilatancy:
            self._least += [opening + mu * slip, opening - mu * slip]
        else:
            self._least.append(opening)
        if np.isinf(limit) or (limit > 0 and self._strict):
            self._equal.append(slip)

    def loads(self, key: str) -> Floats:
        """Return the power of loads for each unknown."""
        blocks = rigid_blocks(self._recipe)
        total = np.zeros(3 * len(self._parts) + len(self._footings))
        forces = blocks.live if key == "reference" else blocks.dead
        for part, force in zip(blocks.parts, forces, strict=True):
            first = 3 * self._parts.index(part)
            total[first : first + 3] += [*force[:2], force[2] / self._size]
        for load in self._recipe[key]:
            body = self._problem.bodies[load["body"]]
            if isinstance(body, la.Body):
                total += self._load(body, load)
        return total

    def _load(self, body: la.Body, load: Mapping[str, Any]) -> Floats:
        part = (load["body"], "")
        if load["load"] == "RigidFooting":
            row = np.zeros(3 * len(self._parts) + len(self._footings))
            start, end, _ = edges_of(body, load["where"])
            force = load.get("pressure", 1.0) * np.linalg.norm(end - start, axis=0).sum()
            row[3 * len(self._parts) + self._footings.index(load)] = force
            return row
        if load["load"] == "BodyForce":
            places, weights = in_cells(body.mesh.p, body.mesh.t)
            force = weights * force_density(load, places)
            whole = force.sum(axis=(1, 2))
            arm = (places - self._middle[part][:, None, None]) / self._size
            turn = np.sum(arm[0] * force[1] - arm[1] * force[0])
            row = np.zeros(3 * len(self._parts) + len(self._footings))
            first = 3 * self._parts.index(part)
            row[first : first + 3] = [*whole, turn]
            return row
        start, end, outward = edges_of(body, load["where"])
        length = np.linalg.norm(end - start, axis=0)
        place = ((start + end) / 2 @ length) / length.sum()
        if load["load"] == "Pressure":
            size = float(load["value"] * length.sum())
            return -size * self._row(part, place, outward[:, 0])
        return np.asarray(float(length.sum()) * self._row(part, place, load["vector"]))

    def largest(self, live: Floats, further: list[Floats]) -> float:
        """Return the largest power of a load at motions of at most one.

        Powers in `further` are >= 0.
        """
        least = np.array([*self._least, *(row / max(np.abs(row).max(), 1e-300) for row in further)])
        least = least.reshape(-1, live.size)
        equal = np.array(self._equal).reshape(-1, live.size)
        slack = len(least)
        matrix = np.block([[equal, np.zeros((len(equal), slack))], [least, -np.eye(slack)]])
        program = Program(
            cost=np.concatenate([live, np.zeros(slack)]),
            matrix=matrix,
            right=np.zeros(len(matrix)),
            low=np.concatenate([np.full(live.size, -1.0), np.zeros(slack)]),
            high=np.concatenate([np.full(live.size, 1.0), np.full(slack, np.inf)]),
        )
        return maximum(program).value


def _overlap(one: Floats, other: Floats) -> Floats:
    """Return the common part of two segments on one line, (2, 2)."""
    along = (one[1] - one[0]) / np.hypot(*(one[1] - one[0]))
    share = np.sort((other - one[0]) @ along)
    low, high = max(0.0, share[0]), min(float(np.hypot(*(one[1] - one[0]))), share[1])
    return np.stack([one[0] + low * along, one[0] + high * along])
