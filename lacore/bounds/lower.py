"""Strict lower bounds by equilibrium elements (T25, T26b, T26c)."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from lacore.assembly.water import pore_pressures, total_stress
from lacore.bounds.constants import (
    COLLAPSE_TOLERANCE,
    GOOD_PER_TOLERANCE,
    GOOD_RESIDUAL,
    REDUCED_TO,
    REDUCTIONS,
)
from lacore.bounds.lending import with_lent_cohesion
from lacore.bounds.precision import exactness, smallest_angle
from lacore.bounds.static_model import StaticModel, static_model
from lacore.bounds.stresses.admissible import margins, weaker
from lacore.bounds.stresses.attempt import Attempt, attempt
from lacore.coupling.claims.proving import Ray, prove_claim
from lacore.limit.conversion import in_si, ray_in_si
from lacore.limit.tables.contact_table import traction_table
from lacore.model.bodies.continuum.regions.gathering import by_body, continuum_stress
from lacore.model.bodies.continuum.regions.lending import hardly_any, next_to_none
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats
from lacore.program.certificate import Certificate
from lacore.program.kinematic import KinematicProgram, associated_contact, dimensionless
from lacore.program.state import ProgramState
from lacore.reporting import views
from lacore.reporting.errors import typed
from lacore.reporting.findings import Finding, Severity
from lacore.reporting.kinds import Kind
from lacore.reporting.showing import Facts, Picture, counted
from lacore.reporting.status import Reported, Rigor, Status
from lacore.reporting.text import PYTHON, Quantity, number
from lacore.solvers.backend import (
    Prepare,
    check_capable,
    checked_answer,
    find_backend,
    nominal_tolerance,
    read_options,
)
from lacore.solvers.compilation import SolveClock, started
from lacore.solvers.inner.preparing import preparer, require_exact
from lacore.solvers.isolation import make_ready

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False)
class LowerBound(Reported):
    """A statically admissible state, and the load factor that it proves.

    Attributes:
        status: SOLVED where the state is admissible: in equilibrium, within yield and friction.
        load_factor: alpha of that state, no larger than that of the continuum; NaN unless SOLVED,
            or +inf where LOCKED.
        rigor: what the load factor proves.
        backend: name of the backend.
        certificate: recomputed residuals. Equilibrium (at most 1e-12, or the
            precision of coordinates far from the origin), yield and cone (0) prove the
            bound; gap, flow and those of the multipliers show how close it is to the best one of
            these elements. None if there is no state.
        history: one row per inner solve: margin of all strengths, solved and proven load factors,
            residuals before and after the projection, statuses, times.
        build_time: wall-clock time of assembly, s.
        solve_time: wall-clock time of everything after it except compilation, s.
        compile_time: see `LimitState`.
        options: given options of the backend.
        findings: further findings; `message` is their text.
        model: the assembled problem.
        point: multipliers of the free unknowns (m/s at ``F0.U = 1``), stresses and reactions (Pa);
            None if there is no state.
        ray: proof of LOCKED or UNSAFE in SI units, with its recomputed residuals; else None.
    """

    status: Status
    load_factor: float
    rigor: Rigor
    backend: str
    certificate: Certificate | None
    history: pd.DataFrame
    build_time: float
    solve_time: float
    options: Mapping[str, Any]
    findings: tuple[Finding, ...]
    model: StaticModel
    point: ProgramState | None
    ray: Ray | None = None
    compile_time: float = 0.0

    @property
    def lost(self) -> float:
        """Loss of the load factor when the solver's stresses are made admissible.

        It is NaN if either load factor is missing.
        """
        if not {"solved", "load_factor"} <= set(self.history):
            return np.nan
        last = self.history.iloc[-1]
        return float(last["solved"] - last["load_factor"])

    def _point(self) -> ProgramState:
        return self.required(self.point)

    def facts(self) -> Facts:
        """Return the proven load factor and its residuals, for printing."""
        told = {"status": self.report.summary_for(PYTHON)}
        if self.certificate is not None:
            told["residual"] = (
                f"equilibrium {self.certificate.equilibrium:.1e}, yield"
                f" {self.certificate.yield_violation:.1e}, cone {self.certificate.cone:.1e};"
                f" gap {self.certificate.gap:.1e}"
            )
        elif self.ray is not None:
            told["proof"] = str(self.ray)
        solves = counted(len(self.history), "solve")
        told["solved by"] = (
            f"{self.backend}: {solves} in {self.solve_time:.3g} s,"
            f" after {self.build_time:.3g} s of assembly"
        )
        told |= started(self.compile_time)
        told["size"] = self.model.contents
        lent = any(own.kind is Kind.LENT_COHESION for own in self.findings)
        lent &= self.rigor is Rigor.LOWER
        rigor = "strict lower bound with a lent cohesion" if lent else self.rigor.value
        return Facts(f"LowerBound: load factor {number(self.load_factor, '.7g')}, {rigor}", told)

    def picture(self) -> Picture:
        """Return the stresses of continua, or the problem if there are none."""
        if self.point is None or not self.model.continua:
            return Picture(self.model.problem.plot(), "the problem")
        return Picture(self.plot())

    def plot(self) -> Figure:
        """Plot the utilisation of the strength: see `lacore.pictures.mesh.plot_strength`."""
        return views.picture(self)

    def plot_section(self, point: Sequence[float], normal: Sequence[float]) -> Figure:
        """Plot it on a section: see `lacore.pictures.space.section.plot_strength_section`."""
        return views.section(self, point, normal)

    @property
    def stress(self) -> dict[str, Floats]:
        """Total stress (xx, yy, zz, xy) at the vertices of ``mesh.t``, shape (elements, 3, 4), Pa.

        It is given by body, linear in an element, tension positive. Body forces that vary in
        elements add quadratic stresses that are zero at the vertices: `StaticModel.bulging` (T86).
        """
        water = self.pore_pressure
        return {name: total_stress(own, water[name]) for name, own in self.effective_stress.items()}

    @property
    def effective_stress(self) -> dict[str, Floats]:
        """Effective part of `stress`, to which criteria apply (T64); without water all of it."""
        point, bodies = self._point(), self.model.continua
        stresses = by_body(bodies, point.stress)
        means = by_body(bodies, point.mean_stress)
        return {
            name: continuum_stress(dofs, own, mean)
            for (name, dofs, own), (*_, mean) in zip(stresses, means, strict=True)
        }

    @property
    def pore_pressure(self) -> dict[str, Floats]:
        """Pressure of the pore water at these vertices, by body, shape (elements, 3), Pa."""
        water = pore_pressures(self.model.problem, self._point().load_factor)
        return {name: water[name][own.body.mesh.t.T] for name, own in self.model.continua.items()}

    @property
    def reactions(self) -> pd.DataFrame:
        """Tractions on the slave at the ends of contact facets, linear between: see `LimitState`.

        ``length`` is the half of the facet of this end; in three dimensions ``area`` is the third
        of the face of this corner.
        """
        return traction_table(self.model.program.contact, self.model.points, self._point())


@typed(problem="give a lacore.Problem; that of a state is state.discretisation.problem")
def lower_bound(
    problem: Problem | StaticModel,
    backend: str = "auto",
    *,
    options: Mapping[str, Any] | None = None,
    throw: bool = False,
    lent_cohesion: float | None = None,
) -> LowerBound:
    """Compute a strict lower bound of the load factor, with the stresses that prove it.

    The solver's stresses are projected onto equilibrium (T26c) and made admissible: without dead
    loads by scaling them with the load factor; with dead loads or dilatant friction, which cannot
    be scaled, by solving with slightly reduced strengths.

    Args:
        problem: the problem, or its model where several backends share it. The velocity spaces of
            its bodies have no effect.
        backend: name of an exact backend.
        options: options of the backend.
        throw: raise `SolveError` unless the status is SOLVED.
        lent_cohesion: Pa, given to bodies without cohesion or without tension: the bound is then
            one of the problem with it.

    Raises:
        InputError: features without equilibrium elements, see `static_model`; unknown names.
        CapabilityError: the backend is missing, regularised, or does not support the problem.
        SolveError: see `throw`.

    Example:
        >>> bound = la.lower_bound(la.examples.footing())
        >>> bound.rigor.name, round(bound.load_factor, 2)  # exact: 2 + pi
        ('LOWER', 4.95)
    """
    read_options(require_exact(backend, "a lower bound"), options or {})
    begin = time.perf_counter()
    problem, notes = with_lent_cohesion(problem, lent_cohesion)
    model = problem if isinstance(problem, StaticModel) else static_model(problem)
    solved = _solved(model, 0.0, backend, options or {}, begin)
    settled = True
    for _ in range(REDUCTIONS if model.bulging.live else 0):
        if solved.status is not Status.SOLVED:
            break
        most = solved.load_factor * REDUCED_TO
        solved = _solved(model, most, backend, options or {}, begin)
        settled = min(most, 0.0) <= solved.load_factor <= max(most, 0.0)
        if settled:
            break
    settled = settled or solved.status is not Status.SOLVED
    return _bound(solved, backend, options or {}, settled, notes).checked(throw)


@dataclass(frozen=True)
class _Solved:
    """Result of solves with decreasing strengths, dimensionless.

    Attributes:
        model: model with strengths reduced by quadratic stresses.
        program: its program.
        attempts: one per margin.
        status: the proven status.
        refuted: why the solver's claim is not proven; None if it is, or if there is none.
        ray: proof of LOCKED or UNSAFE.
        times: times of assembly, of everything after it except compilation, and of compilation, s.
    """

    model: StaticModel
    program: KinematicProgram
    attempts: tuple[Attempt, ...]
    status: Status
    refuted: Finding | None
    ray: Ray | None
    times: tuple[float, float, float]

    @property
    def load_factor(self) -> float:
        """Load factor in SI units; NaN if none is proven, +inf if the load is locked."""
        state = self.attempts[-1].state
        if self.status is Status.SOLVED and state is not None:
            return float(state.load_factor * self.program.scales.load_factor)
        return np.inf if self.status is Status.LOCKED else np.nan


def _solved(
    model: StaticModel,
    most: float,
    backend: str,
    options: Mapping[str, Any],
    begin: float,
) -> _Solved:
    """Solve with strengths reduced by quadratic stresses up to a load factor."""
    engine = find_backend(backend)
    engine_options = read_options(engine, options)
    if model.bulging.any:
        model = model.weakened(most)
    program = dimensionless(model.program, model.natural)
    check_capable(engine, program)
    build_time, clock = time.perf_counter() - begin, SolveClock()
    make_ready(engine)
    exact = exactness(dofs.body for dofs in model.continua.values())
    tolerance = nominal_tolerance(engine, engine_options)
    prepare = preparer(
        engine, engine_options, good=max(GOOD_RESIDUAL, GOOD_PER_TOLERANCE * tolerance)
    )
    attempts = _attempts(program, prepare, tolerance, exact)
    last, refuted, ray = attempts[-1], None, None
    status = Status.SOLVED if last.proves else Status.NOT_CERTIFIED
    if last.state is None:
        laws = associated_contact(program.contact)
        status, refuted, ray = prove_claim(
            last.inner.status, program, laws, laws, prepare, COLLAPSE_TOLERANCE
        )
    times = build_time, clock.seconds, clock.compile_time
    return _Solved(model, program, attempts, status, refuted, ray, times)


def _attempts(
    program: KinematicProgram, prepare: Prepare, tolerance: float, exact: float
) -> tuple[Attempt, ...]:
    """Reduce all strengths step by step, until the stresses are admissible or there are none."""
    attempts, tried = list[Attempt](), margins(program, tolerance)
    for margin in tried:
        if attempts and margin < min(attempts[-1].lacks, tried[-1]):
            continue  # It would lack as much again.
        less = weaker(program, margin)
        with closing(prepare(less)) as solver:
            answer = solver.solve(associated_contact(less.contact))
        answer = checked_answer(less, False, answer)
        attempts.append(attempt(program, less, margin, answer, exact))
        if attempts[-1].proves or attempts[-1].state is None:
            break
    return tuple(attempts)


def _bound(
    solved: _Solved,
    backend: str,
    options: Mapping[str, Any],
    settled: bool,
    notes: tuple[Finding, ...],
) -> LowerBound:
    """Return the result as a bound of the problem, in SI units.

    Args:
        solved: the last solve.
        backend, options: backend of the solve.
        settled: whether the strengths suffice for the load factor that was found.
        notes: what else there is to report.
    """
    model, last, scales = solved.model, solved.attempts[-1], solved.program.scales
    status = solved.status if settled else Status.NOT_CERTIFIED
    rigor, ray = Rigor.NOT_CERTIFIED, None
    if status is Status.SOLVED and last.state is not None:
        exact = all(dofs.body.geometry == "exact" for dofs in model.continua.values())
        rigor = Rigor.LOWER if exact else Rigor.DISCRETE
    findings = tuple(_findings(model, status, rigor, last))
    if solved.refuted:
        findings = (solved.refuted,)
    if not settled:
        findings = (Finding(Kind.FORCES_NOT_SETTLED, severity=Severity.REASON),)
    if solved.ray is not None:
        ray = ray_in_si(scales, solved.ray, in_si(scales, solved.ray.point))
    build_time, solve_time, compile_time = solved.times
    return LowerBound(
        status=status,
        load_factor=solved.load_factor if settled else np.nan,
        rigor=rigor,
        backend=backend,
        certificate=last.after,
        history=pd.DataFrame([attempt.row(scales.load_factor) for attempt in solved.attempts]),
        build_time=build_time,
        solve_time=solve_time,
        compile_time=compile_time,
        options=dict(options),
        findings=(*findings, *notes),
        model=model,
        point=None if last.state is None else in_si(scales, last.state),
        ray=ray,
    )


def _findings(model: StaticModel, status: Status, rigor: Rigor, last: Attempt) -> Iterator[Finding]:
    """Yield findings on what the last attempt proves, or lacks."""
    reason, after = Severity.REASON, last.after
    if status is Status.UNSAFE:
        yield Finding(Kind.NO_STRESSES, severity=reason)
    elif status is Status.NOT_CERTIFIED and after is not None:
        lacks = {"equilibrium": after.equilibrium, "beyond": after.yield_violation}
        yield Finding(Kind.STRESSES_NOT_ADMISSIBLE, (), lacks, reason)
        yield from _fixes(model)
    elif status is Status.SOLVED and after is not None:
        values = {"gap": after.gap, "native": last.inner.native_status}
        yield Finding(Kind.ADMISSIBLE_STRESSES, (), values, reason)
        if rigor is Rigor.DISCRETE:
            yield Finding(Kind.POLYGON, severity=Severity.WARNING)
    if last.inner.message:
        yield Finding(Kind.BACKEND, values={"text": last.inner.message})


def _fixes(model: StaticModel) -> Iterator[Finding]:
    """Yield advice on stresses that are still not admissible."""
    dead, bodies = model.full.dead_load, {name: own.body for name, own in model.continua.items()}
    weak = {name: own for name, body in bodies.items() if (own := hardly_any(body, dead))}
    for name, own in weak.items():  # Neither a tolerance nor a mesh gives them more strength.
        lent = next_to_none(bodies[name], dead)
        values = {"strength": Quantity(own, "Pa", ".1e"), "lent": Quantity(lent, "Pa", ".1e")}
        yield Finding(Kind.STRENGTH_TOO_SMALL, (name,), values, Severity.REASON)
    if not weak:
        angle = min(map(smallest_angle, bodies.values()))
        yield Finding(Kind.COARSE_TOLERANCE, (), {"angle": angle}, Severity.REASON)
