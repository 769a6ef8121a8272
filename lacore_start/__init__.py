"""Start lacore, after checking that Python finds the packages of lacore and not others.

Python imports the first package `backends` on its path, which begins with the folder of the script.
A folder or file of that name next to the script hides the package of lacore; for an editable
installation, even a folder without Python files does. This package imports no other package of
lacore, so that it can report this.
"""

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.machinery import ModuleSpec, PathFinder
from pathlib import Path

PACKAGES = {
    "lacore": "certificate.py",
    "backends": "clarabel_socp.py",
    "verification": "defaults.py",
}
"""Packages of lacore, each with a file that distinguishes it from others of that name."""


@dataclass(frozen=True)
class Place:
    """The place where Python finds a package.

    Attributes:
        package: Name of the package.
        path: Folder or file; empty if there is none.
        ours: Whether it is the package of lacore.
    """

    package: str
    path: str
    ours: bool

    @property
    def fix(self) -> str:
        """How to fix a wrong place; empty if the place is right."""
        if self.ours:
            return ""
        if not self.path:
            return f"the package {self.package!r} of lacore is missing: install lacore again"
        return (
            f"{self.path} hides the package {self.package!r} of lacore: rename it, or remove"
            f" {Path(self.path).parent} from Python's path (run from another folder, or change"
            " PYTHONPATH)"
        )


def place(package: str, first: Sequence[str] = ()) -> Place:
    """Return where Python finds a package of lacore.

    Args:
        package: One of `PACKAGES`.
        first: Folders to search before `sys.path`, such as the folder of a script.
    """
    loaded = None if first else getattr(sys.modules.get(package), "__spec__", None)
    for spec in (
        loaded,
        _found(package, first),
    ):  # a loaded package may differ from the one that is found
        if spec is not None and not (own := _place(package, spec)).ours:
            return own
    return Place(package, "", False) if spec is None else _place(package, spec)


def hidden(*packages: str) -> str:
    """Describe what hides packages of lacore and how to fix it; empty if nothing does.

    Args:
        packages: Names to check; all packages of lacore if none is given. Others are ignored.
    """
    wanted = [name for name in packages or PACKAGES if name in PACKAGES]
    return "; ".join(own.fix for own in map(place, wanted) if own.path and not own.ours)


def _found(package: str, first: Sequence[str]) -> ModuleSpec | None:
    """Return the module that an import would find now."""
    path = [*first, *sys.path]
    for finder in sys.meta_path:
        spec = finder.find_spec(package, path if finder is PathFinder else None)
        if spec is not None:
            return spec
    return None


def _place(package: str, spec: ModuleSpec) -> Place:
    folders = list(spec.submodule_search_locations or [])
    path = Path(folders[0] if folders else str(spec.origin)).absolute()
    return Place(package, str(path), (path / PACKAGES[package]).is_file())
