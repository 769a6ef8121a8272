"""HiGHS on programs whose cones are all of one row: rigid blocks and frames in the plane, an LP.

Each |v| is split, ``v = p - q`` with p, q >= 0, so that the row dual of the split is the stress
or the tangential reaction itself. Rows are multiplied by their integration weight as in (T34).

minimise   bound.(p + q) - Fd.U
subject to F0.U = 1              dual: load factor
           w theta U = 0         dual: -mean stress
           w D U - p + q = 0     dual: -stress; of contact points, w T U: tangential reaction
           w N U - d (p + q) >= -w s            dual: normal reaction

Sticking is p = q = 0. A change of bounds, sticking and shifts leaves the rows as they are.
"""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import highspy
import numpy as np
from scipy.sparse import coo_array, csc_array, csr_array, diags_array, hstack, vstack

from lacore.arrays import Floats
from lacore.backend import Capabilities, InnerSolution
from lacore.errors import InputError, require_count, require_known, require_positive
from lacore.program import FrozenContact, KinematicProgram
from lacore.state import ProgramState
from lacore.status import Status

STATUS_MAP = {
    "kOptimal": Status.SOLVED,
    "kInfeasible": Status.LOCKED,
    "kUnbounded": Status.UNSAFE,
    "kUnboundedOrInfeasible": Status.FAILED,  # solved again without presolve, to know
    "kIterationLimit": Status.ITERATION_LIMIT,
    "kTimeLimit": Status.TIME_LIMIT,
    "kUnknown": Status.STALLED,
    "kObjectiveBound": Status.STALLED,
    "kObjectiveTarget": Status.STALLED,
    "kSolutionLimit": Status.STALLED,
    "kNotset": Status.FAILED,
    "kLoadError": Status.FAILED,
    "kModelError": Status.FAILED,
    "kPresolveError": Status.FAILED,
    "kSolveError": Status.FAILED,
    "kPostsolveError": Status.FAILED,
    "kModelEmpty": Status.FAILED,
    "kInterrupt": Status.FAILED,
    "kHighsInterrupt": Status.FAILED,
    "kMemoryLimit": Status.FAILED,
}
_SMALLEST_TOLERANCE = 1e-10


@dataclass(frozen=True)
class HighsOptions:
    """Options of the `highs` backend.

    Attributes:
        tolerance: absolute, of the rows and of the reduced costs; HiGHS takes none below 1e-10.
        solver: ``simplex``, which starts from the vertex of the solve before, or ``ipm``, an
            interior point followed by a crossover to a vertex.
        max_iterations: of the simplex method, or of the interior-point method.
        time_limit: s, one inner solve.
    """

    tolerance: float = 1e-10
    solver: str = "simplex"
    max_iterations: int = 1_000_000
    time_limit: float = 3600.0

    def __post_init__(self) -> None:
        require_positive("highs.tolerance", self.tolerance)
        if self.tolerance < _SMALLEST_TOLERANCE:
            why = f"HiGHS takes no tolerance below {_SMALLEST_TOLERANCE}"
            raise InputError("highs.tolerance", self.tolerance, why, "give a larger one")
        require_known("highs.solver", self.solver, ("simplex", "ipm"))
        require_count("highs.max_iterations", self.max_iterations)
        require_positive("highs.time_limit", self.time_limit)


class Highs:
    """Vertex solutions of linear programs, exact to round-off."""

    name: ClassVar[str] = "highs"
    title: ClassVar[str] = "HiGHS, exact linear program (blocks and frames in the plane)"
    source: ClassVar[str] = "Huangfu & Hall, Parallelizing the dual revised simplex method, 2018"
    capabilities: ClassVar[Capabilities] = Capabilities(
        regularised=False, max_cone=1, warm_start=True
    )
    statuses: ClassVar[Mapping[Any, Status]] = STATUS_MAP
    Options: ClassVar[type] = HighsOptions

    def unavailable(self) -> str:
        """Always there once imported."""
        return ""

    def version(self) -> str:
        """The solver and its version."""
        return f"HiGHS {highspy.Highs().version()}"

    def prepare(self, program: KinematicProgram, options: HighsOptions) -> "HighsSolver":
        """Put down the rows that no frozen contact changes."""
        return HighsSolver(program, options)


class HighsSolver:
    """HiGHS at work on one program."""

    def __init__(self, program: KinematicProgram, options: HighsOptions) -> None:
        self._form, self._options = _LinearForm(program), options
        self._dilatancy: Floats | None = None
        self._highs = highspy.Highs()
        for name, value in {
            "output_flag": False,
            "solver": options.solver,
            "primal_feasibility_tolerance": options.tolerance,
            "dual_feasibility_tolerance": options.tolerance,
            "ipm_optimality_tolerance": options.tolerance,
            "simplex_iteration_limit": options.max_iterations,
            "ipm_iteration_limit": options.max_iterations,
            "small_matrix_value": 1e-12,  # smaller entries, of tiny weights, would be dropped
        }.items():
            self._highs.setOptionValue(name, value)

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve from the last vertex; a change of dilatancy alone passes the rows anew."""
        begin = time.perf_counter()
        highs, form = self._highs, self._form
        if self._dilatancy is None or not np.array_equal(contact.dilatancy, self._dilatancy):
            basis = highs.getBasis()
            highs.passModel(form.model(contact.dilatancy))
            if self._dilatancy is not None and basis.valid:
                highs.setBasis(basis)
            self._dilatancy = contact.dilatancy
        columns = np.arange(form.columns, dtype=np.int32)
        rows = np.arange(form.rows, dtype=np.int32)
        highs.changeColsCost(columns.size, columns, form.cost(contact))
        highs.changeColsBounds(columns.size, columns, *form.column_bounds(contact))
        highs.changeRowsBounds(rows.size, rows, *form.row_bounds(contact))
        native = self._run()
        if native == "kUnboundedOrInfeasible":
            highs.setOptionValue("presolve", "off")
            highs.setOptionValue("allow_unbounded_or_infeasible", False)
            highs.clearSolver()
            native = self._run()
            highs.setOptionValue("presolve", "choose")
        status, answer, info = STATUS_MAP[native], highs.getSolution(), highs.getInfo()
        there = status.has_point and answer.value_valid and answer.dual_valid
        point = form.point(np.array(answer.col_value), np.array(answer.row_dual)) if there else None
        if status is not Status.SOLVED:
            highs.clearSolver()  # no vertex to start from
        return InnerSolution(
            status=status,
            native_status=native,
            iterations=max(info.simplex_iteration_count, 0) + max(info.ipm_iteration_count, 0),
            solve_time=time.perf_counter() - begin,
            point=point,
        )

    def _run(self) -> str:
        # The clock of HiGHS runs on from solve to solve.
        self._highs.setOptionValue(
            "time_limit", self._highs.getRunTime() + self._options.time_limit
        )
        self._highs.run()
        return str(self._highs.getModelStatus().name)

    def close(self) -> None:
        """Drop the model."""
        self._highs.clear()


class _LinearForm:
    """Columns (U, p, q), p and q of all cones and then of all contact points; rows as above."""

    def __init__(self, program: KinematicProgram) -> None:
        self._program, contact = program, program.contact
        groups = [group for group in program.groups if group.weights.size]
        self._cones, self._points = sum(g.weights.size for g in groups), contact.count
        self._split = self._cones + self._points
        self.columns = program.n + 2 * self._split
        self.rows = 1 + self._cones + self._split + self._points
        blocks: list[Any] = [csr_array(program.reference_load[None, :])]
        blocks += [diags_array(group.weights) @ group.volumetric for group in groups]
        blocks += [diags_array(group.weights) @ group.rows for group in groups]
        if self._points:
            weights = diags_array(contact.weights)
            blocks += [weights @ contact.tangential, weights @ contact.normal]
        self._velocity = vstack(blocks)

    def model(self, dilatancy: Floats) -> Any:
        """The rows; costs and bounds follow."""
        split, points = np.arange(self._split), np.arange(self._points)
        first = 1 + self._cones
        at = (
            np.concatenate([first + split, first + self._split + points]),
            np.concatenate([split, self._cones + points]),
        )
        p, q = (
            coo_array(
                (np.concatenate([np.full(self._split, sign), -dilatancy]), at),
                shape=(self.rows, self._split),
            )
            for sign in (-1.0, 1.0)
        )
        matrix = csc_array(hstack([self._velocity, p, q]))
        matrix.eliminate_zeros()
        lp = highspy.HighsLp()
        lp.num_col_, lp.num_row_ = self.columns, self.rows
        lp.col_cost_ = lp.col_lower_ = lp.col_upper_ = np.zeros(self.columns)
        lp.row_lower_ = lp.row_upper_ = np.zeros(self.rows)
        lp.a_matrix_.format_ = highspy.MatrixFormat.kColwise
        lp.a_matrix_.start_ = matrix.indptr.astype(np.int32)
        lp.a_matrix_.index_ = matrix.indices.astype(np.int32)
        lp.a_matrix_.value_ = matrix.data
        return lp

    def cost(self, contact: FrozenContact) -> Floats:
        """Dead load, stress bounds, friction bounds; none on what sticks."""
        bounds = [group.bound for group in self._program.groups]
        split = np.concatenate([*bounds, np.where(np.isinf(contact.bound), 0.0, contact.bound)])
        return np.concatenate([-self._program.dead_load, split, split])

    def column_bounds(self, contact: FrozenContact) -> tuple[Floats, Floats]:
        """U is free; p and q are not negative, and zero where a point sticks."""
        free = np.full(self._program.n, np.inf)
        split = np.where(np.isinf(contact.bound), 0.0, np.inf)
        split = np.concatenate([np.full(self._cones, np.inf), split])
        lower = np.concatenate([-free, np.zeros(2 * self._split)])
        return lower, np.concatenate([free, split, split])

    def row_bounds(self, contact: FrozenContact) -> tuple[Floats, Floats]:
        """Equalities, then openings."""
        equal = np.zeros(self.rows - self._points)
        equal[0] = 1.0
        opening = -self._program.contact.weights * contact.shift
        upper = np.full(self._points, np.inf)
        return np.concatenate([equal, opening]), np.concatenate([equal, upper])

    def point(self, x: Floats, y: Floats) -> ProgramState:
        """Velocity and duals in the signs of `ProgramState`."""
        program = self._program
        sizes = [group.weights.size for group in program.groups]
        ends = np.cumsum([1, *sizes, *sizes, self._points])
        alpha, *body, slip, opening = np.split(y, ends)
        mean, stress = body[: len(sizes)], body[len(sizes) :]
        return ProgramState(
            velocity=x[: program.n],
            load_factor=float(alpha[0]),
            stress=tuple(
                -part.reshape(-1, group.dim)
                for part, group in zip(stress, program.groups, strict=True)
            ),
            mean_stress=tuple(-part for part in mean),
            normal_reaction=opening,
            tangential_reaction=slip.reshape(-1, program.contact.tangent_dim),
        )
