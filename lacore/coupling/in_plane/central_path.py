"""The central path of the Coulomb problem, followed round its turns: walls whose loop stalls.

All equations F of the problem (`lacore.coupling.in_plane.complementarity`) but a share theta of
what they leave at a start that is inside of every bound,

    F(z) = theta F(z0),    s p, a g+, b g- = theta c,

have a curve of solutions through the start, at theta = 1, and Coulomb states are where it meets
theta = 0. The problem is not monotone, and the curve turns back where one mechanism ends: theta
grows then for a while. So it is followed by its length in logarithms of all that is positive, and
not by theta: Newton's steps from a tangent, in the plane across it (Allgower & Georg 1990, ch. 10).
From a start far inside, with powers a thousand times those of the load, it turns seldom and leads
far; from close to a pair with a small gap it turns at once, and may never end. In space the law is
smoothed in another way (T79), since directions of slip turn; here all is linear but for products.
"""

from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np

from lacore.arrays import Floats
from lacore.backend import InnerSolution, PreparedSolver
from lacore.coupling.bounds import kinematic_power
from lacore.coupling.in_plane.complementarity import Complementarity, Newton, poses
from lacore.coupling.run import Iterate, Run
from lacore.coupling.steps import alternate, carries
from lacore.numerics.linear_algebra import SingularError
from lacore.program import FrozenContact, reaction_contact
from lacore.state import ProgramState
from lacore.status import Status

_INSIDE = 1e3  # powers of the start, of the power that the associated state turns over
_END = 0.3  # of the bar: gap at the end
_MOST = 1500  # factorisations
_NEAR, _CLOSE = 0.6, 0.1  # of a power: off the path after one correction, and after more
_BOUNDARY = 0.9  # of the way to it
_FALL, _RISE = 0.8, 2.5  # of anything positive, in a predicted step
_CORRECTIONS, _TRIALS, _RECENTRED = 4, 6, 3


@dataclass(frozen=True)
class _Path:
    """The curve: a problem, and what its equations leave at the start."""

    problem: Complementarity
    left: Floats
    orientation: float

    def residual(self, place: "_Place") -> Floats:
        return np.asarray(self.problem.residual(place.z) - np.exp(place.level) * self.left)

    def move(self, place: "_Place", newton: "_Linear") -> Floats:
        """dz/d log(theta) of the problem that was linearised last."""
        return np.asarray(np.exp(place.level) * newton.tangent)

    def off(self, place: "_Place") -> float:
        """Largest share by which a power is off; inf outside of the bounds."""
        if not (np.isfinite(place.z).all() and (self.problem.positive(place.z) > 0).all()):
            return float("inf")
        aim = np.exp(place.level) * self.powers
        return float(np.abs(self.problem.products(place.z) / aim - 1).max())

    @property
    def powers(self) -> Floats:
        return self.left[-3 * self.problem.program.contact.count :]


@dataclass(frozen=True)
class _Place:
    """A vector, log(theta), and the direction of the path in logarithms where it was last known."""

    z: Floats
    level: float
    along: tuple[Floats, float] | None = None


class _Linear(Newton):
    """The problem linearised at a vector, and what a change of theta does there."""

    def __init__(self, path: _Path, z: Floats) -> None:
        super().__init__(path.problem, z)
        self.tangent = self.solve(path.left)


def central_path(run: Run, static: ProgramState) -> Iterate | None:
    """The state at the end of the path from the associated one, if need be after K- and S-steps."""
    first = run.iterates[0].inner.point
    if first is None or not poses(run.program) or not np.any(first.normal_reaction > 0):
        return None
    frozen = reaction_contact(run.program.contact, np.maximum(first.normal_reaction, 0.0))
    found = run.solve("path", frozen, solver=_Follower(run, first))
    point = found.inner.point
    if run.exhausted or point is None or run.free(found) or run.proven(found):
        return found if carries(run, found) else None
    return alternate(run, point, "K", 1, lambda _, s, k: (s + k) / 2)


class _Follower(PreparedSolver):
    """The path as a solve: its answer is its end, whatever the contact."""

    def __init__(self, run: Run, start: ProgramState) -> None:
        self._run, self._start = run, start

    def solve(self, contact: FrozenContact) -> InnerSolution:
        """Follow the path; where it is lost, its last place is the point."""
        begin = perf_counter()
        program, end = self._run.program, _END * self._run.options.tolerance
        problem = Complementarity(program)
        power = _INSIDE * kinematic_power(program, self._start)
        z = problem.start(self._start, power / (3 * program.contact.count))
        z, steps, lost = follow(problem, z, end)
        status = Status.ALMOST_SOLVED if lost else Status.SOLVED
        return InnerSolution(status, lost or "end", steps, perf_counter() - begin, problem.state(z))

    def close(self) -> None:
        """It holds nothing."""


def follow(problem: Complementarity, z: Floats, end: float) -> tuple[Floats, int, str]:
    """The last vector of the path from another, factorisations, and why it is not the end.

    Args:
        problem: what to solve.
        z: inside of all bounds.
        end: sum of the powers, of that of the load, where the path is at its end.
    """
    left, recentred = problem.residual(z), False
    place, length, count = _Place(z, 0.0), 0.3, 1
    try:
        path = _Path(problem, left, Newton(problem, z).orientation())
        newton = _Linear(path, z)
        while problem.products(place.z).sum() > end * abs(place.z[-1]):
            if count >= _MOST:
                return place.z, count, "limit of steps"
            reached, length, used, newton = _step(path, place, length, newton)
            count += used
            if reached is not None:
                place, recentred = reached, False
            elif recentred:
                return place.z, count, "no progress"
            else:  # the tangent was that of a point beside the path
                for _ in range(_RECENTRED):
                    place = _corrected(path, place, _Linear(path, place.z))
                newton, recentred, count = _Linear(path, place.z), True, count + _RECENTRED + 1
    except SingularError:
        return place.z, count, "singular"
    return place.z, count, ""


def _step(
    path: _Path, place: _Place, length: float, newton: _Linear
) -> tuple[_Place | None, float, int, _Linear]:
    """The next place, None where none is found; next length, factorisations, and the last one."""
    move = path.move(place, newton)
    change = path.problem.rates(move) / path.problem.positive(place.z)
    size = np.hypot(np.linalg.norm(change), 1.0)
    # Cosines to the last direction go wrong where both ends of a hairpin are close to each other.
    forward = -newton.orientation() * path.orientation
    along = change * (forward / size), forward / size
    longest = 1 / max(float((-along[0]).max()) / _FALL, float(along[0].max()) / _RISE, 1e-300)
    count = 0
    for _ in range(_TRIALS):
        length = min(length, longest)
        ahead = _Place(place.z + (length * forward / size) * move, place.level + length * along[1])
        ahead = replace(ahead, along=along)
        for correction in range(_CORRECTIONS):
            newton, count = _Linear(path, ahead.z), count + 1
            ahead = _corrected(path, ahead, newton)
            if path.off(ahead) < (_CLOSE if correction else _NEAR):
                factor = (2.0, 1.0, 2 / 3, 2 / 3)[correction]
                return ahead, factor * length, count, newton
        length /= 3
    return None, length, count, newton


def _corrected(path: _Path, place: _Place, newton: _Linear) -> _Place:
    """A Newton step across the direction of the path; at the same theta where none is known."""
    move = path.move(place, newton)
    step = newton.solve(-path.residual(place))
    positive, rise = path.problem.positive(place.z), 0.0
    if place.along is not None:
        rates = path.problem.rates(step) / positive, path.problem.rates(move) / positive
        rise = -_inner((rates[0], 0.0), place.along) / _inner((rates[1], 1.0), place.along)
    step = step + rise * move
    nearest = float((-path.problem.rates(step) / positive).max())
    share = min(1.0, _BOUNDARY / nearest) if nearest > 0 else 1.0
    level = place.level + float(np.clip(share * rise, -1.0, 1.0))
    return replace(place, z=place.z + share * step, level=level)


def _inner(one: tuple[Floats, float], other: tuple[Floats, float]) -> float:
    return float(one[0] @ other[0] + one[1] * other[1])
