"""Central paths of the Coulomb problem of rigid blocks, followed around their turning points (T79).

Let F be the equations of the problem (`lacore.coupling.blocks.complementarity`) and z0 a start
inside all bounds. The equations

    F(z) = theta F(z0),    s p = theta c,   x o y = theta c (1, 0),

have a curve of solutions through the start, at theta = 1, and Coulomb states are its points at
theta = 0. The problem is not monotone, so theta increases again where one mechanism ends
(`lacore.numerics.curve`). A curve that starts far inside, with powers a thousand times those of the
load, seldom turns. One that starts close to a pair with a small gap turns at once and may never
end. Powers c that differ between points give other curves, which often end at other states; they
also avoid the branches that curves of equal powers have in symmetric structures.

Paths of walls with thousands of blocks are long. A place long before the end is then close enough
for K- and S-steps, which stall from the associated state. If they also stall from there, with a gap
within ten times the tolerance, further steps start from the closest pair (T12b).
"""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property
from time import perf_counter

import numpy as np

from lacore.coupling.blocks.complementarity import Complementarity, poses
from lacore.coupling.constants import FALLING_GAP, NEARLY_PROVEN, PATH_END
from lacore.coupling.run import CENTRAL_PATH, Iterate, Run
from lacore.coupling.steps import (
    alternate,
    closest,
    least_gap,
    mean,
    proves_load,
    static_alone,
)
from lacore.numerics.arrays import Floats
from lacore.numerics.curve import Place, followed
from lacore.program.kinematic import FrozenContact, KinematicProgram, reaction_contact
from lacore.program.power import kinematic_power
from lacore.program.state import ProgramState
from lacore.reporting.showing import Compact
from lacore.reporting.status import Status
from lacore.solvers.backend import InnerSolution, PreparedSolver

_SPREADS = (0.01, 0.3, 0.3, 0.3)  # logarithmic spreads of the powers of successive paths
_INSIDE = 1e3  # powers of the start, relative to the power that its state dissipates
_MOST, _ALL = 1000, 3000  # factorisations of one path, and those after which none is started
_LARGE = 5000  # unknowns from which a solve costs as much as dozens of factorisations
_NEARER = 10.0  # powers of a closer start, whose path is shorter but may turn more often
_BORNE = 4  # pairs without progress of these steps
_STOPS = (1e-2, 600), (2e-3, _MOST)  # gaps and factorisations, whichever comes first


def central_path(run: Run, static: ProgramState) -> Iterate | None:
    """Return the state at the end of a path from the associated state, or after further steps."""
    if not poses(run.program):
        return None
    return _stepped(run, _ends(run, run.iterates[0].inner.point or static))


def by_places(run: Run, static: ProgramState) -> Iterate | None:
    """K- and S-steps from two places of one path, the second nearer to its end; of large walls."""
    rows = run.program.contact
    if not poses(run.program) or rows.tangent_dim > 1 or run.program.n < _LARGE:
        return None
    return _stepped(run, _stops(run, run.iterates[0].inner.point or static))


def _ends(run: Run, start: ProgramState) -> Iterator[Iterate]:
    """Ends of paths, as long as there is budget."""
    rng, spent = np.random.default_rng(0), 0  # the same paths
    for spread in _SPREADS:
        if run.exhausted or spent >= _ALL:
            return
        found = along_path(run, start, spread, rng)
        spent += found.inner.iterations
        yield found


def _stops(run: Run, start: ProgramState) -> Iterator[Iterate]:
    """Places of a path, as long as there is budget."""
    path = replace(
        _path(run, start, _SPREADS[0], np.random.default_rng(0)), inside=_NEARER, stops=_STOPS
    )
    for _ in _STOPS:
        if run.exhausted:
            return
        found = run.solve(CENTRAL_PATH, _frozen(run, start), solver=path)
        if not found.inner.iterations:  # it was lost at the last place
            return
        yield found


def _stepped(run: Run, places: Iterator[Iterate]) -> Iterate | None:
    """Return the first place that is proven, or the state that K- and S-steps reach from one."""
    within = NEARLY_PROVEN * run.options.tolerance
    for found in places:
        point = found.inner.point
        if point is None or run.free(found) or run.proven(found):
            return found if proves_load(run, found) else None
        closer = alternate(run, point, "K", 1, mean)
        if closer is not None:
            return closer
        while not run.exhausted and (least := least_gap(run)) <= within:
            within = FALLING_GAP * least  # from the same pair steps would reach the same end
            closer = _nearer(run, closest(run, point))
            if closer is not None:
                return closer
    return None


def _nearer(run: Run, static: ProgramState) -> Iterate | None:
    """Alternate from a pair that is nearly proven.

    With the reactions of S-steps alone the gap decreases until it stalls (T12). The mean reactions
    of both steps then escape from there, with gaps that first increase.
    """
    falling = alternate(run, static, "K", 0, static_alone)
    return falling or alternate(run, closest(run, static), "K", _BORNE, mean)


def along_path(run: Run, start: ProgramState, spread: float, rng: np.random.Generator) -> Iterate:
    """Return the iterate at the end of one path, which need not be proven.

    Args:
        run: Run of a program that the path can solve, see `poses`.
        start: State whose largest force and velocity are the units.
        spread: Logarithmic spread of the powers of the points.
        rng: Random numbers for these.
    """
    return run.solve(CENTRAL_PATH, _frozen(run, start), solver=_path(run, start, spread, rng))


def _frozen(run: Run, start: ProgramState) -> FrozenContact:
    """Freeze the start, for the mismatch in the history; a path itself freezes nothing."""
    return reaction_contact(run.program.contact, np.maximum(start.normal_reaction, 0.0))


def _path(run: Run, start: ProgramState, spread: float, rng: np.random.Generator) -> "Path":
    shares = np.exp(spread * rng.standard_normal(run.program.contact.count))
    return Path(run.program, start, shares, PATH_END * run.options.tolerance, run.time_limit)


@dataclass(repr=False)
class Path(PreparedSolver, Compact):
    """A central path in the form of a solver, whose answer is the end of the path.

    Attributes:
        program: Program of rigid blocks.
        start: A state of it.
        shares: Factors on the powers of the points, shape (m,), > 0.
        end: Sum of the powers, relative to the power of the load, at which the path ends.
        time_limit: Time limit of one solve, s.
        inside: Powers of the start, relative to the power that its state dissipates.
        stops: Stop of each solve, from which the next solve continues: the sum of the powers and
            the number of factorisations from the start, whichever is reached first.
    """

    program: KinematicProgram
    start: ProgramState
    shares: Floats
    end: float
    time_limit: float
    inside: float = _INSIDE
    stops: tuple[tuple[float, int], ...] = field(default_factory=lambda: ((0.0, _MOST),))
    _solves: int = field(default=0, init=False)
    _last: Place | None = field(default=None, init=False)

    @cached_property
    def _problem(self) -> Complementarity:
        return Complementarity(self.program)

    @cached_property
    def _places(self) -> Iterator[Place]:
        power = self.inside * kinematic_power(self.program, self.start) / (3 * self.shares.size)
        if not (power > 0 and self.start.normal_reaction.max() > 0):
            return iter(())
        return followed(self._problem, self._problem.start(self.start, power * self.shares))

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Follow the path to the next stop; the point of the answer is the last place."""
        begin, before = perf_counter(), 0 if self._last is None else self._last.count
        enough, most = self.stops[self._solves]
        self._solves += 1
        lost = "no progress"
        for place in self._places:
            self._last, power = place, self._problem.power(place.z)
            if power <= self.end:
                lost = ""
            elif power <= enough:
                lost = "on its way"
            elif place.count >= most:
                lost = "limit of steps"
            elif perf_counter() - begin >= self.time_limit:
                lost = "limit of time"
            else:
                continue
            break
        if self._last is None:
            return InnerSolution(Status.NOT_CONVERGED, "no start", 0, 0.0, None)
        status, spent = Status.ALMOST_SOLVED if lost else Status.SOLVED, perf_counter() - begin
        steps, point = self._last.count - before, self._problem.state(self._last.z)
        return InnerSolution(status, lost or "end", steps, spent, point)

    def close(self) -> None:
        """Do nothing; a path holds no resources."""
