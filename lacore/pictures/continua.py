"""Pictures of continua: deformed meshes coloured by the density of dissipation."""

from itertools import pairwise

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import LogNorm

from lacore.limit.state import LimitState
from lacore.model.bodies.continuum.dofs import BodyDofs, edge_shapes
from lacore.model.meshes.curved import edge_lines
from lacore.numerics.arrays import Floats
from lacore.pictures.axis import colour_bar, has_axis, superscript
from lacore.reporting.units import Units

BEFORE = {"colors": "#999999", "linewidths": 0.8, "linestyles": (0, (4, 3))}
"""Style of outlines before collapse."""
RIGID = "#f3f3f0"  # colour without dissipation
_DECADES = 3.0  # decades of dissipation density in the colour scale
_RIGID_SHARE = 1e-5  # by all power: smaller dissipation counts as rigid motion
_SIDES = 6  # number of chords for each curved edge of a deformed element


def draw_continua(
    axes: Axes, state: LimitState, stretch: float, units: Units, edges: float = 0.35
) -> PolyCollection | None:
    """Draw continua displaced by `stretch` (s) times their velocity.

    Args:
        axes: Axes.
        state: Any state with a point.
        stretch: Displacement per velocity, s.
        units: Units of the dissipation density.
        edges: Width of the lines between elements, points; 0 draws none.

    Returns:
        The elements coloured by their dissipation; None if no body dissipates.
    """
    dissipation = dict(state.dissipation)
    if not dissipation:
        return None
    size = units.size("m") ** _power(state)
    dissipation = {name: size * own for name, own in dissipation.items()}
    norm = _colour_scale(state, np.concatenate(list(dissipation.values())))
    cmap = matplotlib.colormaps["YlOrRd"].with_extremes(under=RIGID, bad=RIGID)
    picture = None
    for name, body in state.discretisation.continua.items():
        outline, faces = _deformed(body, state.velocity[name], stretch)
        axes.add_collection(LineCollection(boundary_lines(body), **BEFORE, zorder=1))
        picture = PolyCollection(
            list(faces),
            array=dissipation[name] if norm else np.zeros_like(dissipation[name]),
            norm=norm or LogNorm(1, 2),
            cmap=cmap,
            edgecolors=(0, 0, 0, 0.16) if edges else "none",
            linewidths=edges,
            # Smoothed sides of polygons without lines between them would leave hairlines.
            antialiaseds=edges > 0,
            zorder=2,
        )
        axes.add_collection(picture)
        axes.add_collection(
            LineCollection(list(outline), colors="#222222", linewidths=1.0, zorder=3)
        )
    return picture if norm else None


def draw_colour_bar(axes: Axes, faces: PolyCollection, state: LimitState, units: Units) -> None:
    """Draw the colour bar of the dissipation density next to the axes."""
    density = f"W/{units.length}{superscript(_power(state))} per W of load"
    colour_bar(faces, axes, f"dissipation density [{density}]")


def _power(state: LimitState) -> int:
    """Return the dimension of the volume of dissipation densities."""
    return 3 if has_axis(state.discretisation.problem.bodies.values()) else 2


def boundary_lines(body: BodyDofs) -> list[Floats]:
    """Return the edges of the boundary before collapse, each of shape (points, 2)."""
    return edge_lines(body.body.mesh, body.body.mesh.boundary_facets())


def _edge_curve(places: Floats) -> Floats:
    """Return the points on edges through nodes (2, nodes, edges): (_SIDES + 1, edges, 2)."""
    shape = edge_shapes(np.linspace(0, 1, _SIDES + 1), places.shape[1] - 1)
    return np.asarray(np.einsum("sn,xne->sex", shape, places))


def _colour_scale(state: LimitState, density: Floats) -> LogNorm | None:
    """Return the scale of the densities; None if the dissipation is round-off."""
    point, program = state.point, state.program
    assert point is not None
    slip, weights = program.contact.slip(point.velocity), program.contact.weights
    friction = float(np.abs(weights[:, None] * point.tangential_reaction * slip).sum())
    powers = zip(state.discretisation.continua.values(), state.dissipation.values(), strict=True)
    plastic = sum(float(body.volumes @ power) for body, power in powers)
    if plastic <= _RIGID_SHARE * (program.plastic_dissipation(point.velocity) + friction):
        return None
    peak = float(density.max())
    return LogNorm(float(np.clip(density.min(), peak * 10**-_DECADES, peak / 2)), peak)


def _deformed(body: BodyDofs, velocity: Floats, stretch: float) -> tuple[Floats, Floats]:
    """Return the boundary edges and element outlines of the deformed mesh, as polylines."""
    mesh = body.body.mesh
    moved = body.nodes + stretch * velocity
    corners = len(mesh.t)
    ring = [*range(corners), 0]
    # scikit-fem numbers the edges of a polygon (0, 1), (1, 2), ..., (0, last).
    along = [
        [start, corners + number, end] if body.degree == 2 else [start, end]
        for number, (start, end) in enumerate(pairwise(ring))
    ]
    sides = [_edge_curve(moved[:, body.element_nodes[nodes]])[:-1] for nodes in along]
    faces = np.concatenate(sides).transpose(1, 0, 2)
    outline = _edge_curve(moved[:, body.facet_nodes(mesh.boundary_facets())])
    return outline.transpose(1, 0, 2), faces
