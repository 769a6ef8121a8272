"""`coulomb_range`: the lowest and the highest Coulomb load factor that can be certified (T14b)."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd

from lacore.assembly.discretisation import Discretisation
from lacore.assembly.discretise import discretise
from lacore.backend import read_options
from lacore.claims.judged import Ray
from lacore.coupling.deadline import OutOfTime, until
from lacore.coupling.kinds import CERTIFIED
from lacore.coupling.run import Coupled
from lacore.coupling.search import HIGH, LOW, CertifiedMechanism, Search, coulomb_bounds
from lacore.errors import InputError, require_positive, require_whole, typed
from lacore.inner.preparing import preparing, require_exact
from lacore.inner.rescaling import good_for
from lacore.limit.conversion import point_in_program
from lacore.limit.judges.driven_corners import driven_corners
from lacore.limit.outcome import Times, outcome_of
from lacore.limit.solve import limit_state, solve
from lacore.limit.state import LimitState
from lacore.problem.problem import Problem
from lacore.program import dimensionless
from lacore.ranges.continuum import continuum_range
from lacore.ranges.told import residuals, short
from lacore.reporting import terms
from lacore.reporting.findings import Finding, texts
from lacore.reporting.kinds import Kind
from lacore.reporting.text import PYTHON, Reader, text
from lacore.showing import Facts, Picture, Shown, counted, listed
from lacore.solvers.compilation import SolveClock
from lacore.status import Reported, Scope, Status

_SEARCHED = (Status.SOLVED, Status.NOT_CERTIFIED, Status.JAM)
_COLUMNS = ["restart", "origin", "low", "high", "low_end", "high_end", "residual", "solves"]
_CLOSE = 1e-6  # relative: a load factor this close to a bound has reached it


@dataclass(frozen=True, repr=False)
class CoulombRange(Reported, Shown):
    """The lowest and the highest Coulomb load factor found, in SI units.

    Each is proven to be one, by its certificate. That there is none lower or higher is proven only
    by `bracket`, where they reach it; otherwise it is merely what the search found. Where bodies
    deform all this is said of the discrete problem (`scope`), whose load factors lie above those of
    the continuum as a rule; of the continuum `continuum` is proven.

    Attributes:
        status: SOLVED where states were found; else what `solve` says of the problem.
        lowest, highest: their states; None where none was found. Of a mechanism that carries any
            load factor (`high` = inf) `highest` is a state with a large one.
        low, high: their load factors; NaN where nothing is certified, +inf of a LOCKED problem.
        scope: of which problem the load factors, `bracket` and what reaches it are.
        bracket: proven bounds of every Coulomb load factor of that problem, frictionless and
            associated (T14); -inf and inf where there is none.
        continuum: proven bounds of every Coulomb load factor of the continuum: a strict lower bound
            of the problem without Coulomb friction, a strict upper bound of that with associated
            friction; -inf and inf where there is none. `bracket` where nothing is discretised.
        unbounded: Why the continuum has no bound; empty where it has both.
        states: one row a certified state: restart, origin (of what reactions it settled: of the
            ``certified`` state of `solve`, the ``associated`` one, a ``continuation`` in friction,
            the ``low end`` or ``high end`` of the state before; or at the end of a central ``path``
            of blocks in space), low and high load factor of its mechanism, what each end is worth
            (`EndStatus`), the largest residual of both ends, inner solves so far.
        backend: name.
        seed, restarts: of the search.
        solves: inner solves of the search.
        solve_time: s, wall clock, without the compilation of the backend.
        findings: What else there is to report; `message` is their text.
        stop: Why the search ended before its restarts did; None where it did not.
        ray: what proves LOCKED or UNSAFE, with its residuals: see `LimitState`; None else.
    """

    status: Status
    lowest: LimitState | None
    highest: LimitState | None
    low: float
    high: float
    scope: Scope
    bracket: tuple[float, float]
    continuum: tuple[float, float]
    unbounded: tuple[Finding, ...]
    states: pd.DataFrame
    backend: str
    seed: int
    restarts: int
    solves: int
    solve_time: float
    findings: tuple[Finding, ...]
    stop: Finding | None = None
    ray: Ray | None = None

    @property
    def missing(self) -> str:
        """Text of `unbounded`: why the continuum has no bound; empty where it has both."""
        return texts(self.unbounded)

    @property
    def stopped(self) -> str:
        """Text of `stop`: why the search ended before its restarts did; empty where it did not."""
        return str(self.stop or "")

    @property
    def lowest_proven(self) -> bool:
        """Whether there is proven to be no lower Coulomb load factor of the problem of `scope`."""
        return _reached(self.low, self.bracket[0])

    @property
    def highest_proven(self) -> bool:
        """Whether there is proven to be no higher Coulomb load factor of the problem of `scope`."""
        return _reached(self.high, self.bracket[1])

    def facts(self) -> Facts:
        """What was found, and what of it is proven; `summary` has the whole."""
        return self.facts_for(PYTHON)

    def facts_for(self, reader: Reader) -> Facts:
        """Return the facts for a reader."""
        found = f"{self.low:.7g} to {self.high:.7g}{self.scope.phrase}"
        if self.lowest is None or self.highest is None:
            found = "none is certified"
        below, above = self.bracket
        proven = f"every one is in [{below:.7g}, {above:.7g}]"
        if self.scope is Scope.DISCRETE:
            below, above = self.continuum
            proven += f", those of the continuum in [{below:.7g}, {above:.7g}]"
        told = {"status": self.report.summary_for(reader), "proven": proven}
        told |= residuals(self.lowest, self.highest)
        told |= {} if self.ray is None else {"proof": str(self.ray)}
        told["solved by"] = (
            f"{self.backend}: {counted(len(self.states), 'state')} in"
            f" {counted(self.solves, 'solve')}, {self.solve_time:.3g} s"
        )
        if self.lowest is not None:
            told["size"] = self.lowest.discretisation.contents
        told |= {"stopped": self.stopped} if self.stopped else {}
        title = f"Coulomb load factors {found}{short(self.stopped)}"
        return Facts(title, told, "CoulombRange")

    def picture(self) -> Picture | None:
        """The mechanism of the lowest load factor."""
        if self.lowest is None:
            return None
        return Picture(self.lowest.plot(), "the mechanism with the lowest load factor")

    def summary(self) -> str:
        """What was found, and what of it is proven, as plain text."""
        of = self.scope.phrase
        lines = [f"Coulomb load factors{of}: {self.low:.6g} to {self.high:.6g}"]
        if self.lowest is None or self.highest is None:
            lines = [f"no certified Coulomb load factor{of}: {self.message}"]
        if self.scope is Scope.DISCRETE:
            below, above = self.continuum
            lines.append(
                f"  proven of the continuum: every one lies in [{below:.6g}, {above:.6g}]"
                f" (lower bound frictionless, upper bound associated)"
            )
            if self.missing:
                lines.append(f"  of the continuum {self.missing}")
        below, above = self.bracket
        lines.append(
            f"  proven{of}: every one lies in [{below:.6g}, {above:.6g}] (frictionless, associated)"
        )
        for name, value, state, proven in (
            ("lowest", self.low, self.lowest, self.lowest_proven),
            ("highest", self.high, self.highest, self.highest_proven),
        ):
            if state is None or state.certificate is None:
                continue
            residual, size = state.certificate.worst
            worst = f"(largest residual {size:.1e}, {residual})"
            other = "lower" if name == "lowest" else "higher"
            if np.isinf(value):
                lines.append(f"  proven{of}: a mechanism carries any higher one {worst}")
                continue
            lines.append(f"  proven{of}: {value:.6g} is one, by its certificate {worst}")
            if proven:
                lines.append(f"  proven{of}: none is {other}, it reaches its bound")
            else:
                lines.append(f"  found, not proven{of}: that none is {other}")
        lines.append(
            f"  {len(self.states)} certified states in {self.solves} solves by {self.backend},"
            f" {self.restarts} restarts, seed {self.seed}, {self.solve_time:.1f} s"
        )
        if self.stopped:
            lines.append(f"  stopped {self.stopped}: others may be further out")
        return "\n".join(lines)

    def __str__(self) -> str:
        return self.summary()


@typed()
def coulomb_range(
    problem: Problem | Discretisation,
    backend: str = "auto",
    *,
    seed: int = 0,
    restarts: int = 8,
    tolerance: float = 1e-6,
    target_width: float | None = None,
    time_limit: float = 600.0,
    options: Mapping[str, Any] | None = None,
    on_progress: Callable[[Mapping[str, Any]], None] | None = None,
) -> CoulombRange:
    """Search for the lowest and the highest Coulomb load factor (T14b).

    Args:
        problem: the problem, or its discretisation.
        backend: an exact one.
        seed: of the random shaking of reactions; the same seed finds the same states.
        restarts: further searches from shaken reactions, after the one from those of the associated
            problem; of blocks in space each follows three central paths (T79).
        tolerance: bar for the residuals of every state.
        target_width: of ``(upper - lower)/mean`` of the bounds of the continuum, to which meshes of
            their own are refined, see `lacore.bracket`. None: bounds on the mesh of the problem.
        time_limit: s, wall clock, from the beginning: the search stops at the first inner solve
            that ends after it, with what it has found.
        options: of the backend, by name.
        on_progress: called with the row of each certified state as it is found.

    Raises:
        InputError: an unknown name, an option out of range; a target width for a problem that
            `lacore.bracket` refuses.
        CapabilityError: the backend is missing, regularised, or cannot take the problem.

    Example:
        >>> found = la.coulomb_range(la.examples.column(friction=0.3))
        >>> round(found.low, 3), round(found.high, 3)
        (0.3, 0.3)
    """
    require_whole("seed", seed)
    require_whole("restarts", restarts)
    require_positive("tolerance", tolerance)
    require_positive("time_limit", time_limit)
    engine = require_exact(backend, "a Coulomb load factor")
    begin, clock = time.perf_counter(), SolveClock()
    if not isinstance(problem, Discretisation):
        problem = discretise(problem)
    if problem.program.frictional:
        raise InputError(
            "problem",
            listed([group.name for group in problem.program.groups if group.frictional]),
            "flow of a soil is not associated: what it carries is looked for in other ways",
            text("take {}", terms.SOIL_RANGE),
        )
    continuum = None
    if problem.scope is Scope.DISCRETE:
        continuum = continuum_range(problem, backend, options or {}, target_width)
    given: dict[str, Any] = {"backend": backend, "tolerance": tolerance, "options": options}
    first = solve(problem, coupling=CERTIFIED, **given)
    problem = first.discretisation  # with the nodes where members under line loads hinge
    program = dimensionless(problem.program, problem.natural)
    scale = problem.natural.load_factor
    rows: list[dict[str, Any]] = []
    stop = None

    def note(found: CertifiedMechanism) -> None:
        rows.append(_row(found, scale) | {"solves": search.solves})
        if on_progress is not None:
            on_progress(rows[-1])

    with ExitStack() as stack:
        settings = read_options(engine, options or {})
        prepare = preparing(engine, settings, good_for(tolerance))
        solver = prepare(program)
        stack.callback(solver.close)
        bounds, admissible = coulomb_bounds(program, solver, tolerance)
        if first.status is Status.UNSAFE:
            bounds = (-np.inf, np.inf)  # of none, whatever a locked program says
        if driven_corners(problem, None, tolerance):
            bounds = (bounds[0], np.inf)  # contact at corners, which no program has, may carry more
        search = Search(
            program=program,
            solver=solver,
            prepare=prepare,
            tolerance=tolerance,
            bounds=bounds,
            rng=np.random.default_rng(seed),
            on_found=note,
            on_solve=until(begin + time_limit),
            seconds=lambda: min(settings.time_limit, begin + time_limit - time.perf_counter()),
        )
        known = None if first.point is None else point_in_program(problem, first.point)
        start = known if admissible is None else admissible
        if first.status in _SEARCHED and start is not None:
            try:
                search.run(known if first.status is Status.SOLVED else None, start, restarts)
            except OutOfTime:
                done = rows[-1]["restart"] if rows else 0
                values = {"limit": float(time_limit), "done": done, "every": restarts}
                stop = Finding(Kind.STOPPED_IN_RESTART, values=values)
    ends = {}
    for side, found in search.best.items():
        end = found.end(side)
        last = replace(found.iterates[-1], state=end.point, certificate=end.certificate)
        coupled = Coupled(Status.SOLVED, found.iterates, last, tolerance=tolerance)
        times = Times(first.build_time, clock.seconds)
        outcome = outcome_of(problem, program, coupled, CERTIFIED, times)
        load_factor = _outward(side, end.load_factor * scale, first)
        ends[side] = limit_state(outcome, backend, options or {}, load_factor)
    for refused in [state for state in ends.values() if state.status is not Status.SOLVED][:1]:
        first, ends = refused, {}
    none = Status.NOT_CERTIFIED if first.status is Status.SOLVED else first.status
    nothing = np.inf if first.status is Status.LOCKED else np.nan
    si = _with_known((bounds[0] * scale, bounds[1] * scale), first)
    if ends:
        si = _about(si, ends[LOW].load_factor, ends[HIGH].load_factor)
    return CoulombRange(
        status=Status.SOLVED if ends else none,
        lowest=ends.get(LOW),
        highest=ends.get(HIGH),
        low=ends[LOW].load_factor if ends else nothing,
        high=ends[HIGH].load_factor if ends else nothing,
        scope=problem.scope,
        bracket=si,
        continuum=si if continuum is None else (continuum.lower, continuum.upper),
        unbounded=() if continuum is None else continuum.missing,
        states=pd.DataFrame(rows, columns=_COLUMNS),
        backend=backend,
        seed=seed,
        restarts=restarts,
        solves=search.solves + len(first.history) + 2,
        solve_time=clock.seconds,
        findings=first.findings,
        stop=stop,
        ray=None if ends else first.ray,
    )


def _row(found: CertifiedMechanism, scale: float) -> dict[str, Any]:
    lower, upper = found.interval.lower, found.interval.upper
    return {
        "restart": found.restart,
        "origin": found.origin,
        "low": lower.load_factor * scale,
        "high": upper.load_factor * scale,
        "low_end": lower.status.label,
        "high_end": upper.status.label,
        "residual": max(lower.certificate.worst[1], upper.certificate.worst[1]),
    }


def _outward(side: float, load_factor: float, first: LimitState) -> float:
    """An end, and no nearer by round-off than the certified state that the search began with."""
    if first.status is not Status.SOLVED:
        return load_factor
    return side * max(side * load_factor, side * first.load_factor)


def _with_known(bracket: tuple[float, float], first: LimitState) -> tuple[float, float]:
    """Bounds with those that the first solve found, where it searched for a state."""
    if first.bracket is None or first.status not in _SEARCHED:
        return bracket
    return max(bracket[0], first.bracket[0]), min(bracket[1], first.bracket[1])


def _about(bracket: tuple[float, float], low: float, high: float) -> tuple[float, float]:
    """Bounds that certified load factors stick out of by round-off moved to them."""
    below, above = bracket
    sizes = [abs(value) for value in (below, above, low, high) if np.isfinite(value)]
    slack = _CLOSE * max(sizes)
    if below - slack <= low < below:
        below = low
    if above < high <= above + slack:
        above = high
    return below, above


def _reached(value: float, bound: float) -> bool:
    """Whether a load factor is at a bound; both may be infinite."""
    if not (np.isfinite(value) and np.isfinite(bound)):
        return value == bound
    return abs(value - bound) <= _CLOSE * max(abs(value), abs(bound))
