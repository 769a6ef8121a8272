"""Mechanism of three-dimensional blocks as an interactive scene on a page (pyvista)."""

import asyncio
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from lacore.limit.state import LimitState
from lacore.numerics.arrays import Floats, Ints
from lacore.pictures.contact import COLOURS
from lacore.pictures.space.mechanism import MOVES, THRUST, colours_of, thrust_lines
from lacore.pictures.space.structure import Motion, motion_of, stretch_of, touches_of
from lacore.reporting.errors import InputError, install_command

_TUBE = 0.008  # radius of the line of the largest force, by the size of the structure
_FAINTEST = 0.01  # by the largest force
_OPAQUE = 0.4


def write_scene(state: LimitState, place: str | os.PathLike[str]) -> Path:
    """Write a page with displaced blocks, joints by state, and thrust; it needs no server.

    Blocks are transparent; the thrust is drawn in the original geometry. The function needs pyvista
    and trame-pyvista: ``pip install 'lacore-limit-analysis[scene]'``.

    Args:
        state: state of three-dimensional blocks, with a point.
        place: path of the file, .html.

    Returns:
        the file.

    Raises:
        InputError: a plane problem, another ending, a file that cannot be written, or pyvista is
            not installed.
    """
    file = Path(os.fspath(place))
    if not state.discretisation.solids:
        raise InputError("state", None, "of the plane: it has no scene", "take state.plot()")
    if file.suffix.lower() != ".html":
        raise InputError("path", str(file), "not the name of a page", "let it end in .html")
    try:
        import pyvista
        from trame_pyvista.jupyter import launch_server
    except ImportError as error:
        raise InputError(
            "pyvista", None, f"it is not installed ({error})", install_command("scene")
        ) from error

    plotter = pyvista.Plotter(off_screen=True)
    _fill(plotter, state)

    async def export() -> None:
        await launch_server().ready
        plotter.trame.export_html(str(file))

    try:
        asyncio.run(export())
    except OSError as error:
        why = f"cannot be written ({error.strerror or error})"
        raise InputError("path", str(file), why, "free space, or name another place") from error
    return file


def _fill(plotter: Any, state: LimitState) -> None:
    motion = motion_of(state)
    fastest = float(np.linalg.norm(motion.vertices, axis=0).max())
    touches = touches_of(state, motion, MOVES * fastest)
    stretch = stretch_of(motion)
    blocks, moved = motion.blocks, motion.blocks.points + stretch * motion.vertices
    colours = np.array(colours_of(motion))[blocks.block[[face[0] for face in blocks.faces]]]
    for colour in np.unique(colours).tolist():
        faces = [blocks.faces[face] for face in np.flatnonzero(colours == colour).tolist()]
        plotter.add_mesh(_surface(moved, faces), color=colour, opacity=_OPAQUE)
    plotter.add_mesh(_lines(moved, blocks.edges), color="#555555", line_width=1)
    for kind in ("slip", "open", "crush"):
        corners = [
            own + stretch * _mean_velocity(motion, own, slave, master)
            for own, slave, master, does in zip(
                touches.corners, touches.slave, touches.master, touches.kind, strict=True
            )
            if does == kind
        ]
        if corners:
            ends = np.cumsum([0, *(own.shape[1] for own in corners)])
            polygons = np.split(np.arange(ends[-1]), ends[1:-1])
            joints = _surface(np.concatenate(corners, axis=1), polygons)
            plotter.add_mesh(joints, color=COLOURS[kind])
    size = np.linalg.norm(touches.force, axis=0)
    own = np.flatnonzero(size > _FAINTEST * size.max(initial=0.0))
    if own.size:
        ends = thrust_lines(motion, touches)[:, :, own].transpose(0, 2, 1).reshape(3, -1)
        lines = _lines(ends, np.arange(2 * own.size).reshape(-1, 2).T)
        lines["radius"] = _TUBE * blocks.size * np.repeat(np.sqrt(size[own] / size.max()), 2)
        plotter.add_mesh(lines.tube(scalars="radius", absolute=True), color=THRUST)
    plotter.set_background("white")


def _mean_velocity(motion: Motion, places: Floats, slave: int, master: int) -> Floats:
    """Return the mean velocity of two blocks, one of which may be an obstacle, (3, k)."""
    both = [np.full(places.shape[1], block) for block in (slave, master)]
    return np.asarray(np.mean([motion.at(places, block) for block in both], axis=0))


def _surface(points: Floats, faces: Sequence[Ints]) -> Any:
    from pyvista import PolyData

    return PolyData.from_irregular_faces(points.T, faces)


def _lines(points: Floats, ends: Ints) -> Any:
    from pyvista import PolyData

    return PolyData(points.T, lines=np.insert(ends.T, 0, 2, axis=1))
