"""`envelope`: which combinations of loads a structure carries (T82)."""

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

_ROUND = 1e-9  # of a vertex: what lies nearer to a plane is on it


@dataclass(frozen=True, repr=False)
class Envelope(Result):
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
        bound_width: largest distance between both along the directions that were asked, which a
            smaller `target_width` narrows.
        polyhedral_width: what would be left of `width` if inner met outer in each of them, which
            more directions narrow; at most both make up `width`, as factors above 1.
        stop: why it ended before `n` directions; None where it did not.
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
    bound_width: float
    polyhedral_width: float
    stop: Finding | None
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
        far = gauge(self.inner, self.centre, given[None, :]) if len(self.inner) else None
        return True if far is not None and far[0] <= 1 else None

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What is proven, and how far apart both sides are."""
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
        """What is proven, and how well."""
        told = {"status": self.message, "rigor": self.rigor}
        if self.bounded:
            told["width"] = (
                f"{self.bound_width:.2%} between bounds along the directions asked,"
                f" {self.polyhedral_width:.2%} by corners between directions"
            )
        spans = zip(self.names, self.inner.T, strict=True)
        carried = [f"{name} {own.min():.4g} to {own.max():.4g}" for name, own in spans if own.size]
        told["carried"] = ", ".join(carried) or "nothing is proven to be"
        told["solved by"] = f"{counted(len(self.table), 'direction')} in {self.solve_time:.3g} s"
        return Facts(f"Envelope: of {', '.join(self.names)}, {len(self.inner)} points", told)

    def picture(self) -> Picture:
        """Inner and outer."""
        return Picture(self.plot())

    def plot(self) -> Figure:
        """Inner and outer: see `lacore.pictures.analyses.plot_envelope`."""
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
        jobs: how many directions at a time, by threads; there are two at most. What is found is the
            same whatever it is, unless a bracket runs out of time. None: as many as there are
            processors.

    Raises:
        InputError: components that do no power in any motion, or all the same, before any solve;
            dead loads that are not carried; what bounds refuse.
        CapabilityError: the backend is missing, or cannot take the problem.

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
