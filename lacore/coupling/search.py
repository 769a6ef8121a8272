"""Search for low and high Coulomb load factors among different mechanisms (T14b b).

A state is settled from reactions by alternation (T12), and its mechanism carries an interval. From
an end of it the same reactions, shaken a little, often settle at a mechanism that reaches further:
so on, until none does. Such a climb starts from the associated reactions, shaken, from the best end
so far, shaken, and, for the low side, from the end of a continuation: friction grows in steps from
little, where load factors are unique or nearly so, and each step starts at the low end before it.
Of blocks in space, where alternation seldom settles, central paths come in place of all these
(T79): powers that differ from point to point lead to other states, and climbs start from the
furthest of them.

A search finds; that there is nothing lower or higher, it does not prove.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from lacore.coupling.blocks.central_path import along_path
from lacore.coupling.blocks.complementarity import poses
from lacore.coupling.bounds import lower_bound, upper_bound
from lacore.coupling.certified import averaged
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
_SETTLE = 24  # inner solves from one start; most certify within 6
_SHAKEN = 0.3  # logarithmic spread of the reactions of a restart; 1 finds less on the low side
_SPREADS = (0.0, 0.02, 0.02, 0.1, 0.3)  # at an end, one try each
_BEST = 0.1  # at the best end, in each restart
_PATHS = (0.01, 0.3, 1.0)  # logarithmic spreads of their powers, one path each in each restart
_FURTHER = 1e-7  # of the size of load factors; less is round-off of interior-point methods
_ALIKE = 100.0  # bars of residuals, of that size: with deformable bodies states that a bar of 1e-6
# certifies settle to loads up to 3e-5 apart, and a search for so little has no end


@dataclass(frozen=True, repr=False)
class CertifiedMechanism(Compact):
    """One certified mechanism, in the units of the program.

    Attributes:
        restart: 0 is the unshaken start.
        origin: of what reactions it settled: ``certified``, ``associated``, ``continuation``,
            ``best``, ``path``, ``low end``, ``high end``.
        interval: what it carries.
        iterates: the inner solves that led to it.
    """

    restart: int
    origin: str
    interval: Interval
    iterates: tuple[Iterate, ...]

    def end(self, side: float) -> End:
        """The lower or the upper end."""
        return self.interval.lower if side < 0 else self.interval.upper


def coulomb_bounds(
    program: KinematicProgram, solver: PreparedSolver, tolerance: float
) -> tuple[tuple[float, float], ProgramState | None]:
    """Bounds of all Coulomb load factors of a program (T14), and the associated state, if any.

    Below, by admissible stresses and reactions without friction; above, by a velocity that the
    associated law admits. Each needs its own half of the residuals only.
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
        program: dimensionless.
        solver: at work on it; friction grows in what is frozen, so that it serves all steps.
        prepare: for the programs of the ends.
        tolerance: bar for all residuals.
        bounds: proven bounds of all load factors of the program (T14): an end that reaches its
            bound ends a climb.
        rng: of the shaking.
        on_found: called for each certified mechanism.
        on_solve: called after each inner solve of a loop; it may end the search by raising
            `lacore.coupling.deadline.OutOfTime`: `best` stands.
        seconds: that are left for a central path.
        best: the mechanism that reaches furthest on each side.
        solves: inner solves so far, those of the ends included.
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

        From these once as they are, and `restarts` times shaken; of blocks in space as many times
        along central paths.
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
        """Central paths, and then climbs from what is furthest out."""
        for restart in range(restarts + 1):
            for spread in _PATHS:
                if not (self._bounded(LOW) and self._bounded(HIGH)):
                    self._along(start, spread, restart)
        for side in (LOW, HIGH):
            self._climb(self.best.get(side), side)

    def _along(self, start: ProgramState, spread: float, restart: int) -> None:
        """The mechanism at the end of a central path, noted."""
        run = replace(self._run(self.program), time_limit=self.seconds())
        last = along_path(run, start, spread, self.rng)
        self.solves += 1
        if last.state is not None and run.proven(last):
            self._noted(last.state, restart, "path", (last,))

    def _climb_both(self, found: CertifiedMechanism | None) -> None:
        for side in (LOW, HIGH):
            self._climb(found, side)

    def _climb(self, found: CertifiedMechanism | None, side: float) -> None:
        """From the end of an interval to that of the next, until none reaches further."""
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
        """Reactions after steps of growing friction along the low ends, shaken at each."""
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
        """The certified state that alternation reaches from reactions (T12)."""
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
        """The mechanism that settles from reactions, noted."""
        settled = self._settled(self.program, start)
        if settled is None:
            return None
        state, run = settled
        return self._noted(state, restart, origin, tuple(run.iterates))

    def _known(self, certified: ProgramState) -> CertifiedMechanism | None:
        """The mechanism of a state that needs no settling, so that its own load is among those."""
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
            if best is None or self._beyond(side, found.end(side), best.end(side), _FURTHER):
                self.best[side] = found
        self.on_found(found)
        return found

    def _counted(self, program: KinematicProgram) -> PreparedSolver:
        self.solves += 1
        return self.prepare(program)

    @property
    def _apart(self) -> float:
        """Share of the size of load factors by which ends differ, as far as a climb can tell."""
        return max(_FURTHER, _ALIKE * self.tolerance)

    def _beyond(self, side: float, end: End, other: End, share: float) -> bool:
        """Whether an end is further out than another one, by more than a share of their size."""
        return side * (end.load_factor - other.load_factor) > share * self._size

    def _left(self, side: float, end: End) -> bool:
        """Whether a climb came to this end before; notes it."""
        known = self._visited[side]
        if any(abs(alpha - end.load_factor) <= self._apart * self._size for alpha in known):
            return True
        known.append(end.load_factor)
        return False

    def _bounded(self, side: float) -> bool:
        """Whether the best end has reached what bounds every Coulomb load factor."""
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
