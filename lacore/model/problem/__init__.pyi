"""The modules that are names of `la`, for `__init__` and for type checkers."""

from . import examples as examples
from . import types as types
