"""Random assemblies of rigid blocks: ragged courses and arches, of similar or disparate weights."""

from itertools import pairwise

import numpy as np

from lacore_verification.fuzz.drawn.draw import Rng, chosen, decades, law, number, short, vector
from lacore_verification.fuzz.drawn.recipe import Recipe

_MOST = 9  # Blocks at most.


def blocks(rng: Rng) -> Recipe:
    """Return blocks of one density."""
    recipe = _assembly(rng)
    recipe["dead"].append({"load": "BodyForce", "body": "wall", "vector": [0.0, -1.0]})
    return recipe


def weights(rng: Rng) -> Recipe:
    """Return blocks whose weights are ten decades apart, by density, by size, or both."""
    recipe = _assembly(rng, ragged=bool(rng.random() < 0.5))
    polygons = recipe["bodies"]["wall"]["polygons"]
    recipe["dead"] += [
        {"load": "BodyForce", "body": "wall", "vector": [0.0, -decades(rng, -5, 5)], "where": name}
        for name in polygons
        if name != "base"
    ]
    return recipe


def _assembly(rng: Rng, ragged: bool = False) -> Recipe:
    """Return blocks on a base under a push, without dead loads."""
    polygons = _arch(rng) if rng.random() < 0.2 else _courses(rng, ragged)
    free = [name for name in polygons if name != "base"]
    joints = []
    if rng.random() < 0.4:
        joints = _other_joints(rng, polygons)
    wall = {
        "kind": "blocks",
        "polygons": polygons,
        "friction": number(rng, 0.1, 1.0),
        "joints": joints,
    }
    if rng.random() < 0.5:
        live: dict[str, object] = {"load": "BodyForce", "body": "wall", "vector": vector(rng)}
        if rng.random() < 0.4:
            live["where"] = chosen(rng, free)
    else:
        name = chosen(rng, free)
        corners = np.array(polygons[name])
        at = name if rng.random() < 0.5 else [float(c) for c in chosen(rng, corners)]
        live = {"load": "PointForce", "body": "wall", "at": at, "vector": vector(rng)}
        live["where"] = name
    supports = [{"body": "wall", "where": "base"}]
    if rng.random() < 0.1:
        supports.append({"body": "wall", "where": chosen(rng, free)})
    dead = []
    if rng.random() < 0.3:
        push = vector(rng, float(rng.uniform(0.01, 0.2)))
        dead.append({"load": "BodyForce", "body": "wall", "vector": push})
    return {
        "bodies": {"wall": wall},
        "reference": [live],
        "dead": dead,
        "supports": supports,
        "interfaces": [],
    }


def _courses(rng: Rng, ragged: bool) -> dict[str, list[list[float]]]:
    """Return courses between bent lines, cut into blocks by inclined joints; some are omitted."""
    wide = number(rng, 1.0, 4.0)
    rows = int(rng.integers(1, 4))
    lines = [[(0.0, 0.0), (wide, 0.0)]]
    for _ in range(rows):
        below = max(y for _, y in lines[-1])
        high = short(below + (decades(rng, -2, 0) if ragged else number(rng, 0.3, 1.0)))
        bend = 0.2 * (high - below)
        inner = [number(rng, 0.3, 0.7) * wide] if rng.random() < 0.3 else []
        places = [0.0, *inner, wide]
        lines.append([(x, short(high - bend * float(rng.random()))) for x in places])
    polygons = {"base": [[-0.5, -1.0], [wide + 0.5, -1.0], [wide + 0.5, 0.0], [-0.5, 0.0]]}
    for row, (low, high_line) in enumerate(pairwise(lines)):
        count = int(rng.integers(1, 4))
        cuts = _cuts(rng, wide, count, ragged)
        for place, (left, right) in enumerate(pairwise(cuts)):
            if len(polygons) <= _MOST and (place == 0 or rng.random() < 0.92):
                bottom = _along(low, left[0], right[0])
                top = _along(high_line, left[1], right[1])
                polygons[f"r{row + 1}b{place + 1}"] = [list(p) for p in (*bottom, *top[::-1])]
    return polygons


def _cuts(rng: Rng, wide: float, count: int, ragged: bool) -> list[tuple[float, float]]:
    """Return the ends of joints of a course, left to right, with both ends of the course."""
    share = 10.0 ** rng.uniform(-2, 0, count) if ragged else rng.uniform(0.5, 1.5, count)
    ends = np.cumsum(share)[:-1] / share.sum() * wide
    room = 0.3 * share.min() / share.sum() * wide
    inner = [
        (short(float(x + s)), short(float(x - s)))
        for x, s in zip(ends, rng.uniform(-room, room, count - 1), strict=True)
    ]
    return [(0.0, 0.0), *inner, (wide, wide)]


def _along(line: list[tuple[float, float]], left: float, right: float) -> list[tuple[float, float]]:
    """Return the part of a bent line from left to right."""
    x, y = np.array(line).T
    inner = [(px, py) for px, py in line if left < px < right]
    ends = [(end, float(np.interp(end, x, y))) for end in (left, right)]
    return [ends[0], *inner, ends[1]]


def _arch(rng: Rng) -> dict[str, list[list[float]]]:
    """Return voussoirs of unequal size between two abutments of the base, which is one block."""
    count = int(rng.integers(2, 6))
    share = rng.uniform(0.5, 1.5, count)
    angles = np.pi - np.pi * np.concatenate([[0], np.cumsum(share)]) / share.sum()
    inner, thick = 1.0, number(rng, 0.15, 0.5)
    points = [
        [[short(r * float(np.cos(a))), short(r * float(np.sin(a)))] for r in (inner, inner + thick)]
        for a in angles
    ]
    points[0] = [[-1.0, 0.0], [-1.0 - thick, 0.0]]
    points[-1] = [[1.0, 0.0], [1.0 + thick, 0.0]]
    out = 1.5 + thick
    polygons: dict[str, list[list[float]]] = {
        "base": [[-out, -1.0], [out, -1.0], [out, 0.0], [-out, 0.0]]
    }
    for n, (one, other) in enumerate(pairwise(points)):
        polygons[f"v{n + 1}"] = [one[0], other[0], other[1], one[1]]
    return polygons


def _other_joints(rng: Rng, polygons: dict[str, list[list[float]]]) -> list[list[object]]:
    """Return specific laws for some pairs of consecutive blocks that share a joint."""
    names = list(polygons)
    pairs = [
        pair for pair in pairwise(names) if _share_a_line(polygons[pair[0]], polygons[pair[1]])
    ]
    return [[*pair, law(rng)] for pair in pairs if rng.random() < 0.5]


def _share_a_line(one: list[list[float]], other: list[list[float]]) -> bool:
    """Return whether two polygons have two common vertices: then they have a joint."""
    return len({tuple(p) for p in one} & {tuple(p) for p in other}) >= 2
