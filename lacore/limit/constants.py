"""Numbers that decide limit states and their findings; ratios have no unit."""

from typing import Final

TOLERANCE: Final[float] = 1e-6
"""Residuals of a certificate, where a solve requests no other tolerance."""

ACCEPTED: Final[float] = 5e-5
"""The same for soils with non-associated flow, relative to the dissipated power (T53, T58)."""

SOLVES_IN_SPACE: Final[int] = 300
"""Solves of a loop in three dimensions: domes and vaults need ten times as many as walls."""

HINGING_ROUNDS: Final[int] = 12
"""Solves with further nodes in members: each reduces the excess of moments quadratically."""

NODES_APART: Final[float] = 0.1
"""Distance of nodes by a piece of a member; earlier nodes that are nearer to new ones give way."""

REGULARISED_EXCESS: Final[float] = 1e-3
"""Excess of moments in members of regularised states, whose hinges are no sharper."""

SAME_LOAD_FACTOR: Final[float] = 1e-6
"""Relative difference of load factors that are equal within the tolerance of their proofs."""

RESTING: Final[float] = 1e-6
"""Speed per fastest one, below which contact points and hinges count as at rest."""

BEYOND: Final[float] = 0.2
"""Depth of the row of elements beyond a side, by the size of the body across the side."""

LESS_LOAD: Final[float] = 0.035
"""Reduction of the load factor by the row beyond a side that shows that the mesh ends too early.

From 180 elements on, the row reduces the load of footings whose box ends a fifth before their
mechanism by 3.8 to 8 %, and that of the boxes of cases by at most 2.8 %.
"""

SHOWING_ELEMENTS: Final[int] = 180
"""Elements of a mesh; on fewer the reduction was 9 % although a box was large enough."""

FLAT: Final[float] = 1e-9
"""Distance of vertices from one line, by the size of the body: round-off of coordinates."""

NEAR_SUPPORT: Final[float] = 0.02
"""Distance from a support, by the size of the body, at which motion counts as motion there."""

MOVES: Final[float] = 0.15
"""Speed near a support, by the largest one, at which the mechanism reaches it.

It is 0.12 for footings in boxes a tenth larger than the mechanism, on 40 to 1920 elements. In boxes
that raise the load by 5 % it is 0.11 on 160 elements, 0.13 on 576 and 0.2 on 1920.
"""

ROLLS: Final[float] = 0.35
"""The same for rollers, which do not restrain motion along them.

It is 0.23 for footings in boxes a tenth larger than the mechanism, on 40 to 1344 elements, and 0.53
or more if the box ends with the mechanism.
"""

IN_DOUBT: Final[float] = 0.5
"""The same in elements at a support that are too large to show where motion ends."""

FACING_SIDES: Final[float] = -0.99
"""Cosine of the outward normals of two sides that face each other."""
