"""Pictures of frames: the mechanism with its hinges, and the moments that the members carry."""

from collections.abc import Iterator, Mapping

import matplotlib.colors
import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.path import Path

from lacore.limit.span_moments import SpanMoments, span_moments
from lacore.limit.state import LimitState
from lacore.model.bodies.frames.dofs import FrameDofs
from lacore.model.bodies.frames.frame import Frame
from lacore.model.bodies.frames.modes import WHOLE
from lacore.numerics.arrays import Floats
from lacore.pictures.contact import COLOURS, GROUND
from lacore.pictures.contact_segments import SegmentedContact
from lacore.pictures.continua import BEFORE
from lacore.reporting.units import Units

HINGE = "#b2182b"
MOMENT = "#5e3c99"
BAR = {1: ("#2166ac", "tension"), -1: ("#b2182b", "compression")}
_WIDEST = 3.5  # points: width of a bar
_MEMBER = "#333333"
_TURNS = 1e-3  # by the largest velocity over the size: visible rotation
_BESIDE = 0.03  # by the size of the frame: distance of hinges from a node
_ORDINATE = 0.12  # ordinate of the largest moment, by the size of the frame
_SAMPLES = 33  # number of points of a curved diagram
_FOOT = 0.035  # half the length of the ground under a foot, by the size of the frame
_SENSES = {1: "hinge, anticlockwise", -1: "hinge, clockwise"}
_SUPPORTS = {"clamped": "s", "xy": "^", "x": ">", "y": "^", "rotation": "D"}


def turning(dofs: FrameDofs, motion: Floats) -> Floats:
    """Return the rates of rotation of the rigid pieces, rad/s anticlockwise, shape (P,)."""
    pieces = dofs.body.pieces
    across = np.stack([-pieces.along[1], pieces.along[0]])
    jump = motion[:2, pieces.end] - motion[:2, pieces.start]
    return np.asarray(np.sum(across * jump, axis=0) / pieces.length)


def _turn_mark(sense: int) -> Path:
    """Return an arc with an arrow head around the origin, of radius 1; +1 anticlockwise."""
    angle = np.radians(np.linspace(-60, 210, 28))
    arc = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    tip, back = np.array([-arc[-1, 1], arc[-1, 0]]), arc[-1]
    head = [1.5 * back, back + 0.75 * tip, 0.5 * back]
    outline = np.concatenate([1.09 * arc, head, 0.91 * arc[::-1]])
    return Path(np.concatenate([outline, outline[:1]]) * [1, sense], closed=True)


def draw_frames(axes: Axes, state: LimitState, stretch: float, fastest: float) -> list[Artist]:
    """Draw frames displaced by `stretch` (s) times their velocity, with the turning hinges.

    If two members meet at a node, one hinge is drawn, on the one that turns more against the node;
    its sense is that of this member against the other. With more members, each has a hinge against
    the node.

    Returns:
        handles of a legend.
    """
    senses: list[float] = []
    yielding: dict[str, Artist] = {}
    for name, dofs in state.discretisation.frames.items():
        frame, motion = dofs.body, state.velocity[name]
        moved = frame.position + stretch * motion[:2]
        axes.add_collection(LineCollection(_lines(frame, frame.position), **BEFORE, zorder=1))
        axes.add_collection(
            LineCollection(
                _lines(frame, moved),
                colors=_MEMBER,
                linewidths=2.6,
                capstyle="round",
                zorder=3,
            )
        )
        _draw_supports(axes, state, name, frame)
        place, sense = _hinges(state, name, moved, _TURNS * fastest / frame.size)
        axes.scatter(place[0], place[1], s=26, color=HINGE, zorder=6)
        for sign in _SENSES:
            x, y = place[:, sense == sign]
            axes.scatter(x, y, s=300, marker=_turn_mark(sign), color=HINGE, linewidths=0, zorder=6)
        senses += sense.tolist()
        drawn = _draw_yielding_bars(axes, state, name, moved)
        yielding |= dict(drawn)
    return [*yielding.values()] + [
        Line2D([], [], ls="none", marker=_turn_mark(sign), ms=12, color=HINGE, mew=0, label=text)
        for sign, text in _SENSES.items()
        if sign in senses
    ]


def _draw_yielding_bars(
    axes: Axes, state: LimitState, name: str, moved: Floats
) -> Iterator[tuple[str, Artist]]:
    """Draw the bars that change their length, and yield their entries of a legend."""
    dofs = state.discretisation.frames[name]
    piece, side = dofs.modes.ends
    if not (side == WHOLE).any():
        return
    table = _own_hinges(state, name)
    places = _lines(dofs.body, moved)
    rate = table["elongation_rate"].to_numpy() * (table["state"] == "stretches").to_numpy()
    for sign, (colour, _) in BAR.items():
        own = piece[(side == WHOLE) & (np.sign(rate) == sign)]
        if own.size:
            lines = [places[bar] for bar in own]
            axes.add_collection(
                LineCollection(lines, colors=colour, linewidths=2.6, linestyles="--", zorder=4)
            )
            text = "bar yields, elongating" if sign > 0 else "bar yields, shortening"
            yield text, Line2D([], [], color=colour, lw=2.6, ls="--", label=text)


def _lines(frame: Frame, places: Floats) -> list[Floats]:
    """Return the pieces as lines (2, 2) between places of the nodes."""
    return list(places[:, frame.pieces.nodes].transpose(1, 2, 0))


def _own_hinges(state: LimitState, name: str) -> pd.DataFrame:
    """Return the rows of `LimitState.hinges` of one frame, in the order of its stiff ends."""
    table = state.hinges
    return table[table["frame"] == name] if len(table) else table


def _hinges(state: LimitState, name: str, moved: Floats, least: float) -> tuple[Floats, Floats]:
    """Return the places (2, h) of the turning hinges, and their senses, +1 anticlockwise, (h,).

    Args:
        state: the state.
        name: name of the frame.
        moved: nodes after displacement, (2, N), m.
        least: smallest drawn rate of rotation, rad/s.
    """
    dofs = state.discretisation.frames[name]
    frame, (piece, side) = dofs.body, dofs.modes.ends
    if not piece.size:
        return np.zeros((2, 0)), np.zeros(0)
    rate = _own_hinges(state, name)["rotation_rate"].to_numpy()
    ends = side != WHOLE
    piece, side, rate = piece[ends], side[ends], rate[ends]
    node = frame.pieces.nodes[piece, side]
    ends = np.bincount(node, minlength=len(frame.names))
    pair = ends[node] == 2
    first = np.zeros(node.size, dtype=bool)
    # Of a pair the one that turns more; of equals the first.
    order = np.lexsort((np.arange(node.size), -np.abs(rate), node))
    first[order] = np.append(True, node[order][1:] != node[order][:-1])
    other = np.bincount(node, rate, len(frame.names))[node] - rate
    relative = np.where(pair, rate - other, rate)
    shown = (np.abs(relative) > least) & (first | ~pair)
    inwards = np.where(side == 0, 1.0, -1.0) * frame.pieces.along[:, piece]
    place = moved[:, node] + _BESIDE * frame.size * inwards
    return place[:, shown], np.sign(relative[shown])


def _draw_supports(axes: Axes, state: LimitState, name: str, frame: Frame) -> None:
    for support in state.discretisation.problem.supports:
        if support.body == name:
            x, y = frame.position[:, frame.find(support.where, "Fix.where")]
            axes.scatter(
                x,
                y,
                s=60,
                marker=_SUPPORTS[support.components],
                facecolor=GROUND,
                edgecolor="#222222",
                zorder=5,
            )


def draw_foot(
    axes: Axes, contact: SegmentedContact, state: LimitState, stretch: float, size: float
) -> None:
    """Draw the contact of single nodes: the ground at an obstacle, and the state of the foot."""
    place, normal = contact.segments.start, contact.segments.normal
    along, half = contact.tangent, _FOOT * size
    if len(contact.sides) == 1:
        left, right, depth = place - half * along, place + half * along, 0.5 * half * normal
        corners = np.stack([left, right, right - depth, left - depth]).transpose(2, 0, 1)
        axes.add_collection(
            PolyCollection(
                list(corners),
                facecolors="none",
                edgecolors=GROUND,
                hatch="//////",
                linewidths=0,
                zorder=1.4,
            )
        )
        axes.add_collection(
            LineCollection(list(corners[:, :2]), colors="#222222", linewidths=1.2, zorder=1.5)
        )
    moved = contact.moved(state, stretch, np.zeros(1))[0][:, 0]
    colours = [matplotlib.colors.to_rgba(COLOURS[kind]) for kind in contact.kind]
    axes.scatter(moved[:, 0], moved[:, 1], s=70, marker="s", color=colours, zorder=5)


def draw_moments(axes: Axes, state: LimitState, units: Units) -> list[Artist]:
    """Draw bending moments on the tension side of members, parabolas under loads along them.

    Returns:
        handles of a legend.
    """
    frames, point = state.discretisation.frames, state.point
    assert point is not None
    moments = {name: span_moments(state.discretisation, point, name) for name in frames}
    peak = max(
        (
            float(max(np.nan_to_num(np.abs(own.ends)).max(), own.inside.max()))
            for own in moments.values()
        ),
        default=0.0,
    )
    for name, dofs in frames.items():
        frame, own = dofs.body, moments[name]
        axes.add_collection(
            LineCollection(_lines(frame, frame.position), colors=_MEMBER, linewidths=1.6, zorder=3)
        )
        if peak > 0:
            axes.add_collection(
                PolyCollection(
                    _ordinates(frame, own, _ORDINATE * frame.size / peak),
                    facecolors=matplotlib.colors.to_rgba(MOMENT, 0.25),
                    edgecolors=MOMENT,
                    linewidths=0.8,
                    zorder=2,
                )
            )
    handles = _draw_bars(axes, state, moments, units)
    if not peak > 0:
        return handles
    text = f"moment (max {units.told(peak, 'N', framed=True, digits=3)})"
    patch = Patch(facecolor=matplotlib.colors.to_rgba(MOMENT, 0.25), edgecolor=MOMENT, label=text)
    return [patch, *handles]


def _draw_bars(
    axes: Axes, state: LimitState, moments: Mapping[str, SpanMoments], units: Units
) -> list[Artist]:
    """Draw bars with the width of their axial force, in tension and in compression."""
    forces, lines = [np.zeros(0)], []
    for name, dofs in state.discretisation.frames.items():
        piece, side = dofs.modes.ends
        bars = piece[side == WHOLE]
        forces.append(moments[name].axial[bars, 0])
        places = _lines(dofs.body, dofs.body.position)
        lines += [places[bar] for bar in bars]
    force = np.concatenate(forces)
    peak = float(np.abs(force).max(initial=0.0))
    if not peak > 0:
        return []
    colours = [BAR[1 if own > 0 else -1][0] for own in force]
    widths = 0.8 + _WIDEST * np.abs(force) / peak
    axes.add_collection(LineCollection(lines, colors=colours, linewidths=widths, zorder=3.5))
    largest = {
        sign: units.told(float(np.abs(force[own]).max()), "N/m", framed=True, digits=3)
        for sign in BAR
        if (own := np.sign(force) == sign).any()
    }
    return [
        Line2D([], [], color=BAR[sign][0], lw=3, label=f"{BAR[sign][1]} (max {size})")
        for sign, size in largest.items()
    ]


def _ordinates(frame: Frame, moments: SpanMoments, scale: float) -> list[Floats]:
    """Return the outlines of the diagrams of the pieces, m: curved under loads along them."""
    straight = not np.any(moments.load)
    share = np.linspace(0.0, 1.0, 2 if straight else _SAMPLES)
    pieces = frame.pieces
    across = np.stack([-pieces.along[1], pieces.along[0]])
    start, end = (frame.position[:, ends] for ends in (pieces.start, pieces.end))
    foot = start[:, :, None] + (end - start)[:, :, None] * share
    tips = foot + scale * across[:, :, None] * moments.at(share)
    faces = np.concatenate([foot[:, :, [0, -1]], tips[:, :, ::-1]], axis=2)
    known = np.isfinite(moments.ends).all(axis=1)  # They are unknown for rigid members.
    return list(faces.transpose(1, 2, 0)[known])
