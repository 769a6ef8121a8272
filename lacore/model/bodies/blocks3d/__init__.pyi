"""The module that is a name of `la`, for `__init__` and for type checkers."""

from . import masonry3d as masonry3d
