"""Thumbnails of paths: the deformed bodies, coloured by their strain."""

import matplotlib
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from lacore.bodies.continuum.nodal import element_means
from lacore.conditions.footings import footings
from lacore.meshes.curved import edge_lines, outlines
from lacore.paths.configuration import Configuration
from lacore.paths.path import Path
from lacore.paths.stage import Stage
from lacore.pictures.contact import PLANE_DEPTH, draw_obstacle
from lacore.pictures.continua import BEFORE
from lacore.pictures.path import FOOTING, draw_blocks
from lacore.pictures.thumbnails.paper import SIZE, Size, finish, paper


def thumbnail_of_path(path: Path, size: Size = SIZE) -> Figure:
    """Draw the bodies at the end of a path and nothing else: no title, axes, load or legend.

    Args:
        path: Any path.
        size: Width and height, inches; the bodies fill it.
    """
    last = path.snapshots[-1]
    return thumbnail_of_shape(path.stage_of(last), path.stage, last.configuration, size)


def thumbnail_of_shape(
    stage: Stage, before: Stage, configuration: Configuration, size: Size = SIZE
) -> Figure:
    """Draw bodies on a configuration, over their outlines before.

    Args:
        stage: Stage with the meshes of the configuration.
        before: Stage with the bodies at the beginning of the path.
        configuration: Places of the nodes, and strains.
        size: Width and height, inches; the bodies fill it.
    """
    axes = paper(size)
    for body in before.bodies.values():
        lines = edge_lines(body.mesh, body.mesh.boundary_facets())
        axes.add_collection(LineCollection(lines, **BEFORE, zorder=1))
    dofs = stage.dofs_at(configuration)
    strains = {name: element_means(own, configuration.strain[name]) for name, own in dofs.items()}
    largest = max(float(own.max()) for own in strains.values())
    for name, own in dofs.items():
        mesh = own.body.mesh
        # Smoothed sides of polygons without lines between them would leave hairlines.
        axes.add_collection(
            PolyCollection(
                list(outlines(mesh)),
                array=strains[name],
                norm=Normalize(0.0, largest or 1.0),
                cmap=matplotlib.colormaps["YlOrRd"],
                linewidths=0,
                antialiaseds=False,
                zorder=2,
            )
        )
        lines = edge_lines(mesh, mesh.boundary_facets())
        axes.add_collection(LineCollection(lines, colors="#222222", linewidths=1.0, zorder=4))
    meshes = stage.meshes_at(configuration)
    for footing in footings(before.problem.reference_loads):
        mesh = meshes[footing.body]
        lines = edge_lines(mesh, np.asarray(mesh.boundaries[str(footing.where)]))
        axes.add_collection(LineCollection(lines, colors=FOOTING, linewidths=3.0, zorder=5))
    draw_blocks(axes, stage, configuration)
    corners = axes.dataLim.get_points()
    low, high = corners.min(axis=0), corners.max(axis=0)
    obstacles = stage.obstacles_at(configuration)
    if obstacles:
        margin = PLANE_DEPTH * float(np.linalg.norm(high - low))
        low, high = low - margin, high + margin
    for obstacle in obstacles:
        draw_obstacle(axes, obstacle.shape, low, high)
    return finish(axes, low, high)
