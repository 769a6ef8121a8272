"""Central paths of the Coulomb problem of rigid blocks, followed round their turns (T79).

All equations F of the problem (`lacore.coupling.blocks.complementarity`) but a share theta of what
they leave at a start that is inside of every bound,

    F(z) = theta F(z0),    s p = theta c,   x o y = theta c (1, 0),

have a curve of solutions through the start, at theta = 1, and Coulomb states are where it meets
theta = 0. The problem is not monotone, and the curve turns back where one mechanism ends
(`lacore.numerics.curve`). From a start far inside, with powers a thousand times those of the load,
it turns seldom and leads far; from close to a pair with a small gap it turns at once, and may never
end. Powers c that differ from point to point lead along other curves, and often to other states;
where a structure is symmetric curves of equal powers branch, others pass by.
"""

from dataclasses import dataclass
from time import perf_counter

import numpy as np

from lacore.arrays import Floats
from lacore.backend import InnerSolution, PreparedSolver
from lacore.coupling.blocks.complementarity import Complementarity, poses
from lacore.coupling.bounds import kinematic_power
from lacore.coupling.run import Iterate, Run
from lacore.coupling.steps import alternate, carries
from lacore.numerics.curve import followed
from lacore.program import FrozenContact, KinematicProgram, reaction_contact
from lacore.showing import Compact
from lacore.state import ProgramState
from lacore.status import Status

_SPREADS = (0.01, 0.3, 0.3, 0.3)  # logarithmic, of the powers of the paths, one after another
_INSIDE = 1e3  # powers of the start, of the power that its state turns over
_END = 0.3  # of the bar: gap at the end
_MOST, _ALL = 1000, 3000  # factorisations, of one path, and after which no other one begins


def central_path(run: Run, static: ProgramState) -> Iterate | None:
    """The state at the end of a path from the associated one, if need be after K- and S-steps."""
    if not poses(run.program):
        return None
    start, rng = run.iterates[0].inner.point or static, np.random.default_rng(0)  # the same paths
    spent = 0
    for spread in _SPREADS:
        if run.exhausted or spent >= _ALL:
            break
        found = along_path(run, start, spread, rng)
        point, spent = found.inner.point, spent + found.inner.iterations
        if point is None or run.free(found) or run.proven(found):
            return found if carries(run, found) else None
        closer = alternate(run, point, "K", 1, lambda _, s, k: (s + k) / 2)
        if closer is not None:
            return closer
    return None


def along_path(run: Run, start: ProgramState, spread: float, rng: np.random.Generator) -> Iterate:
    """The end of one path, whatever that is worth.

    Args:
        run: of a program that is posed.
        start: its largest force and velocity are the units.
        spread: logarithmic, of the powers of the points.
        rng: of these.
    """
    rows = run.program.contact
    frozen = reaction_contact(rows, np.maximum(start.normal_reaction, 0.0))
    shares = np.exp(spread * rng.standard_normal(rows.count))
    end = _END * run.options.tolerance
    return run.solve("path", frozen, solver=Path(run.program, start, shares, end, run.time_limit))


@dataclass(frozen=True, repr=False)
class Path(PreparedSolver, Compact):
    """A path as a solve: its answer is its end, whatever the contact.

    Attributes:
        program: that is posed.
        start: a state of it.
        shares: of the powers of the points, (m,) > 0.
        end: sum of the powers, of that of the load, where the path is at its end.
        time_limit: s.
    """

    program: KinematicProgram
    start: ProgramState
    shares: Floats
    end: float
    time_limit: float

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Follow the path; where it is lost, its last place is the point."""
        begin = perf_counter()
        problem, count = Complementarity(self.program), self.program.contact.count
        power = _INSIDE * kinematic_power(self.program, self.start) / (3 * count)
        if not (power > 0 and self.start.normal_reaction.max() > 0):
            return InnerSolution(Status.NOT_CONVERGED, "no start", 0, 0.0, None)
        lost, place, steps = "no progress", problem.start(self.start, power * self.shares), 0
        for step in followed(problem, place):
            place, steps = step.z, step.count
            if problem.power(place) <= self.end:
                lost = ""
            elif steps >= _MOST:
                lost = "limit of steps"
            elif perf_counter() - begin >= self.time_limit:
                lost = "limit of time"
            else:
                continue
            break
        status, spent = Status.ALMOST_SOLVED if lost else Status.SOLVED, perf_counter() - begin
        return InnerSolution(status, lost or "end", steps, spent, problem.state(place))

    def close(self) -> None:
        """It holds nothing."""
