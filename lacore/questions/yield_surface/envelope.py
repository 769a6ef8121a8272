"""`envelope`: which combinations of loads a structure carries (T82)."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from lacore import views
from lacore.adaptive.refine import bracket
from lacore.arrays import Floats
from lacore.bodies.any_body import of_kind
from lacore.bodies.continuum.body import Body
from lacore.bounds.lower import lower_bound
from lacore.bounds.upper import upper_bound
from lacore.conditions.loads import Load
from lacore.errors import InputError, require_count, require_positive
from lacore.limit.solve import solve
from lacore.limit.state import LimitState
from lacore.problem.problem import Problem
from lacore.questions.worth import error, worth
from lacore.questions.yield_surface.components import Components
from lacore.questions.yield_surface.directions import apart, corners, spread
from lacore.questions.yield_surface.hulls import Hulls, gauge, hulls
from lacore.showing import Facts, Picture, Shown, counted
from lacore.status import Rigor, Status

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_TRIES = 3  # of directions that nothing is proven in, before it is left as it is
_ROUND = 1e-9  # of a vertex: what lies nearer to a plane is on it


@dataclass(frozen=True, repr=False)
class Envelope(Shown):
    """Which combinations of loads are carried: the yield surface in two or three components.

    Factors of loads are multiples of the components as they are given; dead loads stay.

    Attributes:
        names: of the components.
        convex: whether flow and friction are associated, so that what is carried is convex, and
            `inner` and `outer` are proven; else there are points alone, each a certified Coulomb
            state, and what lies between them is not known.
        inner: vertices of the hull of what is proven to be carried, (i, k), of two components in
            order; of Coulomb states the points.
        outer: vertices of what no load outside of is carried, (o, k); empty of Coulomb states.
        planes: normals and offsets of `outer`, ``normal . factors <= offset``, (h, k + 1): each is
            the mechanism of an upper bound, and holds for all combinations.
        bounded: whether planes alone enclose it; where loads are locked they do not, and a box of 4
            times the extent of `inner` stands for infinity.
        rigor: what inner and outer prove.
        table: a row a direction: from ``centre`` along ``direction`` factors ``lower`` and
            ``upper`` (NaN where there is none), the ``status``, the factors of the point that is
            proven, ``seconds``.
        centre: factors that directions go out from, (k,).
        target_width: of brackets, where bodies deform; NaN of bounds on the mesh itself.
        solve_time: s, wall clock.
    """

    names: tuple[str, ...]
    convex: bool
    inner: Floats
    outer: Floats
    planes: Floats
    bounded: bool
    width: float = field(metadata={"told": "largest distance along rays, per that of `inner`"})
    rigor: str
    table: pd.DataFrame
    centre: Floats
    target_width: float
    solve_time: float

    def contains(self, factors: Sequence[float]) -> bool | None:
        """Whether loads are carried: True and False are proven, None lies between both.

        Raises:
            InputError: not a number for each component.
        """
        given = np.asarray(factors, dtype=np.float64)
        if given.shape != (len(self.names),) or not np.all(np.isfinite(given)):
            raise InputError(
                "factors", factors, f"not {len(self.names)} numbers", f"give {self.names}"
            )
        if not self.convex:
            return None
        room = self.planes[:, -1] - self.planes[:, :-1] @ given
        size = np.abs(self.planes[:, :-1]) @ np.abs(given) + np.abs(self.planes[:, -1])
        if np.any(room < -_ROUND * size):
            return False
        far = gauge(self.inner, self.centre, given[None, :])
        return True if far is not None and far[0] <= 1 else None

    @property
    def message(self) -> str:
        """What is proven, and how far apart both sides are."""
        failed = int((~self.table["status"].isin(["solved", "reached"])).sum())
        rest = f"; {counted(failed, 'direction')} of {len(self.table)} not (see the table)"
        if not self.convex:
            said = "certified points; what lies between them is not proven: friction is Coulomb's"
        elif not self.bounded:
            said = "unbounded: some combinations are carried however large"
        else:
            said = f"inner and outer at most {self.width:.2%} apart"
        return said + rest * (failed > 0)

    def facts(self) -> Facts:
        """What is proven, and how well."""
        told = {"status": self.message, "rigor": self.rigor}
        low, high = self.inner.min(axis=0), self.inner.max(axis=0)
        spans = zip(self.names, low, high, strict=True)
        told["carried"] = ", ".join(f"{name} {a:.4g} to {b:.4g}" for name, a, b in spans)
        told["solved by"] = f"{counted(len(self.table), 'direction')} in {self.solve_time:.3g} s"
        return Facts(f"Envelope: of {', '.join(self.names)}, {len(self.inner)} points", told)

    def picture(self) -> Picture:
        """Inner and outer."""
        return Picture(self.plot())

    def plot(self) -> "Figure":
        """Inner and outer: see `lacore.pictures.questions.envelope.plot_envelope`."""
        return views.picture(self)


def envelope(
    problem: Problem,
    loads: Mapping[str, Sequence[Load]],
    n: int = 24,
    backend: str = "clarabel",
    *,
    target_width: float | None = None,
    options: Mapping[str, Any] | None = None,
    on_direction: Callable[[Mapping[str, Any]], None] | None = None,
) -> Envelope:
    """Which combinations of two or three loads a structure carries, from inside and outside (T82).

    Along each direction of the loads a lower bound is a point of the yield surface or within it.
    The mechanism of an upper bound is more: the same velocity bounds every combination, by a half-
    plane. Directions go first along the components, then where the corners of the outer polygon are
    farthest from the inner one. Where nothing tells a load from its opposite, no contact, no dead
    load, no strength that depends on pressure, each direction counts for both; where a mirror
    leaves the structure as it is, on its mesh, for its image, too. With Coulomb friction what is
    carried need not be convex: then each direction gives a certified point, and no more.

    Args:
        problem: the structure, with its dead loads, which stay; its reference loads do not act.
        loads: two or three components by name, such as ``{"V": [...], "H": [...]}``.
        n: directions.
        backend: an exact one.
        target_width: of a `lacore.bracket` along each direction, where a body deforms; None: bounds
            on the mesh of the problem.
        options: of the backend.
        on_direction: called with the row of each direction as it ends.

    Raises:
        InputError: components that do no power in any motion, or all the same, before any solve;
            dead loads that are not carried; what bounds refuse.
        CapabilityError: the backend is missing, or cannot take the problem.
    """
    begin = time.perf_counter()
    require_count("n", n)
    if target_width is not None:
        require_positive("target_width", target_width)
    if not isinstance(problem, Problem):
        raise InputError("problem", problem, "not a problem", "give a lacore.Problem")
    components = Components(problem, loads)
    k = len(components.names)
    if n < 2 * k + 1:
        raise InputError(
            "n", n, "fewer directions than there are axes", f"give {2 * k + 1} or more"
        )
    convex, deforms = components.associated, bool(of_kind(problem.bodies, Body))
    run = _Run(
        components=components,
        backend=backend,
        options=options,
        target=target_width,
        convex=convex,
        senses=components.senses if convex else np.ones((1, k)),
        deforms=deforms,
        tell=on_direction,
    )
    centre = np.zeros(k)
    for axis in range(k):
        run.ask(centre, np.eye(k)[axis])
        if not run.turns(axis):
            run.ask(centre, -np.eye(k)[axis])
    scale, centre = run.middle()
    if convex:
        run.refine(centre, scale, n)
    else:
        run.around(centre, scale, n)
    found = run.hulls(centre) if convex else None
    planes = np.array(run.planes).reshape(-1, k + 1)
    return Envelope(
        names=components.names,
        convex=convex,
        inner=np.array(run.points) if found is None else found.inner,
        outer=np.zeros((0, k)) if found is None else found.outer,
        planes=planes,
        bounded=found is not None and found.bounded,
        width=np.nan if found is None else found.width,
        rigor=run.rigor,
        table=pd.DataFrame(run.rows),
        centre=centre,
        target_width=np.nan if target_width is None else float(target_width),
        solve_time=time.perf_counter() - begin,
    )


@dataclass
class _Run:
    """What was asked, and what is proven so far."""

    components: Components
    backend: str
    options: Mapping[str, Any] | None
    target: float | None
    convex: bool
    senses: Floats
    deforms: bool
    tell: Callable[[Mapping[str, Any]], None] | None
    points: list[Floats] = field(default_factory=list)
    planes: list[Floats] = field(default_factory=list)
    rows: list[dict[str, Any]] = field(default_factory=list)
    rigors: set[Rigor] = field(default_factory=set)

    def ask(self, centre: Floats, direction: Floats) -> bool:
        """Both bounds along a direction; whether any of them is new."""
        begin = time.perf_counter()
        stated = self.components.problem_at(centre, direction)
        if self.deforms and self.convex:
            lower, upper, status, plane = self._bounds(stated)
        else:
            lower, upper, status, plane = self._state(stated)
        if status == Status.UNSAFE.label:
            raise InputError(
                "Problem.dead_loads",
                None,
                "they alone collapse the structure, so that no surface has them inside",
                "reduce them, or add what holds them up",
            )
        reach = lower
        if lower == np.inf:  # it is carried at any size, so at the one that was asked, too
            reach = 1.0 if self.convex else np.nan
        point = None if np.isnan(reach) else centre + reach * direction
        if point is not None:
            self.points += [signs * point for signs in self.senses]
        if plane is not None:
            velocity, problem = plane
            normal = self.components.powers(problem, velocity)
            offset = upper + float(normal @ centre)
            self.planes += [np.append(signs * normal, offset) for signs in self.senses]
        names = self.components.names
        seen = np.full(len(names), np.nan) if point is None else point
        self.rows.append(
            {
                "centre": tuple(centre.tolist()),
                "direction": tuple(direction.tolist()),
                "lower": lower,
                "upper": upper,
                "status": status,
                **dict(zip(names, seen, strict=True)),
                "seconds": time.perf_counter() - begin,
            }
        )
        if self.tell is not None:
            self.tell(self.rows[-1])
        return point is not None or plane is not None

    def _state(self, stated: Problem) -> tuple[float, float, str, tuple[Floats, Problem] | None]:
        """Of rigid parts: one load factor, exact but for its residuals; or a Coulomb state."""
        state = solve(stated, self.backend, options=self.options)
        value, wrong = worth(state), error(state)
        if state.status is Status.SOLVED:
            self.rigors.add(state.rigor)
        if state.status is Status.LOCKED:
            return np.inf, np.inf, state.status.label, None
        if not np.isfinite(value):
            return np.nan, np.nan, state.status.label, None
        if not self.convex:
            return value, np.nan, state.status.label, None
        return value - wrong, value + wrong, state.status.label, _mechanism(state)

    def _bounds(self, stated: Problem) -> tuple[float, float, str, tuple[Floats, Problem] | None]:
        """Strict bounds of the continuum, on the mesh or on refined ones."""
        if self.target is not None:
            found = bracket(stated, self.target, backend=self.backend, options=self.options)
            below, above, status = found.lower_bound, found.upper_bound, found.status.label
        else:
            below = lower_bound(stated, self.backend, options=self.options)
            above = upper_bound(stated, self.backend, options=self.options)
            ends = {below.status, above.status} - {Status.SOLVED}
            status = min((end.label for end in ends), default=Status.SOLVED.label)
        proven = below.status in (Status.SOLVED, Status.LOCKED)
        lower = below.load_factor if proven else np.nan
        if above.status is not Status.SOLVED:
            return lower, np.nan, status, None
        self.rigors |= {above.rigor} | ({below.rigor} if np.isfinite(lower) else set())
        return lower, above.load_factor, status, (above.velocity, above.discretisation.problem)

    def turns(self, axis: int) -> bool:
        """Whether a component alone is carried in both senses alike."""
        return bool(np.any(self.senses[:, axis] < 0))

    def middle(self) -> tuple[Floats, Floats]:
        """Half the extent of what is carried along each component, and a point inside."""
        k = len(self.components.names)
        ends = np.zeros((k, 2))
        for row in self.rows:
            size = row["lower"]
            if not np.isfinite(size):
                size = row["upper"] if np.isfinite(row["upper"]) else 1.0  # locked: as it is given
            axis = int(np.argmax(np.abs(row["direction"])))
            backward = row["direction"][axis] < 0
            ends[axis, int(backward)] = -size if backward else size
            if self.turns(axis):
                ends[axis] = size, -size
        half = (ends[:, 0] - ends[:, 1]) / 2
        if not np.all(half > 0):
            name = self.components.names[int(np.argmin(half))]
            raise InputError(
                f"loads[{name!r}]",
                None,
                "is carried in neither sense: what is carried has no inside",
                "add the weight or the strength that carries it",
            )
        return half, ends.mean(axis=1) / k

    def refine(self, centre: Floats, scale: Floats, n: int) -> None:
        """Directions to where the outer side is farthest from the inner one."""
        tried: list[Floats] = []
        axes = len(self.rows)
        known: list[Floats] = []
        for corner in corners(centre.size):
            if len(self.rows) < n and all(apart(corner, own) for own in known):
                self.ask(centre, scale * corner)
                known += [signs * corner for signs in self.senses]
        while len(self.rows) < n and len(tried) < _TRIES:
            found = self.hulls(centre)
            if found is None:
                return
            order = np.argsort(-found.gauge)
            ways = [np.array(row["direction"]) / scale for row in self.rows[axes:]]
            known = [signs * way for way in ways for signs in self.senses]
            for number in order:
                way = (found.outer[number] - centre) / scale
                way /= np.linalg.norm(way)
                if all(apart(way, own) for own in [*known, *tried]):
                    break
            else:
                return
            if not self.ask(centre, scale * way):
                tried.append(way)

    def around(self, centre: Floats, scale: Floats, n: int) -> None:
        """Directions at equal angles, or on a spiral around a sphere."""
        for way in spread(centre.size, n - len(self.rows)):
            self.ask(centre, scale * way)

    def hulls(self, centre: Floats) -> Hulls | None:
        if len(self.points) <= centre.size or not self.planes:
            return None
        planes = np.array(self.planes)
        return hulls(np.array(self.points), planes[:, :-1], planes[:, -1], centre)

    @property
    def rigor(self) -> str:
        if not self.convex:
            return Rigor.DISCRETE.phrase if self.deforms else "certified Coulomb states"
        if not self.deforms:
            return "exact but for the residuals of certificates"
        strict = self.rigors <= {Rigor.LOWER, Rigor.UPPER}
        return "both sides by strict bounds of the continuum" if strict else "not all bounds strict"


def _mechanism(state: LimitState) -> tuple[Floats, Problem] | None:
    if state.point is None or state.status is not Status.SOLVED:
        return None
    return state.point.velocity, state.discretisation.problem
