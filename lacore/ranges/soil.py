"""`soil_range`: low and high load factors of soils whose flow is not associated (T59)."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd

from lacore.assembly.discretisation import Discretisation
from lacore.assembly.discretise import discretise
from lacore.backend import check_capable, read_options
from lacore.claims.judged import Ray
from lacore.coupling.deadline import OutOfTime, until
from lacore.coupling.kinds import CERTIFIED
from lacore.coupling.run import Coupled, CouplingOptions, Run
from lacore.coupling.soil_search import SEARCHES, SoilFound, soil_bounds, soil_states
from lacore.errors import InputError, is_number, require_positive, typed
from lacore.inner.preparing import preparing, require_exact
from lacore.inner.rescaling import good_for
from lacore.limit.outcome import Times, outcome_of
from lacore.limit.solve import limit_state, solve
from lacore.limit.state import LimitState
from lacore.problem.problem import Problem
from lacore.program import KinematicProgram, dimensionless
from lacore.ranges.told import residuals, short
from lacore.reporting.findings import Finding
from lacore.reporting.kinds import Kind
from lacore.reporting.text import PYTHON, Reader, Term, text
from lacore.showing import Facts, Picture, Shown, counted
from lacore.solvers.compilation import SolveClock
from lacore.status import Reported, Status

SHARES = (1.0, 0.6, 0.3)
"""Of the friction that a soil has where searches start: loads far apart, from 2 to 32 of a footing
of 30 degrees, lead to limit states much nearer to each other (T59)."""
_AIM = 1e-6  # residual at which a search stops
_MOST = 120  # solves of a search: it stops by itself sooner
_BEYOND = 1e-6  # of the associated load factor: the round-off of two solves
_COLUMNS = ["share", "search", "status", "load_factor", "residual", "gap", "solves", "seconds"]


@dataclass(frozen=True, repr=False)
class SoilRange(Reported, Shown):
    """The lowest and the highest load factor found of a soil whose flow is not associated.

    In SI units. Each is that of a state with its certificate, of the discrete problem. That there
    is none lower or higher is not proven; that all are within `bracket` is.

    Attributes:
        status: SOLVED where states were found; else why there is none.
        lowest, highest: their states; None where none was found.
        low, high: their load factors; NaN where nothing is certified, +inf where it is LOCKED.
        bracket: proven bounds of every load factor of the discrete problem (T54): with associated
            flow of the dilation angle and the same apex, and of the friction angle; -inf and inf
            where there is none.
        davis: load factor with Davis's strength (T55), which bounds nothing; NaN where there is no
            such state.
        states: one row a search: ``share`` of the friction where it starts, ``search`` (``settled``
            by S-steps, ``drifted`` by K-steps first), ``status``, ``load_factor``, the
            largest ``residual``, the ``gap``, ``solves``, ``seconds`` since the beginning.
        tolerance: bar for all residuals.
        backend: name.
        solve_time: s, wall clock, without the compilation of the backend.
        findings: What else there is to report; `message` is their text.
        stop: Why not all searches came to their ends; None where they did.
        ray: what proves LOCKED or UNSAFE, with its residuals: see `LimitState`; None else.
    """

    status: Status
    lowest: LimitState | None
    highest: LimitState | None
    low: float
    high: float
    bracket: tuple[float, float]
    davis: float
    states: pd.DataFrame
    tolerance: float
    backend: str
    solve_time: float
    findings: tuple[Finding, ...]
    stop: Finding | None = None
    ray: Ray | None = None

    @property
    def width(self) -> float:
        """``(high - low)/mean``."""
        return 2 * (self.high - self.low) / (self.high + self.low)

    @property
    def stopped(self) -> str:
        """Text of `stop`: why not all searches came to their ends; empty where they did."""
        return str(self.stop or "")

    def facts(self) -> Facts:
        """What was found, and what of it is proven."""
        return self.facts_for(PYTHON)

    def facts_for(self, reader: Reader) -> Facts:
        """Return the facts for a reader."""
        found = f"load factors {self.low:.6g} to {self.high:.6g} of the discrete problem"
        below, above = self.bracket
        if np.isfinite(above) and abs(below) <= _BEYOND * abs(above):
            below = 0.0
        within = f"in [{below:.6g}, {above:.6g}]" if below > -np.inf else f"at most {above:.6g}"
        proven = f"all of this mesh are {within} (T54)"
        if below == -np.inf and above == np.inf:
            proven = "no bound of any"
        if np.isfinite(self.davis):
            proven += f"; Davis's strength: {self.davis:.6g}, no bound"
        states = counted(len(self._certified), "certified state")
        told = {"found": f"{states}; that none is lower or higher is not proven", "proven": proven}
        if self.lowest is None or self.highest is None:
            found = "no load factor is certified"
            told["found"] = self.report.text_for(reader)
        told |= {} if self.ray is None else {"proof": str(self.ray)}
        told |= residuals(self.lowest, self.highest)
        solves = counted(int(self.states["solves"].sum()), "solve")
        told["solved by"] = f"{self.backend}: {solves} of searches in {self.solve_time:.3g} s"
        if self.lowest is not None:
            told["size"] = self.lowest.discretisation.contents
        told |= {"stopped": self.stopped} if self.stopped else {}
        return Facts(f"{found}{short(self.stopped)}", told, "SoilRange")

    @property
    def _certified(self) -> pd.DataFrame:
        return self.states[self.states["status"] == "certified"]

    def picture(self) -> Picture | None:
        """The mechanism of the lowest load factor."""
        if self.lowest is None:
            return None
        return Picture(self.lowest.plot(), "the mechanism with the lowest load factor")


@typed()
def soil_range(
    problem: Problem | Discretisation,
    backend: str = "auto",
    *,
    shares: tuple[float, ...] = SHARES,
    tolerance: float = 5e-5,
    time_limit: float = 600.0,
    options: Mapping[str, Any] | None = None,
    on_progress: Callable[[Mapping[str, Any]], None] | None = None,
) -> SoilRange:
    """Search for low and high load factors of soils whose flow is not associated (T57, T59).

    Two searches from each start: one settles near it, the other drifts to lower loads first. Each
    takes as many solves as 20 to 80 with associated flow.

    Args:
        problem: the problem, or its discretisation.
        backend: an exact one.
        shares: of the friction of soils with which searches start, each in (0, 1].
        tolerance: bar for the residuals of every state, of the power turned over; a search goes on
            to 1e-6 where it gets there. A gap says by how much friction is mobilised too little on
            the average over the dissipation (T53), not how near other load factors are.
        time_limit: s, wall clock, from the beginning: searches stop at the first inner solve that
            ends after it, with what they have found.
        options: of the backend, by name.
        on_progress: called with the row of each search as it ends.

    Raises:
        InputError: no soil whose flow is not associated; shares or a tolerance out of range.
        CapabilityError: the backend is missing, regularised, or cannot take the problem.

    Example:
        >>> sand = la.MohrCoulomb(cohesion=1.0, friction_angle=30.0, dilation_angle=0.0)
        >>> square = la.meshes.rectangle(x=(0, 1), y=(0, 1), nx=2, ny=2)
        >>> pressed = la.Problem(
        ...     bodies={"sand": la.Body(square, sand, space="p2-gauss")},
        ...     supports=[la.Fix("sand", "left", "x"), la.Fix("sand", "bottom", "y")],
        ...     reference_loads=[la.Pressure("sand", "top")],
        ... )
        >>> found = la.soil_range(pressed)
        >>> round(found.high, 3)  # 2 c cos(phi)/(1 - sin(phi)), whatever the dilation
        3.464
    """
    require_positive("tolerance", tolerance)
    require_positive("time_limit", time_limit)
    listed = isinstance(shares, Sequence) and len(shares) > 0
    if not listed or not all(is_number(share) and 0 < share <= 1 for share in shares):
        raise InputError("shares", shares, "not numbers in (0, 1]", "give (1.0, 0.6, 0.3)")
    engine = require_exact(backend, "a load factor")
    begin, clock = time.perf_counter(), SolveClock()
    if not isinstance(problem, Discretisation):
        problem = discretise(problem)
    program = dimensionless(problem.program, problem.natural)
    if not program.frictional:
        raise InputError(
            "problem",
            None,
            "flow of all bodies is associated, and its load factor is unique",
            text(
                "give a soil a dilation_angle below its friction_angle; or {}",
                Term(
                    "take lacore.solve, and lacore.coulomb_range for friction of interfaces",
                    "leave --range out",
                ),
            ),
        )
    check_capable(engine, program)
    scale, built = problem.natural.load_factor, time.perf_counter() - begin
    aims = CouplingOptions(tolerance=min(_AIM, tolerance), max_iterations=_MOST, accepted=tolerance)
    rows: list[dict[str, Any]] = []
    ends: list[tuple[SoilFound, float]] = []
    stop = None
    with ExitStack() as stack:
        settings = read_options(engine, options or {})
        good = good_for(aims.tolerance)
        prepare = preparing(engine, settings, good)
        solver = prepare(program.associated())
        stack.callback(solver.close)
        run = Run(program, solver, False, aims, lambda _: None, prepare)
        low, high = soil_bounds(run)
        bracket = (low * scale, high * scale)
        limited = replace(run, on_iterate=until(begin + time_limit))
        try:
            for found in soil_states(limited, tuple(map(float, shares))):
                rows.append(_row(found, scale, bracket[1], time.perf_counter() - begin))
                if rows[-1]["status"] == "certified":
                    ends.append((found, rows[-1]["load_factor"]))
                if on_progress is not None:
                    on_progress(rows[-1])
        except OutOfTime:
            every = len(shares) * len(SEARCHES)
            values = {"limit": float(time_limit), "done": len(rows), "every": every}
            stop = Finding(Kind.STOPPED_AFTER_SEARCHES, values=values)
    given: dict[str, Any] = {"backend": backend, "options": options}
    made = [
        _state(problem, program, found, built, given, tolerance)
        for found, _ in sorted(ends, key=lambda end: end[1])
    ]
    status, ray = (Status.SOLVED if made else Status.TIME_LIMIT), None
    if not made and stop is None:
        status, ray = _why(problem, given)
    if status is Status.UNSAFE:
        bracket = (-np.inf, np.inf)  # of none, whatever bounds with more strength say
    nothing = np.inf if status is Status.LOCKED else np.nan
    return SoilRange(
        status=status,
        lowest=made[0] if made else None,
        highest=made[-1] if made else None,
        low=made[0].load_factor if made else nothing,
        high=made[-1].load_factor if made else nothing,
        bracket=bracket,
        davis=_davis(problem, given),
        states=pd.DataFrame(rows, columns=_COLUMNS),
        tolerance=tolerance,
        backend=backend,
        solve_time=clock.seconds,
        findings=(),
        stop=stop,
        ray=ray,
    )


def _row(found: SoilFound, scale: float, above: float, seconds: float) -> dict[str, Any]:
    final, status = found.final, "not certified"
    point, certificate = (None, None) if final is None else (final.state, final.certificate)
    alpha = np.nan if point is None else point.load_factor * scale
    if found.start.inner.point is None:
        status = found.start.inner.status.label
    elif point is not None and not alpha <= above + _BEYOND * abs(above):
        status = "refused"  # no admissible stresses carry so much (T54): an error of ours
    elif certificate is not None:
        status = "certified"
    return {
        "share": found.share,
        "search": found.search,
        "status": status,
        "load_factor": alpha if status == "certified" else np.nan,
        "residual": np.nan if certificate is None else certificate.worst[1],
        "gap": np.nan if certificate is None else certificate.gap,
        "solves": len(found.iterates),
        "seconds": seconds,
    }


def _state(
    problem: Discretisation,
    program: KinematicProgram,
    found: SoilFound,
    build_time: float,
    given: Mapping[str, Any],
    tolerance: float,
) -> LimitState:
    """The end of a search as a state of its problem."""
    assert found.final is not None
    iterates = (found.start, *found.iterates)
    coupled = Coupled(Status.SOLVED, iterates, found.final, tolerance=tolerance)
    times = Times(build_time, float(sum(one.inner.solve_time for one in iterates)))
    outcome = outcome_of(problem, program, coupled, CERTIFIED, times)
    return limit_state(outcome, given["backend"], given["options"] or {})


def _why(problem: Discretisation, given: Mapping[str, Any]) -> tuple[Status, Ray | None]:
    """Why there is no state: LOCKED or UNSAFE where that is proven, and by what."""
    state = solve(problem, **given)
    return (Status.NOT_CERTIFIED if state.status is Status.SOLVED else state.status), state.ray


def _davis(problem: Discretisation, given: Mapping[str, Any]) -> float:
    """Load factor with Davis's strength; NaN where cones are no planes of slip alone."""
    if not all(group.sliding for group in problem.program.groups if group.frictional):
        return float("nan")
    return solve(problem, coupling="davis", **given).load_factor
