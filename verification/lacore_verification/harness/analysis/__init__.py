"""What results say: pandas in, pandas out; each function documents the columns it returns.

All of it takes the frame of `load_results`, one row a finished run; only `summary`, one answer a
variant, takes outcomes.

The public names are those of `__init__.pyi`; each is imported when it is first used.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
