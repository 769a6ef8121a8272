"""Read problem files from disk; errors name the file that a mistyped path may mean."""

from difflib import get_close_matches
from pathlib import Path

from lacore.errors import InputError

ENDING = ".toml"
_START = "`lacore new` prints problem files to start from"
_LARGEST = 10_000_000  # bytes


def contents(file: Path) -> bytes:
    """Read a problem file.

    Raises:
        InputError: The path is not that of a file, or the file is empty, too large or unreadable.
    """
    shown = str(file)
    try:
        raw = file.read_bytes() if file.stat().st_size <= _LARGEST else None
    except IsADirectoryError as error:
        raise InputError("path", shown, "is a folder, not a file", _inside(file)) from error
    except FileNotFoundError as error:
        raise InputError("path", shown, "there is no such file", _similar(file)) from error
    except (OSError, ValueError) as error:  # ValueError: a name that no file can have
        why = getattr(error, "strerror", None) or str(error)
        fix = "give the path of a problem file"
        raise InputError("path", shown, f"cannot be read ({why})", fix) from error
    if raw is None:
        limit = f"is larger than {_LARGEST / 1e6:g} MB"
        raise InputError("path", shown, limit, "give the path of a problem file")
    if not raw.strip():
        raise InputError("path", shown, "is empty", _START)
    return raw


def _inside(folder: Path) -> str:
    found = _files(folder)
    return f"did you mean {str(found[0])!r}?" if found else "give the path of a problem file"


def _similar(file: Path) -> str:
    """Return how to fix the path of a missing file."""
    names = {own.stem: own for own in _files(file.parent)}
    close = get_close_matches(file.stem, names, n=1)
    if close:
        return f"did you mean {str(names[close[0]])!r}?"
    return f"give the path of a problem file; {_START}"


def _files(folder: Path) -> list[Path]:
    try:
        return sorted(own for own in folder.iterdir() if own.suffix == ENDING and own.is_file())
    except OSError:
        return []
