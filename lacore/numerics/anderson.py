"""Anderson acceleration of a damped fixed-point iteration."""

from dataclasses import dataclass, field

import numpy as np

from lacore.numerics.arrays import Floats

_INDEPENDENT = 1e-8  # singular values below this share of the largest are ignored


@dataclass
class Anderson:
    """Damped fixed-point iteration with Anderson acceleration (Walker & Ni 2011, type II).

    Attributes:
        depth: number of earlier steps used; 0 is plain damping.
        damping: share w of the image in the next argument.
    """

    depth: int
    damping: float
    _arguments: list[Floats] = field(default_factory=list)
    _residuals: list[Floats] = field(default_factory=list)

    def step(self, argument: Floats, image: Floats) -> Floats:
        """Return the next argument for the last one and its image."""
        residual = image - argument
        self._arguments = [*self._arguments, argument][-(self.depth + 1) :]
        self._residuals = [*self._residuals, residual][-(self.depth + 1) :]
        plain = argument + self.damping * residual
        if len(self._residuals) < 2:
            return plain
        changes = np.diff(np.stack(self._residuals, axis=1), axis=1)
        moves = np.diff(np.stack(self._arguments, axis=1), axis=1)
        weights = np.linalg.lstsq(changes, residual, rcond=_INDEPENDENT)[0]
        return np.asarray(plain - (moves + self.damping * changes) @ weights)
