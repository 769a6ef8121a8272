"""Clarabel on the exact conic form of the kinematic program (T34, T35); no modelling layer."""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from lacore.program import FrozenContact, KinematicProgram
from lacore.reporting.errors import require_count, require_positive
from lacore.reporting.status import Status
from lacore.solvers.backend import Capabilities, InnerSolution, Writer
from lacore_backends._clarabel import STATUS_MAP, ConicSolver, version
from lacore_backends._instances import write_cbf, write_npz


@dataclass(frozen=True)
class ClarabelOptions:
    """Options of the `clarabel` backend.

    Attributes:
        tolerance: relative tolerance on gap and feasibility.
        max_iterations: limit of the interior-point method.
        time_limit: s, limit for one inner solve.
    """

    tolerance: float = 1e-10
    max_iterations: int = 200
    time_limit: float = 3600.0

    def __post_init__(self) -> None:
        require_positive("clarabel.tolerance", self.tolerance)
        require_count("clarabel.max_iterations", self.max_iterations)
        require_positive("clarabel.time_limit", self.time_limit)


class Clarabel:
    """Backend for the exact program: interior-point method for second-order cone programs."""

    name: ClassVar[str] = "clarabel"
    title: ClassVar[str] = "Clarabel, exact second-order cone program"
    source: ClassVar[str] = "Goulart & Chen, Clarabel: an interior-point solver, 2024"
    capabilities: ClassVar[Capabilities] = Capabilities(
        regularised=False, hardening=True, surfaces=True, paths=True, packages=("clarabel",)
    )
    statuses: ClassVar[Mapping[Any, Status]] = STATUS_MAP
    Options: ClassVar[type] = ClarabelOptions
    writers: ClassVar[Mapping[str, Writer]] = {"npz": write_npz, "cbf": write_cbf}

    def unavailable(self) -> str:
        """Return an empty reason: the solver is installed."""
        return ""

    def version(self) -> str:
        """Return the name and version of the solver."""
        return version()

    def prepare(self, program: KinematicProgram, options: ClarabelOptions) -> "ClarabelSolver":
        """Keep the parts of the conic form that no frozen contact changes."""
        return ClarabelSolver(program, options)


class ClarabelSolver:
    """Clarabel for one program."""

    def __init__(self, program: KinematicProgram, options: ClarabelOptions) -> None:
        self._solver = ConicSolver(program, options)

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve; a change of friction bounds alone updates the cost vector in place."""
        begin = time.perf_counter()
        answer = self._solver.solve(contact)
        has_point = answer.status.has_point
        return InnerSolution(
            status=answer.status,
            native_status=answer.native,
            iterations=answer.iterations,
            solve_time=time.perf_counter() - begin,
            point=answer.form.point(answer.x, answer.z, contact) if has_point else None,
        )

    def close(self) -> None:
        """Do nothing: no resources are held."""
