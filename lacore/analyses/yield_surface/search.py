"""Directions of a yield surface, and what each of them proves (T82)."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from lacore.analyses.proven_values import error, proven, proven_value
from lacore.analyses.yield_surface.components import Components
from lacore.analyses.yield_surface.hulls import Hulls, gauge, hulls
from lacore.bounds.bracket.bracket import crossing
from lacore.bounds.bracket.refine import bracket
from lacore.bounds.lower import lower_bound
from lacore.bounds.upper import upper_bound
from lacore.limit.cells import from_below, laws_of_crushing
from lacore.limit.solve import solve
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats
from lacore.numerics.threads import each
from lacore.reporting.errors import InputError
from lacore.reporting.findings import Finding
from lacore.reporting.kinds import Kind
from lacore.reporting.status import Rigor, Status

_NEARLY = 1 - 1.5e-6  # cosine of a tenth of a degree

_TRIES = 3  # number of directions without result before the search ends
_AT_A_TIME = 2  # number of directions that are chosen at a time, for any number of threads


@dataclass(frozen=True)
class DirectionBounds:
    """Proven results along one direction.

    Attributes:
        centre, direction: start and direction, (k,).
        lower, upper: factors of the direction; NaN without one.
        status: status at the end.
        normal: power of each component on the mechanism of the upper bound, (k,), or None.
        rigors: rigour of both bounds.
        seconds: time.
    """

    centre: Floats
    direction: Floats
    lower: float
    upper: float
    status: str
    normal: Floats | None
    rigors: frozenset[Rigor]
    seconds: float


@dataclass(frozen=True)
class Asking:
    """Computation of directions, each independent of the others.

    Attributes:
        components: components that are combined.
        backend, options: backend of all solves.
        target: width of brackets; None: bounds on the given mesh.
        convex: whether flow and friction are associated.
        deforms: whether any body is deformable, so that bounds are those of the continuum.
        jobs: number of simultaneous directions in threads.
    """

    components: Components
    backend: str
    options: Mapping[str, Any] | None
    target: float | None
    convex: bool
    deforms: bool
    jobs: int

    def answers(self, centre: Floats, ways: Sequence[Floats]) -> list[DirectionBounds]:
        """Return the results in the order of directions, which do not depend on `jobs`."""
        jobs = self.jobs if min(self.jobs, len(ways)) < 2 else 1  # jobs of each direction
        return list(each(lambda way: self.answer(centre, way, jobs), ways, self.jobs))

    def answer(self, centre: Floats, direction: Floats, jobs: int) -> DirectionBounds:
        """Return both bounds along a direction.

        Raises:
            InputError: dead loads that are not carried.
        """
        begin = time.perf_counter()
        stated = self.components.problem_at(centre, direction)
        if self.deforms and self.convex:
            lower, upper, status, rigors, plane = self._bounds(stated, jobs)
        else:
            lower, upper, status, rigors, plane = self._state(stated)
        return DirectionBounds(
            centre=centre,
            direction=direction,
            lower=lower,
            upper=upper,
            status=status,
            normal=None if plane is None else self.components.powers(*plane),
            rigors=rigors,
            seconds=time.perf_counter() - begin,
        )

    def _state(self, stated: Problem) -> "_Bounds":
        """Return the single load factor of rigid parts with its error, or a Coulomb state."""
        state = solve(stated, self.backend, options=self.options)
        value, wrong = proven_value(state), error(state)
        solved, label = state.status is Status.SOLVED, state.status.label
        rigors = frozenset({state.rigor} if solved else ())
        if state.status is Status.LOCKED:
            return np.inf, np.inf, label, rigors, None
        if state.status is Status.UNSAFE:
            raise _falling()
        if not np.isfinite(value):
            return np.nan, np.nan, label, rigors, None
        if not self.convex:
            return value, np.nan, label, rigors, None
        if not solved or state.point is None:
            return value - wrong, value + wrong, label, rigors, None
        if from_below(stated):  # This gives a point, as mechanisms of cells are not bounds.
            return value - wrong, np.nan, label, rigors, None
        lower, upper = proven(state)
        plane = state.discretisation.problem, state.point.velocity
        return lower if np.isfinite(lower) else np.nan, upper, label, rigors, plane

    def _bounds(self, stated: Problem, jobs: int) -> "_Bounds":
        """Return strict bounds of the continuum, on the mesh or on refined ones."""
        if self.target is not None:
            found = bracket(
                stated, self.target, backend=self.backend, options=self.options, jobs=jobs
            )
            below, above, status = found.lower_bound, found.upper_bound, found.status.label
            as_stated = not found.lent
        else:
            as_stated = True
            below = lower_bound(stated, self.backend, options=self.options)
            above = upper_bound(stated, self.backend, options=self.options)
            ends = {below.status, above.status} - {Status.SOLVED}
            status = min((end.label for end in ends), default=Status.SOLVED.label)
        # The lower bound may be UNSAFE because of its elements alone.
        if above.status is Status.UNSAFE:
            raise _falling()
        holds = as_stated and below.status in (Status.SOLVED, Status.LOCKED)
        holds = holds and not crossing(below, above)
        lower = below.load_factor if holds else np.nan
        if above.status is not Status.SOLVED or crossing(below, above):
            return lower, np.nan, status, frozenset(), None
        rigors = frozenset({above.rigor} | ({below.rigor} if np.isfinite(lower) else set()))
        plane = above.discretisation.problem, above.velocity
        return lower, above.load_factor, status, rigors, plane


def _falling() -> InputError:
    return InputError(
        "Problem.dead_loads",
        None,
        "they alone collapse the structure, so that no surface has them inside",
        "reduce them, or add what holds them up",
    )


_Bounds = tuple[float, float, str, frozenset[Rigor], tuple[Problem, Floats] | None]


@dataclass
class Search:
    """Directions that were computed, and what is proven so far.

    Attributes:
        asking: computation of directions.
        senses: signs of components that do not change whether loads are carried, (s, k), the first
            all 1.
        points: points that are carried, (k,) each.
        planes: planes beyond which nothing is carried, (k + 1,) each.
        rows: rows of the table.
        rigors: rigour of all bounds.
    """

    asking: Asking
    senses: Floats
    points: list[Floats] = field(default_factory=list)
    planes: list[Floats] = field(default_factory=list)
    rows: list[dict[str, Any]] = field(default_factory=list)
    rigors: set[Rigor] = field(default_factory=set)

    def ask(self, centre: Floats, ways: Sequence[Floats]) -> list[bool]:
        """Compute directions together; return whether any of them gives a point or a plane."""
        return [self._keep(answer) for answer in self.asking.answers(centre, ways)]

    def _keep(self, answer: DirectionBounds) -> bool:
        reach = answer.lower
        if reach == np.inf:  # It is carried at any size, so also at the given one.
            reach = 1.0 if self.asking.convex else np.nan
        point = None if np.isnan(reach) else answer.centre + reach * answer.direction
        if point is not None:
            self.points += [signs * point for signs in self.senses]
        if answer.normal is not None:
            offset = answer.upper + float(answer.normal @ answer.centre)
            self.planes += [np.append(signs * answer.normal, offset) for signs in self.senses]
            self.rigors |= answer.rigors
        names = self.asking.components.names
        seen = np.full(len(names), np.nan) if point is None else point
        self.rows.append(
            {
                "centre": tuple(answer.centre.tolist()),
                "direction": tuple(answer.direction.tolist()),
                "lower": answer.lower,
                "upper": answer.upper,
                "status": answer.status,
                **dict(zip(names, seen, strict=True)),
                "seconds": answer.seconds,
            }
        )
        return point is not None or answer.normal is not None

    def turns(self, axis: int) -> bool:
        """Return whether a component alone is equivalent in both senses."""
        return bool(np.any(self.senses[:, axis] < 0))

    def along_axes(self, k: int) -> None:
        """Compute the components alone, in both senses if they differ."""
        for axis in np.eye(k):
            self.ask(np.zeros(k), [axis])
            if not self.turns(int(np.argmax(axis))):
                self.ask(np.zeros(k), [-axis])

    def middle(self) -> tuple[Floats, Floats]:
        """Return half the extent of carried loads along each component, and a point inside."""
        names = self.asking.components.names
        k = len(names)
        ends = np.zeros((k, 2))
        for row in self.rows:
            size = row["lower"]
            if not np.isfinite(size):
                size = row["upper"] if np.isfinite(row["upper"]) else 1.0  # locked: the given size
            axis = int(np.argmax(np.abs(row["direction"])))
            backward = row["direction"][axis] < 0
            ends[axis, int(backward)] = -size if backward else size
            if self.turns(axis):
                ends[axis] = size, -size
        half = (ends[:, 0] - ends[:, 1]) / 2
        if not np.all(half > 0):
            raise InputError(
                f"loads[{names[int(np.argmin(half))]!r}]",
                None,
                "is carried in neither sense: what is carried has no inside",
                "add the weight or the strength that carries it",
            )
        return half, ends.mean(axis=1) / k

    def refine(self, centre: Floats, scale: Floats, n: int) -> Finding | None:
        """Compute directions to where the outer set is farthest from the inner one.

        Returns:
            Why it ended before `n` directions; None if it did not.
        """
        axes = len(self.rows)
        first: list[Floats] = []
        for corner in _corners(centre.size):
            images = [signs * own for own in first for signs in self.senses]
            if len(self.rows) + len(first) < n and all(_apart(corner, own) for own in images):
                first.append(corner)
        self.ask(centre, [scale * way for way in first])
        tried: list[Floats] = []
        while len(self.rows) < n:
            if len(tried) >= _TRIES:
                return Finding(Kind.NOTHING_PROVEN, values={"count": _TRIES})
            found = self.hulls(centre)
            if found is None:
                return Finding(Kind.NO_VOLUME)
            known = [np.array(row["direction"]) / scale for row in self.rows[axes:]]
            ways = self._farthest(found, centre, scale, [*known, *tried])[: n - len(self.rows)]
            if not ways:
                return Finding(Kind.CORNERS_SOLVED)
            new = self.ask(centre, [scale * way for way in ways])
            tried += [way for way, any_ in zip(ways, new, strict=True) if not any_]
        return None

    def _farthest(
        self, found: Hulls, centre: Floats, scale: Floats, known: Sequence[Floats]
    ) -> list[Floats]:
        """Return directions of the farthest corners that differ from known ones.

        The second is chosen as if inner and outer met half-way in the first, and in its images.
        """
        ways: list[Floats] = []
        points, far = list(found.inner), found.gauge
        for _ in range(_AT_A_TIME):
            images = [signs * way for way in [*known, *ways] for signs in self.senses]
            for number in np.argsort(-far):
                way = (found.outer[number] - centre) / scale
                way /= np.linalg.norm(way)
                if all(_apart(way, own) for own in images):
                    break
            else:
                break
            ways.append(way)
            met = centre + (found.outer[number] - centre) * (1 + 1 / found.gauge[number]) / 2
            points += [signs * met for signs in self.senses]
            nearer = gauge(np.array(points), centre, found.outer)
            assert nearer is not None
            far = nearer
        return ways

    def around(self, centre: Floats, scale: Floats, n: int) -> None:
        """Compute directions at equal angles, or on a spiral around a sphere, without early end."""
        ways = [scale * way for way in _spread(centre.size, n - len(self.rows))]
        for begin in range(0, len(ways), _AT_A_TIME):
            self.ask(centre, ways[begin : begin + _AT_A_TIME])

    def hulls(self, centre: Floats) -> Hulls | None:
        """Return both sets so far; None if points have no volume yet."""
        if len(self.points) <= centre.size or not self.planes:
            return None
        planes = np.array(self.planes)
        return hulls(np.array(self.points), planes[:, :-1], planes[:, -1], centre)

    @property
    def rigor(self) -> str:
        """What inner and outer prove."""
        if not self.asking.convex:
            if self.asking.deforms:
                return Rigor.DISCRETE.value
            return "certified Coulomb states"
        if laws_of_crushing(self.asking.components.problem):
            return "from one side, by cells of joints that crush"
        if not self.asking.deforms:
            return "exact but for the residuals of certificates"
        strict = self.rigors == {Rigor.LOWER, Rigor.UPPER}
        return "both sides by strict bounds of the continuum" if strict else "not all bounds strict"


def _corners(k: int) -> Floats:
    """Return directions between the axes, of length 1, (2^k, k); opposite ones from both ends."""
    signs = np.array(np.meshgrid(*[[1.0, -1.0]] * k)).reshape(k, -1).T
    return np.asarray(signs / np.sqrt(k))


def _spread(k: int, count: int) -> Floats:
    """Return directions at equal angles, or on a spiral around a sphere, shape (count, k)."""
    number = np.arange(count) + 0.5
    if k == 2:
        around = 2 * np.pi * number / max(count, 1)
        return np.stack([np.cos(around), np.sin(around)], axis=1)
    height = 1 - 2 * number / max(count, 1)
    turned = np.pi * (1 + 5**0.5) * number
    ring = np.sqrt(1 - height**2)
    return np.stack([ring * np.cos(turned), ring * np.sin(turned), height], axis=1)


def _apart(one: Floats, other: Floats) -> bool:
    """Return whether directions differ by more than a tenth of a degree."""
    size = float(np.linalg.norm(one) * np.linalg.norm(other))
    return float(one @ other) < _NEARLY * size
