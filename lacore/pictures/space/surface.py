"""Surfaces of bodies of tetrahedra: their parts by name, or a value of each element."""

from collections.abc import Mapping

import matplotlib
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Colormap, Normalize, to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from mpl_toolkits.mplot3d.axes3d import Axes3D
from skfem import MeshTet

from lacore.limit.state import LimitState
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.solid.faces import face_geometry
from lacore.model.meshes.solid.faces import face_corners
from lacore.numerics.arrays import Bools, Floats
from lacore.pictures.axis import colour_bar
from lacore.pictures.space.drawing import explain, eye, page, space
from lacore.reporting.units import Units

_STRETCH = 0.1  # by the size of the bodies: the largest drawn displacement
_WIDE = 7.4  # inches, with the colour scale
PLAIN = "#ece2cd"
DISSIPATION = "dissipation density / largest value"
EDGE = 0.6  # brightness of edges, by the faces
_FEW = 10  # number of boundaries with a colour
_SHADOW = 0.72  # brightness of sides without light
_LIGHT = np.array([-0.35, -0.6, 0.72]) / np.linalg.norm([-0.35, -0.6, 0.72])
_SI = Units()


def surface_by_name(body: Body) -> Figure:
    """Draw the visible faces of a body, coloured by the names of its boundaries."""
    mesh = body.mesh
    facets = mesh.boundary_facets().astype(np.int64)
    colours = np.tile(to_rgb(PLAIN), (facets.size, 1))
    handles = []
    for number, (name, own) in enumerate(list((mesh.boundaries or {}).items())[:_FEW]):
        colour = matplotlib.colormaps["tab10"](number)[:3]
        colours[np.isin(facets, np.asarray(own))] = colour
        handles.append(Patch(facecolor=colour, label=str(name)))
    figure, (place,) = page(1, "")
    axes = space(figure, place, *body.box, _SI)
    fill_faces(axes, mesh, face_corners(mesh, facets), colours)
    explain(axes, handles)
    return figure


def surface_by_value(
    bodies: Mapping[str, Body],
    values: Mapping[str, Floats],
    title: str,
    label: str,
    colours: Colormap,
    top: float,
) -> Figure:
    """Draw the visible faces of bodies, coloured by the values of the elements behind them."""
    corners = {
        name: face_corners(body.mesh, body.mesh.boundary_facets()) for name, body in bodies.items()
    }
    return _coloured(bodies, corners, values, (title, label, colours, top), _SI)


def plot_flow(state: LimitState, units: Units, title: str) -> Figure:
    """Draw the mechanism of bodies of tetrahedra: displaced, with the dissipated power.

    It shows the dissipation per volume of the elements at the surface, with that of velocity jumps
    half to either side, by the largest of all elements.

    Args:
        state: any state with a point.
        units: units of sizes.
        title: title of the figure.
    """
    bodies, corners, shares = displaced_faces(state)
    return _coloured(
        bodies, corners, shares, (title, DISSIPATION, matplotlib.colormaps["YlOrRd"], 1.0), units
    )


def displaced_faces(
    state: LimitState,
) -> tuple[dict[str, Body], dict[str, Floats], dict[str, Floats]]:
    """Find the bodies of a state, their displaced boundary faces and their dissipation.

    Returns:
        The bodies, the corners of their boundary faces, m, shape (3, 3, faces), and the
        dissipation density of their elements, as a share of the largest, shape (elements,).
    """
    dofs, velocity = state.discretisation.continua, state.velocity
    bodies = {name: own.body for name, own in dofs.items()}
    size = max(body.size for body in bodies.values())
    fastest = max(float(np.linalg.norm(own, axis=0).max()) for own in velocity.values())
    stretch = _STRETCH * size / (fastest or 1.0)
    corners = {}
    for name, own in dofs.items():
        facets = own.body.mesh.boundary_facets().astype(np.int64)
        moved = velocity[name][:, own.facet_nodes(facets)[:3]]
        corners[name] = face_corners(own.body.mesh, facets) + stretch * moved
    power = state.dissipation
    largest = max(float(own.max()) for own in power.values()) or 1.0
    return bodies, corners, {name: own / largest for name, own in power.items()}


def _coloured(
    bodies: Mapping[str, Body],
    corners: Mapping[str, Floats],
    values: Mapping[str, Floats],
    told: tuple[str, str, Colormap, float],
    units: Units,
) -> Figure:
    title, label, colours, top = told
    every = np.concatenate([own.reshape(3, -1) for own in corners.values()], axis=1)
    figure, (place,) = page(1, title)
    figure.set_size_inches(_WIDE, figure.get_size_inches()[1])
    axes = space(figure, place, every.min(axis=1), every.max(axis=1), units)
    scale = ScalarMappable(Normalize(0.0, top if top > 0 else 1.0), colours)
    for name, body in bodies.items():
        behind = body.mesh.f2t[0, body.mesh.boundary_facets()]
        fill_faces(axes, body.mesh, corners[name], scale.to_rgba(values[name][behind])[:, :3])
    colour_bar(scale, axes, label, shrink=0.6)
    return figure


def fill_faces(axes: Axes3D, mesh: MeshTet, corners: Floats, colours: Floats) -> None:
    """Draw boundary faces with corners (3, 3, k) that face the viewer, shaded, colours (k, 3)."""
    seen, shaded = seen_faces(mesh, colours)
    axes.add_collection3d(
        Poly3DCollection(
            list(corners[:, :, seen].transpose(2, 1, 0)),
            facecolors=shaded,
            edgecolors=EDGE * shaded,
            linewidths=0.3,
            zorder=2.0,
        )
    )


def seen_faces(mesh: MeshTet, colours: Floats) -> tuple[Bools, Floats]:
    """Return the boundary faces that face the viewer, (k,), and their shaded colours, (seen, 3)."""
    _, normal = face_geometry(mesh, mesh.boundary_facets())
    seen = eye() @ normal > 0
    shade = _SHADOW + (1 - _SHADOW) * np.maximum(_LIGHT @ normal, 0.0)
    return seen, (shade[:, None] * colours)[seen]
