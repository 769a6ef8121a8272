"""Bodies in the sketch of a problem: the shape of each kind, and the names of its parts."""

from functools import singledispatch

import numpy as np
import shapely
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from lacore.model.bodies.any_body import AnyBody
from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.blocks.dofs import RigidDofs
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.frames.frame import Frame
from lacore.model.meshes.curved import edge_lines, outlines
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Bools, Floats
from lacore.pictures.blocks import FIXED, fill_blocks
from lacore.pictures.mesh import shaded
from lacore.pictures.sketch.sheet import Label, Sheet, quantity
from lacore.reporting.text import Reader, render

_FEW = 6  # number of regions up to which each has an entry of the legend
_BLOCK, _OUTLINE, _NAME = "#ece7dc", "#333333", "#555555"


@singledispatch
def draw_body(body: AnyBody, sheet: Sheet, name: str, problem: Problem) -> None:
    """Draw the body of that name in a problem."""
    raise TypeError(f"nothing sketches a {type(body).__name__}")


@draw_body.register
def _continuum(body: Body, sheet: Sheet, name: str, problem: Problem) -> None:
    mesh = body.mesh
    corners = outlines(mesh)
    many = len(body.regions) > _FEW
    whole = _plain(name) if len(problem.bodies) > 1 else "rigid-plastic"
    # Each body has its own colours, for any material.
    sheet.shades[name] = list(shaded(body, sum(map(len, sheet.shades.values()))))
    # Edges in the colour of the faces leave no hairlines between them.
    for region, colour in sheet.shades[name]:
        fill = PolyCollection(
            list(corners[region.elements]),
            facecolors=colour,
            edgecolors=colour,
            linewidths=0.5,
            zorder=1.5,
        )
        sheet.axes.add_collection(fill)
        named = _plain(region.name) or whole
        text = f"{named}, {render(region.label, Reader(sheet.units, mathtext=True))}"
        if many:
            text = f"{whole}, {len(body.regions)} regions"
        sheet.handles[text] = Patch(facecolor=colour, edgecolor=_OUTLINE)
    outer = edge_lines(mesh, mesh.boundary_facets())
    sheet.axes.add_collection(
        LineCollection(outer, colors=_OUTLINE, linewidths=1.1, zorder=3, capstyle="round")
    )
    sheet.bodies.append(shapely.union_all(shapely.polygons(corners)))


def _plain(name: str) -> str:
    """Return a user's name with dollars that do not start mathematics."""
    return name.replace("$", r"\$")


@draw_body.register
def _frame(frame: Frame, sheet: Sheet, name: str, problem: Problem) -> None:
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
        sheet.handles["pinned end"] = Line2D(
            [], [], ls="none", marker="o", mfc="white", mec=_OUTLINE, ms=5.5
        )
    finite = pieces.plastic_moment[(pieces.plastic_moment > 0) & np.isfinite(pieces.plastic_moment)]
    for kind, there in (
        ("bar", ~pieces.stiff.any(axis=1) & (pieces.plastic_moment == 0)),
        ("rigid member", np.isinf(pieces.plastic_moment)),
    ):
        if there.any():
            sheet.handles[kind] = Line2D([], [], color=_OUTLINE, lw=2.6)
    if finite.size:
        low, high = finite.min(), finite.max()
        most, unit = quantity(high, "N", sheet.units, framed=True)
        least, _ = quantity(low, "N", sheet.units, framed=True)
        size = most if np.isclose(low, high) else rf"{least} \ldots {most}"
        sheet.handles[rf"member, $M_p = {size}$ {unit}"] = Line2D([], [], color=_OUTLINE, lw=2.6)


@draw_body.register
def _blocks(body: BlockAssembly, sheet: Sheet, name: str, problem: Problem) -> None:
    held = _held(body, name, problem)
    polygons = list(body.polygons.values())
    fill_blocks(sheet.axes, polygons, held, 2.0)
    sheet.bodies.extend(shapely.Polygon(polygon) for polygon in polygons)
    for fixed, look, text in (
        (False, {"facecolor": _BLOCK, "edgecolor": "#555555"}, "rigid block"),
        (True, {"facecolor": FIXED, "edgecolor": "#666666", "hatch": "////"}, "fixed block"),
    ):
        if (held == fixed).any():
            sheet.handles[text] = Patch(**look, label=text)  # type: ignore[arg-type]


@singledispatch
def part_names(body: AnyBody, name: str, problem: Problem) -> list[Label]:
    """Return the label with its name, if there are several bodies."""
    low, high = body.box
    home = shapely.box(*low, *high)
    return [_named(name, (low + high) / 2, home)] if len(problem.bodies) > 1 else []


@part_names.register
def _block_names(body: BlockAssembly, name: str, problem: Problem) -> list[Label]:
    """Return the labels of its blocks, if several move or there are several bodies."""
    if np.count_nonzero(~_held(body, name, problem)) <= 1 and len(problem.bodies) == 1:
        return []
    homes = map(shapely.Polygon, body.polygons.values())
    return [_named(*part) for part in zip(body.names, body.centroid.T, homes, strict=True)]


def _named(name: str, place: Floats, home: shapely.Geometry) -> Label:
    return Label(name, place, np.zeros(2), _NAME, plain=True, home=home)


def _held(body: BlockAssembly, name: str, problem: Problem) -> Bools:
    """Return which blocks have no velocity because of supports, shape (blocks,)."""
    basis = RigidDofs(body, 0).free([s for s in problem.supports if s.body == name])
    largest = np.asarray(abs(basis).max(axis=1).todense()).reshape(-1, 3)
    return np.asarray(~np.any(largest > 0, axis=1))
