"""Sketch of a problem of three-dimensional blocks with supports and loads."""

import numpy as np
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from mpl_toolkits.mplot3d.axes3d import Axes3D

from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.blocks.loads import carried
from lacore.model.bodies.blocks3d.block_assembly import BlockAssembly3D
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats
from lacore.pictures.space.drawing import explain, fill_polygons, fill_solids, page, space
from lacore.pictures.space.structure import Blocks, blocks_of
from lacore.reporting.showing import cut
from lacore.reporting.text import Reader, render
from lacore.reporting.units import Units

FREE, FIXED = "#ece2cd", "#a8a8a8"
_GROUND = "#8c6d46"
_LIVE, _DEAD = "#0f7b3f", "#6b6b6b"
_FEW = 40  # number of arrows that a reader can distinguish
_ARROW = 0.22  # by the size of the structure: the longest
_LONGEST = 60  # characters of a legend
_ROUND_OFF = 1e-9  # by the largest force


def sketch_in_space(problem: Problem, units: Units) -> Figure:
    """Draw blocks, held ones grey, faces on obstacles brown, and loads as arrows.

    More than a few arrows are replaced by their resultant.

    Args:
        problem: problem of three-dimensional blocks.
        units: units of sizes.
    """
    bodies = of_kind(problem.bodies, BlockAssembly3D)
    blocks = blocks_of(bodies.items())
    figure, (place,) = page(1, "")
    low, high = blocks.points.min(axis=1), blocks.points.max(axis=1)
    axes = space(figure, place, low, high, units)
    handles: list[Artist] = []
    if problem.supports:
        handles.append(Patch(facecolor=FIXED, edgecolor="#555555", label="fixed"))
    fill_solids(axes, blocks.points, blocks, block_colours(problem, blocks), 2.0)
    for interface in problem.interfaces:
        (name, where), *master = interface.sides
        if master:
            continue
        faces = bodies[name].outline(where, "Interface.slave")
        corners, owner = bodies[name].corners_of(faces)
        polygons = [corners[:, owner == face] for face in faces]
        fill_polygons(axes, polygons, [(_GROUND, 0.5)] * len(polygons), 1.0)
        label = cut(render(interface.name, Reader(units)), _LONGEST)
        handles.append(Patch(facecolor=_GROUND, alpha=0.5, label=label))
    for loads, colour in ((problem.dead_loads, _DEAD), (problem.reference_loads, _LIVE)):
        for load in loads:
            _, points, force = carried(load, bodies[load.body])
            _draw_arrows(axes, points, force, colour, blocks)
            label = cut(render(load.told, Reader(units, framed=True)), _LONGEST)
            handles.append(Line2D([], [], color=colour, lw=2, marker=">", label=label))
    explain(axes, handles, 1)
    return figure


def block_colours(problem: Problem, blocks: Blocks) -> list[str]:
    """Return the colours of blocks: held ones are grey."""
    bodies = of_kind(problem.bodies, BlockAssembly3D)
    colours = [FREE] * blocks.radius.size
    for support in problem.supports:
        body = bodies[support.body]
        held = body.faces.block[body.outline(support.where, "Fix.where")]
        for block in np.unique(held + blocks.first[support.body]).tolist():
            colours[block] = FIXED
    return colours


def _draw_arrows(axes: Axes3D, points: Floats, force: Floats, colour: str, blocks: Blocks) -> None:
    """Draw forces at points, (3, k) each, as arrows that end there."""
    size = np.linalg.norm(force, axis=0)
    own = size > _ROUND_OFF * size.max(initial=0.0)
    points, force, size = points[:, own], force[:, own], size[own]
    if size.size > _FEW or np.unique(np.round(points / blocks.size, 9), axis=1).shape[1] > _FEW:
        points = (points * size).sum(axis=1, keepdims=True) / size.sum()
        force = force.sum(axis=1, keepdims=True)
        size = np.linalg.norm(force, axis=0)
    if not size.max(initial=0.0) > 0:
        return
    arrow = _ARROW * blocks.size * force / size.max()
    axes.quiver(
        *(points - arrow), *arrow, color=colour, linewidth=2.0, arrow_length_ratio=0.3, zorder=4
    )
