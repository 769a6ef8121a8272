"""Files of a report: each is written completely or not at all, and the next report removes them.

A list names the files that a report has written. Its lines are those of ``sha256sum``: files that
were changed since are kept.
"""

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from hashlib import sha256
from pathlib import Path

MANIFEST = "report.sha256"


@contextmanager
def whole_file(path: Path, folder: Path | None = None) -> Iterator[Path]:
    """Yield a path to write to; afterwards that file takes the place of `path`.

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


def replace_files(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write files, and remove those of an earlier report that this one does not write.

    A process that is killed meanwhile leaves each file either unchanged or complete.

    Args:
        folder: made if it does not exist.
        files: contents by path, relative to the folder, parts joined by ``/``.

    Raises:
        OSError: the folder cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    listed = folder / MANIFEST
    earlier = _listed(listed)
    own = {(sha256(data).hexdigest(), file): None for file, data in files.items()}
    # A report that is killed here leaves files of either report.
    _write(folder, MANIFEST, _lines(earlier | own))
    for file, data in files.items():
        _write(folder, file, data)
    for digest, file in earlier:
        if file not in files:
            _remove(folder, file, digest)
    _write(folder, MANIFEST, _lines(own))


def _write(folder: Path, file: str, data: bytes) -> None:
    path = folder / file
    path.parent.mkdir(parents=True, exist_ok=True)
    with whole_file(path, folder) as unfinished:
        unfinished.write_bytes(data)


def _lines(listed: Iterable[tuple[str, str]]) -> bytes:
    return "".join(f"{digest}  {file}\n" for digest, file in listed).encode()


def _listed(file: Path) -> dict[tuple[str, str], None]:
    """Return digests and paths; lines of another format are ignored."""
    if not file.is_file():
        return {}
    lines = file.read_text(encoding="utf-8", errors="replace").splitlines()
    pairs = (line.split("  ", 1) for line in lines if "  " in line)
    return dict.fromkeys((digest, name) for digest, name in pairs)


def _remove(folder: Path, file: str, digest: str) -> None:
    """Remove a file that is unchanged, never outside of the folder, and its folder if empty."""
    place = folder.resolve()
    with suppress(OSError, ValueError):  # The name may be invalid, or the file protected.
        path = (folder / file).resolve(strict=True)
        if path.is_relative_to(place) and sha256(path.read_bytes()).hexdigest() == digest:
            path.unlink()
            path.parent.rmdir()
