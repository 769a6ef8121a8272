"""lacore: plastic collapse loads of bodies in frictional contact, each with its own proof.

The public names are those of `__init__.pyi`; each is imported when it is first asked for, so that
what a script or a child process does not use costs it nothing.
"""

import lazy_loader

from lacore import doors as doors  # a result finds who draws it, whichever way it was imported

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
