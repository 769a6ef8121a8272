"""`envelope`: combinations of loads that a structure carries (T82)."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from lacore.analyses.yield_surface.components import Components
from lacore.analyses.yield_surface.hulls import gauge, parts_of_width
from lacore.analyses.yield_surface.search import Asking, Search
from lacore.bounds.bracket.asking import processors
from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.continuum.body import Body
from lacore.model.conditions.loads import Load
from lacore.model.problem.problem import Problem
from lacore.numerics.arrays import Floats
from lacore.reporting import views
from lacore.reporting.errors import InputError, require_count, require_width, typed
from lacore.reporting.findings import Finding
from lacore.reporting.kinds import Kind
from lacore.reporting.showing import Facts, Picture, counted
from lacore.reporting.status import Result

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_ROUND = 1e-9  # by a vertex: distance of points on a plane


@dataclass(frozen=True, repr=False)
class Envelope(Result):
    """Combinations of loads that are carried: the yield surface in two or three components.

    Factors of loads are multiples of the given components; dead loads are constant.

    Attributes:
        names: names of the components.
        convex: whether flow and friction are associated, so that the set of carried loads is
            convex, and `inner` and `outer` are proven; else there are only points, each a certified
            Coulomb state, and the set between them is unknown.
        inner: vertices of the hull of points that are proven to be carried, (i, k), for two
            components in order; for Coulomb states the points.
        outer: vertices of a set outside of which no load is carried, (o, k); empty for Coulomb
            states.
        planes: normals and offsets of `outer`, ``normal . factors <= offset``, (h, k + 1): each is
            the mechanism of an upper bound, valid for all combinations.
        bounded: whether planes alone enclose it; if loads are locked they do not, and a box of 4
            times the extent of `inner` represents infinity.
        bound_width: largest distance between both along the computed directions, which a smaller
            `target_width` reduces.
        polyhedral_width: the remaining `width` if inner met outer in each of them, which more
            directions reduce; both together make up at most `width`, as factors above 1.
        stop: why it ended before `n` directions; None if it did not.
        rigor: what inner and outer prove.
        table: one row per direction: from ``centre`` along ``direction`` factors ``lower`` and
            ``upper`` (NaN without one), the ``status``, the factors of the proven point,
            ``seconds``.
        centre: factors from which directions start, (k,).
        target_width: width of brackets for deformable bodies; NaN for bounds on the mesh itself.
        solve_time: s, wall clock.
    """

    names: tuple[str, ...]
    convex: bool
    inner: Floats
    outer: Floats
    planes: Floats
    bounded: bool
    width: float = field(metadata={"told": "largest distance along rays, per that of `inner`"})
    bound_width: float
    polyhedral_width: float
    stop: Finding | None
    rigor: str
    table: pd.DataFrame
    centre: Floats
    target_width: float
    solve_time: float

    def contains(self, factors: Sequence[float]) -> bool | None:
        """Return whether loads are carried: True and False are proven, None lies between both.

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
        far = gauge(self.inner, self.centre, given[None, :]) if len(self.inner) else None
        return True if far is not None and far[0] <= 1 else None

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Findings on what is proven, and on the distance of both sides."""
        found = Finding(Kind.APART, values={"width": self.width})
        if not self.convex:
            found = Finding(Kind.POINTS_ALONE)
        elif not self.bounded:
            found = Finding(Kind.UNBOUNDED)
        every = len(self.table)
        failed = int((~self.table["status"].isin(["solved", "reached"])).sum())
        missing = Finding(Kind.DIRECTIONS_FAILED, values={"count": failed, "every": every})
        ended = Finding(Kind.DIRECTIONS_ENDED, values={"count": every, "why": self.stop})
        return (found, *[missing] * (failed > 0), *[ended] * (self.stop is not None))

    @property
    def stopped(self) -> str:
        """Text of `stop`; empty where all directions were searched."""
        return str(self.stop or "")

    def facts(self) -> Facts:
        """Return what is proven, for printing."""
        told = {"status": self.message, "rigor": self.rigor}
        if self.bounded:
            told["width"] = (
                f"{self.bound_width:.2%} between bounds along the requested directions,"
                f" {self.polyhedral_width:.2%} by corners between directions"
            )
        spans = zip(self.names, self.inner.T, strict=True)
        carried = [f"{name} {own.min():.4g} to {own.max():.4g}" for name, own in spans if own.size]
        told["carried"] = ", ".join(carried) or "nothing is proven to be"
        told["solved by"] = f"{counted(len(self.table), 'direction')} in {self.solve_time:.3g} s"
        return Facts(f"Envelope: of {', '.join(self.names)}, {len(self.inner)} points", told)

    def picture(self) -> Picture:
        """Return the inner and outer sets."""
        return Picture(self.plot())

    def plot(self) -> Figure:
        """Plot the inner and outer sets: see `lacore.pictures.analyses.plot_envelope`."""
        return views.picture(self)


@typed()
def envelope(
    problem: Problem,
    loads: Mapping[str, Sequence[Load]],
    n: int = 24,
    backend: str = "auto",
    *,
    target_width: float | None = None,
    options: Mapping[str, Any] | None = None,
    jobs: int | None = None,
) -> Envelope:
    """Compute the combinations of two or three loads that a structure carries (T82).

    Along each direction of the loads a lower bound gives a point within the yield surface. The
    mechanism of an upper bound gives a half-plane, since the same velocity bounds every
    combination. Directions are first along the components, then towards the corners of the outer
    polygon that are farthest from the inner one. If opposite loads are equivalent, without contact,
    dead load or pressure-dependent strength, each direction counts for both; if the structure and
    its mesh have a mirror symmetry, also for its image. With Coulomb friction the set need not be
    convex, and each direction only gives a certified point.

    Args:
        problem: the structure, with its constant dead loads; its reference loads do not act.
        loads: two or three components by name, such as ``{"V": [...], "H": [...]}``.
        n: number of directions.
        backend: name of an exact backend.
        target_width: width of a `lacore.bracket` along each direction for deformable bodies; None:
            bounds on the mesh of the problem.
        options: options of the backend.
        jobs: number of simultaneous directions in threads, at most two. The results do not depend
            on it, unless a bracket reaches its time limit. None: the number of processors.

    Raises:
        InputError: components without power in any motion, or equal ones, before any solve; dead
            loads that are not carried; anything that bounds reject.
        CapabilityError: the backend is missing, or does not support the problem.

    Example:
        >>> forces = {
        ...     "P": [la.PointForce("beam", (1, 0), (0, -1))],
        ...     "Q": [la.PointForce("beam", (3, 0), (0, -1))],
        ... }
        >>> found = la.envelope(la.examples.beam(), forces)
        >>> found.outer.max(axis=0).round(2).tolist()  # N: the most of each, whatever the other is
        [3.0, 3.0]
    """
    begin = time.perf_counter()
    require_count("n", n)
    jobs = processors() if jobs is None else jobs
    require_count("jobs", jobs)
    if target_width is not None:
        require_width("target_width", target_width)
    components = Components(problem, loads)
    k = len(components.names)
    if n < 2 * k + 1:
        raise InputError(
            "n", n, "fewer directions than there are axes", f"give {2 * k + 1} or more"
        )
    convex = components.associated
    asking = Asking(
        components=components,
        backend=backend,
        options=options,
        target=target_width,
        convex=convex,
        deforms=bool(of_kind(problem.bodies, Body)),
        jobs=jobs,
    )
    run = Search(asking, components.senses if convex else np.ones((1, k)))
    run.along_axes(k)
    scale, centre = run.middle()
    stop = None
    if convex:
        stop = run.refine(centre, scale, n)
    else:
        run.around(centre, scale, n)
    found = run.hulls(centre) if convex else None
    planes = np.array(run.planes).reshape(-1, k + 1)
    parts = (np.nan, np.nan)
    if found is not None and found.bounded:
        ways = np.array(
            [signs * np.array(r["direction"]) for r in run.rows for signs in run.senses]
        )
        parts = parts_of_width(found, planes, centre, ways)
    return Envelope(
        names=components.names,
        convex=convex,
        inner=np.array(run.points).reshape(-1, k) if found is None else found.inner,
        outer=np.zeros((0, k)) if found is None else found.outer,
        planes=planes,
        bounded=found is not None and found.bounded,
        width=np.nan if found is None else found.width,
        bound_width=parts[0],
        polyhedral_width=parts[1],
        stop=stop,
        rigor=run.rigor,
        table=pd.DataFrame(run.rows),
        centre=centre,
        target_width=np.nan if target_width is None else float(target_width),
        solve_time=time.perf_counter() - begin,
    )
