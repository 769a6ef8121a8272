"""Clarabel for the regularised program (T17-T20), as cones and a quadratic cost.

It finds the same minimum as `ipopt`, `newton` and `slsqp` with the solver of the exact program. The
difference to the exact result is the regularisation error; the difference to the others is their
solver error.
"""

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

from lacore.program import FrozenContact, KinematicProgram
from lacore.program.regularization import (
    RegularisedPoint,
    by_shifts,
    check_penalties,
    evaluate,
    judged_status,
    penalties,
)
from lacore.reporting.errors import require_count, require_positive
from lacore.reporting.status import Status
from lacore.solvers.backend import Capabilities, InnerSolution
from lacore_backends._clarabel import STATUS_MAP, ClarabelResult, ConicSolver, version

_PROVEN = 1e-8  # gap, by the power, at which the duals are the stresses of the velocity


@dataclass(frozen=True)
class ClarabelRegularisedOptions:
    """Options of the `clarabel-regularised` backend.

    Attributes:
        r: dimensionless regularisation (T20).
        eta, bulk: instead of r: viscosity and bulk penalty, Pa s.
        normal, tangential: instead of r: contact penalties, Pa/(m/s).
        tolerance: relative tolerance on gap and feasibility.
        max_iterations: limit of the interior-point method.
        time_limit: s, limit for one inner solve.
    """

    r: float = 1e-3
    eta: float | None = None
    bulk: float | None = None
    normal: float | None = None
    tangential: float | None = None
    tolerance: float = 1e-10
    max_iterations: int = 200
    time_limit: float = 3600.0

    def __post_init__(self) -> None:
        check_penalties(self.r, self.eta, self.bulk, self.normal, self.tangential)
        require_positive("clarabel-regularised.tolerance", self.tolerance)
        require_count("clarabel-regularised.max_iterations", self.max_iterations)
        require_positive("clarabel-regularised.time_limit", self.time_limit)


class ClarabelRegularised:
    """Backend with a regularisation error but without solver error."""

    name: ClassVar[str] = "clarabel-regularised"
    title: ClassVar[str] = "Clarabel, regularised program as cones and quadratic cost"
    source: ClassVar[str] = "Goulart & Chen, Clarabel: an interior-point solver, 2024"
    capabilities: ClassVar[Capabilities] = Capabilities(
        regularised=True, hardening=True, surfaces=True, packages=("clarabel",)
    )
    statuses: ClassVar[Mapping[Any, Status]] = STATUS_MAP
    Options: ClassVar[type] = ClarabelRegularisedOptions

    def unavailable(self) -> str:
        """Return an empty reason: the solver is installed."""
        return ""

    def version(self) -> str:
        """Return the name and version of the solver."""
        return version()

    def prepare(
        self, program: KinematicProgram, options: ClarabelRegularisedOptions
    ) -> "RegularisedSolver":
        """Prepare the penalties.

        The conic form depends on which contact points rub, stick or dilate.
        """
        return RegularisedSolver(program, options)


class RegularisedSolver:
    """Clarabel for one regularised program."""

    def __init__(self, program: KinematicProgram, options: ClarabelRegularisedOptions) -> None:
        self._program = program
        self._penalty = penalties(
            program.scales, options.r, options.eta, options.bulk, options.normal, options.tangential
        )
        self._solver = ConicSolver(program, options, self._penalty)

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve; a change of friction bounds or shifts alone updates costs in place."""
        begin = time.perf_counter()
        answer = self._solver.solve(contact)
        status, point = answer.status, None
        if status.has_point:
            point = self._point(contact, answer)
            status = judged_status(status, self._program, point)
        return InnerSolution(
            status=status,
            native_status=answer.native,
            iterations=answer.iterations,
            solve_time=time.perf_counter() - begin,
            point=point.state if point is not None and status.has_point else None,
            regularised=None if point is None else point.values,
        )

    def close(self) -> None:
        """Do nothing: no resources are held."""

    def _point(self, contact: FrozenContact, answer: ClarabelResult) -> RegularisedPoint:
        """Return the energies at the velocity, with the stresses and reactions of the duals.

        Stresses computed by the law amplify errors of the velocity by the penalties: at r = 1e-5
        their nodal forces are out of balance by 1e-3, those of the duals by 1e-9. The gap, which is
        that of the objective in equilibrium, proves that the duals are the stresses of the law. If
        it does not, the stresses of the law are returned, and the certificate assesses them.
        """
        dual = answer.form.point(answer.x, answer.z, contact)
        point = evaluate(self._program, contact, self._penalty, dual.velocity, dual.load_factor)
        values = point.values
        shifted = by_shifts(self._program, contact, dual)
        below = dual.load_factor - shifted - answer.form.complementary_energy(answer.z, contact)
        dead_power = float(self._program.dead_load @ dual.velocity)
        power = max(abs(point.objective) + abs(dead_power), 1.0)
        if not abs(point.objective - below) <= _PROVEN * power:
            return point
        return replace(point, state=replace(dual, load_factor=values.load_factor))
