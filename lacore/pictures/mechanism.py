"""Pictures of limit states (matplotlib, without global state)."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.gridspec import GridSpec, SubplotSpec

from lacore.limit.state import LimitState
from lacore.numerics.arrays import Floats
from lacore.pictures.axis import label_coordinates, lay_out
from lacore.pictures.contact import draw_panel
from lacore.pictures.continua import draw_colour_bar
from lacore.pictures.displaced import displacement_of, draw_displaced, draw_ground_below
from lacore.pictures.forces import draw_forces
from lacore.pictures.frames import draw_moments
from lacore.pictures.space.mechanism import plot_in_space
from lacore.pictures.space.surface import plot_flow
from lacore.reporting.status import Status
from lacore.reporting.units import Units, fitting

_NOTHING = 1e-6  # by the size of the structure: shorter contact has no panel
_POINTS = 72.0  # per inch
_PAGE = 9.0  # inches
_TALLEST = 6.5  # inches, for one picture
_NARROWEST = 3.7  # inches, for one of two pictures, as the legend needs it
_WIDE = 0.4  # height over width below which two pictures are stacked
_CROWD = 300  # number of blocks above which this limit is doubled
_THRUST = 0.2  # by the side of a block: width of the thickest line of thrust
_EDGES = 0.35  # points: width of the lines between elements


def plot_mechanism(state: LimitState, units: Units | None = None) -> Figure:
    """Plot the mechanism: deformed meshes, displaced blocks and frames, the state of contact.

    With rigid blocks or frames a second picture shows their forces: the forces in joints as lines
    of thrust, the moments of members, the reactions of feet, and the reference loads. Below, for
    each interface of a continuum, there are means over its edges of reactions and velocities,
    because point values of reactions oscillate without meaning. Three-dimensional blocks are drawn
    in three pictures, see `lacore.pictures.space.mechanism.plot_in_space`. For a state of a path,
    the planes are drawn that bodies touch or nearly touch, and the contact of edges that touch
    within the step. The displacements are larger than those of the step, so an approaching body may
    be drawn behind a plane.

    Args:
        state: any state with a point and any status; the title contains the status.
        units: units; m, and a prefix that fits most forces, if None.

    Raises:
        ValueError: there is no point to show.
    """
    units = units or Units(fitting(state.discretisation.problem.sizes))
    if state.discretisation.solids:
        return plot_in_space(state, units, title_of(state))
    if state.discretisation.problem.dimension == 3:
        return plot_flow(state, units, title_of(state))
    shown = displacement_of(state)
    least = _NOTHING * shown.size
    panels = [one for one in shown.interfaces if one.deforms and one.length > least]
    layout = _layout(shown.extent, _rigid_parts(state), len(panels))
    axes, *others = layout.pictures
    faces, handles = draw_displaced(axes, shown, units, layout.points, _EDGES)
    if faces is not None:
        draw_colour_bar(axes, faces, state, units)
    elif state.dissipation:
        axes.set_title("no plastic dissipation: rigid-body motion", fontsize=9, loc="right")
    bodies = list(state.discretisation.problem.bodies.values())
    _frame(axes, handles, layout.columns)
    label_coordinates(axes, bodies, units)
    for picture in others:
        thickest = float(np.clip(_THRUST * layout.points * shown.block_side, 2.0, 6.0))
        handles = [*draw_moments(picture, state, units)]
        handles += draw_forces(picture, state, thickest, units)
        draw_ground_below(picture, shown)
        _frame(picture, handles, layout.columns)
        label_coordinates(picture, bodies, units)
        if layout.columns > 1:
            picture.set_ylabel("")
    _fit(layout, faces is not None)
    for cell, contact in zip(layout.cells, panels, strict=True):
        draw_panel(layout.figure, cell, contact, shown.fastest, units)
    layout.figure.suptitle(title_of(state), fontsize=11, x=0.01, ha="left")
    lay_out(layout.figure)
    return layout.figure


@dataclass(frozen=True)
class _Layout:
    """Figure with the mechanism and, with blocks, their forces; below, one row per panel.

    Attributes:
        columns: 2 if the forces are next to the mechanism.
        points: scale of the pictures, points per metre.
    """

    figure: Figure
    grid: GridSpec
    pictures: list[Axes]
    cells: list[SubplotSpec]
    columns: int
    points: float


def _layout(extent: Floats, blocks: int, panels: int) -> _Layout:
    """Return axes for pictures of `extent` (m), without a size yet."""
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
    margin = 0.9 + (1.0 if colours else 0.0)  # inches: labels and the colour bar
    page = (_PAGE + 0.9) / layout.columns
    tall = float(np.clip((page - margin) * aspect, 1.2, _TALLEST))
    if layout.columns > 1:
        page = max(min(page, tall / aspect + margin), _NARROWEST)
    rows = len(layout.pictures) // layout.columns
    heights = [*[tall + 0.85 + 0.25 * layout.columns] * rows, *[2.0] * len(layout.cells)]
    layout.grid.set_height_ratios(heights)
    layout.figure.set_size_inches(page * layout.columns, sum(heights) + 0.5)


def _blocks(state: LimitState) -> int:
    """Return the number of rigid blocks."""
    return sum(len(dofs.body.names) for dofs in state.discretisation.blocks.values())


def _rigid_parts(state: LimitState) -> int:
    """Return the number of rigid blocks and frames, for whose forces there is a second picture."""
    return _blocks(state) + len(state.discretisation.frames)


def title_of(state: LimitState) -> str:
    """Return the load factor, what it proves, and the solver."""
    if state.status is Status.SOLVED:
        first = f"load factor {state.load_factor:.6g}   ({state.claim.text})"
    elif state.status is Status.UNSAFE:
        first = "UNSAFE: collapse mechanism under the dead loads alone"
    else:
        first = f"{state.status.label.upper()}: last iterate, for inspection only"
    return (
        f"{first}\n{state.backend}, {state.coupling} coupling, {_parts(state)},"
        f" status: {state.status.label}"
    )


def _parts(state: LimitState) -> str:
    """Return the parts of the structure as text: ``96 elements, 1 rigid block, 3 members``."""
    d = state.discretisation
    counts = {
        "element": sum(body.body.mesh.nelements for body in d.continua.values()),
        "rigid block": _blocks(state),
        "member": sum(len(dofs.body.member_names) for dofs in d.frames.values()),
    }
    return ", ".join(f"{n} {name}{'s' if n > 1 else ''}" for name, n in counts.items() if n)


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
