"""Plane sections of bodies of tetrahedra: dissipation and velocity."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from lacore.bounds.lower import LowerBound
from lacore.limit.state import LimitState
from lacore.model.bodies.continuum.body import Body
from lacore.numerics.arrays import Floats
from lacore.pictures.axis import colour_bar, label_lengths
from lacore.pictures.mechanism import title_of
from lacore.pictures.mesh import STRENGTH_USED, strength_used
from lacore.pictures.space.cut import Cut, Plane, cut_by, plane_of, velocity_in
from lacore.pictures.space.mechanism import MOVES
from lacore.pictures.space.surface import DISSIPATION
from lacore.reporting.errors import InputError
from lacore.reporting.units import Units

_PAGE, _TALLEST, _LOWEST = 6.0, 5.0, 1.6  # inches: the section alone
_ARROW = 0.09  # by the size of the section: the longest
_ARROWS = 24  # number along the longer side, as more cannot be distinguished
_MARGIN = 0.04  # by the size of the section
_VELOCITY = "#12395b"


def plot_section(
    state: LimitState, point: Sequence[float], normal: Sequence[float], units: Units | None = None
) -> Figure:
    """Plot a section of bodies of tetrahedra: dissipation, and the velocity in the plane.

    It shows the dissipation per volume of each element that the plane cuts, with that of velocity
    jumps half to either side, by the largest of all elements, cut or not. Arrows begin at centroids
    of cuts; in fine meshes at the largest cut of each place. The two axes are x, y or z if the
    plane lies along them, else lengths from the origin along directions in the labels.

    Args:
        state: any state with a point.
        point: point of the plane, three numbers, m.
        normal: normal of the plane, three numbers, of any length and sense.
        units: units of lengths; m if None.

    Raises:
        InputError: not three numbers, a normal of zero, a plane that misses the bodies, or no body
            of tetrahedra.
        ValueError: there is no point to show.
    """
    dofs, power, velocity = state.discretisation.continua, state.dissipation, state.velocity
    bodies = {name: own.body for name, own in dofs.items()}
    plane = plane_of(point, normal)
    cuts = _cuts(plane, bodies)
    largest = max(float(own.max()) for own in power.values()) or 1.0
    shares = {name: own / largest for name, own in power.items()}
    told = (title_of(state), DISSIPATION, "YlOrRd")
    figure, axes = _coloured(plane, cuts, shares, told, units or Units())
    centroids = [cut.centroid(bodies[name].mesh) for name, cut in cuts.items()]
    places = plane.axes @ np.concatenate(centroids, axis=1)
    moves = [velocity_in(plane, cut, dofs[name], velocity[name]) for name, cut in cuts.items()]
    areas = np.concatenate([cut.area for cut in cuts.values()])
    fastest = max(float(np.linalg.norm(own, axis=0).max()) for own in velocity.values())
    _draw_velocity(axes, places, np.concatenate(moves, axis=1), areas, fastest)
    return figure


def plot_strength_section(
    bound: LowerBound, point: Sequence[float], normal: Sequence[float], units: Units | None = None
) -> Figure:
    """Plot the utilisation of the strength by the stresses of a lower bound, in a section.

    Args:
        bound: bound of bodies of tetrahedra.
        point: point of the plane, three numbers, m.
        normal: normal of the plane, three numbers, of any length and sense.
        units: units of lengths; m if None.

    Raises:
        InputError: see `plot_section`.
        ValueError: there is no state.
    """
    used = strength_used(bound)
    plane = plane_of(point, normal)
    cuts = _cuts(plane, {name: own.body for name, own in bound.model.continua.items()})
    told = (f"lower bound {bound.load_factor:.6g}", STRENGTH_USED, "viridis")
    return _coloured(plane, cuts, used, told, units or Units())[0]


def _cuts(plane: Plane, bodies: Mapping[str, Body]) -> dict[str, Cut]:
    """Return the cuts of the bodies that a plane meets."""
    solids = {name: body.mesh for name, body in bodies.items() if body.dimension == 3}
    if not solids:
        raise InputError("bodies", list(bodies), "none is of tetrahedra", "take plot()")
    found = {name: cut_by(plane, mesh) for name, mesh in solids.items()}
    cuts = {name: cut for name, cut in found.items() if cut.element.size}
    if not cuts:
        height = [plane.normal @ mesh.p for mesh in solids.values()]
        low, high = min(own.min() for own in height), max(own.max() for own in height)
        nearest = np.clip(plane.normal @ plane.point, low, high)
        place = plane.point + (nearest - plane.normal @ plane.point) * plane.normal
        shown = ", ".join(f"{own:.4g}" for own in place.tolist())
        raise InputError(
            "point",
            tuple(plane.point.tolist()),
            "the plane misses all bodies of tetrahedra",
            f"the nearest plane that touches one goes through ({shown})",
        )
    return cuts


def _coloured(
    plane: Plane,
    cuts: Mapping[str, Cut],
    values: Mapping[str, Floats],
    told: tuple[str, str, str],
    units: Units,
) -> tuple[Figure, Axes]:
    """Draw cuts in the colours of element values, from 0 to 1; texts: title, label, colours."""
    title, label, colours = told
    corners = np.concatenate([cut.corners for cut in cuts.values()], axis=2)
    flat = corners.reshape(2, -1)
    low, extent = flat.min(axis=1), np.ptp(flat, axis=1)
    scale = min(_PAGE / extent[0], _TALLEST / extent[1])
    size = _PAGE + 1.2, max(scale * extent[1], _LOWEST) + 1.7
    figure = Figure(figsize=size, layout="constrained")
    figure.set_facecolor("white")
    figure.suptitle(title, fontsize=11, x=0.01, ha="left")
    axes = figure.add_subplot()
    axes.set_aspect("equal")
    margin = _MARGIN * extent.max()
    axes.set_xlim(low[0] - margin, low[0] + extent[0] + margin)
    axes.set_ylim(low[1] - margin, low[1] + extent[1] + margin)
    axes.tick_params(labelsize=8)
    label_lengths(axes, plane.names, units)
    polygons = PolyCollection(
        list(corners.transpose(2, 1, 0)),
        array=np.concatenate([values[name][cut.element] for name, cut in cuts.items()]),
        cmap=matplotlib.colormaps[colours],
        norm=Normalize(0.0, 1.0),
        edgecolors=(0, 0, 0, 0.2),
        linewidths=0.35,
    )
    axes.add_collection(polygons)
    colour_bar(polygons, axes, label)
    return figure, axes


def _draw_velocity(
    axes: Axes, places: Floats, velocity: Floats, areas: Floats, fastest: float
) -> None:
    """Draw arrows at places, (2, k) both, unless they are invisible."""
    speed = np.linalg.norm(velocity, axis=0)
    if not speed.max() > MOVES * fastest:
        return
    size = float(np.ptp([axes.get_xlim(), axes.get_ylim()], axis=1).max())
    cell = np.floor(_ARROWS * (places - places.min(axis=1, keepdims=True)) / size)
    order = np.argsort(-areas, kind="stable")
    shown = order[np.unique(cell[:, order], axis=1, return_index=True)[1]]
    arrows = _ARROW * size * velocity[:, shown] / speed.max()
    axes.quiver(
        *places[:, shown],
        *arrows,
        color=_VELOCITY,
        angles="xy",
        scale_units="xy",
        scale=1.0,
        width=0.0025,
        zorder=3,
    )
    label = f"in-plane velocity, up to {speed.max() / fastest:.2g} of the largest"
    line = Line2D([], [], color=_VELOCITY, marker=">", markersize=4, label=label)
    axes.legend(handles=[line], loc="lower left", bbox_to_anchor=(0, 1), frameon=False, fontsize=8)
