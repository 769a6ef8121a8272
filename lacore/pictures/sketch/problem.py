"""Sketch of a problem, before it is solved: what it consists of, how it is held and loaded."""

import re

import numpy as np
import shapely
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from lacore.arrays import Bools, Floats
from lacore.bodies.any_body import AnyBody
from lacore.bodies.blocks.block_assembly import BlockAssembly
from lacore.bodies.continuum.body import Body
from lacore.bodies.frames.frame import Frame
from lacore.meshes.curved import edge_lines, outlines
from lacore.pictures.axis import draw_axis, label_coordinates
from lacore.pictures.blocks import FIXED, fill_blocks
from lacore.pictures.sketch.conditions import (
    draw_interface,
    draw_joints,
    draw_support,
    held_blocks,
    joint_laws,
    law_colours,
    law_text,
)
from lacore.pictures.sketch.loads import draw_load
from lacore.pictures.sketch.sheet import Label, Sheet
from lacore.problem.problem import Problem

_POINTS = 72.0  # an inch
_PAGE, _TALLEST = 5.6, 3.9  # inches: the structure alone
_NARROWEST = 4.6  # inches: the legend needs that
_FLAT = 0.08  # a single beam has no height
_SOIL, _BLOCK, _OUTLINE = "#efe3c8", "#ece7dc", "#333333"
_FEW = 6  # contacts, that have their own labels; blocks, that have names


def plot_problem(problem: Problem) -> Figure:
    """Sketch of a problem: outlines, supports, obstacles, friction, loads with their sizes.

    Arrows of body forces start at the centroid and are worth their resultant. Artists carry the
    `gid` of what they show: ``support-0``, ``interface-0``, ``reference-load-0``, ``dead-load-0``,
    numbered as in the problem.

    Args:
        problem: any.
    """
    places = np.concatenate([_places(body) for body in problem.bodies.values()], axis=1)
    extent = np.ptp(places, axis=1)
    extent = np.maximum(extent, _FLAT * np.linalg.norm(extent))
    point = float(max(extent[0] / _PAGE, extent[1] / _TALLEST) / _POINTS)
    figure = Figure(layout="constrained")
    figure.set_facecolor("white")
    sheet = Sheet(figure.add_subplot(), point)
    held = {
        name: held_blocks(name, body, problem.supports)
        for name, body in problem.bodies.items()
        if isinstance(body, BlockAssembly)
    }
    for name, body in problem.bodies.items():
        _draw_body(sheet, body, held.get(name))
    for index, support in enumerate(problem.supports):
        body = problem.bodies[support.body]
        whole = not callable(support.where) and isinstance(body, BlockAssembly)
        draw_support(sheet, support, body, whole, f"support-{index}")
    _draw_contacts(sheet, problem)
    for kind, loads in (("reference", problem.reference_loads), ("dead", problem.dead_loads)):
        for index, load in enumerate(loads):
            body = problem.bodies[load.body]
            draw_load(sheet, load, body, kind == "reference", f"{kind}-load-{index}")
    _name_parts(sheet, problem, held)
    sheet.place_labels()
    for line in draw_axis(sheet.axes, problem.bodies.values()):
        sheet.handles["axis"] = line
    _finish(figure, sheet)
    label_coordinates(sheet.axes, problem.bodies.values())
    return figure


def _places(body: AnyBody) -> Floats:
    if isinstance(body, Body):
        return np.asarray(body.mesh.p)
    return body.edges.start if isinstance(body, BlockAssembly) else body.position


def _draw_body(sheet: Sheet, body: AnyBody, held: Bools | None) -> None:
    if isinstance(body, Body):
        _draw_continuum(sheet, body)
    elif isinstance(body, Frame):
        _draw_frame(sheet, body)
    else:
        assert held is not None
        polygons = list(body.polygons.values())
        fill_blocks(sheet.axes, polygons, held, 2.0)
        sheet.bodies.extend(shapely.Polygon(polygon) for polygon in polygons)
        for fixed, look, text in (
            (False, {"facecolor": _BLOCK, "edgecolor": "#555555"}, "rigid block"),
            (True, {"facecolor": FIXED, "edgecolor": "#666666", "hatch": "////"}, "held block"),
        ):
            if (held == fixed).any():
                sheet.handles[text] = Patch(**look, label=text)  # type: ignore[arg-type]


def _draw_continuum(sheet: Sheet, body: Body) -> None:
    mesh = body.mesh
    corners = outlines(mesh)
    # Edges in the colour of the faces leave no hairlines between them.
    fill = PolyCollection(
        list(corners), facecolors=_SOIL, edgecolors=_SOIL, linewidths=0.5, zorder=1.5
    )
    sheet.axes.add_collection(fill)
    outer = edge_lines(mesh, mesh.boundary_facets())
    sheet.axes.add_collection(
        LineCollection(outer, colors=_OUTLINE, linewidths=1.1, zorder=3, capstyle="round")
    )
    sheet.bodies.append(shapely.union_all(shapely.polygons(corners)))
    symbols = re.sub(r"(\w+ = [^\s,]+)", r"$\1$", body.criterion.label)
    text = f"rigid-plastic, {symbols}"
    sheet.handles[text] = Patch(facecolor=_SOIL, edgecolor=_OUTLINE)


def _draw_frame(sheet: Sheet, frame: Frame) -> None:
    pieces = frame.pieces
    lines = frame.position[:, pieces.nodes].transpose(1, 2, 0)
    sheet.axes.add_collection(
        LineCollection(list(lines), colors=_OUTLINE, linewidths=2.6, capstyle="round", zorder=3)
    )
    sheet.taken.extend(shapely.LineString(line).buffer(2 * sheet.point) for line in lines)
    released = ~pieces.stiff & (np.bincount(pieces.nodes.ravel())[pieces.nodes] > 1)
    piece, side = np.nonzero(released)
    if piece.size:
        inwards = np.where(side == 0, 1.0, -1.0) * pieces.along[:, piece]
        x, y = frame.position[:, pieces.nodes[piece, side]] + 6 * sheet.point * inwards
        sheet.axes.scatter(x, y, s=28, facecolor="white", edgecolor=_OUTLINE, zorder=5)
        sheet.handles["hinge without moment"] = Line2D(
            [], [], ls="none", marker="o", mfc="white", mec=_OUTLINE, ms=5.5
        )
    low, high = pieces.plastic_moment.min(), pieces.plastic_moment.max()
    size = f"{low:.4g}" if np.isclose(low, high) else rf"{low:.4g} \ldots {high:.4g}"
    sheet.handles[rf"member, $M_p = {size}$ N"] = Line2D([], [], color=_OUTLINE, lw=2.6)


def _name_parts(sheet: Sheet, problem: Problem, held: dict[str, Bools]) -> None:
    """Names of bodies, or of blocks, where there are several and few."""
    names = []
    for name, body in problem.bodies.items():
        if isinstance(body, BlockAssembly):
            if np.count_nonzero(~held[name]) > 1 or len(problem.bodies) > 1:
                polygons = map(shapely.Polygon, body.polygons.values())
                names += list(zip(body.names, body.centroid.T, polygons, strict=True))
        elif len(problem.bodies) > 1:
            places = _places(body)
            home = shapely.box(*places.min(axis=1), *places.max(axis=1))
            names.append((name, (places.min(axis=1) + places.max(axis=1)) / 2, home))
    if len(names) <= _FEW:
        sheet.labels += [
            Label(name, place, np.zeros(2), "#555555", plain=True, home=home)
            for name, place, home in names
        ]


def _draw_contacts(sheet: Sheet, problem: Problem) -> None:
    assemblies = [body for body in problem.bodies.values() if isinstance(body, BlockAssembly)]
    laws = [law_text(interface.law) for interface in problem.interfaces]
    joints = [text for body in assemblies for text in joint_laws(body)]
    colours = law_colours([*laws, *joints])
    several = len({*laws, *joints}) > 1
    label = len(laws) + len(joints) <= (_FEW if several else 2)
    for index, body in enumerate(assemblies):
        draw_joints(sheet, body, colours, label, f"joints-{index}")
    for index, (interface, text) in enumerate(zip(problem.interfaces, laws, strict=True)):
        draw_interface(sheet, interface, problem.bodies, colours[text], label, f"interface-{index}")


def _finish(figure: Figure, sheet: Sheet) -> None:
    """Limits around all that was drawn, at the scale that it was drawn for."""
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
    columns = max(int(page / 1.65), 2)
    axes.legend(
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
    rows = -(-len(sheet.handles) // columns)
    figure.set_size_inches(page, height + 0.6 + 0.2 * rows)
    figure.draw_without_rendering()
