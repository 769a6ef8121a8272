"""The collapse mechanism of a plane state on its axes: displaced bodies, contact, obstacles."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from lacore.limit.state import LimitState
from lacore.numerics.arrays import Floats
from lacore.pictures.axis import draw_axis
from lacore.pictures.blocks import FIXED, draw_blocks, held_blocks
from lacore.pictures.contact import (
    COLOURS,
    GROUND,
    PLANE_DEPTH,
    draw_ground,
    draw_moved,
    draw_obstacle,
    draw_strips,
)
from lacore.pictures.contact_segments import SegmentedContact, segmented_contacts
from lacore.pictures.continua import draw_continua
from lacore.pictures.frames import draw_foot, draw_frames, turning
from lacore.reporting.units import Units

_STRETCH = 0.08  # largest drawn displacement, by the size of the structure
_TURN = 0.3  # largest drawn rotation, rad: blocks grow by half its square
_STRIP = 0.018  # depth of strips behind contact, by the size of the structure
_GROUND = 0.03  # the same for obstacles under blocks
_NEAR = 0.1  # by the picture: distance up to which a plane is drawn
_LINE = 0.07  # by the side of a block: width of contact lines
_TINY = np.finfo(float).tiny


@dataclass(frozen=True)
class Displacement:
    """A plane state with the exaggeration of its displacements.

    Attributes:
        state: A state with a point.
        size: Diagonal of the structure, m.
        extent: Width and height of the structure before and after displacement, m, shape (2,).
        fastest: Largest velocity, m/s; 1 if nothing moves.
        stretch: Displacement drawn per velocity, s.
        interfaces: Contact of the interfaces.
        joints: Contact of the joints of each block assembly.
    """

    state: LimitState
    size: float
    extent: Floats
    fastest: float
    stretch: float
    interfaces: Sequence[SegmentedContact]
    joints: Sequence[SegmentedContact]

    @property
    def block_side(self) -> float:
        """Side of the mean block of the finest assembly; of the structure if there is none, m."""
        assemblies = self.state.discretisation.assemblies.values()
        sides = [np.sqrt(dofs.body.area).mean() for dofs in assemblies]
        return float(min(sides, default=self.extent.max()))


def displacement_of(state: LimitState) -> Displacement:
    """Choose the displacements in the picture of a state."""
    places, velocities = _outline(state)
    size = float(np.linalg.norm(np.ptp(places, axis=1)))
    fastest = float(np.linalg.norm(velocities, axis=0).max()) or 1.0
    stretch = min(_STRETCH * size / fastest, _TURN / max(_spin(state), _TINY))
    extent = np.ptp(np.concatenate([places, places + stretch * velocities], axis=1), axis=1)
    extent = np.maximum(extent, _STRETCH * size)  # A single beam has no height.
    return Displacement(state, size, extent, fastest, stretch, *segmented_contacts(state, fastest))


def draw_displaced(
    axes: Axes, shown: Displacement, units: Units, points: float, edges: float
) -> tuple[PolyCollection | None, list[Artist]]:
    """Draw the mechanism, without a frame around it.

    Args:
        axes: Axes.
        shown: The state and its displacements.
        units: Units of the dissipation density.
        points: Scale of the picture, points per metre.
        edges: Width of the lines between elements, points; 0 draws none.

    Returns:
        The elements coloured by their dissipation, None if there are none, and the handles of a
        legend.
    """
    state, stretch, size = shown.state, shown.stretch, shown.size
    faces = draw_continua(axes, state, stretch, units, edges)
    draw_blocks(axes, state, stretch, shown.fastest)
    width = float(np.clip(_LINE * points * shown.block_side, 0.5, 3.5))
    hinges = draw_frames(axes, state, stretch, shown.fastest)
    for contact in [*shown.interfaces, *shown.joints]:
        if contact.pointwise:
            draw_foot(axes, contact, state, stretch, size)
            continue
        if len(contact.sides) == 1 and contact.deforms:
            draw_strips(axes, contact, _STRIP * size)
            continue
        if len(contact.sides) == 1:
            draw_ground(axes, contact, _GROUND * size)
        draw_moved(axes, contact, state, stretch, width)
    obstacles = _draw_obstacles(axes, state)
    handles = [*_handles(shown), *obstacles, *hinges]
    return faces, [*handles, *draw_axis(axes, state.discretisation.problem.bodies.values())]


def draw_ground_below(axes: Axes, shown: Displacement) -> None:
    """Draw the obstacles under blocks, as the mechanism has them."""
    for contact in shown.interfaces:
        if len(contact.sides) == 1 and not contact.pointwise:
            draw_ground(axes, contact, _GROUND * shown.size)


def _draw_obstacles(axes: Axes, state: LimitState) -> list[Artist]:
    """Draw the obstacles of a path that bodies touch, or nearly touch."""
    points, number = state.discretisation.points, state.discretisation.full.contact.interface
    low, high = np.min(axes.dataLim.get_points(), axis=0), np.max(axes.dataLim.get_points(), axis=0)
    size = float(np.linalg.norm(high - low))
    drawn = False
    for index, obstacle in enumerate(points.obstacles):
        face, places = obstacle.shape, points.position[number == index].T
        distances = face.distance(places)
        if distances.min(initial=np.inf) > _NEAR * size:
            continue
        draw_obstacle(axes, face, low, high)
        closest = int(np.argmin(distances))
        normal = face.normal(places[:, [closest]])[:, 0]
        foot = places[:, closest] - distances[closest] * normal
        axes.update_datalim([foot - PLANE_DEPTH * size * normal])
        drawn = True
    return [_obstacle_handle()] if drawn else []


def _obstacle_handle() -> Patch:
    return Patch(facecolor="none", edgecolor=GROUND, hatch="//////", label="obstacle")


def _outline(state: LimitState) -> tuple[Floats, Floats]:
    """Return the points that bound the structure, m, and their velocities, m/s.

    The shape is (2, n), for each.
    """
    d, velocity = state.discretisation, state.velocity
    places = [dofs.nodes for dofs in d.continua.values()]
    places += [dofs.body.edges.start for dofs in d.assemblies.values()]
    places += [dofs.body.position for dofs in d.frames.values()]
    moves = [velocity[name] for name in d.continua]
    moves += [
        dofs.velocity_at(velocity[name], dofs.body.edges.block, dofs.body.edges.start)
        for name, dofs in d.assemblies.items()
    ]
    moves += [velocity[name][:2] for name in d.frames]
    return np.concatenate(places, axis=1), np.concatenate(moves, axis=1)


def _spin(state: LimitState) -> float:
    """Return the largest rate of rotation of a block or a member, rad/s."""
    d, velocity = state.discretisation, state.velocity
    rates = [velocity[name][2] for name in d.assemblies]
    rates += [turning(dofs, velocity[name]) for name, dofs in d.frames.items()]
    return max((float(np.abs(rate).max()) for rate in rates), default=0.0)


def _handles(shown: Displacement) -> list[Artist]:
    """Return the legend of the mechanism, with entries for its contents only."""
    contacts = [*shown.interfaces, *shown.joints]
    handles: list[Artist] = [
        Line2D([], [], color="#999999", lw=0.8, ls=(0, (4, 3)), label="before collapse")
    ]
    assemblies = shown.state.discretisation.assemblies.values()
    if any(held_blocks(shown.state, dofs).any() for dofs in assemblies):
        handles.append(Patch(facecolor=FIXED, edgecolor="#666666", hatch="////", label="fixed"))
    bare = [contact for contact in contacts if len(contact.sides) == 1 and not contact.deforms]
    if bare:
        handles.append(_obstacle_handle())
    for kind, colour in COLOURS.items():
        if any((contact.kind == kind).any() for contact in contacts):
            handles.append(Line2D([], [], color=colour, lw=5, label=f"contact: {kind}"))
    return handles
