"""What starts lacore: it knows whether Python finds our packages or others of the same names.

Python takes the first `backends` on its path, and that begins with the folder of a script: a folder
or file of that name beside the script hides our package. Of an editable installation even a folder
without any Python in it does. This package imports none of ours, so that it can say so.
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
"""Our packages, each with a file that tells it from others of that name."""


@dataclass(frozen=True)
class Place:
    """Where Python finds a package.

    Attributes:
        package: its name.
        path: folder or file; empty where there is none.
        ours: whether it is that of lacore.
    """

    package: str
    path: str
    ours: bool

    @property
    def mend(self) -> str:
        """What to do about it; empty where nothing is wrong."""
        if self.ours:
            return ""
        if not self.path:
            return f"the package {self.package!r} of lacore is missing: install lacore again"
        return (
            f"{self.path} hides the package {self.package!r} of lacore: rename it, or keep"
            f" {Path(self.path).parent} off Python's path (run from elsewhere, mend PYTHONPATH)"
        )


def place(package: str, first: Sequence[str] = ()) -> Place:
    """Where Python finds one of our packages.

    Args:
        package: one of `PACKAGES`.
        first: folders before those of `sys.path`, such as that of a script.
    """
    loaded = None if first else getattr(sys.modules.get(package), "__spec__", None)
    for spec in (loaded, _found(package, first)):  # what is loaded need not be what others find
        if spec is not None and not (own := _place(package, spec)).ours:
            return own
    return Place(package, "", False) if spec is None else _place(package, spec)


def hidden(*packages: str) -> str:
    """In a sentence what hides packages and the mend; empty where nothing does.

    Args:
        packages: names; those that are not ours hide nothing. All of ours if none is given.
    """
    wanted = [name for name in packages or PACKAGES if name in PACKAGES]
    return "; ".join(own.mend for own in map(place, wanted) if own.path and not own.ours)


def _found(package: str, first: Sequence[str]) -> ModuleSpec | None:
    """As an import that has not been done yet would find it."""
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
