"""Hooks that lacore ships: progress, tables, curves, animations and files for ParaView."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path as File
from typing import TextIO

from lacore.paths.hooks.hook import AFTER_STEP, END, Hook, PathProgress
from lacore.reporting import views
from lacore.reporting.errors import InputError

_FIGURES = (".png", ".svg", ".pdf")
_FILMS = (".gif", ".mp4")


def progress(stream: TextIO | None = None) -> Hook:
    """Print one line after each step.

    Args:
        stream: to print to; standard output by default.

    Example:
        >>> hooks = [la.hooks.progress()]
    """

    def progress(now: PathProgress) -> None:
        out = sys.stdout if stream is None else stream
        out.write(f"{now.row}\n")
        out.flush()

    return Hook(progress)


def table(file: str | os.PathLike[str]) -> Hook:
    """Write the history as CSV after each step, so that a stopped path leaves a complete table.

    Args:
        file: ending in .csv; its folder exists.

    Raises:
        InputError: another ending, or no such folder.

    Example:
        >>> hooks = [la.hooks.table("history.csv")]
    """
    place = _file(file, (".csv",))
    return Hook(_named("table", lambda now: now.path.history.to_csv(place, index=False)))


def curve(file: str | os.PathLike[str]) -> Hook:
    """Draw the force over the travel when the path ends, see `Path.plot_force`.

    Args:
        file: ending in .png, .svg or .pdf; its folder exists.

    Raises:
        InputError: another ending, or no such folder.

    Example:
        >>> hooks = [la.hooks.curve("force.png")]
    """
    place = _file(file, _FIGURES)
    return Hook(_named("curve", lambda now: now.path.plot_force().savefig(place)), END)


def animation(file: str | os.PathLike[str], fps: float = 8.0, dpi: float = 90.0) -> Hook:
    """Write an animation of all snapshots when the path ends, see `Path.animate`.

    Args:
        file: ending in .gif or .mp4; its folder exists.
        fps: snapshots per second.
        dpi: pixels per inch.

    Raises:
        InputError: another ending, or no such folder.

    Example:
        >>> hooks = [la.hooks.animation("billet.gif")]
    """
    place = _file(file, _FILMS)

    def animation(now: PathProgress) -> None:
        if not now.path.history.empty:
            now.path.animate(place, fps, dpi)

    return Hook(animation, END)


def vtu(folder: str | os.PathLike[str]) -> Hook:
    """Write files for ParaView after each step: a VTU file per step, and a PVD file of all.

    All steps are written, even those that `keep_every` does not keep. ParaView opens ``path.pvd``
    as one series, also while the path is running.

    Args:
        folder: is made if it does not exist.

    Example:
        >>> hooks = [la.hooks.vtu("billet")]
    """
    place, written = os.fspath(folder), dict[int, float]()

    def vtu(now: PathProgress) -> None:
        views.series(now.path, place, written)

    return Hook(vtu, AFTER_STEP)


def _named(name: str, call: Callable[[PathProgress], object]) -> Callable[[PathProgress], object]:
    """The function with a name for messages."""

    def called(now: PathProgress) -> object:
        return call(now)

    called.__name__ = name
    return called


def _file(file: str | os.PathLike[str], endings: tuple[str, ...]) -> File:
    """Return a file that can be written; an error is reported before the path starts."""
    place = File(os.fspath(file))
    if place.suffix.lower() not in endings:
        known = " or ".join(endings)
        raise InputError("file", str(place), "has another ending", f"let it end in {known}")
    if not place.parent.is_dir():
        raise InputError("file", str(place), "its folder does not exist", "create it")
    return place
