"""Analysis of results with pandas; each function documents the columns that it returns.

All functions take the frame of `load_results`, one row for each finished run; only `summary`, one
row for each variant, takes outcomes.

The public names are those of `__init__.pyi`; each is imported when it is first used.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
