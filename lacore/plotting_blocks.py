"""Pictures of rigid blocks: displaced on the mechanism, and the forces between them."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.lines import Line2D

from lacore.arrays import Bools, Floats
from lacore.contact_segments import rigid_sides
from lacore.plotting_continua import BEFORE, boundary_lines
from lacore.result import LimitState
from lacore.rigid import RigidDofs

FIXED = "#9a9a9a"
THRUST = "#b2182b"
LOAD = "#0f7b3f"
_FACE = "#ece7dc"
_AT_REST = 1e-3  # of the largest velocity
_FAINTEST = 1e-3  # of the largest force: lines of thrust below it would not be seen
_SHORTEST = 0.3  # of the radius of the smaller block
_FEW = 10  # arrows that have room to be thick
_MANY = 150  # arrows a reader tells apart


def vertex_velocity(dofs: RigidDofs, motion: Floats) -> Floats:
    """Velocity at the starts of all outline edges, m/s, shape (2, n)."""
    edges = dofs.body.edges
    u_x, u_y, omega = motion[:, edges.block]
    x, y = edges.start - dofs.body.centroid[:, edges.block]
    return np.stack([u_x - omega * y, u_y + omega * x])


def held_blocks(state: LimitState, dofs: RigidDofs) -> Bools:
    """Which blocks supports leave no velocity, shape (blocks,)."""
    basis = state.discretisation.free_basis[dofs.offset : dofs.offset + dofs.count]
    largest = np.asarray(abs(basis).max(axis=1).todense()).reshape(-1, 3)
    return np.asarray(~np.any(largest > 0, axis=1))


def draw_blocks(axes: Axes, state: LimitState, stretch: float, fastest: float) -> None:
    """Blocks displaced by `stretch` (s) times their velocity, dashed where they were.

    Displacements are linear in the rotation, so that contact that is kept looks kept; blocks grow
    by half the square of their rotation for it.
    """
    for name, dofs in state.discretisation.assemblies.items():
        velocity = vertex_velocity(dofs, state.velocity[name])
        held, edges = held_blocks(state, dofs), dofs.body.edges
        moves = np.zeros(held.size, dtype=bool)
        moves[edges.block[np.linalg.norm(velocity, axis=0) > _AT_REST * fastest]] = True
        lines = np.stack([edges.start, edges.end], axis=1)[:, :, moves[edges.block]].T
        axes.add_collection(LineCollection(list(lines), **BEFORE, zorder=1))
        _fill(axes, _outlines(dofs, edges.start + stretch * velocity), held, 2.0)


def _outlines(dofs: RigidDofs, vertices: Floats) -> list[Floats]:
    """Polygons (k, 2) of all blocks from the starts of their edges."""
    return np.split(vertices.T, np.flatnonzero(np.diff(dofs.body.edges.block)) + 1)


def _fill(axes: Axes, polygons: list[Floats], held: Bools, zorder: float) -> None:
    thin = 0.9 if held.size < _MANY else 0.4
    free = [polygon for polygon, fixed in zip(polygons, held, strict=True) if not fixed]
    fixed = [polygon for polygon, fixed in zip(polygons, held, strict=True) if fixed]
    axes.add_collection(
        PolyCollection(free, facecolors=_FACE, edgecolors="#555555", linewidths=thin, zorder=zorder)
    )
    if fixed:
        axes.add_collection(
            PolyCollection(
                fixed,
                facecolors=FIXED,
                edgecolors="#666666",
                hatch="////",
                linewidths=thin,
                zorder=zorder - 0.1,
            )
        )


def draw_forces(axes: Axes, state: LimitState, thickest: float) -> list[Line2D]:
    """The structure before collapse with its loads, and the forces that its contacts carry.

    A line of thrust passes through the centre of pressure of each joint in the direction of its
    force, and ends in both blocks where it comes closest to their centroids, and at what is fixed;
    its width is the force. Contacts between continua are left out: their panels show them.

    Args:
        thickest: width of the line of the largest force, points.

    Returns:
        handles of a legend.
    """
    for dofs in state.discretisation.assemblies.values():
        _fill(axes, _outlines(dofs, dofs.body.edges.start), held_blocks(state, dofs), 1.0)
    for body in state.discretisation.bodies.values():
        axes.add_collection(
            LineCollection(boundary_lines(body), colors="#555555", linewidths=0.9, zorder=1)
        )
    handles = []
    forces = contact_forces(state)
    size = np.linalg.norm(forces.force, axis=0)
    peak = float(size.max(initial=0.0))
    if peak > 0:
        seen = size > _FAINTEST * peak
        lines = np.concatenate([forces.lines[0][:, :, seen], forces.lines[1][:, :, seen]], axis=2).T
        widths = np.tile(np.maximum(thickest * size[seen] / peak, 0.3), 2)
        axes.add_collection(
            LineCollection(
                list(lines), colors=THRUST, linewidths=widths, capstyle="round", zorder=3
            )
        )
        handles.append(
            Line2D([], [], color=THRUST, lw=4, label=f"contact force (thickest: {peak:.3g} N/m)")
        )
    handles += _draw_loads(axes, state)
    return handles


@dataclass(frozen=True)
class ContactForces:
    """Resultants of the contact between each two blocks, or a block and anything else.

    Attributes:
        force: on the slave, N/m, shape (2, k).
        centre: of pressure, m, shape (2, k).
        lines: from the centre into the slave, and into the master: (2, ends, k) each; of no
            length into what is no block, or a fixed one.
    """

    force: Floats
    centre: Floats
    lines: tuple[Floats, Floats]


def contact_forces(state: LimitState) -> ContactForces:
    """Resultant force of each joint, at its centre of pressure."""
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
        return np.stack([np.bincount(group, row, k) for row in values])

    t_n, t_t, length = (table[name].to_numpy()[rigid] for name in ("t_n", "t_t", "length"))
    tangent = np.stack([-normal[1], normal[0]])
    force = total(length * (t_n * normal + t_t * tangent))
    pressed = total((length * t_n)[None])[0]
    # Without pressure (cohesion alone) the middle of the joint has to do.
    weight = np.where((pressed > 0)[group], length * t_n, length)
    centre = total(weight * place) / total(weight[None])
    at = rigid[first]
    reach = np.nanmin(radius[:, at], axis=0)
    lines = _thrust(force, centre, (centroid[0][:, at], centroid[1][:, at]), reach)
    return ContactForces(force, centre, lines)


def _thrust(
    force: Floats, centre: Floats, centroids: tuple[Floats, Floats], reach: Floats
) -> tuple[Floats, Floats]:
    """Lines from the centres of pressure into the slaves and masters, (2, ends, k) each."""
    size = np.linalg.norm(force, axis=0)
    along = np.divide(force, size, out=np.zeros_like(force), where=size > 0)
    lines = []
    for sense, centroid in zip((1.0, -1.0), centroids, strict=True):
        length = sense * np.sum((centroid - centre) * along, axis=0)
        length = np.nan_to_num(np.clip(length, _SHORTEST * reach, reach))
        lines.append(np.stack([centre, centre + sense * length * along], axis=1))
    return lines[0], lines[1]


def _draw_loads(axes: Axes, state: LimitState) -> list[Line2D]:
    """Reference loads: an arrow a block where they can be told apart, else their resultant."""
    vectors, places, sizes = [], [], []
    for force, place, size in _loads(state):
        vectors.append(force)
        places.append(place)
        sizes.append(size)
    force, place = np.concatenate(vectors, axis=1), np.concatenate(places, axis=1)
    size = np.linalg.norm(force, axis=0)
    loaded = size > _FAINTEST * size.max(initial=0.0)
    if not loaded.any():  # moments, pressures in balance
        return []
    force, place, size = force[:, loaded], place[:, loaded], size[loaded]
    reach = np.concatenate(sizes)[loaded].mean()
    label = "live load"
    if size.size > _MANY:
        label = "live load (resultant)"
        place = (place * size).sum(axis=1, keepdims=True) / size.sum()
        force = force.sum(axis=1, keepdims=True)
        size = np.linalg.norm(force, axis=0)
        reach = 0.3 * float(np.ptp(axes.dataLim.get_points(), axis=0).max())
    arrow = reach * force / size.max()
    axes.quiver(
        *place,
        *arrow,
        pivot="tip",
        angles="xy",
        scale_units="xy",
        scale=1.0,
        units="inches",
        width=0.012 if size.size > _FEW else 0.03,
        color=LOAD,
        zorder=5,
    )
    axes.update_datalim((place - arrow).T)
    return [Line2D([], [], color=LOAD, lw=2, marker=">", label=label)]


def _loads(state: LimitState) -> Iterator[tuple[Floats, Floats, Floats]]:
    """Forces (2, k) of each block or continuum, points on their lines (2, k), body sizes (k,)."""
    d = state.discretisation
    for rigid in d.assemblies.values():
        own = d.full.reference_load[rigid.offset : rigid.offset + rigid.count].reshape(-1, 3).T
        own = np.where(held_blocks(state, rigid), 0.0, own)
        force, moment = own[:2], own[2] * rigid.body.radius
        square = np.sum(force**2, axis=0)
        arm = np.divide(moment, square, out=np.zeros_like(square), where=square > 0)
        yield force, rigid.body.centroid + arm * np.stack([force[1], -force[0]]), rigid.body.radius
    for dofs in d.bodies.values():
        nodal = d.full.reference_load[dofs.dofs]
        weight = np.linalg.norm(nodal, axis=0)
        if weight.any():
            place = (dofs.nodes * weight).sum(axis=1, keepdims=True) / weight.sum()
            yield nodal.sum(axis=1, keepdims=True), place, np.array([0.25 * dofs.body.size])
