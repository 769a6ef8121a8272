"""Triangles inside closed lines, by gmsh (the optional dependency ``gmsh``)."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
import shapely

from lacore.model.meshes.renewal.sizes import Sizes, Uniform
from lacore.numerics.arrays import Floats, Ints
from lacore.reporting.errors import InputError, install_command

_INWARDS = 0.05  # by an edge: distance by which vertices are moved where a body touches itself


def apart(lines: list[Floats]) -> list[Floats]:
    """Return closed lines that do not cross, the outermost first.

    Where a body touches itself, lines cross slightly, and gmsh would not end: then all vertices are
    moved into the body.

    Raises:
        InputError: they still cross.
    """
    if shapely.is_valid(shapely.Polygon(lines[0], lines[1:])):
        return lines
    moved = []
    for number, line in enumerate(lines):
        along = np.roll(line, -1, axis=0) - np.roll(line, 1, axis=0)
        inwards = np.stack([-along[:, 1], along[:, 0]], axis=1)
        if shapely.LinearRing(line).is_ccw == (number > 0):
            inwards = -inwards
        moved.append(line + _INWARDS * inwards / 2)
    if not shapely.is_valid(shapely.Polygon(moved[0], moved[1:])):
        raise InputError(
            "remeshed",
            None,
            "the outline crosses itself, and gmsh needs one that does not",
            "give a smaller size, or end the path before",
        )
    return moved


def triangulated(lines: Sequence[Floats], inside: Floats, sizes: Sizes) -> tuple[Floats, Ints]:
    """Return points (n, 2), those of the closed lines first, and triangles (m, 3), by gmsh."""
    gmsh = load_gmsh()
    ours = not gmsh.isInitialized()
    if ours:
        with _pipes_as_before():
            gmsh.initialize(interruptible=False)
        gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.add("remeshed")
    try:
        geometry, loops, corners = gmsh.model.geo, [], []
        for line in lines:
            starts = zip(line.tolist(), sizes(line.T).tolist(), strict=True)
            tags = [geometry.addPoint(x, y, 0, size) for (x, y), size in starts]
            pairs = zip(tags, tags[1:] + tags[:1], strict=True)
            sides = [geometry.addLine(one, two) for one, two in pairs]
            for side in sides:
                geometry.mesh.setTransfiniteCurve(side, 2)  # one edge
            loops.append(geometry.addCurveLoop(sides))
            corners += tags
        surface = geometry.addPlaneSurface(loops)
        held = [geometry.addPoint(x, y, 0) for x, y in inside.tolist()]
        geometry.synchronize()
        gmsh.model.mesh.embed(0, held, 2, surface)
        if not isinstance(sizes, Uniform):
            gmsh.model.mesh.setSizeCallback(
                lambda dim, tag, x, y, z, size: float(sizes(np.array([[x], [y]]))[0])
            )
        gmsh.model.mesh.generate(2)
        nodes, places, _ = gmsh.model.mesh.getNodes()
        _, used = gmsh.model.mesh.getElementsByType(2)
        first = [int(gmsh.model.mesh.getNodes(0, tag)[0][0]) for tag in corners]
    except Exception as error:  # gmsh has no other exception
        raise InputError("remeshed", str(error), "gmsh failed", "give another size") from error
    finally:
        gmsh.model.mesh.removeSizeCallback()
        gmsh.model.remove()
        if ours:
            gmsh.finalize()
    where = dict(zip(map(int, nodes), places.reshape(-1, 3)[:, :2], strict=True))
    inner = sorted(set(map(int, used)) - set(first))
    number = {tag: place for place, tag in enumerate([*first, *inner])}
    points = np.array([where[tag] for tag in number])
    return points, np.array([number[int(tag)] for tag in used], dtype=np.int64).reshape(-1, 3)


@contextmanager
def _pipes_as_before() -> Iterator[None]:
    """Restore the signal handling that gmsh changes at its start, so closed pipes do no harm."""
    before = signal.getsignal(signal.SIGPIPE) if hasattr(signal, "SIGPIPE") else None
    try:
        yield
    finally:
        if before is not None and threading.current_thread() is threading.main_thread():
            signal.signal(signal.SIGPIPE, before)


def load_gmsh() -> Any:
    """Return the module `gmsh`.

    Raises:
        InputError: it is missing, or system libraries are missing.
    """
    try:
        import gmsh
    except (ImportError, OSError) as error:  # OSError: system libraries are missing
        raise InputError(
            "remeshed", None, f"gmsh cannot be loaded ({error})", install_command("gmsh")
        ) from error
    return gmsh
