"""Files that are either written completely or not at all, whenever a process is killed."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def whole_file(path: Path, folder: Path | None = None) -> Iterator[Path]:
    """Give a path to write to; afterwards that file takes the place of `path`.

    Args:
        path: Of the file; what it held stays until all is written.
        folder: For the unfinished file, on the same disk; None: that of `path`. It always has the
            same name there, so that processes that are killed leave one at most.
    """
    part = (folder or path.parent) / ".unfinished"
    try:
        yield part
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)
