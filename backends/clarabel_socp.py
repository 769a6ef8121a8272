"""Clarabel on the exact conic form of the kinematic program (T34, T35); no modelling layer.

Variables (U, t, tau): one t a plasticity cone, one tau a friction cone. Rows are multiplied by
their integration weight, so that costs are stress bounds and duals are stresses.
"""

import time
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import clarabel
import numpy as np
from scipy.sparse import csc_matrix, csr_matrix, diags_array, vstack

from lacore.arrays import Bools, Floats, Sparse
from lacore.backend import Capabilities, InnerSolution
from lacore.errors import require_count, require_positive
from lacore.program import FrozenContact, KinematicProgram, interleaved
from lacore.state import ProgramState
from lacore.status import Status

STATUS_MAP = {
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
_DEFINITE = {"Solved", "PrimalInfeasible", "DualInfeasible"}  # nothing to gain from another try


@dataclass(frozen=True)
class ClarabelOptions:
    """Options of the `clarabel` backend.

    Attributes:
        tolerance: relative tolerance on gap and feasibility.
        max_iterations: of the interior-point method.
        time_limit: s, one inner solve.
    """

    tolerance: float = 1e-10
    max_iterations: int = 200
    time_limit: float = 3600.0

    def __post_init__(self) -> None:
        require_positive("clarabel.tolerance", self.tolerance)
        require_count("clarabel.max_iterations", self.max_iterations)
        require_positive("clarabel.time_limit", self.time_limit)


class Clarabel:
    """The exact reference: interior-point method for second-order cone programs."""

    name: ClassVar[str] = "clarabel"
    title: ClassVar[str] = "Clarabel, exact second-order cone program"
    source: ClassVar[str] = "Goulart & Chen, Clarabel: an interior-point solver, 2024"
    capabilities: ClassVar[Capabilities] = Capabilities(regularised=False)
    statuses: ClassVar[Mapping[Any, Status]] = STATUS_MAP
    Options: ClassVar[type] = ClarabelOptions

    def unavailable(self) -> str:
        """Always there once imported."""
        return ""

    def version(self) -> str:
        """The solver and its version."""
        return f"Clarabel {clarabel.__version__}"

    def prepare(self, program: KinematicProgram, options: ClarabelOptions) -> "ClarabelSolver":
        """Keep the parts of the conic form that no frozen contact changes."""
        return ClarabelSolver(program, options)


@dataclass(frozen=True)
class _Pattern:
    """Which contact points need which rows; the solver is rebuilt only when it changes."""

    friction: Bools  # cost g ||u_t||
    stick: Bools  # u_t = 0
    dilatancy: tuple[float, ...]

    def same(self, other: "_Pattern | None") -> bool:
        return (
            other is not None
            and np.array_equal(self.friction, other.friction)
            and np.array_equal(self.stick, other.stick)
            and self.dilatancy == other.dilatancy
        )


class ClarabelSolver:
    """Clarabel at work on one program."""

    def __init__(self, program: KinematicProgram, options: ClarabelOptions) -> None:
        self._program, self._options = program, options
        self._pattern: _Pattern | None = None
        self._solver: Any = None
        self._conic: _ConicForm | None = None

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve; a change of friction bounds alone updates the cost vector in place."""
        begin = time.perf_counter()
        pattern = _Pattern(
            friction=np.isfinite(contact.bound) & (contact.bound > 0),
            stick=np.isinf(contact.bound),
            dilatancy=tuple(contact.dilatancy),
        )
        if not pattern.same(self._pattern) or self._conic is None:
            self._conic = _ConicForm(self._program, contact, pattern)
            self._pattern = pattern
            self._solver = None
        cost, offset = self._conic.cost(contact), self._conic.offset(contact)
        if self._solver is None:
            self._solver = self._start(cost, offset, careful=False)
        else:
            self._solver.update(q=cost, b=offset)
        answer = self._solver.solve()
        if str(answer.status) not in _DEFINITE:
            self._solver = self._start(cost, offset, careful=True)
            answer = self._solver.solve()
            self._solver = None
        native = str(answer.status)
        status = STATUS_MAP[native]
        return InnerSolution(
            status=status,
            native_status=native,
            iterations=int(answer.iterations),
            solve_time=time.perf_counter() - begin,
            point=self._conic.point(np.array(answer.x), np.array(answer.z), contact)
            if status.has_point
            else None,
        )

    def close(self) -> None:
        """Nothing is held."""

    def _start(self, cost: Floats, offset: Floats, careful: bool) -> Any:
        """A solver for the current form: fast first; where that fails, careful.

        Measured on punches, platens and infeasible programs: static regularisation 1e-7 solves
        graded meshes that 1e-8 does not; infeasible programs are recognised reliably only without
        equilibration, which costs feasible ones a digit.
        """
        assert self._conic is not None
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.max_threads = 1
        settings.direct_solve_method = "qdldl"
        settings.presolve_enable = False
        settings.chordal_decomposition_enable = False
        settings.static_regularization_constant = 1e-7
        settings.iterative_refinement_enable = careful
        settings.equilibrate_enable = not careful
        settings.max_iter = self._options.max_iterations
        settings.time_limit = self._options.time_limit
        settings.tol_gap_abs = settings.tol_gap_rel = self._options.tolerance
        settings.tol_feas = self._options.tolerance
        form = self._conic
        none = csc_matrix((cost.size, cost.size))
        return clarabel.DefaultSolver(none, cost, form.matrix, offset, form.cones, settings)


class _ConicForm:
    """``minimise q.x  subject to  A x + s = b, s in cones`` for one pattern of contact rows."""

    def __init__(
        self, program: KinematicProgram, contact: FrozenContact, pattern: _Pattern
    ) -> None:
        self._program, self._pattern = program, pattern
        rows, weights = program.contact, program.contact.weights
        tangential = _weighted(rows.tangential, weights, rows.tangent_dim)
        normal = _weighted(rows.normal, weights, 1)
        self._dilatant = contact.dilatancy > 0
        plain = ~self._dilatant
        self._tau = int(pattern.friction.sum())
        self._t = [group.weights.size for group in program.groups]
        self._columns = program.n + sum(self._t) + self._tau

        blocks: list[Sparse] = [csr_matrix(program.reference_load[None, :])]
        blocks += [_weighted(group.volumetric, group.weights, 1) for group in program.groups]
        blocks += [_take(tangential, pattern.stick, rows.tangent_dim)]
        zero = sum(block.shape[0] for block in blocks)
        blocks += [-normal[plain]]
        self.cones = [
            clarabel.ZeroConeT(zero),
            *([clarabel.NonnegativeConeT(int(plain.sum()))] if plain.any() else []),
        ]
        blocks = [self._widened(block) for block in blocks]
        dilated = csr_matrix(
            diags_array(np.repeat(contact.dilatancy, rows.tangent_dim)) @ tangential
        )
        blocks.append(
            self._widened(
                -interleaved(
                    normal[self._dilatant],
                    1,
                    _take(dilated, self._dilatant, rows.tangent_dim),
                    rows.tangent_dim,
                )
            )
        )
        self.cones += [clarabel.SecondOrderConeT(1 + rows.tangent_dim)] * int(self._dilatant.sum())
        first = program.n
        for group in program.groups:
            velocity = _weighted(group.rows, group.weights, group.dim)
            blocks.append(self._cone_block(velocity, first, group.dim))
            self.cones += [clarabel.SecondOrderConeT(1 + group.dim)] * group.weights.size
            first += group.weights.size
        blocks.append(
            self._cone_block(
                _take(tangential, pattern.friction, rows.tangent_dim), first, rows.tangent_dim
            )
        )
        self.cones += [clarabel.SecondOrderConeT(1 + rows.tangent_dim)] * self._tau
        self._sizes = [block.shape[0] for block in blocks]
        self.matrix = csc_matrix(vstack(blocks, format="csc"))

    def _widened(self, rows: Sparse) -> Sparse:
        return csr_matrix((rows.data, rows.indices, rows.indptr), (rows.shape[0], self._columns))

    def _cone_block(self, rows: Sparse, first: int, dim: int) -> Sparse:
        """``-(t_g, rows_g U)`` by cone, t_g in column first + g."""
        count = rows.shape[0] // dim
        bound = csr_matrix(
            (np.ones(count), (np.arange(count), first + np.arange(count))), (count, self._columns)
        )
        return -interleaved(bound, 1, self._widened(rows), dim)

    def cost(self, contact: FrozenContact) -> Floats:
        """q: dead load, stress bounds, friction bounds."""
        bounds = [group.bound for group in self._program.groups]
        return np.concatenate(
            [-self._program.dead_load, *bounds, contact.bound[self._pattern.friction]]
        )

    def offset(self, contact: FrozenContact) -> Floats:
        """b: ``F0.U = 1`` and the shifts of the contact rows."""
        b = np.zeros(self.matrix.shape[0])
        b[0] = 1.0
        shift = self._program.contact.weights * contact.shift
        width = 1 + self._program.contact.tangent_dim
        nonnegative = self._first_contact_row()
        plain = int((~self._dilatant).sum())
        b[nonnegative : nonnegative + plain] = shift[~self._dilatant]
        dilatant = b[nonnegative + plain :][: width * int(self._dilatant.sum())]
        dilatant[::width] = shift[self._dilatant]
        return b

    def _first_contact_row(self) -> int:
        return sum(self._sizes[: 2 + len(self._program.groups)])

    def point(self, x: Floats, z: Floats, contact: FrozenContact) -> ProgramState:
        """Velocity and duals in the signs of `ProgramState` (T35)."""
        program, pattern = self._program, self._pattern
        parts = np.split(z, np.cumsum(self._sizes)[:-1])
        groups, width = len(program.groups), 1 + program.contact.tangent_dim
        stick, plain, dilatant = parts[1 + groups : 4 + groups]
        normal = np.zeros(program.contact.count)
        tangential = np.zeros((program.contact.count, program.contact.tangent_dim))
        normal[~self._dilatant] = plain
        cones = dilatant.reshape(-1, width)
        normal[self._dilatant] = cones[:, 0]
        tangential[self._dilatant] = contact.dilatancy[self._dilatant, None] * cones[:, 1:]
        tangential[pattern.stick] -= stick.reshape(-1, width - 1)
        tangential[pattern.friction] += parts[-1].reshape(-1, width)[:, 1:]
        return ProgramState(
            velocity=x[: program.n],
            load_factor=float(-z[0]),
            stress=tuple(
                -part.reshape(-1, 1 + group.dim)[:, 1:]
                for group, part in zip(program.groups, parts[4 + groups : -1], strict=True)
            ),
            mean_stress=tuple(parts[1 : 1 + groups]),
            normal_reaction=normal,
            tangential_reaction=tangential,
        )


def _weighted(rows: Sparse, weights: Floats, dim: int) -> Sparse:
    return csr_matrix(diags_array(np.repeat(weights, dim)) @ rows)


def _take(rows: Sparse, mask: Bools, dim: int) -> Sparse:
    return csr_matrix(rows[np.repeat(mask, dim)])
