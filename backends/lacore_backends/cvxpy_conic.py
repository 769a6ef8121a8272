"""Kinematic program (T6) written in cvxpy, for an independent check with any of its solvers.

minimise   sum_g bound_g ||e_g|| + sum_j g_j ||v_j|| - Fd.U
subject to F0.U = 1            dual: -load factor
           w D U = e           dual: stress
           w theta U = 0       dual: mean stress
           w T U = v           dual: -tangential reaction
           w N U = o           dual: -normal reaction
           o + w s >= d ||v||,  and v = 0 where g = inf

Strains e, slips v and openings o are separate variables, weighted by w as in (T34), so that every
stress and reaction is the dual of an equality, whatever cones a solver uses for the norms.
"""

import time
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from typing import Any, ClassVar

import cvxpy as cp
import numpy as np
from cvxpy.reductions.solvers.defines import SOLVER_MAP_CONIC, SOLVER_MAP_QP
from scipy.sparse import diags_array

from lacore.numerics.arrays import Bools, Floats, Sparse
from lacore.program import FrozenContact, KinematicProgram
from lacore.program.state import ProgramState
from lacore.program.surfaces import Surfaces
from lacore.reporting.status import Status
from lacore.solvers.backend import Capabilities, InnerSolution
from lacore_backends._cvxpy_solvers import (
    SOLVERS,
    OwnDefaults,
    Solver,
    known_solver,
    no_mosek_licence,
)

STATUS_MAP = {
    cp.OPTIMAL: Status.SOLVED,
    cp.OPTIMAL_INACCURATE: Status.ALMOST_SOLVED,
    cp.INFEASIBLE: Status.LOCKED,
    cp.INFEASIBLE_INACCURATE: Status.FAILED,
    cp.UNBOUNDED: Status.UNSAFE,
    cp.UNBOUNDED_INACCURATE: Status.FAILED,
    cp.settings.INFEASIBLE_OR_UNBOUNDED: Status.FAILED,  # solved again without costs to decide
    cp.USER_LIMIT: Status.ITERATION_LIMIT,  # or TIME_LIMIT, by the clock
    cp.SOLVER_ERROR: Status.FAILED,
}
_LIMITED = {cp.USER_LIMIT, cp.OPTIMAL_INACCURATE, cp.INFEASIBLE_INACCURATE, cp.UNBOUNDED_INACCURATE}


@cache
def installed() -> frozenset[str]:
    """Return the solvers that cvxpy finds, cached because cvxpy tries to import each of them."""
    return frozenset(cp.installed_solvers())


@dataclass(frozen=True)
class Cvxpy:
    """Backend with a readable model, for any solver of cvxpy as ``cvxpy:SOLVER``."""

    solver: str = "CLARABEL"
    name: str = "cvxpy"
    source: ClassVar[str] = "Diamond & Boyd, CVXPY: a modeling language, JMLR 17, 2016"
    statuses: ClassVar[Mapping[Any, Status]] = STATUS_MAP

    @property
    def title(self) -> str:
        """A line for tables."""
        return f"cvxpy with {self.solver}, exact program"

    @property
    def known(self) -> Solver:
        """Known properties of the solver."""
        return known_solver(self.solver)

    @property
    def capabilities(self) -> Capabilities:
        """Solvers without second-order cones take linear programs."""
        conic = SOLVER_MAP_CONIC.get(self.solver)
        cones = conic is not None and cp.SOC in conic.SUPPORTED_CONSTRAINTS
        return Capabilities(
            regularised=False,
            max_cone=None if cones else 1,
            hardening=self.known.quadratic,
            surfaces=cones,
            warm_start=self.known.warm_start,
            infeasibility=self.known.infeasibility,
            isolated=not self.known.time,
            packages=("cvxpy", self.known.package),
        )

    @property
    def Options(self) -> type:  # noqa: N802  # it is a class
        """Class of the options, by the kind of solver."""
        return self.known.options

    def variants(self) -> Sequence[str]:
        """Return the known and the installed solvers; `unavailable` of each tells if it can run."""
        others = installed() & {*SOLVER_MAP_CONIC, *SOLVER_MAP_QP}
        return sorted(others | set(SOLVERS))

    def variant(self, name: str) -> "Cvxpy":
        """Return the backend of one solver."""
        return Cvxpy(name, f"cvxpy:{name}")

    def unavailable(self) -> str:
        """Return why the solver cannot run: not installed, or no licence."""
        if self.solver not in installed():
            return f"{self.solver} is not installed: pip install {self.known.package}"
        return no_mosek_licence() if self.solver == "MOSEK" else ""

    def version(self) -> str:
        """Return the versions of cvxpy and of the solver."""
        try:
            number = version(self.known.package)
        except PackageNotFoundError:
            number = "of unknown version"
        return f"cvxpy {cp.__version__}, {self.solver} {number}"

    def prepare(self, program: KinematicProgram, options: OwnDefaults) -> "CvxpySolver":
        """Return a solver; the model is built when the contact is known."""
        return CvxpySolver(program, self, options)


class _Model:
    """Program for one pattern of contact points; friction bounds and shifts are parameters."""

    def __init__(self, program: KinematicProgram, contact: FrozenContact) -> None:
        self._program, points = program, program.contact
        self._u = u = cp.Variable(program.n)
        self._power = program.reference_load @ u == 1
        cost, laws = -program.dead_load @ u, [self._power]

        self._flow: list[Any] = []
        self._volume: list[Any] = []
        for group in program.groups:
            rates, theta = _weighted(group.rows, group.weights), group.volumetric
            e = cp.Variable((group.weights.size, group.dim)) if rates.shape[0] else None
            self._flow.append(None if e is None else rates @ u == cp.vec(e, order="C"))
            volume = _weighted(theta, group.volume_weights) @ u
            if e is not None and group.modulus is not None:  # e is a length times a weight.
                cost += (group.modulus / group.weights) @ cp.sum(cp.square(e), axis=1) / 2
            if group.surfaces is not None:
                lead, spread, cost_of = _multiplied(group.surfaces)
                laws += [lead >= _lengths(e)] if e is not None else []
                self._volume.append(
                    volume == spread + group.volume_weights * group.surfaces.besides
                )
                cost += cost_of
                continue
            self._volume.append(volume == 0 if theta.nnz else None)
            cost += 0 if e is None else group.bound @ _lengths(e)

        self.stick, self.rub = _kinds(contact)
        self.dilatancy = contact.dilatancy
        self._bound = cp.Parameter(int(self.rub.sum()), nonneg=True)
        self._shift = cp.Parameter(points.count)
        self._slip = self._opening = None
        if points.count:
            v, o = cp.Variable((points.count, points.tangent_dim)), cp.Variable(points.count)
            self._slip = _weighted(points.tangential, points.weights) @ u == cp.vec(v, order="C")
            self._opening = _weighted(points.normal, points.weights) @ u == o
            gap, rub = o + cp.multiply(points.weights, self._shift), self.rub
            laws += [v[self.stick] == 0] if self.stick.any() else []
            laws += [gap[~rub] >= 0] if not rub.all() else []
            if rub.any():
                lengths = _lengths(v[rub])
                cost += self._bound @ lengths
                laws.append(gap[rub] >= cp.multiply(contact.dilatancy[rub], lengths))
        duals = [*self._flow, *self._volume, self._slip, self._opening]
        laws += [law for law in duals if law is not None]
        self.problem = cp.Problem(cp.Minimize(cost), laws)
        self.feasibility = cp.Problem(cp.Minimize(0), laws)

    def fits(self, contact: FrozenContact) -> bool:
        """Return whether a contact has the rows that this model was built with."""
        now, then = [*_kinds(contact), contact.dilatancy], [self.stick, self.rub, self.dilatancy]
        return all(map(np.array_equal, now, then))

    def freeze(self, contact: FrozenContact) -> None:
        """Put in the numbers of a contact that fits."""
        self._bound.value = contact.bound[self.rub]
        self._shift.value = contact.shift

    def point(self) -> ProgramState | None:
        """Return velocity and duals with the signs of `ProgramState`; None if there are none."""
        if self._u.value is None or self._power.dual_value is None:
            return None
        groups, contact = self._program.groups, self._program.contact
        flow = zip(self._flow, groups, strict=True)
        volume = zip(self._volume, groups, strict=True)
        return ProgramState(
            velocity=self._u.value,
            load_factor=-float(self._power.dual_value),
            stress=tuple(_dual(law, (group.weights.size, group.dim)) for law, group in flow),
            mean_stress=tuple(_dual(law, (group.volumetric.shape[0],)) for law, group in volume),
            normal_reaction=-_dual(self._opening, (contact.count,)),
            tangential_reaction=-_dual(self._slip, (contact.count, contact.tangent_dim)),
        )


class CvxpySolver:
    """cvxpy for one program."""

    def __init__(self, program: KinematicProgram, backend: Cvxpy, options: Any) -> None:
        self._program, self._options, self._solver = program, options, backend.solver
        self._settings = backend.known.settings(options)
        self._warm_start = backend.known.warm_start
        self._model: _Model | None = None

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Solve; a change of friction bounds or shifts alone builds no model."""
        begin = time.perf_counter()
        if self._model is None or not self._model.fits(contact):
            self._model = _Model(self._program, contact)
        model = self._model
        model.freeze(contact)
        word, iterations, message = self._run(model.problem)
        status, late = STATUS_MAP[word], time.perf_counter() - begin >= self._options.time_limit
        if word == cp.settings.INFEASIBLE_OR_UNBOUNDED:
            feasible = self._run(model.feasibility)[0]
            status = {cp.OPTIMAL: Status.UNSAFE, cp.INFEASIBLE: Status.LOCKED}.get(feasible, status)
        elif word in _LIMITED and late:
            status = Status.TIME_LIMIT
        elif word in _LIMITED and iterations >= getattr(self._options, "max_iterations", np.inf):
            status = Status.ITERATION_LIMIT
        return InnerSolution(
            status=status,
            native_status=word,
            iterations=iterations,
            solve_time=time.perf_counter() - begin,
            point=model.point() if status.has_point else None,
            message=message,
        )

    def close(self) -> None:
        """Do nothing: no resources are held."""

    def _run(self, problem: Any) -> tuple[str, int, str]:
        """Return the status of cvxpy, the iterations, and the message of a solver that failed."""
        try:
            with warnings.catch_warnings():
                # The status already states that a solution is inaccurate.
                warnings.simplefilter("ignore")
                problem.solve(solver=self._solver, warm_start=self._warm_start, **self._settings)
        # Solvers raise many kinds of exceptions in addition to SolverError.
        except Exception as error:
            return cp.SOLVER_ERROR, 0, f"{type(error).__name__}: {error}"
        return str(problem.status), int(problem.solver_stats.num_iters or 0), ""


def _kinds(contact: FrozenContact) -> tuple[Bools, Bools]:
    """Return the points that stick, and those whose slip has a cost or opens the contact.

    The norm of any other slip would be unbounded, which interior-point methods do not handle well.
    """
    stick = np.isinf(contact.bound)
    return stick, ~stick & ((contact.bound > 0) | (contact.dilatancy > 0))


def _lengths(rows: Any) -> Any:
    """Return the norm of each row; that of a single column is not a second-order cone."""
    return cp.abs(rows[:, 0]) if rows.shape[1] == 1 else cp.norm(rows, axis=1)


def _multiplied(surfaces: Surfaces) -> tuple[Any, Any, Any]:
    """Return the bounds of the norms, volumetric rates and cost of weighted multipliers (T39)."""
    lam = cp.Variable(surfaces.strength.shape, nonneg=True)
    rates = [
        cp.sum(cp.multiply(surfaces.slope[:, :, row], lam), axis=1)
        for row in range(surfaces.volumes)
    ]
    spread = cp.vec(cp.vstack(rates), order="F")
    return lam @ surfaces.normed, spread, cp.sum(cp.multiply(surfaces.strength, lam))


def _weighted(rows: Sparse, weights: Floats) -> Any:
    return diags_array(np.repeat(weights, rows.shape[0] // max(weights.size, 1))) @ rows


def _dual(law: Any, shape: tuple[int, ...]) -> Floats:
    """Return the dual of an equality by point; zero if it was left out."""
    return np.zeros(shape) if law is None else np.reshape(law.dual_value, shape)
