"""The ends of the load factors that have equilibrium, each with its proof.

The load factors at which stresses and reactions within all strengths and friction cones are in
equilibrium form an interval, because these stresses and reactions form a convex set. One conic
program per end finds the last load factor with equilibrium, and its velocity proves that none lies
beyond (T7): ``load factor <= (D(u) - Fd.u)/(F0.u)`` for every admissible velocity u with
``F0.u > 0``. Both are recomputed from the answer.
"""

from contextlib import closing
from dataclasses import dataclass, replace

import numpy as np

from lacore.coupling.bounds import upper_bound
from lacore.coupling.claims.locking_ray import locking_ray
from lacore.program.certificate import Certificate
from lacore.program.kinematic import FrozenContact, KinematicProgram
from lacore.program.power import kinematic_power
from lacore.program.state import ProgramState
from lacore.reporting.showing import Compact
from lacore.reporting.status import Status
from lacore.solvers.backend import InnerSolution, Prepare, checked_answer


@dataclass(frozen=True, repr=False)
class CarriedEnd(Compact):
    """One end of the load factors with equilibrium, in the units of the program.

    Attributes:
        sign: 1 for the largest load factor, -1 for the smallest.
        load_factor: Last load factor with proven equilibrium, infinite if reactions carry any
            multiple of the load; NaN without a proof.
        bound: Load factor beyond which no equilibrium exists; infinite without a proof.
        error: First-order error of both, if all residuals are as large as their tolerance.
        residual: Largest residual of the equilibrium; NaN without a proof.
        point: Its stresses, reactions and load factor, and the velocity of the bound; None if the
            end is infinite or unknown.
    """

    sign: float
    load_factor: float
    bound: float
    error: float
    residual: float
    point: ProgramState | None

    def carries_beyond(self, load_factor: float, error: float) -> bool | None:
        """Whether equilibrium exists on this side of a load factor; None if neither is proven.

        Args:
            load_factor: A load factor with equilibrium.
            error: Its first-order error. Load factors whose errors overlap are equal.
        """
        if self.sign * (self.load_factor - load_factor) > error + self.error:
            return True
        return False if self.sign * (self.bound - load_factor) <= error + self.error else None


def carried_end(
    program: KinematicProgram,
    contact: FrozenContact,
    sign: float,
    prepare: Prepare,
    tolerance: float,
    answer: InnerSolution | None = None,
) -> CarriedEnd:
    """Compute the largest or the smallest load factor with equilibrium.

    Args:
        program: Dimensionless, homogeneous program with associated flow.
        contact: Contact whose reactions are admissible; associated contact for Coulomb friction.
        sign: 1 for the largest load factor, -1 for the smallest.
        prepare: Function that prepares an exact backend for a program.
        tolerance: Tolerance for the residuals of equilibrium and velocity.
        answer: Solution of this end, if there is one.
    """
    driven = replace(program, reference_load=sign * program.reference_load)
    if answer is None:
        with closing(prepare(driven)) as solver:
            answer = checked_answer(driven, False, solver.solve(contact))
    if answer.point is None:
        ray = locking_ray(driven, contact) if answer.status is Status.LOCKED else None
        endless = ray is not None and ray.proves
        return CarriedEnd(
            sign, sign * np.inf if endless else np.nan, sign * np.inf, 0.0, np.nan, None
        )
    seen = Certificate.of(driven, answer.point, contact)
    residual = float(np.max([seen.equilibrium, seen.yield_violation, seen.cone]))
    proven = residual <= tolerance
    return CarriedEnd(
        sign=sign,
        load_factor=sign * answer.point.load_factor if proven else np.nan,
        bound=sign * upper_bound(driven, answer, tolerance, contact),
        error=tolerance * kinematic_power(driven, answer.point),
        residual=residual if proven else np.nan,
        point=replace(answer.point, load_factor=sign * answer.point.load_factor),
    )
