"""Sketch of a problem before it is solved: its parts, supports and loads."""

from collections.abc import Mapping

import numpy as np
from matplotlib.figure import Figure

from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.continuum.body import Body
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats
from lacore.paths.tools.tool import Tool
from lacore.pictures.axis import draw_axis, label_coordinates, lay_out
from lacore.pictures.sketch.bodies import draw_body, part_names
from lacore.pictures.sketch.conditions import (
    draw_interface,
    draw_joints,
    draw_support,
    joint_laws,
    law_colours,
    law_text,
)
from lacore.pictures.sketch.loads import draw_load
from lacore.pictures.sketch.sheet import Sheet
from lacore.pictures.sketch.tools import draw_tools
from lacore.pictures.space.acting import sketch_of_faces
from lacore.pictures.space.problem import sketch_in_space
from lacore.reporting.units import Units, fitting

_POINTS = 72.0  # per inch
_PAGE, _TALLEST = 5.6, 3.9  # inches: the structure alone
_NARROWEST = 4.6  # inches: needed by the legend
_LEFT = 45.0  # points: numbers of an axis left of the legend
_FLAT = 0.08  # A single beam has no height.
_FEW = 6  # number of contacts with separate labels, and of blocks with names


def plot_problem(
    problem: Problem, units: Units | None = None, tools: Mapping[str, Tool] | None = None
) -> Figure:
    """Sketch of a problem: outlines, supports, obstacles, friction, loads with their sizes.

    Arrows of body forces start at the centroid and show their resultant. Artists carry the
    `gid` of what they show: ``support-0``, ``interface-0``, ``reference-load-0``, ``dead-load-0``,
    numbered as in the problem.

    Args:
        problem: any.
        units: of labels; m, and a prefix that fits most forces, if None.
        tools: of a path of a plane problem, see `lacore.sequential`: their outlines and motions.
    """
    units = units or Units(fitting(problem.sizes))
    if problem.dimension == 3:
        drawn = sketch_of_faces if of_kind(problem.bodies, Body) else sketch_in_space
        return drawn(problem, units)
    extent = extent_of(problem)
    point = float(max(extent[0] / _PAGE, extent[1] / _TALLEST) / _POINTS)
    figure = Figure(layout="constrained")
    figure.set_facecolor("white")
    sheet = Sheet(figure.add_subplot(), point, units)
    draw_problem(sheet, problem)
    draw_tools(sheet, tools or {}, problem)
    _name_parts(sheet, problem)
    sheet.place_labels()
    for line in draw_axis(sheet.axes, problem.bodies.values()):
        sheet.handles["axis"] = line
    label_coordinates(sheet.axes, problem.bodies.values(), units)
    _finish(figure, sheet)
    return figure


def extent_of(problem: Problem) -> Floats:
    """Return the width and height of the bodies of a plane problem, m, shape (2,)."""
    corners = np.array([body.box for body in problem.bodies.values()])
    extent = corners[:, 1].max(axis=0) - corners[:, 0].min(axis=0)
    return np.asarray(np.maximum(extent, _FLAT * np.linalg.norm(extent)))


def draw_problem(sheet: Sheet, problem: Problem) -> None:
    """Draw bodies, supports, contact and loads of a plane problem; labels are left to be placed."""
    for name, body in problem.bodies.items():
        draw_body(body, sheet, name, problem)
    for index, support in enumerate(problem.supports):
        draw_support(sheet, support, problem.bodies[support.body], f"support-{index}")
    _draw_contacts(sheet, problem)
    for kind, loads in (("reference", problem.reference_loads), ("dead", problem.dead_loads)):
        for index, load in enumerate(loads):
            body = problem.bodies[load.body]
            draw_load(sheet, load, body, kind == "reference", f"{kind}-load-{index}")


def _name_parts(sheet: Sheet, problem: Problem) -> None:
    """Draw the names of bodies, or of blocks, if there are several and few."""
    names = [
        label for name, body in problem.bodies.items() for label in part_names(body, name, problem)
    ]
    if len(names) <= _FEW:
        sheet.labels += names


def _draw_contacts(sheet: Sheet, problem: Problem) -> None:
    assemblies = of_kind(problem.bodies, BlockAssembly).values()
    laws = [law_text(interface.law, sheet.units) for interface in problem.interfaces]
    joints = [text for body in assemblies for text in joint_laws(body, sheet.units)]
    colours = law_colours([*laws, *joints])
    several = len({*laws, *joints}) > 1
    label = len(laws) + len(joints) <= (_FEW if several else 2)
    for index, body in enumerate(assemblies):
        draw_joints(sheet, body, colours, label, f"joints-{index}")
    for index, (interface, text) in enumerate(zip(problem.interfaces, laws, strict=True)):
        draw_interface(sheet, interface, problem.bodies, colours[text], label, f"interface-{index}")


def _finish(figure: Figure, sheet: Sheet) -> None:
    """Set limits around everything, with the scale for which it was drawn."""
    low, high = sheet.bounds()
    margin = 4 * sheet.point
    axes = sheet.axes
    axes.set_aspect("equal", anchor="SW")
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)
    axes.tick_params(labelsize=8)
    axes.locator_params(nbins=7)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for text, handle in sheet.handles.items():
        handle.set_label(text)
    width, height = (high - low + 2 * margin) / sheet.point / _POINTS
    page = max(width + 0.65, _NARROWEST)
    # As many columns as the width of the page allows for any texts.
    columns = len(sheet.handles) + 1
    shown = np.inf
    while columns > 1 and shown > page * _POINTS:
        columns -= 1
        legend = axes.legend(
            handles=list(sheet.handles.values()),
            loc="lower left",
            bbox_to_anchor=(0, 1.0),
            ncols=columns,
            frameon=False,
            fontsize=8,
            handlelength=1.6,
            columnspacing=1.2,
            borderaxespad=0.2,
        )
        shown = legend.get_window_extent().width * _POINTS / figure.dpi + _LEFT
    page = max(page, shown / _POINTS)
    rows = -(-len(sheet.handles) // columns)
    figure.set_size_inches(page, height + 0.6 + 0.2 * rows)
    lay_out(figure)
