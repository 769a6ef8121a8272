"""Pictures of limit states (matplotlib, without global state)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import GridSpec, SubplotSpec
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from lacore.arrays import Floats
from lacore.limit.state import LimitState
from lacore.numerics.quantities import Units, fitting
from lacore.pictures.axis import draw_axis, label_coordinates
from lacore.pictures.blocks import FIXED, draw_blocks, held_blocks
from lacore.pictures.contact import (
    COLOURS,
    GROUND,
    PLANE_DEPTH,
    draw_ground,
    draw_moved,
    draw_obstacle,
    draw_panel,
    draw_strips,
)
from lacore.pictures.contact_segments import SegmentedContact, segmented_contacts
from lacore.pictures.continua import draw_continua
from lacore.pictures.forces import draw_forces
from lacore.pictures.frames import draw_foot, draw_frames, draw_moments, turning
from lacore.pictures.space.mechanism import plot_in_space
from lacore.pictures.space.surface import plot_flow
from lacore.status import Status

_STRETCH = 0.08  # largest displacement drawn, per size of the structure
_TURN = 0.3  # largest rotation drawn, rad: blocks grow by half its square
_STRIP = 0.018  # depth of strips behind contact, per size of the structure
_GROUND = 0.03  # the same of obstacles under blocks
_NOTHING = 1e-6  # the same: shorter contact has no panel
_NEAR = 0.1  # of the picture: distance up to which a plane is drawn
_POINTS = 72.0  # an inch
_PAGE = 9.0  # inches
_TALLEST = 6.5  # inches, of one picture
_NARROWEST = 3.7  # inches, of one of two pictures: its legend needs that
_WIDE = 0.4  # height over width: below it two pictures stand above each other
_CROWD = 300  # blocks: above it they do so below twice that
_LINE = 0.07  # of the side of a block: width of contact lines
_THRUST = 0.2  # of the side of a block: width of the thickest line of thrust
_TINY = np.finfo(float).tiny


def plot_mechanism(state: LimitState, units: Units | None = None) -> Figure:
    """Picture of the mechanism: deformed meshes, displaced blocks and frames, what contact does.

    With rigid blocks or frames a second picture shows what they carry: the forces in joints as
    lines of thrust, the moments of members, the reactions of feet, and the live loads. Below,
    for each interface of a continuum, means over its edges of reactions and velocities: point
    values of reactions oscillate and mean nothing. Blocks in space are drawn in three pictures, see
    `lacore.pictures.space.mechanism.plot_in_space`. Of a state of a path the planes are drawn that
    bodies touch or are near to, and of contact the edges that touch, or come to do so within the
    step. The mechanism is drawn larger than the step: what approaches may be drawn behind a plane.

    Args:
        state: any state with a point, whatever its status; the title says which.
        units: that sizes are told in; m, and a prefix that fits most forces, if None.

    Raises:
        ValueError: there is no point to show.
    """
    units = units or Units(fitting(state.discretisation.problem.sizes))
    if state.discretisation.solids:
        return plot_in_space(state, units, title_of(state))
    if state.discretisation.problem.dimension == 3:
        return plot_flow(state, units, title_of(state))
    places, velocities = _outline(state)
    size = float(np.linalg.norm(np.ptp(places, axis=1)))
    fastest = float(np.linalg.norm(velocities, axis=0).max()) or 1.0
    stretch = min(_STRETCH * size / fastest, _TURN / max(_spin(state), _TINY))
    extent = np.ptp(np.concatenate([places, places + stretch * velocities], axis=1), axis=1)
    extent = np.maximum(extent, _STRETCH * size)  # a single beam has no height
    interfaces, joints = segmented_contacts(state, fastest)
    panels = [c for c in interfaces if c.deforms and c.length > _NOTHING * size]

    layout = _layout(extent, _rigid_parts(state), len(panels))
    axes, *others = layout.pictures
    colours = draw_continua(layout.figure, axes, state, stretch, units)
    draw_blocks(axes, state, stretch, fastest)
    width = float(np.clip(_LINE * layout.points * _block_size(state, extent), 0.5, 3.5))
    hinges = draw_frames(axes, state, stretch, fastest)
    for contact in [*interfaces, *joints]:
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
    bodies = list(state.discretisation.problem.bodies.values())
    handles = [*_handles(state, [*interfaces, *joints]), *obstacles, *hinges]
    handles += draw_axis(axes, bodies)
    _frame(axes, handles, layout.columns)
    label_coordinates(axes, bodies, units)
    for picture in others:
        thickest = float(np.clip(_THRUST * layout.points * _block_size(state, extent), 2.0, 6.0))
        handles = [*draw_moments(picture, state, units)]
        handles += draw_forces(picture, state, thickest, units)
        for contact in interfaces:
            if len(contact.sides) == 1 and not contact.pointwise:
                draw_ground(picture, contact, _GROUND * size)
        _frame(picture, handles, layout.columns)
        label_coordinates(picture, bodies, units)
        if layout.columns > 1:
            picture.set_ylabel("")
    _fit(layout, colours)
    for cell, contact in zip(layout.cells, panels, strict=True):
        draw_panel(layout.figure, cell, contact, fastest, units)
    layout.figure.suptitle(title_of(state), fontsize=11, x=0.01, ha="left")
    layout.figure.draw_without_rendering()  # the layout needs the scales to find the margins
    return layout.figure


def _draw_obstacles(axes: Axes, state: LimitState) -> list[Artist]:
    """Of a state of a path the obstacles that bodies touch or are near to."""
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


@dataclass(frozen=True)
class _Layout:
    """A figure with the mechanism and, with blocks, their forces; below, a row a panel.

    Attributes:
        columns: 2 where the forces stand beside the mechanism.
        points: scale of the pictures, points a metre.
    """

    figure: Figure
    grid: GridSpec
    pictures: list[Axes]
    cells: list[SubplotSpec]
    columns: int
    points: float


def _layout(extent: Floats, blocks: int, panels: int) -> _Layout:
    """Axes for pictures of `extent` (m), still without a size."""
    aspect = float(extent[1] / extent[0])
    beside = blocks > 0 and aspect > (_WIDE if blocks < _CROWD else 2 * _WIDE)
    columns, rows = (2, 1) if beside else (1, 2 if blocks else 1)
    figure = Figure(layout="constrained")
    figure.set_facecolor("white")
    grid = figure.add_gridspec(rows + panels, columns)
    pictures = [figure.add_subplot(grid[0, 0])]
    if blocks:
        place = grid[0, 1] if beside else grid[1, 0]
        pictures.append(figure.add_subplot(place, sharex=pictures[0], sharey=pictures[0]))
    cells = [grid[rows + panel, :] for panel in range(panels)]
    points = _POINTS * min(_PAGE / columns / extent[0], _TALLEST / extent[1])
    return _Layout(figure, grid, pictures, cells, columns, float(points))


def _fit(layout: _Layout, colours: bool) -> None:
    """Give the figure a size that its pictures fill, now that everything is drawn."""
    low, high = np.transpose([axes.dataLim.get_points() for axes in layout.pictures], (1, 2, 0))
    extent = high.max(axis=1) - low.min(axis=1)
    aspect = float(extent[1] / extent[0])
    margin = 0.9 + (1.0 if colours else 0.0)  # inches: labels and the bar of colours
    page = (_PAGE + 0.9) / layout.columns
    tall = float(np.clip((page - margin) * aspect, 1.2, _TALLEST))
    if layout.columns > 1:
        page = max(min(page, tall / aspect + margin), _NARROWEST)
    rows = len(layout.pictures) // layout.columns
    heights = [*[tall + 0.85 + 0.25 * layout.columns] * rows, *[2.0] * len(layout.cells)]
    layout.grid.set_height_ratios(heights)
    layout.figure.set_size_inches(page * layout.columns, sum(heights) + 0.5)


def _outline(state: LimitState) -> tuple[Floats, Floats]:
    """Points that bound the structure, m, and their velocities, m/s, shape (2, n) each."""
    d, velocity = state.discretisation, state.velocity
    places = [dofs.nodes for dofs in d.bodies.values()]
    places += [dofs.body.edges.start for dofs in d.assemblies.values()]
    places += [dofs.body.position for dofs in d.frames.values()]
    moves = [velocity[name] for name in d.bodies]
    moves += [dofs.vertex_velocity(velocity[name]) for name, dofs in d.assemblies.items()]
    moves += [velocity[name][:2] for name in d.frames]
    return np.concatenate(places, axis=1), np.concatenate(moves, axis=1)


def _spin(state: LimitState) -> float:
    """Largest rate of rotation of a block or a member, rad/s."""
    d, velocity = state.discretisation, state.velocity
    rates = [velocity[name][2] for name in d.assemblies]
    rates += [turning(dofs, velocity[name]) for name, dofs in d.frames.items()]
    return max((float(np.abs(rate).max()) for rate in rates), default=0.0)


def _blocks(state: LimitState) -> int:
    """Number of rigid blocks."""
    return sum(len(dofs.body.names) for dofs in state.discretisation.jointed.values())


def _rigid_parts(state: LimitState) -> int:
    """Number of rigid blocks and frames: of what a second picture shows the forces."""
    return _blocks(state) + len(state.discretisation.frames)


def _block_size(state: LimitState, extent: Floats) -> float:
    """Side of the mean block of the finest assembly; without blocks, of the structure, m."""
    sizes = [np.sqrt(dofs.body.area).mean() for dofs in state.discretisation.assemblies.values()]
    return float(min(sizes, default=extent.max()))


def title_of(state: LimitState) -> str:
    """The load factor and what it is worth, and who found it."""
    if state.status is Status.SOLVED:
        worth = state.discretisation.worth(state.rigor).partition(":")[0]
        first = f"load factor {state.load_factor:.6g}   ({worth})"
    elif state.status is Status.UNSAFE:
        first = "UNSAFE: what falls under the dead loads alone"
    else:
        first = f"{state.status.label.upper()}: last iterate, for inspection only"
    return (
        f"{first}\n{state.backend}, {state.coupling} coupling, {_parts(state)},"
        f" status: {state.status.label}"
    )


def _parts(state: LimitState) -> str:
    """What the structure consists of: ``96 elements, 1 rigid block, 3 members``."""
    d = state.discretisation
    counts = {
        "element": sum(body.body.mesh.nelements for body in d.bodies.values()),
        "rigid block": _blocks(state),
        "member": sum(len(dofs.body.member_names) for dofs in d.frames.values()),
    }
    return ", ".join(f"{n} {name}{'s' if n > 1 else ''}" for name, n in counts.items() if n)


def _handles(state: LimitState, contacts: Sequence[SegmentedContact]) -> list[Artist]:
    """Legend of the mechanism: what is there, and no more."""
    handles: list[Artist] = [
        Line2D([], [], color="#999999", lw=0.8, ls=(0, (4, 3)), label="before collapse")
    ]
    assemblies = state.discretisation.assemblies.values()
    if any(held_blocks(state, dofs).any() for dofs in assemblies):
        handles.append(Patch(facecolor=FIXED, edgecolor="#666666", hatch="////", label="fixed"))
    bare = [contact for contact in contacts if len(contact.sides) == 1 and not contact.deforms]
    if bare:
        handles.append(_obstacle_handle())
    for kind, colour in COLOURS.items():
        if any((contact.kind == kind).any() for contact in contacts):
            handles.append(Line2D([], [], color=colour, lw=5, label=f"contact: {kind}"))
    return handles


def _frame(axes: Axes, handles: Sequence[Artist], columns: int) -> None:
    axes.set_aspect("equal", anchor="SW")
    axes.autoscale_view()
    axes.tick_params(labelsize=8)
    axes.locator_params(axis="x", nbins=12 // columns)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    axes.legend(
        handles=handles,
        loc="lower left",
        bbox_to_anchor=(0, 1.0),
        ncols=len(handles) if columns == 1 else 3,
        frameon=False,
        fontsize=8,
        handlelength=1.6,
        columnspacing=1.2,
        borderaxespad=0.2,
    )
