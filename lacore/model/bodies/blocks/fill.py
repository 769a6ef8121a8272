"""Fill on vaults: its weight and lateral pressure as loads on blocks."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.conditions.loads import PointForce
from lacore.numerics.arrays import Bools, Floats, Ints
from lacore.reporting.errors import InputError, is_number, require_positive, require_range, typed
from lacore.reporting.text import Quantity, text

_UPWARDS = 1e-9  # component of a unit normal above the round-off of a vertical face


@typed()
def fill(
    body: str,
    blocks: BlockAssembly,
    unit_weight: float,
    level: float,
    lateral: float = 0.0,
    surcharge: float = 0.0,
    where: str | tuple[str, ...] | Callable[[Floats], Bools] | None = None,
) -> list[PointForce]:
    """Return the loads of a fill on the extrados of an arch, or behind a wall.

    At the depth h below its level it presses with ``p = unit_weight h + surcharge`` downwards, and
    with ``lateral p`` sideways, towards the blocks; on an edge with the outward normal n that is
    the traction ``-p (lateral n_x, n_y)``, linear along it. Each edge gets the resultant where it
    acts, which is exact for rigid blocks. If an edge leaves the fill, only its part below the level
    is loaded. The fill is a load, not a body: it neither distributes other loads nor resists.

    Args:
        body: name of the blocks in the problem.
        blocks: the body.
        unit_weight: N/m^3.
        level: height y of the surface of the fill, which is horizontal, m.
        lateral: ratio of horizontal to vertical pressure: 0, at rest ``1 - sin(phi)``, active
            ``tan(45 deg - phi/2)**2``, 1 for a fluid.
        surcharge: pressure on the surface of the fill, Pa.
        where: names of blocks, or a function of coordinates (2, n) that selects edges; None: all
            edges that face upwards and have no joint. Selected edges that face downwards are left
            out, and vertical ones are loaded sideways.

    Raises:
        InputError: a weight that is not positive, a ratio or surcharge below 0, nothing below the
            level.

    Example:
        >>> stones = la.masonry.arch(9, inner_radius=1.0, thickness=0.2, friction=0.6)
        >>> forces = la.masonry.fill("arch", stones, unit_weight=18e3, level=1.5)
        >>> forces[0].body
        'arch'
    """
    require_positive("unit_weight", unit_weight)
    for name, value in (("lateral", lateral), ("surcharge", surcharge)):
        if not is_number(value) or value < 0:
            raise InputError(name, value, "not a number >= 0", "give 0 for none")
        require_range(name, value)
    if not is_number(level):
        raise InputError("level", level, "not a height", "give y of the surface, m")
    require_range("level", level)
    edges = _covered(blocks, where)
    start, end = blocks.edges.start[:, edges], blocks.edges.end[:, edges]
    below = np.minimum(start[1], end[1]) < level
    if not below.any():
        lowest = np.minimum(start[1], end[1]).min(initial=np.inf)
        fix = text("the lowest edge that it could cover is at y = {}", Quantity(lowest, "m", ".6g"))
        raise InputError("level", level, "the fill covers no edge", fix)
    edges = edges[below]
    start, end = _cut(start[:, below], end[:, below], level)
    normal = blocks.edges.normal[:, edges]
    first, last = (unit_weight * (level - own[1]) + surcharge for own in (start, end))
    length, total = np.linalg.norm(end - start, axis=0), first + last
    # share of the length, from the start, at which the resultant acts
    share = np.full(total.size, 0.5)
    np.divide(first + 2 * last, 3 * total, out=share, where=total > 0)
    place = start + share * (end - start)
    force = -0.5 * total * length * np.stack([lateral * normal[0], normal[1]])
    names = [blocks.names[block] for block in blocks.edges.block[edges]]
    return [
        PointForce(body, (float(x), float(y)), (float(across), float(down)), where=name)
        for name, (x, y), (across, down) in zip(names, place.T, force.T, strict=True)
        if across or down
    ]


def _covered(
    blocks: BlockAssembly, where: str | tuple[str, ...] | Callable[[Floats], Bools] | None
) -> Ints:
    """Return the edges that a fill can lie on or against."""
    rise = blocks.edges.normal[1]
    if where is None:
        return np.setdiff1d(np.flatnonzero(rise > _UPWARDS), blocks.jointed_facets)
    edges = np.setdiff1d(blocks.outline(where, "where"), blocks.jointed_facets)
    return np.asarray(edges[rise[edges] > -_UPWARDS])


def _cut(start: Floats, end: Floats, level: float) -> tuple[Floats, Floats]:
    """Return the parts of edges below a level that each of them reaches below."""
    along = end - start
    rise = np.where(along[1] == 0, 1.0, along[1])
    share = np.clip((level - start[1]) / rise, 0.0, 1.0)
    met = start + share * along
    return np.where(start[1] > level, met, start), np.where(end[1] > level, met, end)
