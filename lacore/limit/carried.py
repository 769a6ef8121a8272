"""The load factors that have equilibrium, and the role of a Coulomb load factor among them."""

from __future__ import annotations

from dataclasses import asdict, dataclass

import numpy as np

from lacore.assembly.discretisation import Discretisation
from lacore.coupling.claims.carried import CarriedEnd, carried_end
from lacore.coupling.run import Coupled
from lacore.limit.conversion import point_in_si
from lacore.limit.judges.driven_corners import driven_corners
from lacore.limit.span_moments import span_excess
from lacore.program.kinematic import KinematicProgram, associated_contact
from lacore.program.power import kinematic_power
from lacore.reporting.showing import Facts, Shown
from lacore.reporting.status import Role, Status
from lacore.solvers.backend import Prepare

_ROLES = {
    (False, True): Role.CAPACITY,
    (False, None): Role.CAPACITY,
    (True, False): Role.MINIMUM,
    (None, False): Role.MINIMUM,
    (True, True): Role.BOTH_SIDES,
    (False, False): Role.ONLY,
}
"""Roles by whether equilibrium exists above and below; None if that is not proven."""


@dataclass(frozen=True, repr=False)
class CarriedLoads(Shown):
    """The load factors that have equilibrium, and the role of a load factor among them.

    Stresses within all strengths and reactions within all friction cones are in equilibrium at
    every load factor from `low` to `high`, and at none below `least` or above `most`. They may
    include forces that the contact locks in (prestress). With Coulomb friction, which is not
    associated, a load with equilibrium may still have mechanisms (T14b). With deformable bodies all
    this concerns the discrete problem.

    Attributes:
        role: Role of the load factor of the state.
        low, high: Smallest and largest load factor with proven equilibrium. They are infinite if
            reactions carry any multiple of the load, and the load factor of the state where no
            equilibrium beyond it is proven.
        least, most: Load factors beyond which no equilibrium exists; infinite without a proof.
        residual: Largest residual of both equilibria; NaN if both ends are infinite or unknown.

    Example:
        >>> carried = la.solve(la.examples.column(friction=0.3)).carried
        >>> carried.role.label, round(carried.low, 3), round(carried.high, 3)
        ('capacity', -0.3, 0.3)
    """

    role: Role
    low: float
    high: float
    least: float
    most: float
    residual: float

    @property
    def side(self) -> str:
        """Side on which equilibrium is proven: ``below``, ``above``, ``both``, or empty."""
        return _SIDES.get(self.role, "")

    @property
    def locks_in_forces(self) -> bool:
        """Whether reactions carry any multiple of the load and of its opposite.

        The sum of both is a state of self-stress, which the contact may lock in at any size.
        """
        return bool(np.isinf([self.low, self.high]).all())

    def record(self) -> dict[str, str | float]:
        """Return plain values, as JSON has them."""
        return {**asdict(self), "role": self.role.label}

    def facts(self) -> Facts:
        """Return both ends and their proofs."""
        told = {"role": f"{self.role.label}: {self.role.value}"}
        ends = {"below": self.least, "above": self.most}
        if proven := [f"{side} {end:.7g}" for side, end in ends.items() if np.isfinite(end)]:
            told["proven"] = f"no equilibrium {' or '.join(proven)}"
        if np.isfinite(self.residual):
            told["residual"] = f"largest {self.residual:.1e}"
        return Facts(f"CarriedLoads: {loads_between(self.low, self.high)}", told)


_SIDES = {Role.CAPACITY: "below", Role.MINIMUM: "above", Role.BOTH_SIDES: "both"}


def loads_between(low: float, high: float) -> str:
    """Return the load factors of an interval as text: ``load factors from 0 to 2.5``."""
    if np.isinf(low) and np.isinf(high):
        return "all load factors"
    if np.isinf(high):
        return f"all load factors from {low:.6g}"
    if np.isinf(low):
        return f"all load factors up to {high:.6g}"
    return f"load factors from {low:.6g} to {high:.6g}"


def carried_loads(
    discretisation: Discretisation,
    program: KinematicProgram,
    coupled: Coupled,
    prepare: Prepare,
) -> CarriedLoads | None:
    """Compute the load factors with equilibrium, and the role of the one that a loop found.

    Loops start at the associated state, which is the largest load factor with equilibrium, so that
    one more conic program is solved, for the smallest one.

    Args:
        discretisation: Discretisation of the problem.
        program: Its program, dimensionless.
        coupled: End of the loop.
        prepare: Function that prepares an exact backend for a program.

    Returns:
        None unless the loop certified a state of a limit problem with non-associated flow.
    """
    state, first = coupled.final.state, coupled.iterates[0]
    if coupled.status is not Status.SOLVED or state is None or not program.homogeneous:
        return None
    if coupled.laws is not None or program.associated_flow:
        return None
    laws, tolerance = associated_contact(program.contact), coupled.tolerance
    known = {1.0: first.inner} if first.kind == "associated" else {}
    low, high = (
        end_in_si(
            discretisation,
            carried_end(program.associated(), laws, sign, prepare, tolerance, known.get(sign)),
            tolerance,
        )
        for sign in (-1.0, 1.0)
    )
    scale = discretisation.natural.load_factor
    alpha = state.load_factor * scale
    error = tolerance * kinematic_power(program, state) * scale
    role = _ROLES.get((high.carries_beyond(alpha, error), low.carries_beyond(alpha, error)))
    return CarriedLoads(
        role=role or Role.UNDECIDED,
        low=float(np.fmin(low.load_factor, alpha)),
        high=float(np.fmax(high.load_factor, alpha)),
        least=float(np.fmin(low.bound, alpha)),
        most=float(np.fmax(high.bound, alpha)),
        residual=float(np.fmax(low.residual, high.residual)),
    )


def end_in_si(discretisation: Discretisation, end: CarriedEnd, tolerance: float) -> CarriedEnd:
    """Convert an end to SI units, without proofs that hold of the program and not of the problem.

    Moments along members may exceed the plastic moment between the hinges of a program. Corners of
    blocks that meet may carry forces that no program has.
    """
    scale = discretisation.natural.load_factor
    point = None if end.point is None else point_in_si(discretisation, end.point)
    carries = point is None or span_excess(discretisation, point) <= tolerance
    excludes = point is None or not driven_corners(discretisation, point.velocity, tolerance)
    return CarriedEnd(
        sign=end.sign,
        load_factor=end.load_factor * scale if carries else np.nan,
        bound=end.bound * scale if excludes else end.sign * np.inf,
        error=end.error * scale,
        residual=end.residual if carries else np.nan,
        point=point,
    )
