"""Where a loop on a step that hardens begins: friction of a state nearby (T12)."""

from dataclasses import dataclass

import numpy as np

from lacore.numerics.arrays import Floats
from lacore.program.kinematic import KinematicProgram
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact


@dataclass(frozen=True, repr=False)
class Nearby(Compact):
    """Friction at the contact points of another state, each of shape (m,), all >= 0.

    Attributes:
        normal_reaction: Pa: of a state so near that its first K-step begins with them.
        slip: slip rates, m/s at ``F0.u = 1``, of one that is less near: rough solves begin there;
            None: at the associated state.
    """

    normal_reaction: Floats | None = None
    slip: Floats | None = None

    def within(self, program: KinematicProgram) -> "Nearby":
        """The same in the units of a program.

        Raises:
            InputError: it is not that of its contact points.
        """
        count, scales = program.contact.count, program.scales
        given = (
            ("normal_reaction", self.normal_reaction, scales.stress),
            ("slip", self.slip, scales.velocity),
        )
        found: dict[str, Floats] = {}
        for name, values, scale in given:
            if values is None:
                continue
            wrong = np.shape(values) != (count,) or not np.all(np.isfinite(values))
            if wrong or np.any(values < 0):
                why = f"are not {count} numbers of 0 or more"
                fix = "give those of a state with the same contact points, or leave them out"
                raise InputError(name, None, why, fix)
            found[name] = np.asarray(values, dtype=float) / scale
        return Nearby(**found)
