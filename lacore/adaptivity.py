"""Brackets with proof by adaptive refinement (T26, T26b, T26d)."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields, replace
from math import ceil, log
from typing import Any

import numpy as np
import pandas as pd
from skfem import MeshTri

from lacore.arrays import Floats
from lacore.backend import find_backend
from lacore.bodies import Body
from lacore.brackets import Bracket, Ending, Step, crossing, proven, width
from lacore.errors import InputError, require_count, require_known, require_positive
from lacore.fans import fanned, sectors_for, singular_points
from lacore.kinematic_bound import UpperBound, upper_bound
from lacore.marking import lower_shares, shared_shares, upper_shares
from lacore.mesh_checks import quality
from lacore.meshes import split
from lacore.problem import Problem
from lacore.refinement import grown
from lacore.same_domain import difference
from lacore.solving import solve
from lacore.static_bound import LowerBound, lower_bound
from lacore.static_corners import CornerError
from lacore.static_model import static_model
from lacore.status import Status

Bound = LowerBound | UpperBound

MESHES = ("separate", "shared")
_SPACE = "p2-vertex"  # "p2-gauss" is a little closer, and astray where mechanisms are not unique
_GROWTH = 2.0  # of a mesh from solve to solve
_LEAST_GROWTH = 1.2
_LOOSE = 1e-3  # tolerance of solvers per width: costs a lower bound 20 times as much
_LOOSEST, _TIGHTEST = 2e-5, 1e-9
_JUDGED = 1e-3  # residuals of a velocity that is worth projecting
_SLIVER = 0.01  # shape of a triangle; below it strain rates lose their digits
_RECENT = 2  # refinements whose gains count
_SMALL = 0.5  # of the elements of the other mesh: below it a solve costs little
_PATIENCE = 4  # refinements in a row that gain nothing
_NOTHING = 1e-3  # gain, per target width


def bracket(
    problem: Problem,
    target_width: float = 0.01,
    max_elements: int = 20_000,
    time_limit: float = 600.0,
    backend: str = "clarabel",
    *,
    meshes: str | None = None,
    lower_mesh: MeshTri | None = None,
    on_step: Callable[[Step], None] | None = None,
) -> Bracket:
    """A load factor between a strict lower and a strict upper bound, as narrow as asked for.

    Meshes are refined by the shares of their elements in the error: a shared one by those in the
    gap and in the error of the lower bound, separate ones each by its own, the one that gains more
    per element first. All bounds on the way are proven too (projection, T26c), and the best counts.
    Elements at corners that a lower bound cannot state are split first.

    Args:
        problem: one deformable body in its velocity space ``p2-vertex``, whatever it says itself.
        target_width: of ``(upper - lower)/mean`` to stop at.
        max_elements: of each mesh.
        time_limit: s, wall clock; no solve starts that is expected to end after it.
        backend: name of an exact backend.
        meshes: ``shared`` or ``separate``. None: separate where `lower_mesh` is given. Where the
            mesh of a problem knows nothing of its stresses, a shared one is the better choice.
        lower_mesh: mesh of the same domain to start the lower bound from, such as a
            `lacore.meshes.fan`. None: that of the problem; where meshes are separate, with fans at
            its singular points.
        on_step: called after each solve, for progress.

    Raises:
        InputError: a target or a limit that is not positive, limits below the start, several
            bodies, slivers, a `lower_mesh` of another domain; what a lower bound cannot state.
        CapabilityError: the backend is missing, regularised, or cannot take the problem.
    """
    begin = time.perf_counter()
    require_positive("target_width", target_width)
    require_count("max_elements", max_elements)
    require_positive("time_limit", time_limit)
    if not isinstance(problem, Problem):
        raise InputError("problem", problem, "not a problem", "give a lacore.Problem")
    run = _Run(
        _only_body(problem)[0],
        backend,
        target_width,
        begin,
        begin + time_limit,
        max_elements,
        on_step,
    )
    tracks = _starts(problem, run, meshes, lower_mesh)
    for number, track in enumerate(tracks):
        tracks[number] = run.solved(track, track.problem)
    while (ending := run.ending(tracks)) is None:
        number = _next([k for k, track in enumerate(tracks) if run.closed(track) is None], tracks)
        finer = run.refined(tracks[number])
        if finer is None:
            tracks[number] = replace(tracks[number], too_fine=True)
        elif run.too_late(tracks[number], finer):
            ending = Ending.TIME_LIMIT
            break
        else:
            tracks[number] = run.solved(tracks[number], finer)
    lower, upper = run.best["lower"], run.best["upper"]
    assert isinstance(lower, LowerBound)
    assert isinstance(upper, UpperBound)
    missing = {"lower": lower.message, "upper": upper.state.message}
    for kind, bound in run.best.items():
        if bound.status is not Status.SOLVED:
            run.failures[kind] = run.failures[kind] or missing[kind]
    failed = [f"{kind} bound: {why}" for kind, why in sorted(run.failures.items()) if why]
    if ending is Ending.CROSSED:
        failed.append(crossing(lower, upper))
    return Bracket(ending, lower, upper, target_width, pd.DataFrame(run.rows), "; ".join(failed))


@dataclass(frozen=True)
class _Track:
    """A mesh on its way, and the bounds that are solved on it.

    Attributes:
        kinds: ``lower``, ``upper`` or both.
        problem: on the mesh.
        last: bounds on it, by kind.
        gains: what the last refinements gained, in the unit of load factors.
        seconds: of the last solves.
        too_fine: whether the next mesh has too many elements.
    """

    kinds: tuple[str, ...]
    problem: Problem
    last: Mapping[str, Bound] = field(default_factory=dict)
    gains: tuple[float, ...] = ()
    seconds: float = 0.0
    too_fine: bool = False

    @property
    def mesh(self) -> MeshTri:
        return _mesh(self.problem)

    @property
    def elements(self) -> int:
        return int(self.mesh.nelements)

    @property
    def rate(self) -> float:
        """Largest recent gain per element: bounds rise in steps. What is new goes first."""
        return max(self.gains[-_RECENT:], default=np.inf) / self.elements


def _next(open_: Sequence[int], tracks: Sequence[_Track]) -> int:
    """The one that promises more, or costs little."""
    small = min(open_, key=lambda number: tracks[number].elements)
    if tracks[small].elements < _SMALL * max(tracks[number].elements for number in open_):
        return small
    return max(open_, key=lambda number: tracks[number].rate)


@dataclass
class _Run:
    """What was asked for, and what is proven so far."""

    body: str
    backend: str
    target: float
    begin: float
    deadline: float
    max_elements: int
    on_step: Callable[[Step], None] | None
    best: dict[str, Bound] = field(default_factory=dict)
    failures: dict[str, str] = field(default_factory=dict)
    rows: list[dict[str, Any]] = field(default_factory=list)

    @property
    def lower(self) -> float:
        return proven(self.best.get("lower"), -np.inf)

    @property
    def upper(self) -> float:
        return proven(self.best.get("upper"), np.inf)

    @property
    def width(self) -> float:
        return width(self.lower, self.upper)

    @property
    def crossed(self) -> bool:
        """Whether the lower bound lies above the upper one: either is wrong."""
        lower, upper = self.best.get("lower"), self.best.get("upper")
        if isinstance(lower, LowerBound) and isinstance(upper, UpperBound):
            return bool(crossing(lower, upper))
        return False

    @property
    def growth(self) -> float:
        """Of the next mesh, in even steps to the target: widths fall about as elements rise."""
        missing = self.width / self.target
        if not np.isfinite(missing):
            return _GROWTH
        steps = ceil(log(max(missing, 1.0)) / log(_GROWTH))
        return max(float(missing ** (1 / max(steps, 1))), _LEAST_GROWTH)

    def solved(self, track: _Track, problem: Problem) -> _Track:
        """The track on a new mesh; what it proves is kept."""
        begin = time.perf_counter()
        last: dict[str, Bound] = {}
        before = [proven(self.best.get(kind), np.nan) for kind in track.kinds]
        for kind in track.kinds:
            if last and self.width <= self.target:
                break
            last[kind] = self._solved(kind, problem)
        after = [proven(self.best.get(kind), np.nan) for kind in track.kinds]
        gain = float(np.abs(np.subtract(after, before)).sum())
        return replace(
            track,
            problem=problem,
            last=last,
            gains=(*track.gains, gain) if np.isfinite(gain) else track.gains,
            seconds=time.perf_counter() - begin,
        )

    def _solved(self, kind: str, problem: Problem) -> Bound:
        # What this mesh will about prove decides how close a solve must come.
        width = max(self.width / self.growth if self.rows else np.inf, self.target)
        tolerance = float(np.clip(_LOOSE * width, _TIGHTEST, _LOOSEST))
        bound = self._bound(kind, problem, {"tolerance": tolerance})
        if bound.status is Status.NOT_CERTIFIED:
            bound = self._bound(kind, problem, {})
        sign = 1.0 if kind == "lower" else -1.0
        holds, best = bound.status is Status.SOLVED, self.best.get(kind, bound)
        if best.status is not Status.SOLVED or (
            holds and sign * (bound.load_factor - best.load_factor) > 0
        ):
            best = bound
        self.best[kind] = best
        # Elements that are too few to carry the dead loads, or to flow, are no failure.
        few = {"lower": Status.UNSAFE, "upper": Status.LOCKED}
        state = bound.state if isinstance(bound, UpperBound) else bound
        fails = not (holds or bound.status is few[kind])
        self.failures[kind] = (state.message or bound.status.value) if fails else ""
        self._tell(kind, bound, _mesh(problem))
        return bound

    def _bound(self, kind: str, problem: Problem, options: Mapping[str, Any]) -> Bound:
        known = {field.name for field in fields(find_backend(self.backend).Options)}
        left = max(self.deadline - time.perf_counter(), 1.0)
        given = {k: v for k, v in {**options, "time_limit": left}.items() if k in known}
        if kind == "lower":
            return lower_bound(problem, self.backend, options=given)
        state = solve(problem, self.backend, "associated", tolerance=_JUDGED, options=given)
        return upper_bound(state)

    def _tell(self, kind: str, bound: Bound, mesh: MeshTri) -> None:
        step = Step(
            step=len(self.rows),
            bound=kind,
            elements=int(mesh.nelements),
            solved=proven(bound, np.nan),
            lower=self.lower,
            upper=self.upper,
            width=self.width,
            quality=float(quality(mesh).min()),
            seconds=time.perf_counter() - self.begin,
        )
        if self.on_step is not None:
            self.on_step(step)
        self.rows.append(asdict(step))

    def ending(self, tracks: Sequence[_Track]) -> Ending | None:
        """Why it ends, if it does."""
        if self.crossed:
            return Ending.CROSSED
        if self.width <= self.target:
            return Ending.REACHED
        if any(
            why and self.best[kind].status is not Status.SOLVED
            for kind, why in self.failures.items()
        ):
            return Ending.NO_BOUND
        closed = [self.closed(track) for track in tracks]
        if None in closed:
            return None
        return Ending.MAX_ELEMENTS if Ending.MAX_ELEMENTS in closed else Ending.NO_PROGRESS

    def closed(self, track: _Track) -> Ending | None:
        """Why a mesh is not refined any more."""
        if track.too_fine:
            return Ending.MAX_ELEMENTS
        last = track.gains[-_PATIENCE:]
        least = _NOTHING * self.target * abs(self.upper)
        spent = len(last) == _PATIENCE and max(last) <= least
        return Ending.NO_PROGRESS if spent else None

    def refined(self, track: _Track) -> Problem | None:
        """The problem on the next mesh, if that may be."""
        finer = grown(track.mesh, self.shares(track), self.growth, self.max_elements)
        return None if finer is None else _on_mesh(track.problem, finer)

    def shares(self, track: _Track) -> Floats:
        """Of elements in the error of what was solved last; all the same where nothing was."""
        lower, upper = track.last.get("lower"), track.last.get("upper")
        if proven(lower, np.nan) <= proven(upper, np.nan):
            assert isinstance(lower, LowerBound)
            assert isinstance(upper, UpperBound)
            return shared_shares(upper, lower, self.body)
        if isinstance(upper, UpperBound) and np.all(np.isfinite(upper.velocity)):
            return upper_shares(upper, self.body)
        if isinstance(lower, LowerBound) and lower.point is not None:
            return lower_shares(lower, self.body)
        return np.ones(track.elements)

    def too_late(self, track: _Track, finer: Problem) -> bool:
        """Whether the next solve is expected to end after the limit."""
        expected = track.seconds * float(_mesh(finer).nelements) / track.elements
        return time.perf_counter() + expected > self.deadline


def _starts(
    problem: Problem, run: _Run, meshes: str | None, lower_mesh: MeshTri | None
) -> list[_Track]:
    """The first meshes."""
    if meshes is not None:
        require_known("meshes", meshes, MESHES)
    if lower_mesh is not None and meshes == "shared":
        raise InputError(
            "lower_mesh", None, "there is one mesh only", "give it as that of the problem"
        )
    problem = _on_mesh(problem, _mesh(problem))
    if meshes is None:
        meshes = "shared" if lower_mesh is None else "separate"
    if meshes == "shared":
        both = _statable(problem)
        _check_start("both bounds", _mesh(both), run.max_elements)
        return [_Track(("lower", "upper"), both)]
    _check_start("the upper bound", _mesh(problem), run.max_elements)
    if lower_mesh is None:
        points = singular_points(problem, run.body)
        below = _on_mesh(problem, fanned(_mesh(problem), points, sectors_for(run.target)))
    else:
        below = _given(problem, lower_mesh)
    below = _statable(below)
    _check_start("the lower bound", _mesh(below), run.max_elements)
    return [_Track(("lower",), below), _Track(("upper",), problem)]


def _given(problem: Problem, lower_mesh: MeshTri) -> Problem:
    """The problem on a mesh of the user, which must be one of the same domain."""
    if type(lower_mesh) is not MeshTri:
        raise InputError(
            "lower_mesh",
            type(lower_mesh).__name__,
            "not a mesh of straight-edged triangles",
            "give a skfem.MeshTri, such as a lacore.meshes.fan",
        )
    below = _on_mesh(problem, lower_mesh)
    why = difference(_only_body(problem)[1], _only_body(below)[1])
    if why:
        raise InputError(
            "lower_mesh",
            f"mesh of {lower_mesh.nelements} elements",
            f"covers another domain: {why}; a lower bound there is none of this problem",
            "mesh the same outline, with the same names of its parts",
        )
    return below


def _statable(problem: Problem) -> Problem:
    """With elements split at whose corners loads ask for two shear stresses in one place."""
    try:
        static_model(problem)
    except CornerError as error:
        return _on_mesh(problem, split(_mesh(problem), error.elements))
    return problem


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
            f"the mesh of {whose} starts with {mesh.nelements} elements",
            "raise it, or start coarser",
        )
    shape = quality(mesh)
    worst = int(np.argmin(shape))
    if shape[worst] < _SLIVER:
        raise InputError(
            f"mesh of {whose}",
            None,
            f"element {worst} is a sliver of shape {shape[worst]:.2g} (1 is equilateral), below"
            f" {_SLIVER}",
            "move its vertices, or mesh with larger angles",
        )
