"""lacore: plastic collapse loads of bodies in frictional contact, each with its own proof.

The public names are those of `__init__.pyi`; each is imported when it is first asked for, so that
what a script or a child process does not use costs it nothing.
"""

from typing import Any

import lazy_loader

from lacore import doors as doors  # a result finds who draws it, whichever way it was imported

__version__ = "0.4.0"

_public, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


_RENAMED = {"CoulombRange": "LoadFactorRange", "SoilRange": "LoadFactorRange"}


def __getattr__(name: str) -> Any:
    if name in _RENAMED:
        from warnings import warn

        warn(f"lacore.{name} is now lacore.{_RENAMED[name]}", DeprecationWarning, stacklevel=2)
        return _public(_RENAMED[name])
    if name in __all__ or name.startswith("_"):
        return _public(name)
    from lacore.errors import suggest

    raise AttributeError(f"lacore has no {name!r}; {suggest(name, __all__)}")
