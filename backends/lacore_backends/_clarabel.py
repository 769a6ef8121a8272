"""Statuses, settings and repeated solves of the Clarabel backends. Not a backend."""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import clarabel
import numpy as np

from lacore.numerics.arrays import Floats
from lacore.program import FrozenContact, KinematicProgram
from lacore.program.regularization import Penalties
from lacore.reporting.status import Status
from lacore_backends._conic_form import ConicForm, Pattern

STATUS_MAP: Mapping[str, Status] = {
    "Solved": Status.SOLVED,
    "AlmostSolved": Status.ALMOST_SOLVED,
    "PrimalInfeasible": Status.LOCKED,
    "AlmostPrimalInfeasible": Status.FAILED,
    "DualInfeasible": Status.UNSAFE,
    "AlmostDualInfeasible": Status.FAILED,
    "MaxIterations": Status.ITERATION_LIMIT,
    "MaxTime": Status.TIME_LIMIT,
    "InsufficientProgress": Status.STALLED,
    "NumericalError": Status.FAILED,
    "CallbackTerminated": Status.FAILED,
    "Unsolved": Status.FAILED,
}
_KEPT = 2  # number of forms kept: a coupling loop alternates between bounds and shifts (T12)
# statuses after which another attempt is useless
_DEFINITE = {"Solved", "PrimalInfeasible", "DualInfeasible"}


class Limits(Protocol):
    """Options of all Clarabel backends."""

    @property
    def tolerance(self) -> float:
        """Relative tolerance on gap and feasibility."""

    @property
    def max_iterations(self) -> int:
        """Limit of the interior-point method."""

    @property
    def time_limit(self) -> float:
        """s, one inner solve."""


@dataclass(frozen=True)
class ClarabelResult:
    """Result of Clarabel for one frozen contact: x and z of the form."""

    native: str
    iterations: int
    x: Floats
    z: Floats
    form: ConicForm

    @property
    def status(self) -> Status:
        """Status that corresponds to the native one."""
        return STATUS_MAP[self.native]


@dataclass
class _Standing:
    """Form with the solver that was built for it; None after a failure."""

    pattern: Pattern
    form: ConicForm
    solver: Any = None


class ConicSolver:
    """Clarabel for one program, exact or with penalties."""

    def __init__(
        self, program: KinematicProgram, limits: Limits, penalty: Penalties | None = None
    ) -> None:
        self._program, self._limits, self._penalty = program, limits, penalty
        self._standing: list[_Standing] = []  # The last one used comes last.

    def solve(self, contact: FrozenContact) -> ClarabelResult:
        """Solve; a change of friction bounds or shifts alone updates q and b in place."""
        begin = time.perf_counter()
        standing = self._found(contact)
        form = standing.form
        cost, offset = form.cost(contact)[form.order], form.offset(contact)
        if standing.solver is None:
            limit = self._limits.time_limit
            standing.solver = self._start(form, cost, offset, limit)
        else:
            standing.solver.update(q=cost, b=offset)
        found = standing.solver.solve()
        left = begin + self._limits.time_limit - time.perf_counter()
        if str(found.status) not in _DEFINITE and left > 0:
            standing.solver = None
            # A wall of thousands of blocks that is almost solved is neither locked nor unsafe.
            almost = form.linear and str(found.status) == "AlmostSolved"
            other = form.traits.pressure_dependent and not form.traits.gentle
            careful = self._start(
                form, cost, offset, left, refine=True, equilibrate=almost or other
            )
            again = careful.solve()
            # Of two results that are almost solved the more accurate one is kept.
            both = {str(found.status), str(again.status)} == {"AlmostSolved"}
            if not (form.traits.pressure_dependent and both and _left(found) < _left(again)):
                found = again
        native, steps = str(found.status), int(found.iterations)
        x = np.empty(cost.size)
        x[form.order] = found.x
        return ClarabelResult(native, steps, x, np.array(found.z), form)

    def _found(self, contact: FrozenContact) -> _Standing:
        """Return the form for a contact: one of the last, or a new one in place of the oldest."""
        pattern = Pattern.of(contact)
        known = [standing for standing in self._standing if pattern.same(standing.pattern)]
        if not known:
            self._standing = self._standing[1 - _KEPT :]
            form = ConicForm(self._program, contact, pattern, self._penalty)
            known = [_Standing(pattern, form)]
        self._standing = [other for other in self._standing if other is not known[0]] + known
        return known[0]

    def _start(
        self,
        form: ConicForm,
        cost: Floats,
        offset: Floats,
        time_limit: float,
        refine: bool = False,
        equilibrate: bool = True,
    ) -> Any:
        """Return a solver for a form, without refinement first and with it after a failure.

        Measured on punches, platens and infeasible programs: static regularisation of 1e-7 solves
        graded meshes that 1e-8 does not. Infeasible programs are detected reliably only without
        equilibration, which costs feasible ones a digit. On the linear programs of walls of 33 to 5
        000 blocks, 1e-8 leaves a third of the penetration and slip residuals of 1e-7, and 1e-9 ends
        "AlmostSolved". With hardening, 1e-9 without equilibration solves what 1e-7 with it does
        not, or in a third of the iterations; if softened, 1e-8 with equilibration does. The same
        holds for strength that depends on pressure, except that 1e-8 suffices for a single surface,
        and that angles below 5 degrees need refinement from the start. See
        docs/design-decisions.md.
        """
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.max_threads = 1
        settings.direct_solve_method = "qdldl"
        settings.presolve_enable = False
        settings.chordal_decomposition_enable = False
        exact = self._penalty is None
        bare = exact and (
            form.traits.hardens
            or (form.traits.pressure_dependent and not (form.traits.gentle or refine))
        )
        small = form.linear or form.traits.pressure_dependent or form.traits.hardens
        plain = form.traits.even and not form.traits.cornered
        least = 1e-9 if bare and not (refine or plain) else 1e-8
        settings.static_regularization_constant = least if small else 1e-7
        settings.iterative_refinement_enable = refine or (exact and form.traits.gentle)
        settings.equilibrate_enable = equilibrate and not bare
        settings.max_iter = self._limits.max_iterations
        settings.time_limit = time_limit
        settings.tol_gap_abs = settings.tol_gap_rel = self._limits.tolerance
        settings.tol_feas = self._limits.tolerance
        quadratic, matrix = form.ordered()
        return clarabel.DefaultSolver(quadratic, cost, matrix, offset, form.cones, settings)


def _left(found: Any) -> float:
    """Return the largest residual that Clarabel reports: gap, primal and dual feasibility."""
    gap = abs(found.obj_val - found.obj_val_dual) / max(1.0, abs(found.obj_val))
    return float(max(gap, found.r_prim, found.r_dual))


def version() -> str:
    """Return the name and version of the solver."""
    return f"Clarabel {clarabel.__version__}"
