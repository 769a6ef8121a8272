"""Brackets with proof by adaptive refinement (T26, T26b, T26d)."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np
import pandas as pd
from skfem import MeshTri

from lacore.bounds.bracket.asking import Bound, RequestedBound, Solver, processors
from lacore.bounds.bracket.bracket import Bracket, Ending, Step, crossing, proven, width
from lacore.bounds.bracket.marking import shares_of
from lacore.bounds.bracket.starts import starts
from lacore.bounds.bracket.track import Track, growths, on_finer, order
from lacore.bounds.bracket.whole import continua, mesh_of
from lacore.bounds.constants import (
    AFFORDABLE_LOSS,
    LOOSE_TOLERANCE,
    LOOSEST_TOLERANCE,
    NO_GAIN,
    NO_LOAD_FACTOR,
    PATIENCE,
    RECENT,
    SETTLED_REST,
    SOIL_TOLERANCES,
    TIGHTEST_TOLERANCE,
)
from lacore.bounds.enclosing import has_coulomb, require_associated_flow
from lacore.bounds.lending import with_default_cohesion, with_lent_cohesion
from lacore.bounds.lower import LowerBound, lower_bound
from lacore.bounds.upper import UpperBound
from lacore.limit.solve import solve
from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.continuum.body import Body
from lacore.model.meshes.checks import quality
from lacore.model.meshes.refinement import grown
from lacore.model.problem.problem import Problem
from lacore.reporting.errors import require_count, require_positive, require_width, typed
from lacore.reporting.findings import Finding, Severity
from lacore.reporting.kinds import Kind
from lacore.reporting.status import Status
from lacore.solvers.backend import find_backend, read_options


@typed(lower_mesh="give a skfem.MeshTri, such as a lacore.model.meshes.fan")
def bracket(
    problem: Problem,
    target_width: float = 0.01,
    max_elements: int = 20_000,
    time_limit: float = 600.0,
    backend: str = "auto",
    *,
    options: Mapping[str, Any] | None = None,
    meshes: str | None = None,
    lower_mesh: MeshTri | None = None,
    jobs: int | None = None,
    on_step: Callable[[Step], None] | None = None,
    lent_cohesion: float | None = None,
) -> Bracket:
    """Compute a strict lower and a strict upper bound, as close as requested.

    With Coulomb friction they enclose every Coulomb load factor of the continuum: the lower bound
    is one of the problem without that friction, the upper one of that with associated friction
    (T14), each on a separate mesh. These two may differ on arbitrarily fine meshes; the refinement
    then ends when it gains little.

    Meshes are refined by the shares of their elements in the error: a shared mesh by the shares in
    the gap and in the error of the lower bound, separate meshes by their own shares; the mesh with
    more to gain is refined more. All intermediate bounds are also proven (projection, T26c), and
    the best ones are returned. Elements at corners without suitable stresses are split first.

    Args:
        problem: deformable bodies, always with the velocity space ``p2-vertex``, and any rigid
            blocks in contact with them; meshes have vertices at the ends of blocks. If the edges of
            two bodies in contact do not match, elements are divided first
            (`lacore.matching`); then both sides are refined together.
        target_width: value of ``(upper - lower)/mean`` at which to stop.
        max_elements: limit for each mesh.
        time_limit: s, wall clock; no solve starts that is expected to end after it.
        backend: name of an exact backend.
        options: options of the backend; a tolerance given here is used in all solves, otherwise it
            follows the width.
        meshes: ``shared`` or ``separate``. None: separate where `lower_mesh` is given, with Coulomb
            friction, and with friction in the body and singular points of it. A shared mesh is
            better if the mesh of the problem is not adapted to its stresses.
        lower_mesh: mesh of the same domain to start the lower bound from, such as a
            `lacore.model.meshes.fan`. None: the mesh of the problem, with fans at its singular
            points if meshes are separate.
        jobs: number of simultaneous solves in threads, at most two; None: of processors. Bounds do
            not depend on it unless the time limit is reached.
        on_step: called after each solve, for progress.
        lent_cohesion: Pa, given to bodies without cohesion or without tension. The bracket is then
            not strict: the lower bound is one of the problem with it. None: a share of the target
            width, by weight, for heavy bodies.

    Raises:
        InputError: a target or a limit that is not positive, limits below the start, slivers, a
            `lower_mesh` of another domain or of one of several bodies, unknown options; or features
            without lower bounds.
        CapabilityError: the backend is missing, regularised, or does not support the problem.

    Example:
        >>> found = la.bracket(la.examples.footing(), target_width=0.05)
        >>> found.lower < 2 + np.pi < found.upper
        True
        >>> found.width < 0.05
        True
    """
    begin = time.perf_counter()
    require_width("target_width", target_width)
    require_count("max_elements", max_elements)
    require_positive("time_limit", time_limit)
    jobs = processors() if jobs is None else jobs
    require_count("jobs", jobs)
    require_associated_flow(of_kind(problem.bodies, Body))
    read_options(find_backend(backend), options or {})
    if lent_cohesion is None:
        problem, lent = with_default_cohesion(problem, target_width)
    else:
        problem, lent = with_lent_cohesion(problem, lent_cohesion)
    bodies = continua(problem)
    run = _Run(
        list(bodies),
        any(body.pressure_dependent for body in bodies.values()),
        Solver(backend, dict(options or {}), begin + time_limit, jobs),
        target_width,
        begin,
        max_elements,
        on_step,
        has_coulomb(problem),
        lent,
    )
    first = starts(problem, target_width, max_elements, meshes, lower_mesh)
    tracks = [Track(start.kinds, start.problem) for start in first]
    tracks = run.solved([(track, track.problem) for track in tracks])
    run.seen.append((sum(track.elements for track in tracks), run.width))
    while (ending := run.ending(tracks)) is None:
        tracks = run.advanced(tracks)
    return run.found(ending, tracks)


@dataclass
class _Run:
    """Arguments of a bracket, and the bounds that are proven so far."""

    bodies: list[str]
    pressure_dependent: bool
    solver: Solver
    target: float
    begin: float
    max_elements: int
    on_step: Callable[[Step], None] | None
    coulomb: bool
    lent: tuple[Finding, ...] = ()
    best: dict[str, Bound] = field(default_factory=dict)
    failures: dict[str, Finding | None] = field(default_factory=dict)
    absent: dict[str, Finding] = field(default_factory=dict)
    rows: list[dict[str, Any]] = field(default_factory=list)
    seen: list[tuple[int, float]] = field(default_factory=list)
    sharper: dict[str, float] = field(default_factory=dict)

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
    def size(self) -> float:
        """Largest size of the bounds; inf if none is proven."""
        return max((abs(b) for b in (self.lower, self.upper) if np.isfinite(b)), default=np.inf)

    @property
    def natural(self) -> float:
        """Natural load factor of the strengths, which scales the residuals of solvers."""
        upper = self.best.get("upper")
        return upper.discretisation.natural.load_factor if isinstance(upper, UpperBound) else 1.0

    @property
    def nothing(self) -> float:
        """Load factor that counts as zero where its sign is not known."""
        return NO_LOAD_FACTOR * self.target * self.natural

    @property
    def unsigned(self) -> bool:
        """Whether zero lies between the bounds, as for a load factor of zero."""
        round_off = NO_GAIN * self.nothing
        return -np.inf < self.lower <= round_off and np.inf > self.upper >= -round_off

    @property
    def crossed(self) -> bool:
        """Whether the lower bound exceeds the upper one, so that one of them is wrong."""
        lower, upper = self.best.get("lower"), self.best.get("upper")
        if isinstance(lower, LowerBound) and isinstance(upper, UpperBound):
            return bool(crossing(lower, upper))
        return False

    def growths(self, tracks: Sequence[Track], open_: Sequence[int]) -> list[float]:
        """Return the growth factors of the meshes to refine, by the convergence rate so far."""
        rests = np.array([track.rest for track in tracks])
        apart = 0.0
        if np.all(np.isfinite(rests)) and rests.sum() > 0 and np.isfinite(self.width):
            going = rests[list(open_)].sum()
            # These are two problems, whose load factors differ on arbitrarily fine meshes.
            whole = self.upper - self.lower if self.coulomb else rests.sum()
            apart = float(np.clip(1 - going / whole, 0.0, 1.0))
        going_on = [tracks[number] for number in open_]
        return growths(going_on, self.width / self.target, order(self.seen), apart)

    def solved(self, moves: Sequence[tuple[Track, Problem]]) -> list[Track]:
        """Return the tracks on new meshes, and keep the bounds that these prove."""
        begin = time.perf_counter()
        before = {kind: proven(bound, np.nan) for kind, bound in self.best.items()}
        times = [mesh_of(new).nelements / track.elements for track, new in moves]
        ahead = self.width / max(times, default=1.0) if self.rows else np.inf
        asked = [self._asked(kind, new, ahead) for track, new in moves for kind in track.kinds]
        last: dict[str, Bound] = {}
        with closing(self.solver.answers(asked)) as answers:
            for question, answer in zip(asked, answers, strict=True):
                kind = question.kind
                self._keep(question, answer.bound)
                self.sharper[kind] = self.sharper.get(kind, 1.0) * answer.sharper
                last[kind] = answer.bound
                if self.width <= self.target:
                    break
        after = {kind: proven(bound, np.nan) for kind, bound in self.best.items()}
        gained = {kind: abs(after[kind] - before.get(kind, np.nan)) for kind in after}
        seconds = time.perf_counter() - begin
        return [track.moved(new, last, gained, seconds) for track, new in moves]

    def _asked(self, kind: str, problem: Problem, ahead: float) -> RequestedBound:
        """Return the request for a bound, whose tolerance follows the expected width."""
        width = max(ahead, self.target)
        close = self.nothing if self.unsigned else width * self.size
        affordable = AFFORDABLE_LOSS * close
        width = self.target if self.coulomb else width
        # Dead loads cancel most of the power by which solvers measure.
        width = min(width, close / self.natural)
        share = SOIL_TOLERANCES[kind] if self.pressure_dependent else LOOSE_TOLERANCE
        loose = width * share * self.sharper.get(kind, 1.0)
        tolerance = float(np.clip(loose, TIGHTEST_TOLERANCE, LOOSEST_TOLERANCE))
        return RequestedBound(kind, problem, tolerance, affordable)

    def _keep(self, asked: RequestedBound, bound: Bound) -> None:
        """The best bounds, and what failed."""
        kind = asked.kind
        sign = 1.0 if kind == "lower" else -1.0
        holds, best = bound.status is Status.SOLVED, self.best.get(kind, bound)
        if best.status is not Status.SOLVED or (
            holds and sign * (bound.load_factor - best.load_factor) > 0
        ):
            best = bound
        self.best[kind] = best
        # Meshes that are too coarse to carry the dead loads, or to flow, are not failures.
        few = {"lower": Status.UNSAFE, "upper": Status.LOCKED}
        fails = not (holds or bound.status is few[kind])
        self.failures[kind] = bound.unanswered(self.solver.backend) if fails else None
        if self.coulomb and bound.status is few[kind]:
            self._ask_whether_any(kind, asked.problem)
        self._tell(kind, bound, mesh_of(asked.problem))

    def _ask_whether_any(self, kind: str, problem: Problem) -> None:
        """Note a bound that no mesh has, if friction alone carries or holds all."""
        if (
            kind == "lower"
            and solve(problem, self.solver.backend, "associated").status is Status.UNSAFE
        ):
            self.absent[kind] = Finding(Kind.NONE_WITHOUT_FRICTION)
        if kind == "upper" and lower_bound(problem, self.solver.backend).status is Status.LOCKED:
            self.absent[kind] = Finding(Kind.NONE_WITH_ASSOCIATED_FRICTION)

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

    def ending(self, tracks: Sequence[Track]) -> Ending | None:
        """Return the reason to end, if there is one."""
        if self.crossed:
            return Ending.CROSSED
        if any(track.late for track in tracks):
            return Ending.TIME_LIMIT
        if self.unsigned and self.size <= self.nothing:
            return Ending.ZERO
        if self.width <= self.target:
            return Ending.REACHED
        if any(
            why is not None and self.best[kind].status is not Status.SOLVED
            for kind, why in self.failures.items()
        ):
            return Ending.NO_BOUND
        closed = [self.closed(track) for track in tracks]
        if None in closed:
            return None
        order = (Ending.MAX_ELEMENTS, Ending.SETTLED, Ending.NO_PROGRESS, Ending.NO_BOUND)
        return next(ending for ending in order if ending in closed)

    def closed(self, track: Track) -> Ending | None:
        """Return why a mesh is not refined any more."""
        if self.absent.keys() >= set(track.kinds):
            return Ending.NO_BOUND
        if track.too_fine:
            return Ending.MAX_ELEMENTS
        rests = track.rests
        small = self.target * self.size
        if self.coulomb and len(rests) == RECENT and max(rests) <= SETTLED_REST * small:
            return Ending.SETTLED
        last = track.gains[-PATIENCE:]
        spent = len(last) == PATIENCE and max(last) <= NO_GAIN * small
        return Ending.NO_PROGRESS if spent else None

    def advanced(self, tracks: Sequence[Track]) -> list[Track]:
        """Solve on finer meshes, unless a solve would end too late."""
        after = list(tracks)
        open_ = [number for number, track in enumerate(after) if self.closed(track) is None]
        planned = zip(open_, self.growths(after, open_), strict=True)
        finer = {n: self.refined(after[n], times) for n, times in planned if times > 1}
        moves = {number: own for number, own in finer.items() if own is not None}
        for number in finer.keys() - moves.keys():
            after[number] = replace(after[number], too_fine=True)
        late = [number for number, own in moves.items() if self.too_late(after[number], own)]
        for number in late:
            after[number] = replace(after[number], late=mesh_of(moves[number]).nelements)
        if late:
            return after
        solved = self.solved([(after[number], own) for number, own in moves.items()])
        for number, track in zip(moves, solved, strict=True):
            after[number] = track
        self.seen.append((sum(track.elements for track in after), self.width))
        return after

    def found(self, ending: Ending, tracks: Sequence[Track]) -> Bracket:
        """Return the bracket with all proven bounds and failures."""
        lower, upper = self.best["lower"], self.best["upper"]
        assert isinstance(lower, LowerBound)
        assert isinstance(upper, UpperBound)
        for kind, bound in self.best.items():
            if bound.status is not Status.SOLVED:
                self.failures[kind] = self.failures[kind] or bound.unanswered(self.solver.backend)
        failed = [
            Finding(Kind.BOUND_FAILED, (kind,), {"why": why}, Severity.WARNING)
            for kind, why in sorted((self.failures | self.absent).items())
            if why is not None
        ]
        crossed = crossing(lower, upper) if ending is Ending.CROSSED else None
        return Bracket(
            status=ending,
            lower_bound=lower,
            upper_bound=upper,
            target_width=self.target,
            history=pd.DataFrame(self.rows),
            failures=tuple(failed if crossed is None else [*failed, crossed]),
            coulomb=self.coulomb,
            stops=() if ending is Ending.REACHED else tuple(self.stops(tracks)),
            lent=self.lent,
        )

    def stops(self, tracks: Sequence[Track]) -> Iterator[Finding]:
        """Yield which side stopped, where, and why."""
        for track in tracks:
            closed = self.closed(track)
            why: Finding | str = "it could be refined further" if closed is None else closed.label
            if track.late:
                why = Finding(Kind.NEXT_SOLVE_LATE, values={"elements": track.late})
            kind = Kind.BOUNDS_STOPPED if len(track.kinds) > 1 else Kind.BOUND_STOPPED
            yield Finding(kind, track.kinds, {"elements": track.elements, "why": why})

    def refined(self, track: Track, times: float) -> Problem | None:
        """Return the problem on the next mesh with `times` as many elements, if it is allowed."""
        finer = grown(
            track.mesh, shares_of(track.last, self.bodies, track.elements), times, self.max_elements
        )
        return None if finer is None else on_finer(track.problem, finer, self.rows)

    def too_late(self, track: Track, finer: Problem) -> bool:
        """Return whether the next solve is expected to end after the limit."""
        expected = track.seconds * float(mesh_of(finer).nelements) / track.elements
        return time.perf_counter() + expected > self.solver.deadline
