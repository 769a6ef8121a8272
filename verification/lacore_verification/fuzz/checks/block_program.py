"""Static programs of assemblies from polygons: joints and balance, independent of lacore.

Unknowns are the forces at the ends of joints, and alpha. With associated friction the largest alpha
bounds every Coulomb one from above, without friction from below (T14). Where the first is finite a
Coulomb state exists: of the two maps of the alternating loop (T12), both of linear programs, the
composed one has a fixed point (Kakutani).
"""

from dataclasses import dataclass
from itertools import combinations
from math import inf, isfinite, isnan, nan

import numpy as np

from lacore.numerics.arrays import Floats
from lacore_verification.fuzz.checks.linear_program import Program, maximum
from lacore_verification.fuzz.checks.rigid_checks import Blocks, rigid_blocks
from lacore_verification.fuzz.drawn.recipe import Recipe
from lacore_verification.fuzz.drawn.touches import law_terms

_FLAT = 1e-7  # Relative to the size of blocks, tolerance for edges that coincide.


@dataclass(frozen=True)
class Known:
    """Bounds on the load factor of an assembly by the programs.

    Attributes:
        lowest: without friction: no Coulomb load factor is below; -inf if it cannot stand.
        highest: with associated friction: none is above; +inf, or -inf if it cannot stand.
        locked: whether the reference load alone is carried without friction, whatever its size.
    """

    lowest: float = nan
    highest: float = nan
    locked: bool | None = None

    @property
    def has_load(self) -> bool | None:
        """Return whether there is a Coulomb load factor.

        None if these programs do not determine it.
        """
        if isnan(self.highest):
            return None
        if self.highest == -inf or self.locked:
            return False
        return True if isfinite(self.highest) else None


@dataclass(frozen=True)
class Ends:
    """Ends of joints, (m, 2) each, with block numbers, laws (m, 3) and tributary lengths."""

    place: Floats
    normal: Floats
    slave: Floats
    master: Floats
    law: Floats
    length: Floats


def known_of(recipe: Recipe) -> Known:
    """Return bounds for a recipe of one assembly, without interfaces."""
    (_, data), *others = recipe["bodies"].items()
    if others or recipe["interfaces"] or data["kind"] != "blocks":
        return Known()
    blocks = rigid_blocks(recipe)
    ends = joints_of(data)
    highest = _largest(blocks, ends, friction=True)
    lowest = _largest(blocks, ends, friction=False)
    return Known(lowest, highest, _carried_alone(blocks, ends))


def joints_of(data: Recipe) -> Ends:
    """Return the ends of the segments shared by edges of two polygons."""
    polygons = {name: np.array(p, dtype=float) for name, p in data["polygons"].items()}
    numbers = {name: number for number, name in enumerate(polygons)}
    own = {frozenset(pair): law for *pair, law in data["joints"]}
    rows = []
    for one, other in combinations(polygons, 2):
        law = law_terms(own.get(frozenset((one, other)), data["friction"]))
        for start, end, normal in _shared(_turned(polygons[one]), _turned(polygons[other])):
            half = float(np.linalg.norm(end - start)) / 2
            for place in (start, end):
                rows.append((*place, *normal, numbers[other], numbers[one], *law, half))
    table = np.array(rows, dtype=float).reshape(-1, 10)
    return Ends(table[:, :2], table[:, 2:4], table[:, 4], table[:, 5], table[:, 6:9], table[:, 9])


def _turned(polygon: Floats) -> Floats:
    """Return a polygon in anticlockwise order."""
    (x, y), (x1, y1) = polygon.T, np.roll(polygon, -1, axis=0).T
    return polygon if (x * y1 - x1 * y).sum() > 0 else polygon[::-1]


def _shared(one: Floats, other: Floats) -> list[tuple[Floats, Floats, Floats]]:
    """Return segments along which two polygons touch, with normals from the first to the second."""
    found = []
    size = max(np.ptp(one, axis=0).max(), np.ptp(other, axis=0).max())
    small = min(np.ptp(one, axis=0).max(), np.ptp(other, axis=0).max())
    near = _FLAT * np.sqrt(size * small)
    for a, b in zip(one, np.roll(one, -1, axis=0), strict=True):
        length = np.linalg.norm(b - a)
        along = (b - a) / length
        normal = np.array([along[1], -along[0]])
        for c, d in zip(other, np.roll(other, -1, axis=0), strict=True):
            if (d - c) @ along >= 0:
                continue
            away = np.abs([(c - a) @ normal, (d - a) @ normal])
            low, high = max(0.0, (d - a) @ along), min(length, (c - a) @ along)
            # Where long edges extend beyond a small one, their distance along the small one
            # counts.
            if high - low > 10 * near and away.max() <= near + _FLAT * np.linalg.norm(d - c):
                found.append((a + low * along, a + high * along, normal))
    return found


def _columns(blocks: Blocks, ends: Ends, force: Floats) -> Floats:
    """Return the effect of forces (m, 2) on slaves, one per column, on the balance."""
    m = len(force)
    rows = np.zeros((len(blocks.parts), 3, m))
    column = np.arange(m)
    for number, sign in ((ends.slave.astype(int), 1.0), (ends.master.astype(int), -1.0)):
        arm = ends.place - blocks.centroid[number]
        moment = (arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]) / blocks.radius[number]
        for axis, values in enumerate((force[:, 0], force[:, 1], moment)):
            rows[number, axis, column] += sign * values
    return rows[~blocks.held].reshape(-1, m)


def _program(blocks: Blocks, ends: Ends, friction: bool, dead: bool) -> Program:
    """Return the balance with forces along the edges of friction cones, or within Tresca's limits.

    Without `friction` Coulomb's friction is omitted; without `dead` loads and limits, a ray is
    sought.
    """
    tangent = np.stack([-ends.normal[:, 1], ends.normal[:, 0]], axis=1)
    mu, limit, dilatancy = ends.law.T
    slope = np.where(friction | (dilatancy > 0), mu, 0.0)
    edges = [ends.normal + sign * slope[:, None] * tangent for sign in (1.0, -1.0)]
    shear = np.where(np.isinf(limit), inf, limit * ends.length if dead else 0.0)
    live = blocks.live.copy()
    weight = blocks.dead.copy() if dead else np.zeros_like(live)
    for load in (live, weight):
        load[:, 2] /= blocks.radius
    free = ~blocks.held
    columns = [_columns(blocks, ends, force) for force in (*edges, tangent)]
    matrix = np.concatenate([*columns, live[free].reshape(-1, 1)], axis=1)
    right = -weight[free].ravel()
    m = len(mu)
    low = np.concatenate([np.zeros(2 * m), -shear, [-inf]])
    high = np.concatenate([np.full(2 * m, inf), shear, [inf]])
    cost = np.zeros(3 * m + 1)
    cost[-1] = 1.0
    return Program(cost, matrix, right, low, high)


def _scaled(program: Program) -> Program:
    """Return a program in units in which the loads are of order one."""
    size = float(np.abs(program.right).max(initial=0.0))
    if size == 0:
        return program
    return Program(
        program.cost, program.matrix, program.right / size, program.low / size, program.high / size
    )


def _largest(blocks: Blocks, ends: Ends, friction: bool) -> float:
    program = _program(blocks, ends, friction, dead=True)
    size = float(np.abs(program.right).max(initial=0.0)) or 1.0
    value = maximum(_scaled(program)).value
    return value * size if isfinite(value) else value


def _carried_alone(blocks: Blocks, ends: Ends) -> bool | None:
    """Whether forces without friction carry the reference load alone."""
    program = _program(blocks, ends, friction=False, dead=False)
    high = program.high.copy()
    high[-1] = 1.0  # Bounds the ray to length one.
    value = maximum(Program(program.cost, program.matrix, program.right, program.low, high)).value
    return None if isnan(value) else bool(value > 0.5)
