"""Three-dimensional polygons, lines and axes drawn by matplotlib."""

from collections.abc import Sequence
from dataclasses import dataclass

import matplotlib.colors
import numpy as np
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec
from matplotlib.ticker import FuncFormatter, MaxNLocator
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection
from mpl_toolkits.mplot3d.axes3d import Axes3D

from lacore.numerics.arrays import Floats, Ints
from lacore.pictures.space.structure import Blocks, from_behind
from lacore.reporting.units import Units

ELEVATION, AZIMUTH = 24.0, -58.0  # degrees: direction of the view
Colour = tuple[str, float]
_LIGHT = np.array([-0.35, -0.6, 0.72])  # towards the light, from over the left shoulder
_SHADOW = 0.62  # brightness of sides without light
_PAGE = 5.4, 5.2  # inches, of a picture
_LINE = 0.45  # grey of edges
_MANY = 150  # number of blocks from which lines are thin
_MARGIN = 0.02  # by the extent


def page(count: int, title: str) -> tuple[Figure, list[SubplotSpec]]:
    """Return a figure with places for pictures side by side, and their legends above them."""
    width, height = _PAGE
    figure = Figure(figsize=(width * count, height))
    figure.set_facecolor("white")
    figure.suptitle(title, fontsize=11, x=0.05 / count, y=0.985, ha="left", va="top")
    grid = figure.add_gridspec(
        1, count, left=0.0, right=1 - 0.09 / count, bottom=0.03, top=0.84, wspace=0.04
    )
    return figure, [grid[0, column] for column in range(count)]


def explain(axes: Axes3D, handles: Sequence[Artist], columns: int = 3) -> None:
    """Draw the legend of a picture, above it."""
    axes.legend(
        handles=list(handles),
        loc="lower left",
        bbox_to_anchor=(0.04, 0.97),
        ncols=columns,
        frameon=False,
        fontsize=8,
        handlelength=1.6,
        columnspacing=1.2,
        borderaxespad=0.2,
    )


def space(figure: Figure, cell: SubplotSpec, low: Floats, high: Floats, units: Units) -> Axes3D:
    """Return axes around a box (two corners, m), equally scaled, in parallel projection."""
    axes = figure.add_subplot(cell, projection="3d", proj_type="ortho", computed_zorder=False)
    assert isinstance(axes, Axes3D)
    axes.view_init(elev=ELEVATION, azim=AZIMUTH)
    middle, extent = (low + high) / 2, np.maximum(high - low, _MARGIN * np.linalg.norm(high - low))
    half = (0.5 + _MARGIN) * extent
    metre = units.size("m")

    def told(place: float, _: float) -> str:
        return f"{round(place / metre, 9):g}"

    for name, m, h in zip("xyz", middle, half, strict=True):
        getattr(axes, f"set_{name}lim")(m - h, m + h)
        axis = getattr(axes, f"{name}axis")
        axis.set_pane_color((1.0, 1.0, 1.0, 0.0))
        axis.set_major_locator(_ticks(2 * h, 2 * half.max()))
        axis.set_major_formatter(FuncFormatter(told))
        axis.line.set_color("#bbbbbb")
        getattr(axes, f"set_{name}label")(f"{name} [{units.length}]", fontsize=8)
    axes.grid(visible=False)
    axes.tick_params(labelsize=7, pad=-1)
    axes.set_box_aspect(half / half.max(), zoom=1.05)
    return axes


def _ticks(extent: float, largest: float) -> MaxNLocator:
    return MaxNLocator(max(1, round(5 * extent / largest)))


def eye() -> Floats:
    """Return the unit vector towards the viewer."""
    tall, around = np.radians([ELEVATION, AZIMUTH])
    return np.array([np.cos(tall) * np.cos(around), np.cos(tall) * np.sin(around), np.sin(tall)])


def normals_of(points: Floats, faces: Sequence[Ints]) -> Floats:
    """Return the unit normals of polygons, by the right-hand rule, (3, k)."""
    flat = np.concatenate(faces)
    counts = np.array([len(face) for face in faces])
    first = np.cumsum(counts) - counts
    following = np.arange(1, flat.size + 1)
    following[first + counts - 1] = first
    corner = points[:, flat[first]].repeat(counts, axis=1)
    one, two = points[:, flat] - corner, points[:, flat[following]] - corner
    vector = np.add.reduceat(np.cross(one, two, axis=0), first, axis=1)
    return np.asarray(vector / np.maximum(np.linalg.norm(vector, axis=0), np.finfo(float).tiny))


def fill_solids(
    axes: Axes3D, points: Floats, blocks: Blocks, colours: Sequence[str], zorder: float
) -> None:
    """Draw visible surfaces: without sides that face away, and far blocks first.

    Args:
        axes: axes.
        points: vertices of the blocks, displaced or not, (3, n), m.
        blocks: blocks with these vertices.
        colours: colour of each block.
        zorder: order of drawing.
    """
    shown = faces_of(points, blocks, colours)
    thin = 0.5 if blocks.radius.size < _MANY else 0.25
    for place, own in enumerate(shown.from_behind):
        axes.add_collection3d(
            Poly3DCollection(
                [points[:, blocks.faces[face]].T for face in shown.face[own].tolist()],
                facecolors=shown.filled[own],
                edgecolors=shown.lined[own],
                linewidths=thin,
                zorder=zorder + place / len(shown.from_behind),
            )
        )


@dataclass(frozen=True)
class ShadedFaces:
    """Faces of blocks that face the viewer.

    Attributes:
        face: Numbers of the polygons of the blocks, shape (k,).
        filled, lined: Colours of the faces and of their edges, shape (k, 3).
        from_behind: Places in `face` of the faces of each block; each block hides those before.
    """

    face: Ints
    filled: Floats
    lined: Floats
    from_behind: list[Ints]


def faces_of(points: Floats, blocks: Blocks, colours: Sequence[str]) -> ShadedFaces:
    """Return the visible faces of blocks, shaded.

    Args:
        points: Vertices of the blocks, displaced or not, m, shape (3, n).
        blocks: Blocks that have these vertices.
        colours: Colour of each block.
    """
    normal = normals_of(points, blocks.faces)
    seen = np.flatnonzero(eye() @ normal > 0)
    light = np.maximum(_LIGHT @ normal / np.linalg.norm(_LIGHT), 0.0)
    shade = (_SHADOW + (1 - _SHADOW) * light[seen])[:, None]
    owner = blocks.block[[blocks.faces[face][0] for face in seen.tolist()]]
    rgb = np.array([matplotlib.colors.to_rgb(colours[block]) for block in owner.tolist()])
    filled = np.clip(shade * rgb, 0.0, 1.0)
    lined = np.where(blocks.whole[seen, None], _LINE, filled)
    order = [np.flatnonzero(owner == block) for block in from_behind(blocks, eye())]
    return ShadedFaces(seen, filled, lined, order)


def on_screen(points: Floats) -> tuple[Floats, Floats]:
    """Project points of shape (3, ...) onto the view.

    Returns:
        Their places to the right and upwards, m, shape (2, ...), and their depth, m.
    """
    around = np.radians(AZIMUTH)
    right = np.array([-np.sin(around), np.cos(around), 0.0])
    up = np.cross(eye(), right)
    return np.tensordot(np.stack([right, up]), points, 1), np.tensordot(eye(), points, 1)


def draw_edges(axes: Axes3D, points: Floats, blocks: Blocks, colour: str, zorder: float) -> None:
    """Draw edges of blocks as thin lines, including those behind solids."""
    lines = points[:, blocks.edges].transpose(2, 1, 0)
    axes.add_collection3d(
        Line3DCollection(list(lines), colors=colour, linewidths=0.4, zorder=zorder)
    )


def fill_polygons(
    axes: Axes3D, polygons: Sequence[Floats], colours: Sequence[Colour], zorder: float
) -> None:
    """Draw plane polygons (3, k) with colours and opacity, far ones first."""
    axes.add_collection3d(
        Poly3DCollection(
            [own.T for own in polygons],
            facecolors=[matplotlib.colors.to_rgba(*own) for own in colours],
            edgecolors=[own for own, _ in colours],
            linewidths=0.4,
            zorder=zorder,
        )
    )


def draw_lines(axes: Axes3D, ends: Floats, widths: Floats, colour: str, zorder: float) -> None:
    """Draw straight lines (3, 2, k), m, of widths (k,) in points."""
    axes.add_collection3d(
        Line3DCollection(
            list(ends.transpose(2, 1, 0)),
            colors=colour,
            linewidths=widths,
            capstyle="round",
            zorder=zorder,
        )
    )
