"""Pictures of forces: lines of thrust between blocks, reactions of feet, reference loads."""

from collections.abc import Iterator
from dataclasses import dataclass

import matplotlib.colors
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.lines import Line2D

from lacore.limit.state import LimitState
from lacore.model.bodies.frames.dofs import FrameDofs
from lacore.numerics.arrays import Floats, Ints
from lacore.pictures.blocks import fill_blocks, held_blocks, outlines
from lacore.pictures.contact_segments import rigid_sides
from lacore.pictures.continua import boundary_lines
from lacore.reporting.status import Status
from lacore.reporting.units import Units

THRUST = "#b2182b"
LOAD = "#0f7b3f"
_FAINTEST = 1e-3  # by the largest force: smaller lines of thrust are invisible
_LEFT_OUT = 0.1  # share of the sum of all forces: the smallest ones, which would hide the others
_FAINT = "#e9b7ad"
_SHORTEST = 0.3  # by the radius of the smaller block
_ROUND_OFF = 1e-6  # by the largest load: solvers leave such forces in place of zeros
_FEW = 10  # number of arrows that may be thick
_MANY = 150  # number of arrows that a reader can distinguish
_PART = 0.06  # by the size of a frame: length of a member load for one arrow
_OF_FRAMES = 0.16  # by the size of a frame: length of the longest arrow


def draw_forces(axes: Axes, state: LimitState, thickest: float, units: Units) -> list[Line2D]:
    """Draw the structure before collapse with its loads, and its contact forces.

    A line of thrust passes through the centre of pressure of each joint in the direction of its
    force, and ends in both blocks where it is closest to their centroids, and at fixed parts; its
    width is the force. Contacts between continua are left out, as their panels show them.

    Args:
        axes: axes.
        state: the state.
        thickest: width of the line of the largest force, points.
        units: units of the forces.

    Returns:
        handles of a legend.
    """
    for dofs in state.discretisation.assemblies.values():
        fill_blocks(axes, outlines(dofs, dofs.body.edges.start), held_blocks(state, dofs), 1.0)
    for body in state.discretisation.continua.values():
        axes.add_collection(
            LineCollection(boundary_lines(body), colors="#555555", linewidths=0.9, zorder=1)
        )
    handles = []
    forces = contact_forces(state)
    size = np.linalg.norm(forces.force, axis=0)
    peak = float(size.max(initial=0.0))
    if peak > _ROUND_OFF * _largest_load(state):
        handles.append(_draw_thrust(axes, forces, size, thickest, units))
    handles += _draw_feet(axes, state, units)
    handles += _draw_loads(axes, state)
    return handles


def _draw_thrust(
    axes: Axes, forces: "ContactForces", size: Floats, thickest: float, units: Units
) -> Line2D:
    """Draw lines of thrust with the width of the force, and return the entry of a legend.

    Between many blocks most forces are small, and would hide the important ones: the smallest, up
    to a share of the sum of all, are left out, and larger ones are darker, which makes bundles
    visible.
    """
    peak, told = float(size.max()), ""
    order = np.flatnonzero(size > _FAINTEST * peak)
    shade = np.ones(order.size)
    if order.size > _MANY:
        order = order[np.argsort(size[order], kind="stable")]  # the largest on top
        order = order[np.cumsum(size[order]) > _LEFT_OUT * size[order].sum()]
        shade = np.sqrt(size[order] / peak)
        told = f", shown above {size[order[0]] / units.size('N/m'):.2g}"
    lines = np.concatenate([own[:, :, order] for own in forces.lines], axis=2).T
    faint, full = (np.array(matplotlib.colors.to_rgb(colour)) for colour in (_FAINT, THRUST))
    axes.add_collection(
        LineCollection(
            list(lines),
            colors=np.tile(faint + shade[:, None] * (full - faint), (2, 1)),
            linewidths=np.tile(np.maximum(thickest * size[order] / peak, 0.3), 2),
            capstyle="round",
            zorder=3,
        )
    )
    label = f"contact force (max {units.told(peak, 'N/m', digits=3)}{told})"
    return Line2D([], [], color=THRUST, lw=4, label=label)


@dataclass(frozen=True)
class ContactForces:
    """Contact resultants between two blocks, or a block and anything else.

    Attributes:
        force: force on the slave, N/m, shape (2, k).
        centre: centre of pressure, m, shape (2, k).
        lines: lines from the centre into the slave, and into the master, (2, ends, k) each; of zero
            length for fixed blocks and other bodies.
    """

    force: Floats
    centre: Floats
    lines: tuple[Floats, Floats]


def contact_forces(state: LimitState) -> ContactForces:
    """Return the resultant force of each joint, at its centre of pressure."""
    d, table = state.discretisation, state.reactions
    m = d.full.contact.count
    blocks = np.full((2, m), -1)
    centroid, radius = np.full((2, 2, m), np.nan), np.full((2, m), np.nan)
    for part in rigid_sides(d):
        blocks[part.side, part.points] = part.blocks
        held = held_blocks(state, part.dofs)[part.blocks]
        centroid[part.side][:, part.points] = np.where(
            held, np.nan, part.dofs.body.centroid[:, part.blocks]
        )
        radius[part.side, part.points] = part.dofs.body.radius[part.blocks]
    rigid = np.flatnonzero((blocks >= 0).any(axis=0))
    normal, place = d.points.normal[rigid].T, d.points.position[rigid].T
    key = np.column_stack(
        [d.full.contact.interface[rigid], blocks[:, rigid].T, np.round(normal.T, 9)]
    )
    _, first, group = np.unique(key + 0.0, axis=0, return_index=True, return_inverse=True)
    group, k = group.ravel(), first.size

    def total(values: Floats) -> Floats:
        return np.stack([np.bincount(group, row, k) for row in values]).astype(np.float64)

    t_n, t_t, length = (table[name].to_numpy()[rigid] for name in ("t_n", "t_t", "length"))
    tangent = np.stack([-normal[1], normal[0]])
    force = total(length * (t_n * normal + t_t * tangent))
    pressed = total((length * t_n)[None])[0]
    # Without pressure, or with tension, the middle of the joint is used.
    torn = np.bincount(group, t_n < 0, k) > 0
    weight = np.where(((pressed > 0) & ~torn)[group], length * t_n, length)
    centre = total(weight * place) / total(weight[None])
    at = rigid[first]
    reach = np.nanmin(radius[:, at], axis=0)
    lines = _thrust(force, centre, (centroid[0][:, at], centroid[1][:, at]), reach)
    return ContactForces(force, centre, lines)


def _thrust(
    force: Floats, centre: Floats, centroids: tuple[Floats, Floats], reach: Floats
) -> tuple[Floats, Floats]:
    """Return the lines from the centres of pressure into slaves and masters, (2, ends, k) each."""
    size = np.linalg.norm(force, axis=0)
    along = np.divide(force, size, out=np.zeros_like(force), where=size > 0)
    lines = []
    for sense, centroid in zip((1.0, -1.0), centroids, strict=True):
        length = sense * np.sum((centroid - centre) * along, axis=0)
        length = np.nan_to_num(np.clip(length, _SHORTEST * reach, reach))
        lines.append(np.stack([centre, centre + sense * length * along], axis=1))
    return lines[0], lines[1]


def _largest_load(state: LimitState) -> float:
    """Return the largest single force of scaled reference loads, and of dead loads, N/m."""
    point, program = state.point, state.discretisation.full
    assert point is not None
    live = abs(point.load_factor) * float(np.abs(program.reference_load).max())
    return max(live, float(np.abs(program.dead_load - program.held_shut).max()))


def _draw_loads(axes: Axes, state: LimitState) -> list[Line2D]:
    """Draw the reference loads: one arrow per block if they are few, else their resultant."""
    vectors, places, sizes = [], [], []
    for force, place, size in _loads(state):
        vectors.append(force)
        places.append(place)
        sizes.append(size)
    force, place = np.concatenate(vectors, axis=1), np.concatenate(places, axis=1)
    size = np.linalg.norm(force, axis=0)
    loaded = size > _FAINTEST * size.max(initial=0.0)
    if not loaded.any():  # moments, or balanced pressures
        return []
    force, place, size = force[:, loaded], place[:, loaded], size[loaded]
    reach = np.concatenate(sizes)[loaded].mean()
    label = "dead load $F_d$" if _dead_alone(state) else "reference load $F_0$"
    if size.size > _MANY:
        label += ", resultant"
        place = (place * size).sum(axis=1, keepdims=True) / size.sum()
        force = force.sum(axis=1, keepdims=True)
        size = np.linalg.norm(force, axis=0)
        reach = 0.3 * float(np.ptp(axes.dataLim.get_points(), axis=0).max())
    _draw_arrows(axes, place, reach * force / size.max(), LOAD)
    return [Line2D([], [], color=LOAD, lw=2, marker=">", label=label)]


def _draw_arrows(axes: Axes, place: Floats, arrow: Floats, colour: str) -> None:
    """Draw arrows (2, k) that end at places (2, k), m."""
    axes.quiver(
        *place,
        *arrow,
        pivot="tip",
        angles="xy",
        scale_units="xy",
        scale=1.0,
        units="inches",
        width=0.012 if place.shape[1] > _FEW else 0.03,
        color=colour,
        zorder=5,
    )
    axes.update_datalim((place - arrow).T)


def _draw_feet(axes: Axes, state: LimitState, units: Units) -> list[Line2D]:
    """Draw contact forces on the nodes of frames, as arrows that end there."""
    d, table = state.discretisation, state.reactions
    places, forces, lengths = [], [], []
    for index, interface in enumerate(d.problem.interfaces):
        for sign, side in zip((1.0, -1.0), interface.sides, strict=False):
            if side[0] not in d.frames:
                continue
            rows = table[d.full.contact.interface == index]
            x, y, n_x, n_y, t_n, t_t = rows[["x", "y", "n_x", "n_y", "t_n", "t_t"]].to_numpy().T
            length = sign * rows["length"].to_numpy()
            forces.append(length * np.stack([t_n * n_x - t_t * n_y, t_n * n_y + t_t * n_x]))
            places.append(np.stack([x, y]))
            lengths.append(_OF_FRAMES * d.frames[side[0]].body.size)
    if not forces:
        return []
    force = np.concatenate(forces, axis=1)
    peak = float(np.linalg.norm(force, axis=0).max())
    if peak <= _ROUND_OFF * _largest_load(state):
        return []
    _draw_arrows(axes, np.concatenate(places, axis=1), max(lengths) / peak * force, THRUST)
    label = f"reaction (max {units.told(peak, 'N/m', framed=True, digits=3)})"
    return [Line2D([], [], color=THRUST, lw=2, marker=">", label=label)]


def _loads(state: LimitState) -> Iterator[tuple[Floats, Floats, Floats]]:
    """Yield forces (2, k) on blocks, continua and nodes, points on their lines, and sizes."""
    d = state.discretisation
    alone = _dead_alone(state)
    load = d.full.dead_load - d.full.held_shut if alone else d.full.reference_load
    stated = d.problem.dead_loads if alone else d.problem.reference_loads
    for rigid in d.assemblies.values():
        own = load[rigid.offset : rigid.offset + rigid.count].reshape(-1, 3).T
        own = np.where(held_blocks(state, rigid), 0.0, own)
        force, moment = own[:2], own[2] * rigid.body.radius
        square = np.sum(force**2, axis=0)
        arm = np.divide(moment, square, out=np.zeros_like(square), where=square > 0)
        yield force, rigid.body.centroid + arm * np.stack([force[1], -force[0]]), rigid.body.radius
    for dofs in d.continua.values():
        nodal = load[dofs.dofs]
        weight = np.linalg.norm(nodal, axis=0)
        if weight.any():
            place = (dofs.nodes * weight).sum(axis=1, keepdims=True) / weight.sum()
            yield nodal.sum(axis=1, keepdims=True), place, np.array([0.25 * dofs.body.size])
    for name, frame in d.frames.items():
        loads = [own for own in stated if own.body == name]
        points = [frame.force(own) for own in loads if own.boundary is None]
        every = np.sum([np.zeros(frame.count), *points], axis=0)
        nodal = every[: frame.nodal].reshape(-1, 3)[:, :2].T
        force, place = _along_members(frame, frame.line_loads(loads))
        force = np.concatenate([nodal, force], axis=1)
        place = np.concatenate([frame.body.position, place], axis=1)
        yield force, place, np.full(force.shape[1], _OF_FRAMES * frame.body.size)


def _along_members(frame: FrameDofs, load: Floats) -> tuple[Floats, Floats]:
    """Return loads along members, N/m per m, (2, P), as forces of short parts, and their places."""
    pieces, size = frame.body.pieces, frame.body.size
    parts = np.ceil(pieces.length / (_PART * size)).astype(np.int64) * load.any(axis=0)
    piece: Ints = np.repeat(np.arange(parts.size), parts)
    share = (np.arange(piece.size) - np.repeat(np.cumsum(parts) - parts, parts) + 0.5) / parts[
        piece
    ]
    start = frame.body.position[:, pieces.start[piece]]
    place = start + pieces.along[:, piece] * pieces.length[piece] * share
    return load[:, piece] * pieces.length[piece] / parts[piece], place


def _dead_alone(state: LimitState) -> bool:
    """Return whether the dead loads act alone, in collapse or with the stresses that carry them."""
    return state.status is Status.UNSAFE or (
        state.load_factor == 0 and bool(np.any(state.discretisation.full.dead_load))
    )
