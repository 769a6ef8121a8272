"""Numbers that decide bounds: `lower`, `upper`, their projections, and brackets.

Ratios have no unit; programs are dimensionless.
"""

from collections.abc import Mapping
from sys import float_info
from typing import Final

GOOD_RESIDUAL: Final[float] = 1e-6
"""Residual of a lower-bound solve that is not repeated in other units.

Stresses are projected in any case, and errors of the velocities do not matter.
"""

GOOD_PER_TOLERANCE: Final[float] = 1e2
"""The same per requested tolerance."""

REDUCED_TO: Final[float] = 1.001
"""Factor of the load factor up to which quadratic stresses reduce strengths."""

REDUCTIONS: Final[int] = 4
"""Iterations of that reduction."""

COLLAPSE_TOLERANCE: Final[float] = 1e-6
"""Residual of the velocity that proves a collapse under dead load."""

MARGINS: Final[tuple[float, ...]] = (1e-6, 1e-5, 1e-4)
"""Margins M of a dimensionless program, tried in turn; the first one usually suffices."""

MARGIN_ROUND_OFF: Final[float] = 1e-12
"""Remaining margin per largest rate, which is round-off."""

DOUBLINGS: Final[int] = 8
"""Times that the share of the inner velocity is doubled if round-off remains."""

EDGE_PARTS: Final[int] = 8
"""Parts into which the edges of an element are divided to integrate the dissipation."""

INSIDE_RESIDUAL: Final[float] = 1e-4
"""Residual of a velocity that is inside, and need not be optimal."""

RIGID_STRAIN: Final[float] = 1e-7
"""Strain of a body, by the largest term of its sums, below which it may be rigid."""

EXACT: Final[float] = 1e-12
"""Residual of quantities of order one: sums of thousands of terms in double precision."""

PARALLEL: Final[float] = 1e-9
"""Sine of the angle between facets in line."""

CORNER_ROUND_OFF: Final[float] = 1e-9
"""Force at a vertex, by the load on its facets, that is round-off."""

SAME_PLACE: Final[float] = 1e-9
"""Distance of coordinates that are equal, by the size of the body."""

MISSING: Final[float] = 2.0
"""Factor of that distance for segments, which have two ends."""

PENETRATION: Final[float] = 1e-13
"""Penetration per largest speed that counts as zero."""

PROJECTIONS: Final[int] = 4
"""Projections of a velocity, each with the contacts that the last one has closed."""

CLOSE_CONTACT: Final[float] = 1e-6
"""Opening per largest speed that the projection could close."""

BUBBLE_REFINEMENTS: Final[int] = 8
"""Iterative refinements of quadratic stresses."""

CHEAP_MEAN: Final[float] = 0.1
"""Weight of a mean stress by that of shear, if strength does not depend on pressure."""

NO_LINEAR_PART: Final[float] = 1e-12
"""Largest linear part, by the largest force, that counts as zero."""

SCALING_STEPS: Final[int] = 40
"""Steps that reduce an excess over strengths; together a sixth of the time of a solve."""

HOPELESS: Final[float] = 0.01
"""Excess over strengths at which a solver has found nothing."""

STRENGTH_MARGIN: Final[float] = 1e-7
"""Least margin of all strengths, tried in turn if a state cannot be scaled.

The change by the projection is measured up to 2e-8. The margin is also at least four times the
tolerance of the backend.
"""

NEGLIGIBLE_STRENGTH: Final[float] = 1e-4
"""Strength by the largest stress below which the first margin is one of the largest stress.

The projection changes stresses by up to 2e-8 of the largest one, so that margins of smaller
strengths, which sands with a lent cohesion have, prove nothing. Larger margins cost other soils up
to 2e-5 of their bound.
"""

WIDER_MARGINS: Final[tuple[float, ...]] = (1.0, 100.0, 10_000.0)
"""Factors of that margin, in the order of the attempts."""

WIDEST_MARGIN: Final[float] = 0.01
"""Largest margin of strengths."""

LENT_COHESION: Final[tuple[float, ...]] = (0.05, 0.5)
"""Shares of a negligible cohesion that are lent to a sand (T45)."""

FRICTION_MARGIN: Final[float] = 10.0
"""Reduction of friction within a body, by the margin of all strengths.

Where pressure gives the strength, there is no other to reduce.
"""

MOST_FRICTION_MARGIN: Final[float] = 1e-5
"""Largest reduction: it costs a footing without cohesion 5e-5 of its load."""

TRACTION_NOISE: Final[float] = 1e-9
"""Traction by the largest reaction or the mean traction of the loads that is noise."""

ZERO_LOAD_FACTOR: Final[float] = 1e-9
"""Load factor that a solver may return for zero."""

BELOW: Final[float] = 4 * float_info.epsilon
"""Reduction per term of a scaled stress, so that it does not exceed strengths by round-off."""

SCALING_LOSS: Final[float] = 1e-6
"""Loss of a load factor by scaling that is allowed in any case."""

LOSS_PER_GAP: Final[float] = 0.5
"""Loss by scaling per gap: less than the distance of the solve from the optimum."""

EXCESS_REMOVED: Final[float] = 0.25
"""Share of the excess over strengths to remove, as scaling removes the rest."""

SLIVER: Final[float] = 0.01
"""Shape of a triangle below which strain rates lose their digits."""

CUT_SHARE: Final[float] = 0.98
"""Share of the difference of the bounds in the cells that are cut."""

CUTS_BY_MECHANISM: Final[int] = 4
"""Iterations that cut cells where mechanisms crush.

After them every other one halves cells.
"""

LEAST_CELL: Final[float] = 1e-9
"""Part of a cell that is negligible."""

HALVINGS: Final[int] = 50
"""Bisections that place a cut: to 1e-15 of the cell."""

PLACED: Final[float] = 4
"""Distance of coordinates that are equal, per precision: both have had one or two operations."""

SUMMED: Final[float] = 1e3
"""Round-off of a proven load factor, by the residual that counts as zero and all loads.

Sums over elements have about ten times this residual, and two digits are in reserve.
"""

LOWER_SHARE: Final[float] = 0.3
"""Share of all in the marks of lower bounds, which may be weak where nothing moves."""

SAME_PRESSURE: Final[float] = 1e-9
"""Difference of water pressures that are equal, by the largest one."""

RECENT: Final[int] = 2
"""Refinements whose gains count."""

LOCKED_MESHES: Final[int] = 2
"""Meshes without an upper bound, after which velocities are discontinuous."""

SMALL_MESH: Final[float] = 0.5
"""Elements by those of the other mesh, below which a solve is cheap."""

MOST_GROWTH: Final[float] = 3.4
"""Largest growth of a mesh: marks of elements hold no further."""

LEAST_GROWTH: Final[float] = 1.2
"""Growth of a mesh below which a solve does not pay."""

TOTAL_GROWTH: Final[float] = 1e6
"""Largest total growth that is considered."""

ORDERS: Final[tuple[float, float]] = (0.7, 2.0)
"""Limits of the order of widths in elements: uniform meshes have 0.45, adapted ones 1.0 to 1.3."""

COST: Final[float] = 1.25
"""Exponent of the time of a solve by its elements."""

LEAST_REST: Final[float] = 0.1
"""Smallest remaining gain, by the largest, as bounds rise in steps."""

WIDTH_AIMS: Final[Mapping[int, float]] = {1: 0.94, 2: 0.97}
"""Share of the target width at which the last one or two meshes aim.

A miss takes another iteration, and two meshes overshoot their aim.
"""

LOOSE_TOLERANCE: Final[float] = 1e-3
"""Tolerance of solvers by the width; it costs a lower bound 20 times as much."""

SOIL_TOLERANCES: Final[Mapping[str, float]] = {"lower": 1e-4, "upper": 3e-6}
"""The same by side in soils, where inadmissible flow is worst in the smallest element (T45).

Multipliers of lower bounds mark the next mesh.
"""

LOOSEST_TOLERANCE: Final[float] = 2e-5
"""Largest tolerance that a bracket requests."""

AFFORDABLE_LOSS: Final[float] = 0.25
"""Allowed loss of a bound, by the next width."""

SETTLED_REST: Final[float] = 0.25
"""Remaining gain, by the target width, at which both sides have converged."""

PATIENCE: Final[int] = 4
"""Refinements in a row without gain, after which a bracket ends."""

NO_GAIN: Final[float] = 1e-3
"""Gain, by the target width, that counts as none."""

NO_LOAD_FACTOR: Final[float] = 1e-3
"""Load factor, by the target width and the natural one, that counts as zero."""

STRAIGHT: Final[float] = 1e-6
"""Angle that is round-off, rad."""

SECTORS: Final[float] = 1.6
"""Sectors of a fan in 180 degrees, times the root of a width."""

SECTORS_BY_FRICTION: Final[float] = 4.7
"""Increase of the sectors with friction, by its tangent."""

NO_COHESION: Final[float] = 1e-3
"""Cohesion, by weight and size of a body, that is negligible."""

TIGHTEST_TOLERANCE: Final[float] = 1e-9
"""Smallest tolerance that a bracket requests."""

PROJECTED_RESIDUAL: Final[float] = 1e-3
"""Largest residual of a velocity that is projected."""

LOSS_AIM: Final[float] = 0.2
"""Share of the affordable loss at which a repeated solve aims, as losses do not fall evenly."""

SHARPER: Final[float] = 0.5
"""Largest ratio of tolerances for which another solve pays."""
