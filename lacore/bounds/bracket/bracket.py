"""Brackets: a load factor between two proven bounds, and the history of the refinement (T26)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from lacore.bounds.constants import SUMMED
from lacore.bounds.gap_identity import GapIdentity, gap_identity
from lacore.bounds.lower import LowerBound, lower_bound
from lacore.bounds.precision import exactness
from lacore.bounds.upper import UpperBound
from lacore.limit.judges.reached import reached_supports
from lacore.reporting import views
from lacore.reporting.findings import Finding, Message, Severity, texts
from lacore.reporting.kinds import Kind
from lacore.reporting.showing import Compact, Facts, Picture, counted
from lacore.reporting.status import Reported, Rigor, Status

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BODY = "load factor"
POLYGON = "load factor of the polygon"  # The polygon replaces a curved outline.
_EVERY = "every Coulomb "  # bounded quantity with Coulomb friction


class Ending(Enum):
    """Reason for the final width of a bracket. Its text says what to do."""

    REACHED = "the target width is reached"
    MAX_ELEMENTS = "not reached: the next mesh would have more elements than `max_elements`"
    TIME_LIMIT = "not reached: the next solve would end after `time_limit`"
    NO_PROGRESS = (
        "not reached: refinement gains nothing more; at a singular point a lower bound needs more"
        " sectors (`lower_mesh`, lacore.model.meshes.fan)"
    )
    SETTLED = (
        "not reached: by what it last gained, refinement would move neither end by more than a"
        " quarter of the target; Coulomb friction keeps them apart, between no friction and"
        " associated friction"
    )
    ZERO = (
        "the load factor is zero within the accuracy: both bounds are, per strength over load,"
        " within a thousandth of the target width, and a width per load factor never closes there"
    )
    NO_BOUND = "not reached: a bound could not be proven"
    CROSSED = "the bounds cross, so that one of them is wrong: report it"

    @property
    def label(self) -> str:
        """The name as shown in tables: ``max elements``."""
        return self.name.lower().replace("_", " ")

    def report(self, findings: tuple[Finding, ...]) -> Message:
        """Return the text of this ending with findings, to be rendered for a reader."""
        return Message("", self.value, findings)


@dataclass(frozen=True, repr=False)
class Step(Compact):
    """One solve of a bracket.

    Attributes:
        step: 0, 1, ...
        bound: ``lower`` or ``upper``.
        elements: number of elements of the mesh.
        solved: load factor that this mesh proves.
        lower, upper: best proven load factors so far.
        width: ``(upper - lower)`` divided by their mean; inf if one is missing.
        quality: shape of the worst triangle, 1 for equilateral ones.
        seconds: time since the start.
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


@dataclass(frozen=True, repr=False)
class Bracket(Reported):
    """A load factor between two proven ones: of the body if `strict`, else of its polygon.

    With Coulomb friction it contains every Coulomb load factor.

    Attributes:
        status: whether the target was reached, and if not, why.
        lower_bound, upper_bound: the best ones, with their states and meshes.
        target_width: requested width.
        history: one row per solve, see `Step`.
        failures: why there is no bound on either side: its mesh is locked or unsafe, or the solver
            failed; or how far the bounds cross.
        coulomb: whether the problem has Coulomb friction: the lower bound is then one of the
            problem without it, the upper one of that with associated friction (T14).
        stops: which side stopped at how many elements, and why; empty if the target is reached.
        lent: what cohesion was lent to bodies, see `lacore.bracket`; empty if none was.
    """

    status: Ending
    lower_bound: LowerBound
    upper_bound: UpperBound
    target_width: float
    history: pd.DataFrame
    failures: tuple[Finding, ...]
    coulomb: bool = False
    stops: tuple[Finding, ...] = ()
    lent: tuple[Finding, ...] = ()

    @property
    def lower(self) -> float:
        """Load factor that is proven from below; -inf if there is none."""
        return proven(self.lower_bound, -np.inf)

    @property
    def upper(self) -> float:
        """Load factor that is proven from above; +inf if there is none."""
        return proven(self.upper_bound, np.inf)

    @property
    def width(self) -> float:
        """``(upper - lower)`` per their mean."""
        return width(self.lower, self.upper)

    @property
    def strict(self) -> bool:
        """Whether both are bounds of the continuum as stated, and do not cross."""
        rigors = (self.lower_bound.rigor, self.upper_bound.rigor)
        crossed = crossing(self.lower_bound, self.upper_bound)
        return rigors == (Rigor.LOWER, Rigor.UPPER) and not crossed and not self.lent

    @property
    def polygonal(self) -> bool:
        """Whether straight edges replace a curved outline: both bounds are then of that polygon."""
        bodies = self.upper_bound.discretisation.continua.values()
        return any(dofs.body.geometry != "exact" for dofs in bodies)

    @property
    def heading(self) -> str:
        """``5.116 <= load factor <= 5.198   (width 1.58%, reached)``."""
        bounded = f"{_EVERY if self.coulomb else ''}{POLYGON if self.polygonal else BODY}"
        ending = self.status.label + "; lower bound with a lent cohesion" * bool(self.lent)
        return heading(self.lower, self.upper, self.width, ending, bounded)

    @property
    def failure(self) -> str:
        """Text of the failures; empty without any."""
        return texts(self.failures)

    @property
    def stopped(self) -> str:
        """Text of `stops`; empty where the target is reached."""
        return texts(self.stops)

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Findings.

        The reason of the end, what is proven, failures, and supports that are too close.
        """
        proven_of = None
        if self.strict:
            proven_of = Kind.BOUNDS_PROVEN_OF_COULOMB if self.coulomb else Kind.BOUNDS_PROVEN
        elif self.polygonal:
            proven_of = Kind.BOUNDS_OF_POLYGON
        upper = self.upper_bound
        moved = upper.velocity if upper.status is Status.SOLVED else None
        reached = reached_supports(upper.discretisation, moved)
        return (
            *self.stops,
            *([] if proven_of is None else [Finding(proven_of)]),
            *self.failures,
            *self.lent,
            *([] if reached is None else [reached]),
        )

    def gaps(self) -> GapIdentity:
        """Compute the shares of the elements in the gap, on the mesh of the upper bound (T26).

        If the lower bound has a separate mesh, this solves for another lower bound on the mesh of
        the upper bound, which is slightly lower without the fans of its own mesh. With Coulomb
        friction both bounds are of the problem with associated friction.

        Raises:
            ValueError: there is no upper bound.
        """
        if self.upper_bound.status is not Status.SOLVED:
            raise ValueError(f"there is no gap to look at: {self.status.label}: {self.failure}")
        problem, below = self.upper_bound.discretisation.problem, self.lower_bound
        if not self.one_mesh:
            options = {k: v for k, v in below.options.items() if k != "time_limit"}
            below = lower_bound(problem, below.backend, options=options, throw=True)
        return gap_identity(self.upper_bound, below)

    @property
    def one_mesh(self) -> bool:
        """Whether both bounds were found on the same mesh, and for the same problem."""
        if self.coulomb:
            return False
        above, below = self.upper_bound.discretisation.continua, self.lower_bound.model.continua
        meshes = [(above[name].body.mesh, below[name].body.mesh) for name in above]
        return all(
            np.array_equal(one.t, other.t) and np.array_equal(one.p, other.p)
            for one, other in meshes
        )

    def facts(self) -> Facts:
        """Return the proven bounds and their origin, for printing."""
        lower, upper = self.lower_bound, self.upper_bound
        told = {
            "status": self.message,
            "rigor": "both bounds are strict" if self.strict else "not both bounds are strict",
            "residual": f"equilibrium {_equilibrium(lower):.1e} below; divergence"
            f" {upper.divergence:.1e}, penetration {upper.penetration:.1e} above",
            "size": f"{counted(lower.model.n_elements, 'element')} below,"
            f" {upper.discretisation.n_elements} above",
        }
        solves = counted(len(self.history), "solve")
        seconds = self.history["seconds"].max() if len(self.history) else np.nan
        told["solved by"] = f"{lower.backend}: {solves} in {seconds:.3g} s"
        return Facts(f"Bracket: {self.heading}", told)

    def picture(self) -> Picture:
        """Return the shares in the gap if they are known; others need a solve (`plot`)."""
        if self.upper_bound.status is Status.SOLVED and (self.one_mesh or "gaps" in vars(self)):
            return Picture(self.plot())
        problem = self.upper_bound.discretisation.problem
        return Picture(problem.plot(), "the problem, on the mesh of the upper bound")

    def plot(self) -> Figure:
        """Return both meshes with their shares: see `lacore.pictures.bracket.plot_bracket`."""
        return views.picture(self)


def heading(lower: float, upper: float, width: float, status: str, bounded: str = BODY) -> str:
    """Return the title of a picture; `bounded` is the bounded quantity."""
    told = f"{lower:.6g} <= {bounded} <= {upper:.6g}"
    if lower > upper:
        told = f"lower bound {lower:.6g}, upper bound {upper:.6g}"
    return f"{told}   (width {width:.2%}, {status})"


def _equilibrium(bound: LowerBound) -> float:
    return np.nan if bound.certificate is None else bound.certificate.equilibrium


def width(lower: float, upper: float) -> float:
    """Return ``(upper - lower)`` divided by their mean; inf if one is missing."""
    if not (np.isfinite(lower) and np.isfinite(upper)):
        return np.inf
    mean = abs(lower + upper) / 2
    return (upper - lower) / mean if mean > 0 else np.inf


def crossing(lower: LowerBound, upper: UpperBound) -> Finding | None:
    """Return how far a lower bound lies above an upper one; None within round-off."""
    below, above = proven(lower, -np.inf), proven(upper, np.inf)
    if not below > above:
        return None
    power = sum(float(part.sum()) for part in upper.dissipation.values())
    # The sum of all powers is used, because dead loads may cancel most of it; strains of rigid
    # parts are round-off of their speed.
    natural = upper.discretisation.natural
    moving = natural.load_factor * float(np.abs(upper.velocity).max()) / natural.velocity
    size = max(abs(below), abs(above), power, moving)
    exact = exactness(dofs.body for dofs in upper.discretisation.continua.values())
    if below - above <= SUMMED * exact * size:
        return None
    values = {"lower": below, "upper": above, "width": width(below, above)}
    return Finding(Kind.BOUNDS_CROSS, (), values, Severity.WARNING)


def proven(bound: LowerBound | UpperBound | None, otherwise: float) -> float:
    """Return the load factor of a bound that holds, or else a given value."""
    if bound is None or bound.status is not Status.SOLVED:
        return otherwise
    return bound.load_factor
