"""Thumbnails of limit states."""

import numpy as np
from matplotlib.figure import Figure

from lacore.limit.state import LimitState
from lacore.pictures.displaced import displacement_of, draw_displaced
from lacore.pictures.space.mechanism import colours_of
from lacore.pictures.space.structure import motion_of, stretch_of
from lacore.pictures.space.surface import displaced_faces
from lacore.pictures.thumbnails.paper import (
    SIZE,
    Size,
    finish_around_contents,
    paper,
    scale_of,
)
from lacore.pictures.thumbnails.solids import blocks_on_paper, surface_colours, surfaces_on_paper
from lacore.reporting.units import Units


def thumbnail_of_state(state: LimitState, size: Size = SIZE) -> Figure:
    """Draw the collapse mechanism and nothing else: no title, axes, colour bar or legend.

    The displacements and colours are those of `lacore.pictures.mechanism.plot_mechanism`.

    Args:
        state: Any state with a point.
        size: Width and height, inches; the mechanism fills it.

    Raises:
        ValueError: The state has no point.
    """
    discretisation = state.discretisation
    if discretisation.solids:
        motion = motion_of(state)
        moved = motion.blocks.points + stretch_of(motion) * motion.vertices
        return blocks_on_paper(size, motion.blocks, moved, colours_of(motion))
    if discretisation.problem.dimension == 3:
        bodies, corners, shares = displaced_faces(state)
        meshes = {name: body.mesh for name, body in bodies.items()}
        colours = {name: surface_colours(own, shares[name]) for name, own in meshes.items()}
        return surfaces_on_paper(size, meshes, corners, colours)
    shown, axes = displacement_of(state), paper(size)
    draw_displaced(axes, shown, Units(), scale_of(size, np.asarray(shown.extent)), edges=0.0)
    return finish_around_contents(axes)
