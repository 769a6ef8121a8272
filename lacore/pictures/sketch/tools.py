"""Rigid tools in the sketch of a problem: their outlines, names and motions."""

from collections.abc import Mapping

import numpy as np
import shapely
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import FancyArrowPatch, Patch

from lacore.model.materials.friction import friction_law
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats
from lacore.paths.tools.tool import Tool
from lacore.pictures.contact import GROUND
from lacore.pictures.sketch.conditions import law_text
from lacore.pictures.sketch.sheet import Label, Sheet

MOTION = "#7b3294"
_AROUND = 50.0  # points around the bodies, in which tools are shown
_ARROW = 34.0  # points: length of the arrow of the fastest tool
_ROUND = 13.0  # points: radius of the arrow of a turn
_BENT = 0.8  # how much that is curved
_FILL = "#ececec"


def draw_tools(sheet: Sheet, tools: Mapping[str, Tool], problem: Problem) -> None:
    """Draw tools as far as they are close to the bodies, with arrows along their motions.

    Straight arrows are as long as the velocities of the tools compare, curved ones show which way
    they turn.
    """
    boxes = np.array([body.box for body in problem.bodies.values()])
    around = _AROUND * sheet.point
    low, high = boxes[:, 0].min(axis=0) - around, boxes[:, 1].max(axis=0) + around
    fastest = max((float(np.hypot(*own.velocity)) for own in tools.values()), default=0.0)
    for name, tool in tools.items():
        seen = _draw_outline(sheet, tool, low, high, f"tool-{name}")
        sheet.tools.append(seen)
        middle = np.array(seen.representative_point().coords[0])
        sheet.labels.append(Label(name, middle, np.zeros(2), "#222222", plain=True, home=seen))
        law = f"tool: {law_text(friction_law(tool.friction, 'Tool.friction'), sheet.units)}"
        sheet.handles[law] = Patch(facecolor=_FILL, edgecolor=GROUND, hatch="//////", lw=0)
        if np.any(tool.velocity):
            half = _ARROW / 2 * sheet.point * np.array(tool.velocity) / fastest
            sheet.arrow(middle - half, middle + half, MOTION, f"tool-{name}-motion", width=2.2)
        if tool.turn:
            about = np.array(tool.reference)
            inside = shapely.contains_xy(seen, *about)
            _draw_turn(sheet, tool.turn, about if inside else middle, f"tool-{name}-turn")
        if tool.moves:
            arrow = Line2D([], [], color=MOTION, lw=1.6, marker=">", ms=5)
            sheet.handles["motion of a tool"] = arrow


def _draw_outline(
    sheet: Sheet, tool: Tool, low: Floats, high: Floats, gid: str
) -> shapely.Geometry:
    """Draw the part of a tool within a box, and return it."""
    box = shapely.box(*low, *high)
    face = tool.shape.outline(low, high)
    if np.allclose(face[:, 0], face[:, -1]):
        solid = shapely.Polygon(face.T)
    else:  # the face of a tool without end
        behind = face - np.linalg.norm(high - low) * tool.shape.normal(face)
        solid = shapely.MultiPoint(np.concatenate([face, behind], axis=1).T).convex_hull
    seen, edge = shapely.intersection([solid, shapely.LineString(face.T)], box)
    sheet.axes.add_collection(
        PolyCollection(
            [shapely.get_coordinates(own.exterior) for own in shapely.get_parts(seen)],
            facecolors=_FILL,
            edgecolors=GROUND,
            hatch="//////",
            linewidths=0,
            zorder=0.9,
            gid=gid,
        )
    )
    lines = [shapely.get_coordinates(own) for own in shapely.get_parts(edge)]
    sheet.axes.add_collection(LineCollection(lines, colors="#222222", linewidths=1.2, zorder=1.0))
    return seen


def _draw_turn(sheet: Sheet, turn: float, centre: Floats, gid: str) -> None:
    """Draw an arrow around a point, anticlockwise where the turn is positive."""
    aside = np.array([_ROUND * sheet.point, 0.0]) * np.sign(turn)
    sheet.axes.add_patch(
        FancyArrowPatch(
            tuple(centre + aside),
            tuple(centre - aside),
            connectionstyle=f"arc3,rad={_BENT * np.sign(turn)}",
            arrowstyle="-|>",
            mutation_scale=12,
            color=MOTION,
            lw=2.2,
            zorder=6,
            gid=gid,
        )
    )
