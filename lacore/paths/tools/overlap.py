"""Tools that overlap bodies or each other where a path begins, and those that touch nothing."""

from collections.abc import Mapping, Sequence
from itertools import combinations

import numpy as np
import shapely

from lacore.model.bodies.continuum.body import Body
from lacore.model.contact.obstacles import Obstacle
from lacore.numerics.arrays import Floats
from lacore.paths.tools.carrier import corners_of
from lacore.reporting.errors import InputError
from lacore.reporting.text import Quantity, text

_FINE = 50  # parts of each piece of an outline
_TOUCH = 1e-6  # of the size of a body: tools that overlap less touch each other


def overlapping(tool: str, other: str, depth: float, place: tuple[float, float]) -> InputError:
    """What is wrong with a tool that overlaps something by a depth [m] near a place."""
    return InputError(
        f"tools[{tool!r}]",
        None,
        text(
            "overlaps {} by {} near {} before it moves",
            other,
            Quantity(depth, "m", ".3g"),
            Quantity(place, "m", ".4g"),
        ),
        "move the tool away from it, so that they touch or are apart",
    )


def require_apart(obstacles: Sequence[Obstacle], bodies: Mapping[str, Body]) -> None:
    """Raise `InputError` where a corner of a tool is inside a body, or two tools overlap.

    Args:
        obstacles: where the path begins; those at rest are not looked at.
        bodies: there.
    """
    tools = {own.carrier: own for own in obstacles if own.carrier is not None}
    for own in obstacles:
        if own.carrier is not None:
            _check_corners(own, own.carrier, bodies[own.body])
    boxes = np.concatenate([np.array(body.box) for body in bodies.values()] or [np.zeros((1, 2))])
    low, high = boxes.min(axis=0), boxes.max(axis=0)
    for (one, first), (other, second) in combinations(tools.items(), 2):
        found = max(_deepest(first, second, low, high), _deepest(second, first, low, high))
        depth, x, y = found
        if depth > _TOUCH * first.size:
            raise overlapping(other, f"tool {one!r}", depth, (x, y))


def contacts(obstacles: Sequence[Obstacle], bodies: Mapping[str, Body], within: float) -> list[str]:
    """What tools touch, or are closer to than a distance [m]: ``'wedge' on body.top``."""
    near = []
    for own in obstacles:
        if own.carrier is not None and distance(own, bodies[own.body]) <= within:
            near.append(f"{own.carrier!r} on {own.body}.{own.where}")
    return near


def distance(own: Obstacle, body: Body) -> float:
    """Of the part of a body that may touch a face, from this face, m."""
    mesh = body.mesh
    nodes = np.unique([*mesh.facets[:, own.facets].ravel(), *(mesh.nvertices + own.facets)])
    return float(own.shape.distance(mesh.doflocs[:, nodes]).min())


def _check_corners(own: Obstacle, tool: str, body: Body) -> None:
    corners = corners_of(own.shape)
    if not corners.shape[1]:
        return
    cells = body.mesh.p[:, body.mesh.t].transpose(2, 1, 0)
    solid = shapely.union_all(shapely.polygons(cells))
    points = shapely.points(corners.T)
    inside = shapely.contains(solid, points)
    depth = np.where(inside, shapely.distance(points, shapely.boundary(solid)), 0.0)
    worst = int(np.argmax(depth))
    if depth[worst] > own.touch:
        x, y = corners[:, worst].tolist()
        raise overlapping(tool, f"body {own.body!r}", float(depth[worst]), (x, y))


def _deepest(
    own: Obstacle, other: Obstacle, low: Floats, high: Floats
) -> tuple[float, float, float]:
    """How deep the outline of a closed shape is inside another closed one, and where."""
    line, closed = own.shape.outline(low, high), other.shape.outline(low, high)
    if not all(np.allclose(part[:, 0], part[:, -1]) for part in (line, closed)):
        return 0.0, 0.0, 0.0  # planes and wedges have no end, and may cross far away
    shares = np.arange(_FINE) / _FINE
    points = (line[:, :-1, None] + np.diff(line)[:, :, None] * shares).reshape(2, -1)
    depth = -other.shape.distance(points)
    worst = int(np.argmax(depth))
    x, y = points[:, worst].tolist()
    return float(depth[worst]), x, y
