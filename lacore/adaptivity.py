"""Brackets with proof by adaptive refinement (T26, T26b, T26d)."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from enum import Enum
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from skfem import MeshTri

from lacore.arrays import Floats
from lacore.backend import find_backend
from lacore.bodies import Body
from lacore.errors import InputError, require_count, require_positive
from lacore.fans import fanned, sectors_for, singular_points
from lacore.gap_identity import GapIdentity, gap_identity
from lacore.kinematic_bound import UpperBound, upper_bound
from lacore.marking import doerfler, lower_shares, upper_shares
from lacore.mesh_checks import quality
from lacore.problem import Problem
from lacore.refinement import refined
from lacore.solving import solve
from lacore.static_bound import LowerBound, lower_bound
from lacore.status import Rigor, Status

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_SPACE = "p2-vertex"
_THETA = 0.5  # Doerfler's part of all shares; 0.4 to 0.7 differ little
_LOOSE = 1e-3  # tolerance of solvers per target width: costs a lower bound 20 times as much
_LOOSEST, _TIGHTEST = 2e-5, 1e-9
_JUDGED = 1e-3  # residuals of a velocity that is worth projecting
_SLIVER = 0.01  # shape of a triangle; below it strain rates lose their digits
_RECENT = 2  # refinements whose gains count
_SMALL = 0.5  # of the elements of the other mesh: below it a solve costs little
_PATIENCE = 4  # refinements in a row that gain nothing
_NOTHING = 1e-3  # gain, per target width


class Ending(Enum):
    """Why a bracket is as wide as it is. The text says what to do."""

    REACHED = "the target width is proven"
    MAX_ELEMENTS = "not reached: the next mesh would have more elements than `max_elements`"
    TIME_LIMIT = "not reached: the next solve would end after `time_limit`"
    NO_PROGRESS = (
        "not reached: refinement gains nothing more; at a singular point a lower bound needs more"
        " sectors (`lower_mesh`, lacore.meshes.fan)"
    )
    NO_BOUND = "not reached: a bound could not be proven; see `failure`"

    @property
    def label(self) -> str:
        """The name as shown in tables: ``max elements``."""
        return self.name.lower().replace("_", " ")


@dataclass(frozen=True)
class Step:
    """One solve on the way.

    Attributes:
        step: 0, 1, ...
        bound: ``lower`` or ``upper``: which one was solved.
        elements: of its mesh.
        solved: what this mesh proves.
        lower, upper: the best that is proven so far.
        width: ``(upper - lower)`` per their mean; inf while there are not both.
        quality: shape of the worst triangle, 1 for equilateral ones.
        seconds: since the start, everything included.
    """

    step: int
    bound: str
    elements: int
    solved: float
    lower: float
    upper: float
    width: float
    quality: float
    seconds: float


@dataclass(frozen=True)
class Bracket:
    """A load factor between two proven ones.

    Attributes:
        status: whether the target was reached, and if not, why.
        lower_bound, upper_bound: the best ones, with their states and meshes.
        target_width: as asked for.
        history: one row a solve, see `Step`.
        failure: what the solver said where there is no bound, else empty.
    """

    status: Ending
    lower_bound: LowerBound
    upper_bound: UpperBound
    target_width: float
    history: pd.DataFrame
    failure: str

    @property
    def lower(self) -> float:
        """Load factor that is proven from below; -inf where none is."""
        return _proven(self.lower_bound, -np.inf)

    @property
    def upper(self) -> float:
        """Load factor that is proven from above; +inf where none is."""
        return _proven(self.upper_bound, np.inf)

    @property
    def width(self) -> float:
        """``(upper - lower)`` per their mean."""
        return width(self.lower, self.upper)

    @property
    def strict(self) -> bool:
        """Whether both are bounds of the continuum: exact geometry."""
        rigors = (self.lower_bound.rigor, self.upper_bound.rigor)
        return rigors == (Rigor.LOWER, Rigor.UPPER)

    @cached_property
    def gaps(self) -> GapIdentity:
        """Shares of the elements of the upper bound's mesh in the gap to a lower bound there (T26).

        From one more solve, on that mesh, which has no fan: its lower bound is a little worse.

        Raises:
            ValueError: there is no upper bound.
        """
        if self.upper_bound.status is not Status.SOLVED:
            raise ValueError(f"there is no gap to look at: {self.status.label}: {self.failure}")
        problem = self.upper_bound.discretisation.problem
        below = self.lower_bound
        options = {k: v for k, v in below.options.items() if k != "time_limit"}
        return gap_identity(
            self.upper_bound, lower_bound(problem, below.backend, options=options, throw=True)
        )

    def plot(self) -> "Figure":
        """Both meshes and their shares: see `lacore.plotting_bracket.plot_bracket`."""
        from lacore.plotting_bracket import plot_bracket

        return plot_bracket(self)


def bracket(
    problem: Problem,
    target_width: float = 0.01,
    max_elements: int = 20_000,
    time_limit: float = 600.0,
    backend: str = "clarabel",
    *,
    lower_mesh: MeshTri | None = None,
    on_step: Callable[[Step], None] | None = None,
) -> Bracket:
    """A load factor between a strict lower and a strict upper bound, as narrow as asked for.

    Each bound is refined on a mesh of its own by its own shares of the error, the one that gains
    more per element first. All bounds on the way are proven too (projection, T26c), and the best
    counts.

    Args:
        problem: one deformable body in its velocity space ``p2-vertex``, whatever it says itself.
        target_width: of ``(upper - lower)/mean`` to stop at.
        max_elements: of each mesh.
        time_limit: s, wall clock; no solve starts that is expected to end after it.
        backend: name of an exact backend.
        lower_mesh: mesh to start the lower bound from. None: that of the problem, with fans at
            its singular points, which refinement cannot make.
        on_step: called after each solve, for progress.

    Raises:
        InputError: a target or a limit that is not positive, limits below the start, several
            bodies, slivers; what a lower bound cannot state.
        CapabilityError: the backend is missing, regularised, or cannot take the problem.
    """
    begin = time.perf_counter()
    require_positive("target_width", target_width)
    require_count("max_elements", max_elements)
    require_positive("time_limit", time_limit)
    if not isinstance(problem, Problem):
        raise InputError("problem", problem, "not a problem", "give a lacore.Problem")
    name, body = _only_body(problem)
    problem = _on_mesh(problem, body.mesh)
    _check_start("upper bound", body.mesh, max_elements)
    if lower_mesh is None:
        below, points = problem, singular_points(problem, name)
        if points:
            below = _on_mesh(problem, fanned(body.mesh, points, sectors_for(target_width)))
    else:
        below = _on_mesh(problem, lower_mesh)
    _check_start("lower bound", _mesh(below), max_elements)
    tolerance = float(np.clip(_LOOSE * target_width, _TIGHTEST, _LOOSEST))
    run = _Run(name, backend, tolerance, target_width, begin + time_limit, max_elements)
    rows: list[dict[str, Any]] = []
    sides: dict[str, _Side] = {}
    ending = None
    for kind, stated in (("lower", below), ("upper", problem)):
        sides[kind] = run.solved(_Side(kind, stated), stated)
        rows.append(_told(sides, kind, len(rows), begin, on_step))
    while ending is None:
        ending = run.ending(sides)
        if ending is not None:
            break
        side = _next([side for side in sides.values() if run.closed(side) is None])
        finer = run.refined(side)
        if finer is None:
            sides[side.kind] = replace(side, too_fine=True)
            continue
        if run.too_late(side, finer):
            ending = Ending.TIME_LIMIT
            break
        sides[side.kind] = run.solved(side, finer)
        rows.append(_told(sides, side.kind, len(rows), begin, on_step))
    lower, upper = sides["lower"].best, sides["upper"].best
    assert isinstance(lower, LowerBound)
    assert isinstance(upper, UpperBound)
    failed = [f"{side.kind} bound: {side.failure}" for side in sides.values() if side.failure]
    return Bracket(ending, lower, upper, target_width, pd.DataFrame(rows), "; ".join(failed))


def width(lower: float, upper: float) -> float:
    """``(upper - lower)`` per their mean; inf where one is missing."""
    if not (np.isfinite(lower) and np.isfinite(upper)):
        return np.inf
    mean = abs(lower + upper) / 2
    return (upper - lower) / mean if mean > 0 else np.inf


@dataclass(frozen=True)
class _Side:
    """One of the two bounds on its way: the last mesh, and the best of all."""

    kind: str
    problem: Problem
    last: LowerBound | UpperBound | None = None
    best: LowerBound | UpperBound | None = None
    gains: tuple[float, ...] = ()
    seconds: float = 0.0
    failure: str = ""
    too_fine: bool = False

    @property
    def mesh(self) -> MeshTri:
        return _mesh(self.problem)

    @property
    def elements(self) -> int:
        return int(self.mesh.nelements)

    @property
    def proven(self) -> bool:
        return self.best is not None and self.best.status is Status.SOLVED

    @property
    def rate(self) -> float:
        """Largest recent gain per element: bounds rise in steps. What is new goes first."""
        return max(self.gains[-_RECENT:], default=np.inf) / self.elements


def _next(sides: Sequence[_Side]) -> _Side:
    """The one that promises more, or costs little."""
    small = min(sides, key=lambda side: side.elements)
    if small.elements < _SMALL * max(side.elements for side in sides):
        return small
    return max(sides, key=lambda side: side.rate)


@dataclass(frozen=True)
class _Run:
    """What does not change."""

    body: str
    backend: str
    tolerance: float
    target: float
    deadline: float
    max_elements: int

    def solved(self, side: _Side, problem: Problem) -> _Side:
        begin = time.perf_counter()
        bound = self._bound(side.kind, problem, {"tolerance": self.tolerance})
        if bound.status is Status.NOT_CERTIFIED:
            bound = self._bound(side.kind, problem, {})
        sign = 1.0 if side.kind == "lower" else -1.0
        proven = bound.status is Status.SOLVED
        better, gains = bound, side.gains
        if side.best is not None and side.best.status is Status.SOLVED:
            gain = sign * (bound.load_factor - side.best.load_factor) if proven else 0.0
            better = bound if gain > 0 else side.best
            gains = (*gains, max(gain, 0.0))
        state = bound.state if isinstance(bound, UpperBound) else bound
        # Elements that are too few to carry the dead loads, or to flow, are no failure.
        few = {"lower": Status.UNSAFE, "upper": Status.LOCKED}
        coarse = bound.status is few[side.kind]
        return replace(
            side,
            problem=problem,
            last=bound,
            best=better,
            gains=gains,
            seconds=time.perf_counter() - begin,
            failure="" if proven or coarse else state.message or bound.status.value,
        )

    def _bound(
        self, kind: str, problem: Problem, options: Mapping[str, Any]
    ) -> LowerBound | UpperBound:
        known = {field.name for field in fields(find_backend(self.backend).Options)}
        left = max(self.deadline - time.perf_counter(), 1.0)
        given = {k: v for k, v in {**options, "time_limit": left}.items() if k in known}
        if kind == "lower":
            return lower_bound(problem, self.backend, options=given)
        state = solve(problem, self.backend, "associated", tolerance=_JUDGED, options=given)
        return upper_bound(state)

    def ending(self, sides: Mapping[str, _Side]) -> Ending | None:
        lower, upper = (_proven(sides[k].best, np.nan) for k in ("lower", "upper"))
        if width(lower, upper) <= self.target:
            return Ending.REACHED
        if any(side.failure and not side.proven for side in sides.values()):
            return Ending.NO_BOUND
        closed = [self.closed(side) for side in sides.values()]
        if None in closed:
            return None
        return Ending.MAX_ELEMENTS if Ending.MAX_ELEMENTS in closed else Ending.NO_PROGRESS

    def closed(self, side: _Side) -> Ending | None:
        """Why a side is not refined any more."""
        if side.too_fine:
            return Ending.MAX_ELEMENTS
        last = side.gains[-_PATIENCE:]
        least = _NOTHING * self.target * abs(_proven(side.best, np.inf))
        spent = len(last) == _PATIENCE and max(last) <= least
        return Ending.NO_PROGRESS if spent else None

    def refined(self, side: _Side) -> Problem | None:
        finer = refined(side.mesh, doerfler(self.shares(side), _THETA))
        if finer.nelements > self.max_elements:
            return None
        return _on_mesh(side.problem, finer)

    def shares(self, side: _Side) -> Floats:
        bound = side.last
        if isinstance(bound, UpperBound) and np.all(np.isfinite(bound.velocity)):
            return upper_shares(bound, self.body)
        if isinstance(bound, LowerBound) and bound.point is not None:
            return lower_shares(bound, self.body)
        return np.ones(side.elements)

    def too_late(self, side: _Side, finer: Problem) -> bool:
        expected = side.seconds * float(_mesh(finer).nelements) / side.elements
        return time.perf_counter() + expected > self.deadline


def _proven(bound: LowerBound | UpperBound | None, otherwise: float) -> float:
    if bound is None or bound.status is not Status.SOLVED:
        return otherwise
    return bound.load_factor


def _told(
    sides: Mapping[str, _Side],
    kind: str,
    number: int,
    begin: float,
    on_step: Callable[[Step], None] | None,
) -> dict[str, Any]:
    side = sides[kind]
    lower = _proven(sides["lower"].best, -np.inf)
    upper = _proven(sides["upper"].best, np.inf) if "upper" in sides else np.inf
    step = Step(
        step=number,
        bound=kind,
        elements=side.elements,
        solved=_proven(side.last, np.nan),
        lower=lower,
        upper=upper,
        width=width(lower, upper),
        quality=float(quality(side.mesh).min()),
        seconds=time.perf_counter() - begin,
    )
    if on_step is not None:
        on_step(step)
    return asdict(step)


def _only_body(problem: Problem) -> tuple[str, Body]:
    if len(problem.bodies) > 1:
        raise InputError(
            "Problem.bodies",
            list(problem.bodies),
            "a bracket refines the mesh of one body, and meshes must match where bodies meet",
            "refine by hand, with lacore.lower_bound and lacore.upper_bound",
        )
    ((name, body),) = problem.bodies.items()
    if not isinstance(body, Body) or type(body.mesh) is not MeshTri:
        raise InputError(
            f"Problem.bodies[{name!r}]",
            type(body.mesh if isinstance(body, Body) else body).__name__,
            "a bracket takes a deformable body on straight-edged triangles",
            "give a lacore.Body on a skfem.MeshTri",
        )
    if body.axisymmetric:
        raise InputError(
            f"Problem.bodies[{name!r}].kinematics",
            body.kinematics,
            "nothing is a strict bound of a body of revolution",
            "take `solve`, whose value converges under refinement",
        )
    return name, body


def _on_mesh(problem: Problem, mesh: MeshTri) -> Problem:
    ((name, body),) = problem.bodies.items()
    assert isinstance(body, Body)
    return replace(problem, bodies={name: replace(body, mesh=mesh, space=_SPACE)})


def _mesh(problem: Problem) -> MeshTri:
    (body,) = problem.bodies.values()
    assert isinstance(body, Body)
    return body.mesh


def _check_start(whose: str, mesh: MeshTri, max_elements: int) -> None:
    if mesh.nelements > max_elements:
        raise InputError(
            "max_elements",
            max_elements,
            f"the mesh of the {whose} starts with {mesh.nelements} elements",
            "raise it, or start coarser",
        )
    shape = quality(mesh)
    worst = int(np.argmin(shape))
    if shape[worst] < _SLIVER:
        raise InputError(
            f"mesh of the {whose}",
            None,
            f"element {worst} is a sliver of shape {shape[worst]:.2g} (1 is equilateral), below"
            f" {_SLIVER}",
            "move its vertices, or mesh with larger angles",
        )
