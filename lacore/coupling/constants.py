"""Numbers that decide results of couplings; ratios have no unit."""

from typing import Final

LOOSEST_TOLERANCE: Final[float] = 1e-3
"""Largest tolerance that can be requested: a state with larger residuals is no limit state."""

PENALTY_SHARE: Final[float] = 0.1
"""Most energy of penalties per load factor: about 0.02 at r = 0.1 for usual penalties."""

NO_CHANGE: Final[float] = 1e-6
"""Relative change of the argument of a map; smaller ones do not determine a rate."""

SOME_LOAD: Final[float] = 1e-3
"""Share of the dead load, or its power per S; smaller values are noise of a solver."""

RAY_ROUND_OFF: Final[float] = 1e-12
"""Residual per largest force on a part: sums of a thousand terms in double precision."""

RAY_TOLERANCE: Final[float] = 1e-6
"""Residual of reactions that a projection onto equilibrium can still make exact."""

CARRYING: Final[float] = 1e-9
"""Multiplier per largest one; smaller ones are within the tolerance of the linear program."""

FALLING_GAP: Final[float] = 0.9
"""Gap per least one so far; anything above is a stall."""

NEAR_GAP: Final[float] = 0.01
"""Gap of one rough S-step; below it, the next pair of steps holds as a rule."""

NO_LOAD_FACTOR: Final[float] = 1e-6
"""Load factor per associated one that counts as zero in a structure without dead loads."""

NO_REACTION: Final[float] = 3e-4
"""Reaction per largest one that rough solves leave where there is none."""

PATIENCE: Final[int] = 4
"""Steps in a row without progress, after which an iteration ends."""

LONG_PATIENCE: Final[int] = 20
"""The same for an iteration whose gap rises and falls on its way."""

FAST_GAP: Final[float] = 0.4
"""Gap per least one so far that consecutive S-steps reach as long as they are fast."""

HALVED_GAP: Final[float] = 0.5
"""Gap per that of the last check, up to which undamped K-steps continue."""

SLOWEST: Final[float] = 1e-10
"""Speed per fastest one; slower points are at rest: solvers leave noise of 1e-9 or more."""

FASTEST_AT_REST: Final[float] = 1e-2
"""Speed per fastest one; faster points move."""

SPEED_GAP: Final[float] = 10.0
"""Ratio of neighbouring speeds that separates points at rest from moving ones."""

SPEEDS_AT_REST: Final[tuple[float, ...]] = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
"""Speeds per fastest one below which points are at rest, where no gap separates them.

A moving point that counts as at rest makes the face too large, which the certificate of its ends
refutes. A point at rest that counts as moving makes it too small, which nothing reveals. Therefore
the widest gap among the speeds comes first, then large thresholds before small ones.
"""

FACE_SLACK: Final[float] = 1e-8
"""Slack of the stress bound of cones that flow, per bound.

Their stress is known to about 1e-10, and without slack no other stress would be in equilibrium.
"""

NEW_MECHANISM: Final[float] = 1e-6
"""Change of a velocity per fastest one; a larger one gives another mechanism."""

FITTED: Final[float] = 1e-9
"""Relative residual at which the least-squares correction of a velocity ends."""

SHARP_END: Final[float] = 1e-7
"""Residual of an end whose branches are right: solvers and slack leave less."""

FAR_LOAD: Final[float] = 100.0
"""Load per dissipated power at which the state is computed that proves an unbounded end."""

FURTHER: Final[float] = 1e-7
"""Difference of load factors per their size; less is round-off of interior-point methods."""

ALIKE: Final[float] = 100.0
"""Difference of load factors, per tolerance and their size, that counts as none.

With deformable bodies, states certified to 1e-6 converge to loads up to 3e-5 apart.
"""

SLACK_SHARE: Final[float] = 0.9
"""Share of the tolerance for slack; the rest is for round-off and equilibrium."""

FREE_SHIFT: Final[float] = 1e-13
"""Shift of the diagonal, relative to it: round-off of free blocks, which nothing holds."""

LEAST_PIVOT: Final[float] = 0.01
"""Pivot on the diagonal per largest entry of its column; smaller ones leave the diagonal."""

PATH_END: Final[float] = 0.3
"""Gap at the end of a path, per tolerance."""

NEARLY_PROVEN: Final[float] = 10.0
"""Gap per tolerance, below which steps continue after a path."""
