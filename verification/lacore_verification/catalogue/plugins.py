"""Cases of users, from the entry-point group ``lacore.cases`` and from folders.

Runs are executed in other processes, which find the functions of a case by module and name. Files
of a folder are therefore ordinary modules, with the folder at the end of `sys.path`, and each must
be importable by its name.
"""

import contextlib
import importlib
import importlib.util
import os
import sys
import traceback
from collections.abc import Iterable, Iterator, Mapping, Sequence
from difflib import get_close_matches
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from types import ModuleType
from typing import Any

from lacore.reporting.errors import InputError
from lacore_verification.case import Case
from lacore_verification.case.case import described
from lacore_verification.catalogue.catalogue import Catalogue, catalogue

GROUP = "lacore.cases"


def gather(folders: Sequence[Path] = ()) -> Catalogue:
    """Return the cases of lacore, of installed packages, and of folders.

    Args:
        folders: each ``*.py`` file in them, other than ``_*.py``, has a CASE or CASES.

    Returns:
        the catalogue; packages with an error are in its `broken`, under the name of their entry
        point, and do not affect other cases.

    Raises:
        InputError: an invalid folder or file in it; it names file and field.
    """
    known = catalogue()
    for entry in sorted(entry_points(group=GROUP), key=lambda entry: entry.name):
        try:
            known = _extended(known, _of_entry(entry), _source(entry))
        except InputError as error:
            broken: Mapping[str, InputError] = {**known.broken, entry.name: error}
            known = Catalogue(known.cases, known.sources, broken)
    for folder in folders:
        for path in _files(folder):
            known = _extended(known, _of_file(path), str(path))
    return known


def _extended(known: Catalogue, found: Iterable[Case], source: str) -> Catalogue:
    for case in found:
        if case.id in known:
            raise InputError(
                f"{source}: Case.id",
                case.id,
                f"is that of a case of {known.sources[case.id]}",
                "rename it",
            )
        known = known.extended(case, source)
    return known


def _source(entry: EntryPoint) -> str:
    package = entry.dist.name if entry.dist is not None else "a package"
    return f"{package}, entry point {entry.name!r} of {GROUP}"


def _of_entry(entry: EntryPoint) -> list[Case]:
    source = _source(entry)
    with _reported(source, None):
        value = entry.load()
    return _checked(value, source, f"give {entry.value} a Case or a sequence of Cases")


def _files(folder: Path) -> list[Path]:
    """Return the case files of a folder, sorted.

    Raises:
        InputError: the folder does not exist, or has no case files.
    """
    fix = "give a folder with files that define cases"
    if not folder.exists():
        raise InputError("--cases", str(folder), "there is no such folder", _similar(folder) or fix)
    try:
        paths = sorted(folder.resolve().iterdir())
    except OSError as error:
        raise InputError(
            "--cases", str(folder), f"cannot be read ({error.strerror})", fix
        ) from error
    if os.pathsep in str(folder.resolve()):
        raise InputError(
            "--cases",
            str(folder),
            f"a path with {os.pathsep!r} in it cannot be passed to other processes",
            "rename the folder",
        )
    files = [path for path in paths if path.suffix == ".py" and not path.name.startswith("_")]
    if not files:
        raise InputError(
            "--cases",
            str(folder),
            "contains no case",
            "add a file NAME.py that defines CASE, or give another folder",
        )
    return files


def _similar(folder: Path) -> str:
    """Return a question for the folder that a mistyped path may mean; empty if there is none."""
    try:
        names = [str(own) for own in folder.parent.iterdir() if own.is_dir()]
    except OSError:
        return ""
    close = get_close_matches(str(folder), names, n=1)
    return f"did you mean {close[0]!r}?" if close else ""


def _of_file(path: Path) -> list[Case]:
    module = _imported(path)
    given = [name for name in ("CASE", "CASES") if hasattr(module, name)]
    if len(given) != 1:
        raise InputError(
            f"{path}: CASE",
            None,
            "CASES is there too" if given else "there is none, nor CASES",
            "define one of them, or name the file _NAME.py if it holds no case",
        )
    (name,) = given
    value = getattr(module, name)
    wanted = "a Case" if name == "CASE" else "a tuple of Cases"
    if isinstance(value, Case) is not (name == "CASE"):
        raise InputError(f"{path}: {name}", type(value).__name__, f"not {wanted}", f"give {wanted}")
    return _checked(value, str(path), f"give {wanted}")


def _checked(value: Any, source: str, fix: str) -> list[Case]:
    """Return the cases from a Case or a sequence of them, each checked."""
    from lacore_verification.catalogue.checks import (
        check,  # Tests check lacore's own cases.
    )

    cases = [value] if isinstance(value, Case) else value
    if not isinstance(cases, Sequence) or isinstance(cases, str) or not cases:
        raise InputError(source, type(value).__name__, "not a case", fix)
    for case in cases:
        if not isinstance(case, Case):
            raise InputError(source, type(case).__name__, "not a case", fix)
        with _reported(source, None):
            check(case)
    return list(cases)


def _imported(path: Path) -> ModuleType:
    """Return a file as a module that its name imports, here and in other processes."""
    name, folder = path.stem, str(path.parent)
    if not name.isidentifier():
        raise InputError(
            str(path),
            None,
            "its name cannot be imported",
            "rename it: letters, digits and '_' only, no digit first",
        )
    if folder not in sys.path:
        sys.path.append(folder)
    # The file may be newer than the import system's listing of its folder.
    importlib.invalidate_caches()
    origin = _origin(name)
    if origin is None or origin.resolve() != path.resolve():
        raise InputError(
            str(path),
            None,
            f"the name {name!r} imports {origin or 'a module of Python'} instead",
            "rename the file",
        )
    with _reported(str(path), path):
        return importlib.import_module(name)


def _origin(name: str) -> Path | None:
    """Return the file that a name imports; None without one."""
    try:
        found = importlib.util.find_spec(name)
    except ValueError:  # a module without a spec, such as __main__
        return None
    return Path(found.origin) if found is not None and found.has_location and found.origin else None


@contextlib.contextmanager
def _reported(source: str, path: Path | None) -> Iterator[None]:
    """Add the origin to errors, and keep output of users' code away from stdout."""
    try:
        with contextlib.redirect_stdout(sys.stderr):
            yield
    except InputError as error:
        field = f"{source}: {error.field}"
        raise InputError(field, error.value, error.reason, error.fix) from error
    except (Exception, SystemExit) as error:  # any error of users' code
        raise InputError(
            f"{source}{_line(error, path)}", None, described(error), "correct the file"
        ) from error


def _line(error: BaseException, path: Path | None) -> str:
    """Return the line of a file at which an error was raised, as text."""
    if isinstance(error, SyntaxError) and error.filename == str(path):
        return f", line {error.lineno}"
    frames = traceback.extract_tb(error.__traceback__)
    lines = [frame.lineno for frame in frames if frame.filename == str(path)]
    return f", line {lines[-1]}" if lines else ""
