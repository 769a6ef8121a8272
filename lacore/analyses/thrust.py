"""`thrust`: smallest and largest force of a support, and the states in which the support moves.

A support that moves, by settlement or spreading, is a problem with a prescribed motion in place of
a reference load. It is the kinematic program of a unit force on the support, whose load factor is
the force of the support on the structure (T6, T7).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from lacore.analyses.stable import require_dead_loads
from lacore.coupling.kinds import ASSOCIATED
from lacore.limit.solve import solve
from lacore.limit.state import LimitState
from lacore.model.bodies.any_body import rigid_blocks
from lacore.model.conditions.loads import Fix, PointForce
from lacore.model.problem.problem import Problem
from lacore.reporting.errors import InputError, typed
from lacore.reporting.showing import Facts, Picture, Shown

_AXES = "xyz"


@dataclass(frozen=True, repr=False)
class Thrust(Shown):
    """Smallest and largest force of a support that equilibrium allows under the dead loads.

    Attributes:
        least, most: Components along the direction of the force of the support on the structure, N,
            per unit thickness in two dimensions; infinite if contact locks in any force, NaN
            without a proof. No equilibrium within the friction cones has a force outside them.
        yielding: State of `least`: the support moves against its force.
        pushing: State of `most`: the support moves along its force.
    """

    least: float
    most: float
    yielding: LimitState
    pushing: LimitState

    def facts(self) -> Facts:
        """Return both forces and the statuses of their states."""
        states = {"least": self.yielding, "most": self.pushing}
        told = {name: own.report.label for name, own in states.items()}
        return Facts(f"Thrust: {self.least:.6g} to {self.most:.6g} N", told)

    def picture(self) -> Picture | None:
        """Return the mechanism in which the support yields."""
        return self.yielding.picture()


@typed()
def thrust(
    problem: Problem,
    body: str,
    block: str,
    direction: Sequence[float],
    backend: str = "auto",
    *,
    tolerance: float = 1e-6,
    options: Mapping[str, Any] | None = None,
) -> Thrust:
    """Compute the smallest and the largest force of a support under the dead loads alone.

    The friction cones bound the forces, and both ends are proven: stresses and reactions carry
    them, and a mechanism excludes any force beyond. With Coulomb friction, which is not associated,
    `lacore.solve` of `support_motion` returns the state with sliding that does not dilate.

    Args:
        problem: Problem with dead loads; its reference loads do not act.
        body: Name of a body of rigid blocks.
        block: Name of the block that is the support; a support fixes it by its name.
        direction: Direction of the force on the structure, along an axis.
        backend, options: An exact backend.
        tolerance: Tolerance for the residuals.

    Raises:
        InputError: No dead loads; the block is no support; the direction is not along an axis.
        CapabilityError: The backend is missing, or does not support the problem.

    Example:
        >>> arch = la.masonry.arch(9, 1, 0.2, friction=0.9)
        >>> problem = la.Problem(
        ...     bodies={"arch": arch},
        ...     supports=[la.Fix("arch", ("left", "right"))],
        ...     dead_loads=[la.BodyForce("arch", (0, -1))],
        ...     reference_loads=[la.BodyForce("arch", (1, 0))],
        ... )
        >>> force = la.thrust(problem, "arch", "right", (-1, 0))
        >>> bool(0 < force.least < force.most)
        True
    """
    require_dead_loads(problem)
    ends = []
    for sign in (-1.0, 1.0):
        along = tuple(sign * float(own) for own in direction)
        moved = support_motion(problem, body, block, along)
        ends.append(solve(moved, backend, ASSOCIATED, tolerance=tolerance, options=options))
    yielding, pushing = ends
    return Thrust(-yielding.load_factor, pushing.load_factor, yielding, pushing)


@typed()
def support_motion(problem: Problem, body: str, block: str, direction: Sequence[float]) -> Problem:
    """Return the problem in which a support moves, under the dead loads alone.

    The block moves along an axis without rotation, by settlement or spreading of the support. The
    load factor of the new problem is the force on the block along its motion, N, and its mechanism
    shows the joints that open or slide. A negative load factor means that the structure pushes the
    support along.

    Args:
        problem: Problem; its reference loads do not act.
        body: Name of a body of rigid blocks.
        block: Name of the block that moves; a support fixes it by its name.
        direction: Direction of the motion, along an axis.

    Raises:
        InputError: The block is no support, or the direction is not along an axis.

    Example:
        >>> blocks = {
        ...     "left": la.masonry.rectangle(-1, 0, 0, 1),
        ...     "a": la.masonry.rectangle(0, 2, 0, 1),
        ...     "b": la.masonry.rectangle(2, 4, 0, 1),
        ...     "right": la.masonry.rectangle(4, 5, 0, 1),
        ... }
        >>> problem = la.Problem(
        ...     bodies={"arch": la.BlockAssembly(blocks, friction=2.0)},
        ...     supports=[la.Fix("arch", ("left", "right"))],
        ...     dead_loads=[la.BodyForce("arch", (0, -1), where=("a", "b"))],
        ...     reference_loads=[la.BodyForce("arch", (1, 0))],
        ... )
        >>> spreading = la.solve(la.support_motion(problem, "arch", "right", (1, 0)))
        >>> round(spreading.load_factor, 6)  # weight times span over 8 times depth
        -2.0
    """
    along = np.asarray(direction, dtype=float)
    axes = np.flatnonzero(along)
    if along.shape != (problem.dimension,) or axes.size != 1 or not np.isfinite(along).all():
        reason = "is not a vector along an axis"
        raise InputError("direction", tuple(direction), reason, "give one such as (-1, 0)")
    axis = _AXES[axes[0]]
    assemblies = rigid_blocks(problem.bodies)
    if body not in assemblies:
        names = ", ".join(assemblies) or "none"
        raise InputError("body", body, "is no body of rigid blocks", f"give one of: {names}")
    supports: list[Fix] = []
    found = False
    for own in problem.supports:
        fixed = (own.where,) if isinstance(own.where, str) else own.where
        if own.body != body or not isinstance(fixed, tuple) or block not in fixed:
            supports.append(own)
            continue
        found = found or axis in own.components
        if others := tuple(name for name in fixed if name != block):
            supports.append(replace(own, where=others))
        if rest := own.components.replace(axis, ""):
            supports.append(replace(own, where=block, components=rest))
    if not found:
        reason = f"no support of body {body!r} fixes this block along {axis} by its name"
        fix = f"fix it: lacore.Fix({body!r}, {block!r})"
        raise InputError("block", block, reason, fix)
    force = PointForce(body, block, tuple((along / abs(along[axes[0]])).tolist()))
    return replace(problem, supports=supports, reference_loads=[force])
