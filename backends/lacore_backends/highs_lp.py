"""HiGHS for programs with cones of one row: rigid blocks and plane frames, an LP."""

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar

import highspy
import numpy as np

from lacore.program import FrozenContact, KinematicProgram
from lacore.reporting.errors import InputError, require_count, require_known, require_positive
from lacore.reporting.status import Status
from lacore.solvers.backend import Capabilities, InnerSolution, Writer
from lacore_backends._instances import heading
from lacore_backends._linear_form import LinearForm

STATUS_MAP = {
    "kOptimal": Status.SOLVED,
    "kInfeasible": Status.LOCKED,
    "kUnbounded": Status.UNSAFE,
    "kUnboundedOrInfeasible": Status.FAILED,  # solved again without presolve to decide
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
_KEPT = 2  # number of models kept: a coupling loop alternates between bounds and shifts (T12)


@dataclass(frozen=True)
class HighsOptions:
    """Options of the `highs` backend.

    Attributes:
        tolerance: absolute tolerance of the rows and of the reduced costs, at least 1e-10.
        solver: ``simplex``, which starts from the vertex of the solve before, or ``ipm``, an
            interior point followed by a crossover to a vertex.
        max_iterations: limit of the simplex method, or of the interior-point method.
        time_limit: s, limit for one inner solve.
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


def write_mps(program: KinematicProgram, contact: FrozenContact, path: Path) -> None:
    """Write the linear program of `lacore_backends._linear_form` in free MPS, velocities first.

    Raises:
        OSError: HiGHS could not write the file.
    """
    form, model = LinearForm(program, contact), highspy.Highs()
    model.setOptionValue("output_flag", False)
    columns, rows = form.column_bounds(contact), form.row_bounds(contact)
    lp = _model(form)
    lp.col_cost_ = form.cost(contact)
    (lp.col_lower_, lp.col_upper_), (lp.row_lower_, lp.row_upper_) = columns, rows
    model.passModel(lp)
    if model.writeModel(str(path)) == highspy.HighsStatus.kError:
        raise OSError(f"{path}: HiGHS could not write it")
    path.write_text(heading("*", program) + path.read_text(encoding="ascii"), encoding="ascii")


class Highs:
    """Backend for vertex solutions of linear programs, exact to round-off."""

    name: ClassVar[str] = "highs"
    title: ClassVar[str] = "HiGHS, exact linear program (blocks and frames in the plane)"
    source: ClassVar[str] = "Huangfu & Hall, Parallelizing the dual revised simplex method, 2018"
    capabilities: ClassVar[Capabilities] = Capabilities(
        regularised=False, max_cone=1, warm_start=True, packages=("highspy",)
    )
    statuses: ClassVar[Mapping[Any, Status]] = STATUS_MAP
    Options: ClassVar[type] = HighsOptions
    writers: ClassVar[Mapping[str, Writer]] = {"mps": write_mps}

    def unavailable(self) -> str:
        """Return an empty reason: the solver is installed."""
        return ""

    def version(self) -> str:
        """Return the name and version of the solver."""
        return f"HiGHS {highspy.Highs().version()}"

    def prepare(self, program: KinematicProgram, options: HighsOptions) -> "HighsSolver":
        """Return a solver; the rows depend on which points are dilatant."""
        return HighsSolver(program, options)


class HighsSolver:
    """HiGHS for one program."""

    def __init__(self, program: KinematicProgram, options: HighsOptions) -> None:
        self._program, self._options = program, options
        self._models: list[_Model] = []  # The last one used comes last.

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve from the last vertex of the same rows."""
        begin = time.perf_counter()
        answer = self._model(contact).solve(contact)
        return replace(answer, solve_time=time.perf_counter() - begin)

    def _model(self, contact: FrozenContact) -> "_Model":
        """Return the model for a contact: one of the last, or a new one in place of the oldest.

        A coupling loop alternates between bounds and shifts (T12): each starts from the last vertex
        of its own kind. If only the dilatancy changes, the rows are passed again with the basis.
        """
        form = LinearForm(self._program, contact)
        known = [model for model in self._models if model.alike(form)]
        if not known:
            for model in self._models[: 1 - _KEPT]:
                model.close()
            self._models = self._models[1 - _KEPT :]
            known = [_Model(self._options)]
        model = known[0]
        model.take(form)
        self._models = [other for other in self._models if other is not model] + [model]
        return model

    def close(self) -> None:
        """Drop the models."""
        for model in self._models:
            model.close()


class _Model:
    """HiGHS with one set of rows, and the last vertex."""

    def __init__(self, options: HighsOptions) -> None:
        self._options = options
        self._form: LinearForm | None = None
        self._highs = highspy.Highs()
        for name, value in {
            "output_flag": False,
            "solver": options.solver,
            "primal_feasibility_tolerance": options.tolerance,
            "dual_feasibility_tolerance": options.tolerance,
            "ipm_optimality_tolerance": options.tolerance,
            "simplex_iteration_limit": options.max_iterations,
            "ipm_iteration_limit": options.max_iterations,
            "small_matrix_value": 1e-12,  # Smaller entries, from tiny weights, would be dropped.
        }.items():
            self._highs.setOptionValue(name, value)

    def alike(self, form: LinearForm) -> bool:
        """Return whether rows and columns have the same meaning, so that the last vertex fits."""
        return self._form is not None and np.array_equal(self._form.split, form.split)

    def take(self, form: LinearForm) -> None:
        """Pass the rows unless they are present; a model that is alike keeps its vertex."""
        if self._form is not None and np.array_equal(self._form.dilatancy, form.dilatancy):
            return
        basis = self._highs.getBasis()
        self._highs.passModel(_model(form))
        if self._form is not None and basis.valid:
            self._highs.setBasis(basis)
        self._form = form

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve from the last vertex."""
        highs, form = self._highs, self._form
        assert form is not None
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
            highs.clearSolver()  # There is no vertex to start from.
        return InnerSolution(
            status=status,
            native_status=native,
            iterations=max(info.simplex_iteration_count, 0) + max(info.ipm_iteration_count, 0),
            solve_time=0.0,
            point=point,
        )

    def _run(self) -> str:
        # The clock of HiGHS continues from solve to solve.
        self._highs.setOptionValue(
            "time_limit", self._highs.getRunTime() + self._options.time_limit
        )
        self._highs.run()
        return str(self._highs.getModelStatus().name)

    def close(self) -> None:
        """Drop the model."""
        self._highs.clear()


def _model(form: LinearForm) -> Any:
    """Return the rows of a form for HiGHS; costs and bounds follow."""
    matrix = form.matrix()
    lp = highspy.HighsLp()
    lp.num_col_, lp.num_row_ = form.columns, form.rows
    lp.col_cost_ = lp.col_lower_ = lp.col_upper_ = np.zeros(form.columns)
    lp.row_lower_ = lp.row_upper_ = np.zeros(form.rows)
    lp.a_matrix_.format_ = highspy.MatrixFormat.kColwise
    lp.a_matrix_.start_ = matrix.indptr.astype(np.int32)
    lp.a_matrix_.index_ = matrix.indices.astype(np.int32)
    lp.a_matrix_.value_ = matrix.data
    return lp
