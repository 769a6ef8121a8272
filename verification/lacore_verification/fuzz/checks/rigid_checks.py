"""Coulomb states of rigid blocks, checked from polygons, loads and the table of reactions.

The balance of each block is relative to its own forces: a pebble in a wall is checked relative to
its weight.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

import lacore as la
from lacore.numerics.arrays import Bools, Floats
from lacore_verification.fuzz.checks.verdict import Wrong, beyond
from lacore_verification.fuzz.drawn.recipe import Recipe
from lacore_verification.fuzz.drawn.touches import OBSTACLE, Part, Touches


@dataclass(frozen=True)
class Blocks:
    """All rigid blocks of a recipe.

    Attributes:
        parts: body and block names, B of them.
        centroid: (B, 2), m. radius: (B,), m. held: (B,).
        live, dead: force (x, y) and moment about the centroid, (B, 3).
    """

    parts: tuple[Part, ...]
    centroid: Floats
    radius: Floats
    held: Bools
    live: Floats
    dead: Floats


def area_and_centroid(polygon: Floats) -> tuple[float, Floats]:
    """Return area and centroid of a simple polygon, (k, 2), of either orientation."""
    origin = polygon[0]
    (x, y), (x1, y1) = (polygon - origin).T, np.roll(polygon - origin, -1, axis=0).T
    cross = x * y1 - x1 * y
    twice = cross.sum()
    centre = np.array([((x + x1) * cross).sum(), ((y + y1) * cross).sum()]) / (3 * twice)
    return abs(float(twice)) / 2, centre + origin


def rigid_blocks(recipe: Recipe) -> Blocks:
    """Return the blocks of a recipe with the loads on them."""
    polygons = {
        (body, name): np.array(polygon, dtype=float)
        for body, data in recipe["bodies"].items()
        if data["kind"] == "blocks"
        for name, polygon in data["polygons"].items()
    }
    parts = tuple(polygons)
    about = [area_and_centroid(polygon) for polygon in polygons.values()]
    area = np.array([size for size, _ in about])
    centroid = np.array([centre for _, centre in about]).reshape(-1, 2)
    held = np.array(
        [
            any(s["body"] == body and s["where"] in (name, [name]) for s in recipe["supports"])
            for body, name in parts
        ],
        dtype=bool,
    )
    radius = np.array(
        [
            np.linalg.norm(polygon - centre, axis=1).max()
            for polygon, centre in zip(polygons.values(), centroid, strict=True)
        ]
    )
    loads = []
    for name in ("reference", "dead"):
        total = np.zeros((len(parts), 3))
        for load in recipe[name]:
            for number, (body, block) in enumerate(parts):
                if load["body"] != body:
                    continue
                force = np.array(load["vector"], dtype=float)
                if load["load"] == "BodyForce" and load.get("where") in (None, block):
                    total[number, :2] += area[number] * force
                elif load["load"] == "PointForce" and block in (load.get("where"), load["at"]):
                    at = centroid[number] if isinstance(load["at"], str) else np.array(load["at"])
                    arm = at - centroid[number]
                    total[number] += [*force, arm[0] * force[1] - arm[1] * force[0]]
        loads.append(total)
    return Blocks(parts, centroid, radius, held, *loads)


def check_blocks(
    recipe: Recipe, blocks: Blocks, points: Touches, state: la.LimitState
) -> Iterator[Wrong]:
    """Yield violations of the balance of blocks and differences between the table and motions."""
    alpha = state.load_factor
    total = alpha * blocks.live + blocks.dead
    arm_length = np.maximum(blocks.radius, 1e-300)[:, None]
    size = np.hypot(*(alpha * blocks.live[:, :2]).T) + np.hypot(*blocks.dead[:, :2].T)
    size += (np.abs(alpha * blocks.live[:, 2]) + np.abs(blocks.dead[:, 2])) / arm_length[:, 0]
    force = points.force
    # A block without loads has no forces of its own: the round-off of others is its scale.
    size = np.where(size > 0, size, np.abs(force).sum())
    motion = _motions(blocks, state)
    jump = np.zeros_like(points.place)
    rigid = np.ones(len(points.place), dtype=bool)
    for number, part in enumerate(blocks.parts):
        sign = points.of(part)
        arm = points.place - blocks.centroid[number]
        moment = arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0]
        total[number] += sign @ np.column_stack([force, moment])
        size[number] += np.abs(sign) @ np.hypot(*force.T)
        turned = motion[number, 2] * np.stack([-arm[:, 1], arm[:, 0]], axis=1)
        jump += sign[:, None] * (motion[number, :2] + turned)
    known = {*blocks.parts, OBSTACLE}
    rigid = np.array(
        [s in known and m in known for s, m in zip(points.slave, points.master, strict=True)],
        dtype=bool,
    )
    free = ~blocks.held
    off = np.hypot(*total[:, :2].T) + np.abs(total[:, 2]) / arm_length[:, 0]
    yield from beyond("balance of a block", "forces that are left", off[free], size[free])
    speed = max(float(np.abs(points.opening).max(initial=0.0)), _speed(blocks, motion))
    yield from beyond("held blocks", "velocity", np.abs(motion[blocks.held]), speed)
    opening = np.sum(jump * points.normal, axis=1)[rigid]
    slip = np.sum(jump * points.tangent, axis=1)[rigid]
    yield from beyond(
        "table of velocities", "u_n off by", abs(opening - points.opening[rigid]), speed
    )
    yield from beyond("table of velocities", "u_t off by", abs(slip - points.slip[rigid]), speed)


def powers(blocks: Blocks, state: la.LimitState) -> tuple[float, float]:
    """Return the power of the reference and of the dead loads on rigid blocks."""
    motion = _motions(blocks, state)
    return float(np.sum(motion * blocks.live)), float(np.sum(motion * blocks.dead))


def _motions(blocks: Blocks, state: la.LimitState) -> Floats:
    """Return u_x, u_y, omega of each block, (B, 3)."""
    order: dict[str, int] = {}
    rows = []
    velocity = state.velocity
    for body, _ in blocks.parts:
        rows.append(velocity[body][:, order.get(body, 0)])
        order[body] = order.get(body, 0) + 1
    return np.array(rows).reshape(-1, 3)


def _speed(blocks: Blocks, motion: Floats) -> float:
    moving = np.hypot(*motion[:, :2].T) + np.abs(motion[:, 2]) * blocks.radius
    return float(moving.max(initial=0.0))


def part_sizes(recipe: Recipe, blocks: Blocks, points: Touches, alpha: float) -> dict[Part, float]:
    """Return the sum of the forces on each free part, N/m, which is the scale of its balance."""
    sizes: dict[Part, float] = {}
    strength = np.hypot(points.force_n, points.force_t)
    for part in {*points.slave, *points.master} - {OBSTACLE}:
        sizes[part] = float(np.abs(points.of(part)) @ strength)
    for number, part in enumerate(blocks.parts):
        if blocks.held[number]:
            sizes.pop(part, None)
        elif part in sizes:
            sizes[part] += float(
                np.hypot(*(alpha * blocks.live[number, :2])) + np.hypot(*blocks.dead[number, :2])
            )
    return sizes
