"""Search for low and high Coulomb load factors among different mechanisms (T14b b).

Alternation converges from given reactions to a state (T12), whose mechanism carries an interval.
From slightly perturbed reactions of an end, it often converges to a mechanism that reaches further.
A climb repeats this until no mechanism does. Climbs start from perturbed associated reactions, from
the perturbed best end so far, and, for low load factors, from the end of a continuation. The
continuation increases friction in steps from a small share, at which load factors are almost
unique, and each step starts at the low end of the step before.

For three-dimensional blocks, where alternation seldom converges, central paths replace these starts
(T79): powers that differ between points lead to different states, and climbs start from the
furthest ones.

All states that a search finds are certified, but lower or higher load factors may exist.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from lacore.coupling.blocks.central_path import along_path
from lacore.coupling.blocks.complementarity import poses
from lacore.coupling.bounds import lower_bound, upper_bound
from lacore.coupling.certified import averaged
from lacore.coupling.constants import ALIKE, FURTHER
from lacore.coupling.interval import (
    End,
    EndStatus,
    Interval,
    load_factor_interval,
    proven_end,
)
from lacore.coupling.options import CouplingOptions
from lacore.coupling.run import Iterate, Run
from lacore.numerics.arrays import Floats
from lacore.program.certificate import Certificate
from lacore.program.kinematic import KinematicProgram, associated_contact, frictionless_contact
from lacore.program.state import ProgramState
from lacore.reporting.showing import Compact
from lacore.reporting.status import Status
from lacore.solvers.backend import InnerSolution, Prepare, PreparedSolver, checked_answer

LOW, HIGH = -1.0, 1.0
_STEPS = 10  # of friction
_SETTLE = 24  # most inner solves from one start; usually 6 are enough
_SHAKEN = 0.3  # logarithmic spread of the reactions of a restart; 1 finds fewer low load factors
_SPREADS = (0.0, 0.02, 0.02, 0.1, 0.3)  # spreads of successive attempts at an end
_BEST = 0.1  # spread at the best end, in each restart
_PATHS = (0.01, 0.3, 1.0)  # logarithmic spreads of the powers of the paths of each restart


@dataclass(frozen=True, repr=False)
class CertifiedMechanism(Compact):
    """One certified mechanism, in the units of the program.

    Attributes:
        restart: Number of the restart; 0 is the start without perturbation.
        origin: Reactions from which it was found: ``certified``, ``associated``, ``continuation``,
            ``best``, ``path``, ``low end`` or ``high end``.
        interval: Load factors that it carries.
        iterates: Inner solves that led to it.
    """

    restart: int
    origin: str
    interval: Interval
    iterates: tuple[Iterate, ...]

    def end(self, side: float) -> End:
        """Return the lower or the upper end."""
        return self.interval.lower if side < 0 else self.interval.upper


def coulomb_bounds(
    program: KinematicProgram, solver: PreparedSolver, tolerance: float
) -> tuple[tuple[float, float], ProgramState | None]:
    """Return bounds of all Coulomb load factors (T14), and the associated state, if any.

    Admissible stresses and reactions without friction give the lower bound, and a velocity that the
    associated law admits gives the upper bound. Each needs only its own half of the residuals.
    """
    frozen = frictionless_contact(program.contact), associated_contact(program.contact)
    below, above = (checked_answer(program, False, solver.solve(f)) for f in frozen)
    lower = lower_bound(program, below, tolerance)
    upper = upper_bound(program, above, tolerance)
    return (lower, upper), above.point


@dataclass
class Search:
    """A search on one program.

    Attributes:
        program: Dimensionless program.
        solver: Solver prepared for it. It serves all steps of a continuation, because only the
            frozen contact contains the friction.
        prepare: Function that prepares a backend for the programs of the ends.
        tolerance: Tolerance for all residuals.
        bounds: Proven bounds of all load factors of the program (T14). A climb stops at an end that
            reaches its bound.
        rng: Random numbers for the perturbations.
        on_found: Function that is called for each certified mechanism.
        on_solve: Function that is called after each inner solve of a loop. It may end the search by
            raising `lacore.coupling.run.OutOfTime`; `best` remains valid.
        seconds: Function that returns the time for a central path, s.
        best: Mechanism that reaches furthest on each side.
        solves: Number of inner solves so far, including those of the ends.
    """

    program: KinematicProgram
    solver: PreparedSolver
    prepare: Prepare
    tolerance: float
    bounds: tuple[float, float]
    rng: np.random.Generator
    on_found: Callable[[CertifiedMechanism], None]
    on_solve: Callable[[Iterate], None]
    seconds: Callable[[], float]
    best: dict[float, CertifiedMechanism] = field(default_factory=dict)
    solves: int = 0
    _visited: dict[float, list[float]] = field(default_factory=lambda: {LOW: [], HIGH: []})

    def run(self, certified: ProgramState | None, start: ProgramState, restarts: int) -> None:
        """Search from a certified state, if there is one, and from admissible reactions.

        The reactions are used once unchanged and `restarts` times perturbed. For three-dimensional
        blocks, central paths are followed as many times.
        """
        known = None if certified is None else self._known(certified)
        if poses(self.program) and self.program.contact.tangent_dim > 1:
            self._explore(start, restarts)
            return
        self._climb_both(known)
        for restart in range(restarts + 1):
            spread = _SHAKEN if restart else 0.0
            if not (self._bounded(LOW) and self._bounded(HIGH)):
                self._climb_both(self._found(self._shaken(start, spread), restart, "associated"))
            if not self._bounded(LOW):
                ready = self._continued(start, spread)
                self._climb(self._found(ready, restart, "continuation"), LOW)
            for side in (LOW, HIGH) if restart else ():
                if side in self.best and not self._bounded(side):
                    shaken = self._shaken(self.best[side].end(side).point, _BEST)
                    self._climb(self._found(shaken, restart, "best"), side)

    def _explore(self, start: ProgramState, restarts: int) -> None:
        """Follow central paths, and then climb from the furthest ends."""
        for restart in range(restarts + 1):
            for spread in _PATHS:
                if not (self._bounded(LOW) and self._bounded(HIGH)):
                    self._along(start, spread, restart)
        for side in (LOW, HIGH):
            self._climb(self.best.get(side), side)

    def _along(self, start: ProgramState, spread: float, restart: int) -> None:
        """Record the mechanism at the end of a central path."""
        run = replace(self._run(self.program), time_limit=self.seconds())
        last = along_path(run, start, spread, self.rng)
        self.solves += 1
        if last.state is not None and run.proven(last):
            self._noted(last.state, restart, "path", (last,))

    def _climb_both(self, found: CertifiedMechanism | None) -> None:
        for side in (LOW, HIGH):
            self._climb(found, side)

    def _climb(self, found: CertifiedMechanism | None, side: float) -> None:
        """Proceed from the end of an interval to that of the next, until none reaches further."""
        origin = "low end" if side < 0 else "high end"
        tries = list(_SPREADS)
        while found is not None and tries and not self._bounded(side):
            end = found.end(side)
            arrived = len(tries) == len(_SPREADS)
            if arrived and (end.status is EndStatus.UNBOUNDED or self._left(side, end)):
                return
            other = self._found(self._shaken(end.point, tries.pop(0)), found.restart, origin)
            if other is not None and self._beyond(side, other.end(side), end, self._apart):
                found, tries = other, list(_SPREADS)

    def _continued(self, start: ProgramState, spread: float) -> ProgramState:
        """Return reactions after steps of increasing friction along perturbed low ends."""
        for share in np.arange(1, _STEPS) / _STEPS:
            rows = self.program.contact
            scaled = replace(rows, coefficient=float(share) * rows.coefficient)
            program = replace(self.program, contact=scaled)
            settled = self._settled(program, self._shaken(start, spread))
            if settled is not None:
                end = proven_end(program, settled[0], LOW, self._counted, self.tolerance)
                start = settled[0] if end is None else end.point
        return self._shaken(start, spread)

    def _settled(
        self, program: KinematicProgram, start: ProgramState
    ) -> tuple[ProgramState, Run] | None:
        """Return the certified state that alternation reaches from reactions (T12)."""
        run = self._run(program)
        last = averaged(run, start)
        self.solves += len(run.iterates)
        if last is None or last.state is None or not run.proven(last):
            return None
        return last.state, run

    def _run(self, program: KinematicProgram) -> Run:
        return Run(program, self.solver, False, self._options, self.on_solve)

    @cached_property
    def _options(self) -> CouplingOptions:
        return CouplingOptions(tolerance=self.tolerance, max_iterations=_SETTLE)

    def _found(self, start: ProgramState, restart: int, origin: str) -> CertifiedMechanism | None:
        """Record and return the mechanism that alternation reaches from reactions."""
        settled = self._settled(self.program, start)
        if settled is None:
            return None
        state, run = settled
        return self._noted(state, restart, origin, tuple(run.iterates))

    def _known(self, certified: ProgramState) -> CertifiedMechanism | None:
        """Record and return the mechanism of a certified state, whose load factor then counts."""
        inner = InnerSolution(Status.SOLVED, "certified", 0, 0.0, certified)
        proof = Certificate.of(self.program, certified)
        iterate = Iterate(0, "certified", inner, certified, proof, float("nan"))
        return self._noted(certified, 0, "certified", (iterate,))

    def _noted(
        self, state: ProgramState, restart: int, origin: str, iterates: tuple[Iterate, ...]
    ) -> CertifiedMechanism | None:
        interval = load_factor_interval(self.program, state, self._counted, self.tolerance)
        if interval.lower.status is EndStatus.NOT_CERTIFIED:  # by round-off of other units
            return None
        found = CertifiedMechanism(restart, origin, interval, iterates)
        for side in (LOW, HIGH):
            best = self.best.get(side)
            if best is None or self._beyond(side, found.end(side), best.end(side), FURTHER):
                self.best[side] = found
        self.on_found(found)
        return found

    def _counted(self, program: KinematicProgram) -> PreparedSolver:
        self.solves += 1
        return self.prepare(program)

    @property
    def _apart(self) -> float:
        """Share of the size of load factors by which the ends of a climb must differ."""
        return max(FURTHER, ALIKE * self.tolerance)

    def _beyond(self, side: float, end: End, other: End, share: float) -> bool:
        """Whether an end is further out than another, by more than a share of the size."""
        return side * (end.load_factor - other.load_factor) > share * self._size

    def _left(self, side: float, end: End) -> bool:
        """Record an end; return whether a climb reached it before."""
        known = self._visited[side]
        if any(abs(alpha - end.load_factor) <= self._apart * self._size for alpha in known):
            return True
        known.append(end.load_factor)
        return False

    def _bounded(self, side: float) -> bool:
        """Whether the best end has reached the bound of all Coulomb load factors."""
        if side not in self.best:
            return False
        alpha, bound = self.best[side].end(side).load_factor, self.bounds[int(side > 0)]
        return not side * (bound - alpha) > self.tolerance * self._size

    @property
    def _size(self) -> float:
        """Size of load factors."""
        return max([abs(bound) for bound in self.bounds if np.isfinite(bound)], default=0.0) or 1.0

    def _shaken(self, state: ProgramState, spread: float) -> ProgramState:
        factors: Floats = np.exp(spread * self.rng.standard_normal(state.normal_reaction.size))
        return replace(state, normal_reaction=factors * np.maximum(state.normal_reaction, 0.0))
