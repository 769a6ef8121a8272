"""Pictures of contact: its state on the mechanism, and its tractions in panels."""

from dataclasses import dataclass

import matplotlib.colors
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from matplotlib.gridspec import SubplotSpec

from lacore.limit.state import LimitState
from lacore.model.contact.obstacles import Shape
from lacore.numerics.arrays import Floats
from lacore.pictures.contact_segments import SegmentedContact
from lacore.reporting.text import Reader, render
from lacore.reporting.units import Units

COLOURS = {  # distinguishable for colour-blind readers
    "stick": "#4d4d4d",
    "slip": "#0072b2",
    "open": "#e69f00",
    "crush": "#cc79a7",
}
GROUND = "#8a8a8a"
PLANE_DEPTH = 0.03  # by the size of the picture: depth of plane obstacles
_SAME = 1e-6  # by the length of a contact, and by unit vectors
_TINY = np.finfo(float).tiny
_ALONG = np.linspace(0.0, 1.0, 5)  # shares of a segment, as edges of continua bend


def draw_strips(axes: Axes, contact: SegmentedContact, depth: float) -> None:
    """Draw a strip on the obstacle's side of a continuum, coloured by the state of contact.

    Args:
        axes: axes.
        contact: the contact.
        depth: depth of the strip, m.
    """
    strips = _strips(contact, depth)
    for kind, colour in COLOURS.items():
        chosen = strips[contact.kind == kind]
        if chosen.size:
            axes.add_collection(
                PolyCollection(list(chosen), facecolors=colour, linewidths=0, zorder=1.5)
            )


def draw_ground(axes: Axes, contact: SegmentedContact, depth: float) -> None:
    """Draw the obstacle under rigid blocks, hatched."""
    strips = _strips(contact, depth)
    axes.add_collection(
        PolyCollection(
            list(strips),
            facecolors="none",
            edgecolors=GROUND,
            hatch="//////",
            linewidths=0,
            zorder=1.4,
        )
    )
    axes.add_collection(LineCollection(list(strips[:, :2]), colors="#222222", linewidths=1.2))


def draw_obstacle(axes: Axes, shape: Shape, low: Floats, high: Floats) -> None:
    """Draw the face of an obstacle across a box, hatched behind; limits are not changed.

    Args:
        axes: axes.
        shape: shape of the obstacle.
        low, high: corners of the box, m, shape (2,).
    """
    size = float(np.linalg.norm(high - low))
    face = shape.outline(low, high)
    behind = face - PLANE_DEPTH * size * shape.normal(face)
    ends, strip = face.T, np.concatenate([face.T, behind.T[::-1]])
    axes.add_collection(
        PolyCollection(
            [strip],
            facecolors="white",
            edgecolors=GROUND,
            hatch="//////",
            linewidths=0,
            zorder=1.4,
        ),
        autolim=False,
    )
    axes.add_collection(
        LineCollection([ends], colors="#222222", linewidths=1.2, zorder=1.5), autolim=False
    )


def _strips(contact: SegmentedContact, depth: float) -> Floats:
    """Return the corners of strips behind the contact, on the master's side, shape (k, 4, 2)."""
    start, end, normal = contact.segments.start, contact.segments.end, contact.segments.normal
    corners = [start, end, end - depth * normal, start - depth * normal]
    return np.stack(corners).transpose(2, 0, 1)


def draw_moved(
    axes: Axes, contact: SegmentedContact, state: LimitState, stretch: float, width: float
) -> None:
    """Draw contact between displaced sides: lines if closed, filled gaps if open.

    Args:
        axes: axes.
        contact: the contact.
        state: state of the contact.
        stretch: displacement per velocity, s.
        width: width of the lines, points.
    """
    slave, master = contact.moved(state, stretch, _ALONG)
    for order, (kind, colour) in enumerate(COLOURS.items()):
        chosen = contact.kind == kind
        if not chosen.any():
            continue
        if kind == "open":
            gaps = np.concatenate([slave[chosen], master[chosen][:, ::-1]], axis=1)
            axes.add_collection(
                PolyCollection(
                    list(gaps),
                    facecolors=matplotlib.colors.to_rgba(colour, 0.85),
                    edgecolors=colour,
                    linewidths=0.5 * width,
                    zorder=4,
                )
            )
        else:
            axes.add_collection(
                LineCollection(
                    list(slave[chosen]),
                    colors=colour,
                    linewidths=width if kind == "slip" else 0.6 * width,
                    capstyle="butt",
                    zorder=4 + 0.1 * order,
                )
            )


@dataclass(frozen=True)
class _Profile:
    """Contact along one interface, edge by edge, in the direction of growing x (y, if vertical).

    Attributes:
        axis: label for `arc`.
        arc: place of the ends of the edges along the interface, m, shape (edges + 1,); an edge with
            NaN separates parts of it.
        t_n, t_t: mean tractions on the slave, Pa; t_t along the drawn interface.
        u_n, u_t: mean relative velocities, m/s; u_t along the drawn interface.
    """

    axis: str
    arc: Floats
    t_n: Floats
    t_t: Floats
    u_n: Floats
    u_t: Floats


def _profile(contact: SegmentedContact) -> _Profile:
    start, end, tangent = contact.segments.start, contact.segments.end, contact.tangent
    # From left to right, or upwards; along a curve, from its first edge on.
    lead = tangent[:, 0]
    sign = 1.0 if lead[np.argmax(np.abs(lead))] > 0 else -1.0
    lead, tangent = sign * lead, sign * tangent
    flip = np.sum((end - start) * tangent, axis=0) < 0
    start, end = np.where(flip, end, start), np.where(flip, start, end)
    order = np.argsort(lead @ start)
    edge = contact.coarse_edges[order]
    first = np.flatnonzero(np.append(True, edge[1:] != edge[:-1]))
    lengths = np.maximum(np.linalg.norm(end - start, axis=0), _TINY)[order]
    length = np.add.reduceat(lengths, first)

    # parts of a plane between edges that touch it
    last = np.append(first[1:], order.size) - 1
    hole = (lead @ start)[order][first[1:]] - (lead @ end)[order][last[:-1]]
    plane = np.ptp(tangent, axis=1).max() < _SAME
    after = np.flatnonzero(plane & (hole > _SAME * length.sum())) + 1
    widths = np.insert(length, after, hole[after - 1])

    def mean(values: Floats) -> Floats:
        means = np.add.reduceat(lengths * values[order], first) / length
        return np.asarray(np.insert(means, after, np.nan))

    straight = np.isclose(np.abs(tangent), 1.0).all(axis=1)
    origin = float(start[np.argmax(straight), order[0]]) if straight.any() else 0.0
    return _Profile(
        axis="xy"[int(np.argmax(straight))] if straight.any() else "distance",
        arc=origin + np.concatenate([[0.0], np.cumsum(widths)]),
        t_n=mean(contact.t_n),
        t_t=sign * mean(contact.t_t),
        u_n=mean(contact.u_n),
        u_t=sign * mean(contact.u_t),
    )


def draw_panel(
    figure: Figure, cell: SubplotSpec, contact: SegmentedContact, fastest: float, units: Units
) -> None:
    """Draw reactions and relative velocities along one interface, as means over its edges.

    Args:
        figure, cell: figure, and place of the panel.
        contact: the contact.
        fastest: largest velocity, m/s, the unit of the drawn velocities.
        units: units of tractions and lengths.
    """
    profile = _profile(contact)
    arc, named = profile.arc / units.size("m"), render(contact.name, Reader(units))
    halves = cell.subgridspec(1, 2, wspace=0.08)
    left, right = figure.add_subplot(halves[0]), figure.add_subplot(halves[1])
    for axes, lines, label, floor in (
        (
            left,
            (
                ("$t_n$ pressure", profile.t_n / units.size("Pa"), "#222222"),
                ("$t_t$ friction", profile.t_t / units.size("Pa"), "#d55e00"),
            ),
            f"traction [{units.label('Pa')}]",
            0.0,
        ),
        (
            right,
            (
                ("$u_t$ slip", profile.u_t / fastest, "#0072b2"),
                ("$u_n$ opening", profile.u_n / fastest, "#e69f00"),
            ),
            "velocity / largest velocity",
            0.05,  # Round-off must not fill the panel.
        ),
    ):
        axes.axhline(0, color="#bbbbbb", lw=0.8)
        for name, values, colour in lines:
            axes.stairs(values, arc, baseline=None, color=colour, lw=1.6, label=name)
        axes.set_xlabel(f"{profile.axis} [{units.length}] along {named}", fontsize=9)
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
