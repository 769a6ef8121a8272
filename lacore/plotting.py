"""Pictures of limit states (matplotlib, without global state)."""

from collections.abc import Iterator
from dataclasses import dataclass

import matplotlib
import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec
from matplotlib.lines import Line2D

from lacore.arrays import Floats, Ints
from lacore.boundaries import boundary_facets, facet_geometry
from lacore.dofs import BodyDofs
from lacore.result import LimitState
from lacore.status import Status

_STRETCH = 0.08  # largest displacement drawn, per size of the body
_DECADES = 3.0  # of dissipation density that the colours span
_RIGID_SHARE = 1e-5  # of all power: below it the bodies move rigidly
_RIGID = "#f3f3f0"  # where nothing is dissipated
_SIDES = 6  # chords drawn for each curved edge of a deformed element
_COLOURS = {"stick": "#4d4d4d", "slip": "#0072b2", "open": "#e69f00"}  # legible to the colour-blind
_MOVES = 1e-3  # of the largest velocity: what the eye would see as slip or opening


def plot_mechanism(state: LimitState) -> Figure:
    """Picture of the mechanism: deformed mesh, dissipation density, slip and opening.

    Below it, for each interface, edge averages of reactions and velocities along the contact:
    point values of reactions oscillate and mean nothing.

    Args:
        state: any state with a point, whatever its status; the title says which.

    Raises:
        ValueError: there is no point to show.
    """
    velocity = state.velocity
    bodies = state.discretisation.bodies
    corners = np.concatenate([body.nodes for body in bodies.values()], axis=1)
    low, high = corners.min(axis=1), corners.max(axis=1)
    size = float(np.linalg.norm(high - low))
    fastest = max(float(np.linalg.norm(u, axis=0).max()) for u in velocity.values())
    stretch = _STRETCH * size / fastest if fastest > 0 else 0.0

    contacts = [_contact(state, number) for number in range(_interfaces(state))]
    width = 9.0
    tall = float(np.clip(0.86 * width * (high[1] - low[1]) / (high[0] - low[0]), 2.2, 6.5))
    figure = Figure(figsize=(width, tall + 1.5 + 2.0 * len(contacts)), layout="constrained")
    figure.set_facecolor("white")
    grid = figure.add_gridspec(1 + len(contacts), 1, height_ratios=[tall, *[1.7] * len(contacts)])
    axes = figure.add_subplot(grid[0])
    _draw_bodies(figure, axes, state, stretch)
    for contact in contacts:
        _draw_contact(axes, contact, size)
    _frame(axes, contacts)
    for row, contact in enumerate(contacts, start=1):
        _draw_panel(figure, grid[row], contact)
    figure.suptitle(_title(state), fontsize=11, x=0.01, ha="left")
    return figure


def _title(state: LimitState) -> str:
    if state.status is Status.SOLVED:
        first = f"load factor {state.load_factor:.6g}   ({state.rigor.value})"
    else:
        first = f"{state.status.label.upper()}: last iterate, for inspection only"
    elements = sum(body.body.mesh.nelements for body in state.discretisation.bodies.values())
    return (
        f"{first}\n{state.backend}, {state.coupling} coupling, {elements} elements,"
        f" status: {state.status.label}"
    )


def _interfaces(state: LimitState) -> int:
    return len(state.discretisation.problem.interfaces)


def _draw_bodies(figure: Figure, axes: Axes, state: LimitState, stretch: float) -> None:
    dissipation = state.dissipation
    norm = _colour_scale(state, np.concatenate(list(dissipation.values())))
    cmap = matplotlib.colormaps["YlOrRd"].with_extremes(under=_RIGID, bad=_RIGID)
    picture = None
    for name, body in state.discretisation.bodies.items():
        outline, faces = _deformed(body, state.velocity[name], stretch)
        for edge in _boundary(body):
            axes.plot(*edge, color="#999999", lw=0.8, ls=(0, (4, 3)), zorder=1)
        picture = PolyCollection(
            list(faces),
            array=dissipation[name] if norm else np.zeros_like(dissipation[name]),
            norm=norm or LogNorm(1, 2),
            cmap=cmap,
            edgecolors=(0, 0, 0, 0.16),
            linewidths=0.35,
            zorder=2,
        )
        axes.add_collection(picture)
        axes.add_collection(
            LineCollection(list(outline), colors="#222222", linewidths=1.0, zorder=3)
        )
    if norm is None:
        axes.set_title("no plastic dissipation: a rigid motion", fontsize=9, loc="right")
    elif picture is not None:
        bar = figure.colorbar(picture, ax=axes, shrink=0.85, pad=0.01, aspect=25, extend="min")
        bar.set_label("dissipation density [W/m$^2$ per W of load]", fontsize=9)
        bar.ax.tick_params(labelsize=8)
    axes.set_aspect("equal")
    axes.autoscale_view()


def _edge_curve(start: Floats, middle: Floats, end: Floats) -> Floats:
    """Points on the quadratic edge through three nodes, shape (_SIDES, edges, 2), without end."""
    s = np.linspace(0, 1, _SIDES, endpoint=False)[:, None, None]
    return np.asarray(
        (1 - s) * (1 - 2 * s) * start.T + 4 * s * (1 - s) * middle.T + s * (2 * s - 1) * end.T
    )


def _colour_scale(state: LimitState, density: Floats) -> LogNorm | None:
    """Scale of the densities; None where what there is of dissipation is round-off."""
    point, program = state.point, state.discretisation.full
    assert point is not None
    plastic = program.plastic_dissipation(point.velocity)
    slip, weights = program.contact.slip(point.velocity), program.contact.weights
    friction = float(np.abs(weights[:, None] * point.tangential_reaction * slip).sum())
    if plastic <= _RIGID_SHARE * (plastic + friction):
        return None
    peak = float(density.max())
    return LogNorm(float(np.clip(density.min(), peak * 10**-_DECADES, peak / 2)), peak)


def _deformed(body: BodyDofs, velocity: Floats, stretch: float) -> tuple[Floats, Floats]:
    """Boundary edges and element outlines of the deformed mesh, as polylines."""
    mesh = body.body.mesh
    moved = body.nodes + stretch * velocity
    vertices = mesh.p.shape[1]

    def curve(start: Ints, end: Ints, facet: Ints) -> Floats:
        return _edge_curve(moved[:, start], moved[:, facet + vertices], moved[:, end])

    # scikit-fem numbers the edges of a triangle (0, 1), (1, 2), (0, 2).
    t, edge = mesh.t.astype(np.int64), mesh.t2f.astype(np.int64)
    sides = [
        curve(t[0], t[1], edge[0]),
        curve(t[1], t[2], edge[1]),
        curve(t[2], t[0], edge[2]),
    ]
    faces = np.concatenate(sides).transpose(1, 0, 2)
    outer = mesh.boundary_facets()
    start, end = mesh.facets[:, outer]
    outline = np.concatenate([curve(start, end, outer), moved[:, end].T[None]])
    return outline.transpose(1, 0, 2), faces


def _boundary(body: BodyDofs) -> Iterator[tuple[Floats, Floats]]:
    mesh = body.body.mesh
    for start, end in mesh.facets[:, mesh.boundary_facets()].T:
        x, y = mesh.p[:, [start, end]]
        yield x, y


@dataclass(frozen=True)
class _Contact:
    """One interface, edge by edge along it, in the direction of growing x (or y, if vertical).

    Attributes:
        name: of the interface.
        axis: what `arc` is, for the label.
        start, end: of the edges, shape (2, edges).
        normal: from the obstacle into the body, shape (2, edges).
        arc: place of the ends of the edges along the interface, m, shape (edges + 1,).
        t_n, t_t: mean tractions on the body, Pa; t_t along the interface as drawn.
        u_n, u_t: mean velocities per largest velocity; u_t along the interface as drawn.
        state: stick, slip or open.
    """

    name: str
    axis: str
    start: Floats
    end: Floats
    normal: Floats
    arc: Floats
    t_n: Floats
    t_t: Floats
    u_n: Floats
    u_t: Floats
    state: list[str]


def _contact(state: LimitState, number: int) -> _Contact:
    interface = state.discretisation.problem.interfaces[number]
    body = state.discretisation.bodies[interface.slave[0]]
    facets = boundary_facets(body.body, interface.slave[1], "Interface.slave")
    start, end, outward = facet_geometry(body.body, facets)
    tangent = np.stack([outward[1], -outward[0]])  # the normal -outward turned by +90 degrees
    # As one reads: from left to right, or upwards; along a curve, from its first edge on.
    lead = tangent[:, 0]
    sign = 1.0 if lead[np.argmax(np.abs(lead))] > 0 else -1.0
    lead, tangent = sign * lead, sign * tangent
    flip = np.sum((end - start) * tangent, axis=0) < 0
    start, end = np.where(flip, end, start), np.where(flip, start, end)
    order = np.argsort(lead @ start)
    facets, start, end = facets[order], start[:, order], end[:, order]
    outward, tangent = outward[:, order], tangent[:, order]

    nodes = body.facet_nodes(facets)
    u = state.velocity[interface.slave[0]][:, nodes]  # (2, 3, edges)
    fastest = float(np.abs(state.velocity[interface.slave[0]]).max()) or 1.0
    mean = (u[:, 0] + 4 * u[:, 1] + u[:, 2]) / (6 * fastest)
    u_n, u_t = -np.sum(mean * outward, axis=0), np.sum(mean * tangent, axis=0)
    table = state.reactions
    table = table[state.discretisation.full.contact.interface == number]
    t_n, t_t = _edge_means(table, start, end)
    length = np.linalg.norm(end - start, axis=0)
    straight = np.isclose(np.abs(tangent), 1.0).all(axis=1)
    first = float(start[np.argmax(straight), 0]) if straight.any() else 0.0
    return _Contact(
        axis=f"{'xy'[int(np.argmax(straight))]} [m]" if straight.any() else "distance [m]",
        name=interface.name,
        start=start,
        end=end,
        normal=-outward,
        arc=first + np.concatenate([[0.0], np.cumsum(length)]),
        t_n=t_n,
        t_t=sign * t_t,
        u_n=u_n,
        u_t=u_t,
        state=list(np.select([u_n > _MOVES, np.abs(u_t) > _MOVES], ["open", "slip"], "stick")),
    )


def _edge_means(table: pd.DataFrame, start: Floats, end: Floats) -> tuple[Floats, Floats]:
    """Means of the tractions at the ends and the middle of each edge: their Bernstein mean."""
    place = table[["x", "y"]].to_numpy().T
    means = []
    for name in ("t_n", "t_t"):
        values = table[name].to_numpy()
        at = [
            values[np.argmin(np.sum((place[:, :, None] - spot[:, None, :]) ** 2, axis=0), axis=0)]
            for spot in (start, (start + end) / 2, end)
        ]
        means.append(np.mean(at, axis=0))
    return means[0], means[1]


def _draw_contact(axes: Axes, contact: _Contact, size: float) -> None:
    """A strip on the obstacle's side of the contact, coloured by what the contact does."""
    depth = 0.018 * size
    for kind, colour in _COLOURS.items():
        edges = [index for index, state in enumerate(contact.state) if state == kind]
        strips = [
            np.stack(
                [
                    contact.start[:, i],
                    contact.end[:, i],
                    contact.end[:, i] - depth * contact.normal[:, i],
                    contact.start[:, i] - depth * contact.normal[:, i],
                ]
            )
            for i in edges
        ]
        axes.add_collection(PolyCollection(strips, facecolors=colour, linewidths=0, zorder=1.5))


def _frame(axes: Axes, contacts: list[_Contact]) -> None:
    axes.set_xlabel("x [m]", fontsize=9)
    axes.set_ylabel("y [m]", fontsize=9)
    axes.tick_params(labelsize=8)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    handles = [Line2D([], [], color="#999999", lw=0.8, ls=(0, (4, 3)), label="before collapse")]
    for kind, colour in _COLOURS.items():
        if any(kind in contact.state for contact in contacts):
            handles.append(Line2D([], [], color=colour, lw=5, label=f"contact: {kind}"))
    axes.legend(
        handles=handles,
        loc="lower left",
        bbox_to_anchor=(0, 1.0),
        ncols=len(handles),
        frameon=False,
        fontsize=8,
        borderaxespad=0.2,
    )


def _draw_panel(figure: Figure, cell: SubplotSpec, contact: _Contact) -> None:
    """Reactions and relative velocities along one interface, edge averages as steps."""
    halves = cell.subgridspec(1, 2, wspace=0.08)
    left, right = figure.add_subplot(halves[0]), figure.add_subplot(halves[1])
    for axes, lines, label, floor in (
        (
            left,
            (
                ("$t_n$ pressure", contact.t_n, "#222222"),
                ("$t_t$ friction", contact.t_t, "#d55e00"),
            ),
            "traction [Pa]",
            0.0,
        ),
        (
            right,
            (("$u_t$ slip", contact.u_t, "#0072b2"), ("$u_n$ opening", contact.u_n, "#e69f00")),
            "velocity / largest",
            0.05,  # round-off must not fill the panel
        ),
    ):
        axes.axhline(0, color="#bbbbbb", lw=0.8)
        for name, values, colour in lines:
            axes.stairs(values, contact.arc, baseline=None, color=colour, lw=1.6, label=name)
        axes.set_xlabel(f"{contact.axis} along {contact.name}", fontsize=9)
        axes.set_ylabel(label, fontsize=9)
        axes.tick_params(labelsize=8)
        axes.margins(x=0.01, y=0.12)
        low, high = axes.get_ylim()
        axes.set_ylim(min(low, -floor), max(high, floor))
        axes.legend(
            fontsize=8,
            frameon=False,
            ncols=2,
            loc="lower left",
            bbox_to_anchor=(0, 1.0),
            borderaxespad=0.1,
        )
        for side in ("top", "right"):
            axes.spines[side].set_visible(False)
