"""Pictures of paths: bodies coloured by their strain, and the load over the travel."""

from collections.abc import Iterable, Sequence

import matplotlib
import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon
from matplotlib.tri import Triangulation
from skfem import Mesh

from lacore.model.bodies.continuum.nodal import corner_shapes, vertex_means
from lacore.model.conditions.footings import footings
from lacore.model.meshes.curved import edge_lines, outlines
from lacore.numerics.arrays import Floats, Ints
from lacore.paths import drift
from lacore.paths.configuration import Configuration
from lacore.paths.contact.poses import placed
from lacore.paths.flow import Snapshot
from lacore.paths.path import Path
from lacore.paths.stage import Stage
from lacore.pictures.axis import colour_bar, draw_axis, label_coordinates, lay_out
from lacore.pictures.contact import GROUND, PLANE_DEPTH, draw_obstacle
from lacore.pictures.continua import BEFORE
from lacore.reporting.showing import counted
from lacore.reporting.units import FORCES, fitting

_PAGE = 10.0  # inches
_TALLEST = 6.0
_CURVE = 3.4  # inches: width, or height if it is below
_WIDE = 0.45  # height over width of bodies below which the load is drawn below them
_MARGIN = 0.04  # margin around bodies, by their size
_FORCE = (6.4, 4.0)  # inches
_FINE = 4  # number of parts of an edge for its colours
_MANY = 2000  # number of elements above which edges would cover the colours
_FEW = 60  # number of steps up to which each has a dot
_TICK, _TICK_WIDTH = 0.055, 0.005  # size of an event, by height and width of the axes
_NOTHING = 1e-6  # by the load: friction without a line
_MAP = "YlOrRd"
_EVENTS = {
    "peak load": "#b2182b",
    "peak force": "#762a83",
    "contact closed": "#0072b2",
    "contact opened": "#e69f00",
    "inversion predicted": "#000000",
    "remeshed": "#5e3c99",
    drift.DRIFTS: "#d6604d",
    drift.SELECTED: "#1b7837",
    drift.LOST: "#8c510a",
}
_LOAD, _PLASTIC, _FRICTION = "#222222", "#b35806", "#0072b2"
FOOTING = _PLASTIC
TOOL = "#d5d5d5"


def plot_path(path: Path) -> Figure:
    """Plot the bodies at the end of a path, and the load over the travel.

    Bodies are coloured by their equivalent strain: means around vertices
    (`lacore.model.bodies.continuum.nodal.vertex_means`), linear between, which are below the
    largest strain of a point, `PathStep.max_strain`. Element edges are drawn as curves. Peaks of
    the load are marked at their step, other events at the bottom, stacked for equal travels.
    """
    figure, bodies, load = page(path)
    draw_bodies(bodies, path, path.snapshots[-1], strain_scale(path))
    draw_load(load, path)
    lay_out(figure)
    return figure


def plot_force(path: Path) -> Figure:
    """Plot the force of the control over the travel, see `PathStep.force`.

    With `Time` as control it is the power of the reference loads.
    """
    figure = Figure(figsize=_FORCE, layout="constrained", facecolor="white")
    axes, forced = figure.add_subplot(), path.unit == "m"
    whole = any(body.axisymmetric for body in path.stage.bodies.values())
    unit = fitting(path.history["force"]) if forced else "N"
    force = path.history["force"] / FORCES[unit]
    axes.plot(path.history["travel"], force, color=_LOAD, lw=1.6)
    if len(path.history) <= _FEW:
        axes.plot(path.history["travel"], force, ".", color=_LOAD, ms=5)
    axes.set_title(f"{counted(len(path.history), 'step')}, status: {path.status.label}", loc="left")
    axes.set_xlabel(f"travel [{path.unit}]" if path.unit else "travel")
    label = f"force [{unit}]" if whole else f"force [{unit}/m]"
    axes.set_ylabel(label if forced else "power per rate of the travel")
    axes.set_xlim(0, (1 + _MARGIN) * (path.snapshots[-1].travel or 1.0))
    if not path.history.empty:
        axes.set_ylim(bottom=min(0.0, float(force.min())))
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    return figure


def page(path: Path) -> tuple[Figure, Axes, Axes]:
    """Return a figure with the axes of the bodies, their colour bar, and the axes of the load."""
    low, high = _box(path)
    extent = high - low
    aspect = float(extent[1] / extent[0])
    beside = aspect > _WIDE
    bodies = np.array([_PAGE - _CURVE - 1.6, 0.0]) if beside else np.array([_PAGE - 1.6, 0.0])
    bodies[1] = min(bodies[0] * aspect, _TALLEST - 1.4)
    if beside:
        width = max(bodies[1] / aspect, 2.6)
        size, ratios = (width + _CURVE + 1.9, max(bodies[1] + 1.4, 3.4)), [width + 0.9, _CURVE]
        figure = Figure(figsize=size, layout="constrained")
        grid = figure.add_gridspec(1, 2, width_ratios=ratios)
    else:
        size, ratios = (_PAGE, bodies[1] + _CURVE + 1.4), [bodies[1] + 0.6, _CURVE - 0.6]
        figure = Figure(figsize=size, layout="constrained")
        grid = figure.add_gridspec(2, 1, height_ratios=ratios)
    figure.set_facecolor("white")
    figure.suptitle(_title(path), fontsize=11, x=0.01, ha="left")
    left, right = figure.add_subplot(grid[0]), figure.add_subplot(grid[1])
    label = "equivalent strain\naveraged at the vertices"
    if not path.history.empty:
        label += f"\n(maximum at a point: {path.history['max_strain'].max():.3g})"
    colour_bar(ScalarMappable(strain_scale(path), matplotlib.colormaps[_MAP]), left, label)
    return figure, left, right


def strain_scale(path: Path) -> Normalize:
    """Return the scale of all snapshots, from 0 to the largest mean around a vertex."""
    highest = max(
        float(values.max()) for own in path.snapshots for _, values in _coloured(path, own)
    )
    return Normalize(0.0, highest or 1.0)


def draw_bodies(axes: Axes, path: Path, snapshot: Snapshot, scale: Normalize) -> None:
    """Draw bodies and obstacles; the limits are those of the whole path."""
    stage = path.stage
    for body in stage.bodies.values():
        lines = edge_lines(body.mesh, body.mesh.boundary_facets())
        axes.add_collection(LineCollection(lines, **BEFORE, zorder=1))
    for mesh, values in _coloured(path, snapshot):
        places, colours, triangles = _lattice(mesh, values)
        shape = Triangulation(places[0], places[1], triangles)
        colour = axes.tripcolor(shape, colours, shading="gouraud", norm=scale, cmap=_MAP)
        colour.set_zorder(2)
        colour.set_rasterized(True)
        width = 0.35 if mesh.nelements < _MANY else 0.12
        axes.add_collection(
            PolyCollection(
                list(outlines(mesh)),
                facecolors="none",
                edgecolors=(0, 0, 0, 0.3),
                linewidths=width,
                zorder=3,
            )
        )
        lines = edge_lines(mesh, mesh.boundary_facets())
        axes.add_collection(LineCollection(lines, colors="#222222", linewidths=1.0, zorder=4))
    before = Line2D([], [], color="#999999", lw=0.8, ls=(0, (4, 3)), label="initial shape")
    axis = draw_axis(axes, stage.bodies.values())
    handles: list[Artist] = [before, *axis]
    handles += _draw_tools(axes, path, snapshot)
    low, high = _box(path)
    obstacles = path.stage_of(snapshot).obstacles_at(snapshot.configuration)
    for obstacle in obstacles:
        draw_obstacle(axes, obstacle.shape, low, high)
    for label in dict.fromkeys("tool" if own.carrier else "obstacle" for own in obstacles):
        handles.append(Patch(facecolor="none", edgecolor=GROUND, hatch="//////", label=label))
    axes.set_xlim(min(low[0], 0.0) if axis else low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.set_aspect("equal", anchor="SW")
    axes.tick_params(labelsize=8)
    label_coordinates(axes, stage.bodies.values())
    _finish(axes, handles)


def draw_load(axes: Axes, path: Path, until: float = np.inf) -> None:
    """Draw load factor, its parts and events over the travel, faint beyond `until`."""
    table = path.history
    handles: list[Artist] = []
    parts = [("load_factor", _LOAD, 1.6, "load factor")]
    if (table["friction"].abs() > _NOTHING * table["load_factor"].abs()).any():
        parts.append(("plastic", _PLASTIC, 1.0, "plastic power"))
        parts.append(("friction", _FRICTION, 1.0, "friction"))
    for name, colour, width, label in parts:
        axes.plot(table["travel"], table[name], color=colour, lw=width, alpha=0.25)
        past = table[table["travel"] <= until]
        (line,) = axes.plot(past["travel"], past[name], color=colour, lw=width, label=label)
        handles.append(line)
        if name == "load_factor" and len(table) <= _FEW:
            axes.plot(past["travel"], past[name], ".", color=colour, ms=5)
        if name == "load_factor" and not past.empty and np.isfinite(until):
            axes.plot(past["travel"].iloc[-1], past[name].iloc[-1], "o", color=colour, ms=6)
    axes.set_xlabel(f"travel [{path.unit}]" if path.unit else "travel", fontsize=9)
    axes.locator_params(axis="x", nbins=4)  # Numbers of small travels are long.
    axes.set_ylabel("load factor", fontsize=9)
    axes.set_xlim(0, (1 + _MARGIN) * (path.snapshots[-1].travel or 1.0))
    handles += _draw_events(axes, path, until)
    if not table.empty:
        axes.set_ylim(bottom=min(0.0, *(float(table[name].min()) for name, *_ in parts)))
    axes.tick_params(labelsize=8)
    _finish(axes, handles)


def _draw_events(axes: Axes, path: Path, until: float) -> list[Artist]:
    handles: list[Artist] = []
    marked: list[Floats] = []
    for kind, colour in _EVENTS.items():
        own = path.events[(path.events["kind"] == kind) & (path.events["travel"] <= until)]
        if not (path.events["kind"] == kind).any():
            continue
        if kind == "peak load":
            rows = path.history.set_index("step").loc[own["step"]]
            axes.plot(rows["travel"], rows["load_factor"], "v", color=colour, ms=7, zorder=5)
            handles.append(Line2D([], [], color=colour, marker="v", lw=0, label=kind))
            continue
        marked.append(_rug(axes, own["travel"], colour, marked))
        handles.append(Line2D([], [], color=colour, marker="|", mew=1.6, lw=0, label=kind))
    return handles


def _rug(axes: Axes, travels: "pd.Series[float]", colour: str, below: Sequence[Floats]) -> Floats:
    """Draw ticks on the axis below, on top of those that are there; return their travels."""
    at = np.unique(travels)
    near = _TICK_WIDTH * axes.get_xlim()[1]
    here = [(np.abs(at[:, None] - others) < near).any(axis=1) for others in below]
    foot = _TICK * np.sum(here, axis=0) + np.zeros(at.size)
    axes.vlines(
        at, foot, foot + 0.8 * _TICK, colors=colour, lw=1.6, transform=axes.get_xaxis_transform()
    )
    return at


def _finish(axes: Axes, handles: Sequence[Artist]) -> None:
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    axes.legend(
        handles=handles,
        loc="lower left",
        bbox_to_anchor=(0, 1.05),  # above the multiplier of an axis
        ncols=3,
        frameon=False,
        fontsize=8,
        handlelength=1.6,
        columnspacing=1.2,
        borderaxespad=0.2,
    )


def _title(path: Path) -> str:
    count = len(path.history)
    second = f"{count} step{'s' if count != 1 else ''}, status: {path.status.label}"
    if not count:
        return f"no step was taken\n{second}"
    highest = path.history.iloc[int(path.history["load_factor"].argmax())]
    peak = (path.events["kind"] == "peak load").any()
    what = "peak" if peak else "largest"
    at = f"{highest['travel']:.4g} {path.unit}".rstrip()
    return f"{what} load factor {highest['load_factor']:.6g} at a travel of {at}\n{second}"


def _box(path: Path) -> tuple[Floats, Floats]:
    """Return the corners of the range of all bodies, with a margin, m."""
    nodes = [
        snap.configuration.nodes[name] for snap in path.snapshots for name in path.stage.bodies
    ]
    low = np.min([own.min(axis=1) for own in nodes], axis=0)
    high = np.max([own.max(axis=1) for own in nodes], axis=0)
    tools = path.stage.obstacles or path.stage.rigid
    margin = (_MARGIN + (PLANE_DEPTH if tools else 0)) * float(np.linalg.norm(high - low))
    return low - margin, high + margin


def _coloured(path: Path, snapshot: Snapshot) -> Iterable[tuple[Mesh, Floats]]:
    """Yield the meshes of a snapshot, and the equivalent strain at their vertices."""
    for name, dofs in path.stage_of(snapshot).dofs_at(snapshot.configuration).items():
        yield dofs.body.mesh, vertex_means(dofs, snapshot.configuration.strain[name])


def _lattice(mesh: Mesh, values: Floats) -> tuple[Floats, Floats, Ints]:
    """Return places (2, n) and values (n,) on a fine lattice of each element, and its triangles."""
    corners, steps = len(mesh.t), np.linspace(0.0, 1.0, _FINE + 1)
    x, y = (axis.ravel() for axis in np.meshgrid(steps, steps))
    at = np.arange(x.size).reshape(_FINE + 1, -1)
    a, b, c, d = (own.ravel() for own in (at[:-1, :-1], at[:-1, 1:], at[1:, :-1], at[1:, 1:]))
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([b, d, c], axis=1)])
    if corners == 3:
        inside = x + y <= 1 + 0.5 / _FINE
        triangles = triangles[inside[triangles].all(axis=1)]
        new = np.cumsum(inside) - 1
        x, y, triangles = x[inside], y[inside], new[triangles]
    points = np.stack([x, y])
    places = np.asarray(mesh.mapping().F(points))
    colours = np.einsum("ce,cp->ep", values[mesh.t], corner_shapes(points, corners))
    shift = x.size * np.arange(mesh.nelements)[:, None, None]
    return places.reshape(2, -1), colours.ravel(), (triangles + shift).reshape(-1, 3)


def _draw_tools(axes: Axes, path: Path, snapshot: Snapshot) -> list[Artist]:
    """Draw rigid blocks and footings in their places."""
    stage, handles = path.stage_of(snapshot), list[Artist]()
    draw_blocks(axes, stage, snapshot.configuration)
    if stage.drawn:
        handles.append(Patch(facecolor=TOOL, edgecolor=GROUND, label="rigid block"))
    meshes, drawn = stage.meshes_at(snapshot.configuration), False
    for footing in footings(path.stage.problem.reference_loads):
        mesh = meshes[footing.body]
        lines = edge_lines(mesh, np.asarray(mesh.boundaries[str(footing.where)]))
        axes.add_collection(LineCollection(lines, colors=FOOTING, linewidths=3.0, zorder=5))
        drawn = True
    if drawn:
        handles.append(Line2D([], [], color=FOOTING, lw=3.0, label="rigid footing"))
    return handles


def draw_blocks(axes: Axes, stage: Stage, configuration: Configuration) -> None:
    """Draw the rigid blocks on a configuration."""
    for name in stage.drawn:
        for corners in placed(stage.rigid[name], configuration.nodes[name]).polygons.values():
            shape = Polygon(corners, facecolor=TOOL, edgecolor=GROUND, lw=1.0, zorder=2.5)
            axes.add_artist(shape)
