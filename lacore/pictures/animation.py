"""Animations of paths: the deforming bodies, and the load."""

import os
from pathlib import Path as File

from matplotlib.animation import AbstractMovieWriter, FFMpegWriter, PillowWriter

from lacore.paths.path import Path
from lacore.pictures.path import draw_bodies, draw_load, page, strain_scale
from lacore.reporting.errors import InputError, require_positive

_HOLD = 1.0  # s, duration of the last picture


def animate_path(
    path: Path, place: str | os.PathLike[str], fps: float = 8.0, dpi: float = 90.0
) -> None:
    """Write a GIF or MP4 of a path, one picture per snapshot; see `lacore.pictures.path.plot_path`.

    Args:
        path: path with at least one step.
        place: path of the file: .gif, or .mp4 if the program ffmpeg is installed.
        fps: snapshots per second.
        dpi: pixels per inch; a picture is about ten inches wide.

    Raises:
        InputError: another ending, ffmpeg is missing, a file that cannot be written, or a path
            without steps.
    """
    require_positive("fps", fps)
    require_positive("dpi", dpi)
    file = File(os.fspath(place))
    writer = _writer(file, fps)
    if path.history.empty:
        raise InputError("path", path.message, "has no step to show", "see why it ended")
    figure, bodies, load = page(path)
    scale = strain_scale(path)
    draw_bodies(bodies, path, path.snapshots[-1], scale)
    draw_load(load, path)
    figure.draw_without_rendering()
    figure.set_layout_engine("none")  # The layout is fixed, so that nothing jumps between pictures.
    try:
        with writer.saving(figure, str(file), dpi):
            for snapshot in path.snapshots:
                for axes in (bodies, load):
                    axes.clear()
                draw_bodies(bodies, path, snapshot, scale)
                draw_load(load, path, snapshot.travel)
                writer.grab_frame()
            for _ in range(round(_HOLD * fps)):
                writer.grab_frame()
    except OSError as error:
        raise InputError(
            "file",
            str(file),
            f"cannot be written ({error.strerror or error})",
            "free space, or name another place",
        ) from error


def _writer(file: File, fps: float) -> AbstractMovieWriter:
    ending = file.suffix.lower()
    if ending not in (".gif", ".mp4"):
        raise InputError("file", str(file), "neither GIF nor MP4", "let it end in .gif or .mp4")
    if not file.parent.is_dir():
        raise InputError("file", str(file), "its folder does not exist", "make it")
    if ending == ".gif":
        return PillowWriter(fps=fps)  # type: ignore[arg-type]  # any number is fine
    if not FFMpegWriter.isAvailable():
        raise InputError(
            "file", str(file), "MP4 needs the program ffmpeg, which is missing", "write a .gif"
        )
    return FFMpegWriter(fps=fps)  # type: ignore[arg-type]
