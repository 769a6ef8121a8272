"""lacore: plastic collapse loads of bodies in frictional contact, each with its own proof.

The public names are those of `__init__.pyi`; each is imported when it is first used, so that
what a script or a child process does not use costs it nothing.
"""

import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any
from warnings import warn

import lazy_loader

from lacore import pictures as pictures  # names the function that draws each result

__version__ = "0.4.0"

_public, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
_RENAMED = {"CoulombRange": "LoadFactorRange", "SoilRange": "LoadFactorRange"}


def __getattr__(name: str) -> Any:
    if name in _RENAMED:
        warn(f"lacore.{name} is now lacore.{_RENAMED[name]}", DeprecationWarning, stacklevel=2)
        return _public(_RENAMED[name])
    if name in __all__ or name.startswith("_"):
        return _public(name)
    from lacore.reporting.errors import suggest

    raise AttributeError(f"lacore has no {name!r}; {suggest(name, __all__)}")


FORMER = {
    "arrays": "numerics.arrays",
    "backend": "solvers.backend",
    "certificate": "program.certificate",
    "contact": "model.contact",
    "errors": "reporting.errors",
    "materials": "model.materials",
    "meshes": "model.meshes",
    "paths.remeshing": "paths.renewal.remeshing",
    "regularization": "program.regularization",
    "state": "program.state",
    "status": "reporting.status",
}
"""Modules and packages of version 0.4 that are now elsewhere, with all that they contain."""


class FormerNames(MetaPathFinder, Loader):
    """Finds the module of today by a former name, before Python looks for a file."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return a spec for a former name, and None for others."""
        new = _new(fullname)
        return ModuleSpec(fullname, self, origin=new) if new else None

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """Return the module of today, and warn the code that imports it."""
        new = _new(spec.name)
        warn(f"{spec.name} is now {new}", DeprecationWarning, stacklevel=2)
        module = import_module(new)
        spec.loader_state = module.__spec__
        return module

    def exec_module(self, module: ModuleType) -> None:
        """Keep the module as it is: the import has replaced its spec only."""
        former = module.__spec__
        if former is not None and former.loader is self:
            module.__spec__ = former.loader_state


def _new(name: str) -> str:
    """Return the name of today; empty if a name has not changed."""
    for former, new in FORMER.items():
        if f"{name}.".startswith(f"lacore.{former}."):
            return f"lacore.{new}" + name.removeprefix(f"lacore.{former}")
    return ""


sys.meta_path.insert(0, FormerNames())
