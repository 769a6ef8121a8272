"""Names of this package that are names of `la`."""

from . import meshes as meshes
