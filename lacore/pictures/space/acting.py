"""Sketch of a problem of tetrahedra: supports, contact and loads of faces."""

from collections.abc import Iterator

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.boundaries import boundary_facets
from lacore.model.conditions.where import Where
from lacore.model.meshes.solid.faces import face_corners
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats, Ints
from lacore.pictures.space.drawing import explain, page, space
from lacore.pictures.space.surface import PLAIN, fill_faces
from lacore.reporting.showing import cut
from lacore.reporting.text import Reader, render, text
from lacore.reporting.units import Units

_HELD = ("#a8a8a8", "#8fa3b0", "#7d8c7a", "#b0a58f", "#6f6f7f", "#c2c2b0")
_LOADED, _DEAD, _TOUCHED = "Greens", "Purples", "Oranges"
_LONGEST = 45  # characters of a legend


def sketch_of_faces(problem: Problem, units: Units) -> Figure:
    """Draw faces of bodies in the colours of their supports and loads, explained in the legend.

    Args:
        problem: problem of bodies of tetrahedra.
        units: units of sizes.
    """
    bodies = of_kind(problem.bodies, Body)
    boxes = np.array([body.box for body in bodies.values()])
    figure, (place,) = page(1, "")
    axes = space(figure, place, boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0), units)
    handles: list[Artist] = []
    for acting, colour, _ in _acting(problem):
        label = cut(render(acting, Reader(units, framed=True)), _LONGEST)
        handles.append(Patch(facecolor=colour, edgecolor="#555555", label=label))
    colours = face_colours(problem)
    for name, body in bodies.items():
        corner = face_corners(body.mesh, body.mesh.boundary_facets())
        fill_faces(axes, body.mesh, corner, colours[name])
    explain(axes, handles, 2)
    return figure


def face_colours(problem: Problem) -> dict[str, Floats]:
    """Return the colours of the boundary faces by supports and loads, by body, (faces, 3) each."""
    bodies = of_kind(problem.bodies, Body)
    facets = {name: body.mesh.boundary_facets().astype(np.int64) for name, body in bodies.items()}
    colours = {name: np.tile(to_rgb(PLAIN), (own.size, 1)) for name, own in facets.items()}
    for _, colour, places in _acting(problem):
        for name, own in places:
            colours[name][np.isin(facets[name], own)] = to_rgb(colour)
    return colours


def _acting(problem: Problem) -> Iterator[tuple[str, str, list[tuple[str, Ints]]]]:
    """Yield supports, contact and loads: a text, a colour, and the faces by body."""
    bodies = of_kind(problem.bodies, Body)

    def faces(name: str, where: Where) -> list[tuple[str, Ints]]:
        return [(name, boundary_facets(bodies[name].mesh, where, "where"))]

    for number, support in enumerate(problem.supports):
        colour = _HELD[number % len(_HELD)]
        yield text("fixed: {}", support.told), colour, faces(support.body, support.where)
    for number, (interface, touching) in enumerate(
        zip(problem.interfaces, problem.touching, strict=True)
    ):
        sides = zip(interface.sides, touching.edges, strict=False)
        parts = [(name, facets) for (name, _), facets in sides if name in bodies]
        yield interface.name, _shade(_TOUCHED, number), parts
    for loads, colours in ((problem.dead_loads, _DEAD), (problem.reference_loads, _LOADED)):
        for number, load in enumerate(loads):
            where = load.boundary
            own = [] if where is None else faces(load.body, where)
            yield load.told, _shade(colours, number), own


def _shade(name: str, number: int) -> str:
    return matplotlib.colors.to_hex(matplotlib.colormaps[name](0.45 + 0.15 * (number % 4)))
