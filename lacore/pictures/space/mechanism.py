"""Pictures of limit states of three-dimensional blocks: mechanism, joints, thrust."""

import numpy as np
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from mpl_toolkits.mplot3d.axes3d import Axes3D

from lacore.limit.state import LimitState
from lacore.numerics.arrays import Floats
from lacore.pictures.contact import COLOURS
from lacore.pictures.space.drawing import (
    draw_edges,
    draw_lines,
    explain,
    fill_polygons,
    fill_solids,
    page,
    space,
)
from lacore.pictures.space.problem import FIXED, FREE
from lacore.pictures.space.structure import Motion, Touches, motion_of, stretch_of, touches_of
from lacore.reporting.units import Units

THRUST, LOAD = "#b2182b", "#0f7b3f"
# Most joints stick, and would hide the others.
_OPAQUE = {"stick": 0.3, "slip": 0.8, "open": 0.8, "crush": 0.8}
MOVES = 1e-3  # by the largest velocity: visible slip or opening
_FAINTEST = 2e-3  # by the largest force: smaller lines of thrust are invisible
_SHORTEST = 0.3  # by the radius of the smaller block: lines of thrust
_THICKEST = 5.0  # points: the line of the largest force
_ARROW = 0.22  # by the size of the structure
_TINY = np.finfo(float).tiny


def plot_in_space(state: LimitState, units: Units, title: str) -> Figure:
    """Draw three pictures of a state of three-dimensional blocks.

    They are the displaced mechanism; the joints before collapse, which stick, slip and open; and
    their forces, as lines of thrust through the centres of pressure, with the width of the force.

    Args:
        state: any state with a point.
        units: units of sizes.
        title: title of the figure.
    """
    motion = motion_of(state)
    blocks, velocity = motion.blocks, motion.vertices
    fastest = float(np.linalg.norm(velocity, axis=0).max())
    touches = touches_of(state, motion, MOVES * fastest)
    moved = blocks.points + stretch_of(motion) * velocity
    figure, places = page(3, title)
    both = np.concatenate([blocks.points, moved], axis=1)
    low, high = both.min(axis=1), both.max(axis=1)

    axes = space(figure, places[0], low, high, units)
    fill_solids(axes, moved, blocks, colours_of(motion), 2.0)
    handles: list[Artist] = [Patch(facecolor=FREE, edgecolor="#555555", label="displaced")]
    if motion.held.any():
        handles.append(Patch(facecolor=FIXED, edgecolor="#555555", label="fixed"))
    explain(axes, handles)

    axes = space(figure, places[1], low, high, units)
    draw_edges(axes, blocks.points, blocks, "#c9c2b2", 1.0)
    shades = [(COLOURS[kind], _OPAQUE[kind]) for kind in touches.kind]
    fill_polygons(axes, touches.corners, shades, 2.0)
    shown = [kind for kind in COLOURS if np.any(touches.kind == kind)]
    explain(axes, [Patch(facecolor=COLOURS[kind], label=f"joints that {kind}") for kind in shown])

    axes = space(figure, places[2], low, high, units)
    draw_edges(axes, blocks.points, blocks, "#c9c2b2", 1.0)
    explain(axes, [*_draw_thrust(axes, motion, touches, units), *_draw_load(axes, state, motion)])
    return figure


def colours_of(motion: Motion) -> list[str]:
    """Return the colours of blocks: held ones are grey."""
    return [FIXED if held else FREE for held in motion.held]


def thrust_lines(motion: Motion, touches: Touches) -> Floats:
    """Return the lines of thrust through the centres of pressure, (3, 2, k), m.

    They end in both blocks where they are closest to the centroids, and at fixed parts.
    """
    size = np.linalg.norm(touches.force, axis=0)
    along = touches.force / np.maximum(size, _TINY)
    radius = motion.blocks.radius
    reach = np.minimum(
        np.where(touches.slave >= 0, radius[touches.slave], np.inf),
        np.where(touches.master >= 0, radius[touches.master], np.inf),
    )
    ends = []
    for sense, block in ((1.0, touches.slave), (-1.0, touches.master)):
        arm = motion.blocks.centroid[:, block] - touches.centre
        length = np.clip(sense * np.sum(arm * along, axis=0), _SHORTEST * reach, reach)
        length = np.where((block < 0) | motion.held[block], 0.0, length)
        ends.append(touches.centre + sense * length * along)
    return np.stack(ends, axis=1)


def _draw_thrust(axes: Axes3D, motion: Motion, touches: Touches, units: Units) -> list[Artist]:
    size = np.linalg.norm(touches.force, axis=0)
    peak = float(size.max(initial=0.0))
    seen = np.flatnonzero(size > _FAINTEST * peak)
    if not seen.size:
        return []
    widths = np.maximum(_THICKEST * size[seen] / peak, 0.3)
    draw_lines(axes, thrust_lines(motion, touches)[:, :, seen], widths, THRUST, 3.0)
    label = f"contact force (max {units.told(peak, 'N', digits=3)})"
    return [Line2D([], [], color=THRUST, lw=4, label=label)]


def _draw_load(axes: Axes3D, state: LimitState, motion: Motion) -> list[Artist]:
    """Draw the resultant of the reference load, an arrow that ends where it acts."""
    d = state.discretisation
    loads = []
    for name, dofs in d.solids.items():
        own = d.full.reference_load[dofs.offset : dofs.offset + dofs.of_blocks].reshape(-1, 6).T
        held = motion.held[motion.blocks.first[name] :][: own.shape[1]]
        loads.append(np.where(held, 0.0, own[:3]))
    force = np.concatenate(loads, axis=1)
    size = np.linalg.norm(force, axis=0)
    total = force.sum(axis=1)
    if not np.linalg.norm(total) > _FAINTEST * size.sum():
        return []
    tip = (motion.blocks.centroid * size).sum(axis=1) / size.sum()
    arrow = _ARROW * motion.blocks.size * total / np.linalg.norm(total)
    axes.quiver(*(tip - arrow), *arrow, color=LOAD, linewidth=2.2, arrow_length_ratio=0.3, zorder=4)
    return [Line2D([], [], color=LOAD, lw=2, marker=">", label="reference load $F_0$, resultant")]
