"""Hooks of a path: functions that it calls. The names of `la.hooks` are those of `__init__.pyi`."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
