"""The list of files that a report has written, so that the next one there leaves none of them.

Its lines are those of ``sha256sum``: what somebody has changed since is theirs, and stays.
"""

from collections.abc import Mapping
from contextlib import suppress
from hashlib import sha256
from pathlib import Path

MANIFEST = "report.sha256"


def replace_files(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write files, and remove those that an earlier report wrote here and this one does not.

    Args:
        folder: made where it is not there.
        files: contents by path, relative to the folder, parts joined by ``/``.

    Raises:
        OSError: the folder cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    listed = folder / MANIFEST
    for file, digest in _listed(listed).items():
        if file not in files:
            _remove(folder, file, digest)
    lines = [f"{sha256(data).hexdigest()}  {file}\n" for file, data in files.items()]
    listed.write_text("".join(lines), encoding="utf-8")
    for file, data in files.items():
        path = folder / file
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)


def _listed(file: Path) -> dict[str, str]:
    """Digests by path; what is no line of a manifest is passed over."""
    if not file.is_file():
        return {}
    lines = file.read_text(encoding="utf-8", errors="replace").splitlines()
    pairs = [line.split("  ", 1) for line in lines if "  " in line]
    return {name: digest for digest, name in pairs}


def _remove(folder: Path, file: str, digest: str) -> None:
    """Remove a file as it was written, nothing outside of the folder, and what it leaves empty."""
    place = folder.resolve()
    with suppress(OSError, ValueError):  # no file can have such a name, or it may not be touched
        path = (folder / file).resolve(strict=True)
        if path.is_relative_to(place) and sha256(path.read_bytes()).hexdigest() == digest:
            path.unlink()
            path.parent.rmdir()
