"""Numbers that decide how states are projected onto exact equilibrium and admissible rates."""

from typing import Final

SHIFT: Final[float] = 1e-11
"""Share of the diagonal, or of rows of length 1, that makes a factorisation possible.

Multipliers of redundant rows, such as tractions at a vertex whose facets are in line, have no
stiffness. Refinement removes the effect of the shift.
"""

REFINEMENTS: Final[int] = 5
"""Iterative refinements of a projection."""

FINISHED: Final[float] = 0.5
"""Residual per last one; a refinement that leaves more has reached round-off."""

STIFF_LOAD: Final[float] = 1e6
"""Stiffness of the load factor in a projection.

It is far above that of a body against its load, of order one, and far below that of a mode without
stiffness, 1 / SHIFT.
"""

NO_STIFFNESS: Final[float] = 1e-30
"""Stiffness per largest one, below which no stress acts on an unknown.

An example is a smooth footing that moves along its face. It is far below the shift.
"""
