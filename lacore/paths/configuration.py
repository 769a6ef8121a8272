"""Where bodies are along a path, and how far each of their points has strained (T29)."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from lacore.numerics.arrays import Floats
from lacore.reporting.showing import Compact


@dataclass(frozen=True, repr=False)
class Configuration(Compact):
    """Bodies at one moment of a path.

    Attributes:
        nodes: coordinates by body, shape (2, nodes), m: vertices, edges, centres.
        strain: equivalent strain at the strain points by body, shape (elements, q).
    """

    nodes: Mapping[str, Floats]
    strain: Mapping[str, Floats]

    def moved(self, by: Mapping[str, Floats], strained: Mapping[str, Floats]) -> "Configuration":
        """After displacements by body, shape (2, nodes), m, and increments of strain."""
        return Configuration(
            nodes={name: np.asarray(own + by[name]) for name, own in self.nodes.items()},
            strain={name: np.asarray(own + strained[name]) for name, own in self.strain.items()},
        )
