"""Verification: cases with references, and the harness that compares backends with them.

As in `lacore`, the public names are those of `__init__.pyi`, imported on first use.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
