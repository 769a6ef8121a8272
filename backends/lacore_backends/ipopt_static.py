"""IPOPT through CasADi for the exact static program (T7): the largest load in equilibrium.

It computes the exact limit load from the static side by a solver for nonlinear programs, without
velocities as unknowns and without regularisation. Hardening within a step of a path (T29) would add
a cost of stresses beyond yield, which is not supported.
"""

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from lacore.numerics.arrays import Floats
from lacore.program import FrozenContact, KinematicProgram
from lacore.program.state import ProgramState, out_of_balance
from lacore.reporting.errors import require_count, require_positive
from lacore.reporting.status import Status
from lacore.solvers.backend import Capabilities, InnerSolution
from lacore_backends._ipopt import STATUS_MAP, solver_version, unavailable
from lacore_backends._static_program import LARGEST, StaticProgram

_EVIDENCE = 1e-5  # allowed error of proofs of infeasibility, by the loads or the velocity
_STALLS = (
    "IPOPT is slow at the apex of cones, where the corners of footings on soil are: give more"
    " iterations, or take 'clarabel'"
)
_MISSING = 1e-6  # share of the dead load that must be missing if it collapses the structure


@dataclass(frozen=True)
class IpoptStaticOptions:
    """Options of the `ipopt-static` backend.

    Attributes:
        tolerance: tolerance of IPOPT; the final gap is about a tenth of it per bound and cone.
        max_iterations: limit of one run of IPOPT.
        time_limit: s, limit for one inner solve.
    """

    tolerance: float = 1e-10
    max_iterations: int = 500
    time_limit: float = 3600.0

    def __post_init__(self) -> None:
        require_positive("ipopt-static.tolerance", self.tolerance)
        require_count("ipopt-static.max_iterations", self.max_iterations)
        require_positive("ipopt-static.time_limit", self.time_limit)


class IpoptStatic:
    """Backend for the exact program from its static side."""

    name: ClassVar[str] = "ipopt-static"
    title: ClassVar[str] = "IPOPT through CasADi, exact static program"
    source: ClassVar[str] = "Waechter & Biegler, Math. Program. 106, 2006; Andersson et al. 2019"
    capabilities: ClassVar[Capabilities] = Capabilities(
        regularised=False, on_demand=True, surfaces=True, packages=("casadi",)
    )
    statuses: ClassVar[Mapping[Any, Status]] = STATUS_MAP
    Options: ClassVar[type] = IpoptStaticOptions

    def unavailable(self) -> str:
        """Return why IPOPT cannot run; empty if it can."""
        return unavailable()

    def version(self) -> str:
        """Return the name and version of the solver."""
        return solver_version()

    def prepare(
        self, program: KinematicProgram, options: IpoptStaticOptions
    ) -> "IpoptStaticSolver":
        """Return a solver.

        Equilibrium and cones depend on the dilatancies, known at the first solve.
        """
        return IpoptStaticSolver(program, options)


class IpoptStaticSolver:
    """IPOPT for one static program."""

    def __init__(self, program: KinematicProgram, options: IpoptStaticOptions) -> None:
        self._program, self._options = program, options
        self._dilatancy: Floats = np.zeros(0)
        self._static: StaticProgram | None = None

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve, from the same start each time; no solution is named where it can be proven."""
        begin, options = time.perf_counter(), self._options
        if self._static is None or not np.array_equal(self._dilatancy, contact.dilatancy):
            self._static = StaticProgram(self._program, contact.dilatancy)
            self._dilatancy = contact.dilatancy
        static, limits = self._static, (options.tolerance, options.max_iterations)
        deadline = begin + options.time_limit
        found = static.run(contact, *limits, max(deadline - time.perf_counter(), 1e-9))
        status, iterations = STATUS_MAP[found.native], found.iterations
        point, message = static.state(found), ""
        left = deadline - time.perf_counter()
        if self._locked(contact, point):
            status, message = Status.LOCKED, f"its bound of {LARGEST:g} held the load factor"
        elif status not in (Status.SOLVED, Status.ALMOST_SOLVED) and left > 0:
            unshifted = replace(contact, shift=np.zeros_like(contact.shift))
            carried = static.run(unshifted, *limits, left, share=True)
            iterations += carried.iterations
            if self._collapses(contact, static.velocity(carried)):
                status, message = Status.UNSAFE, "a mechanism of the dead load proves it"
        if status is Status.ITERATION_LIMIT and self._program.pressure_dependent:
            message = _STALLS
        return InnerSolution(
            status=status,
            native_status=found.native,
            iterations=iterations,
            solve_time=time.perf_counter() - begin,
            point=point if status.has_point else None,
            message=message,
        )

    def close(self) -> None:
        """Do nothing: no resources are held."""

    def _locked(self, contact: FrozenContact, point: ProgramState) -> bool:
        """Return whether unbounded stresses carry the load alone, and so any load (Farkas)."""
        if not point.load_factor > LARGEST / 2:
            return False
        unbounded = (contact.dilatancy > 0) | np.isinf(contact.bound)
        ray = replace(
            point,
            stress=tuple(0 * stress for stress in point.stress),
            tangential_reaction=point.tangential_reaction * unbounded[:, None],
        )
        program = replace(self._program, dead_load=np.zeros(self._program.n))
        loads = point.load_factor * float(np.abs(program.reference_load).sum())
        return bool(np.abs(out_of_balance(program, ray)).max() <= _EVIDENCE * loads)

    def _collapses(self, contact: FrozenContact, velocity: Floats) -> bool:
        """Return whether the dead load does more power on a mechanism than it dissipates.

        The reference load has no power on it, so no load factor keeps the structure (T13). It is
        the mechanism of a limit load, that of the share of the dead load that can be carried.
        """
        program, points = self._program, self._program.contact
        slip = np.linalg.norm(points.slip(velocity), axis=1)
        held = np.where(np.isinf(contact.bound), slip, 0.0)
        inward = np.maximum(contact.dilatancy * slip - points.opening(velocity), held)
        theta = [group.impossible(velocity) for group in program.groups]
        broken = max(float(part.max(initial=0.0)) for part in (inward, *theta))
        idle = abs(float(program.reference_load @ velocity))
        size = float(np.abs(velocity).max())
        loads = float(np.abs(program.reference_load).sum())
        dissipated = program.plastic_dissipation(velocity)
        dissipated += program.friction_dissipation(velocity, contact.bound)
        power = float(program.dead_load @ velocity)
        return (
            power > 0
            and dissipated < (1 - _MISSING) * power
            and broken <= _EVIDENCE * size
            and idle <= _EVIDENCE * size * loads
        )
