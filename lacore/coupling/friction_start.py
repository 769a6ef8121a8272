"""Friction of another state, at which the loop of a hardening step starts (T12)."""

from dataclasses import dataclass

import numpy as np

from lacore.numerics.arrays import Floats
from lacore.program.kinematic import KinematicProgram
from lacore.reporting.errors import InputError
from lacore.reporting.showing import Compact


@dataclass(frozen=True, repr=False)
class FrictionStart(Compact):
    """Friction at the contact points of another state, arrays of shape (m,) with values >= 0.

    Attributes:
        normal_reaction: Normal reactions, Pa, of a state of the same step, which the first K-step
            freezes. None lets rough solves find them.
        slip: Slip rates, m/s at ``F0.u = 1``, of the step before, at which the rough solves start.
            None lets them start at the associated state.
    """

    normal_reaction: Floats | None = None
    slip: Floats | None = None

    def within(self, program: KinematicProgram) -> "FrictionStart":
        """Return the same friction in the units of a program.

        Raises:
            InputError: The arrays do not belong to its contact points.
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
        return FrictionStart(**found)
