"""Strength reduction: the factor that divides strengths until given loads are the collapse load.

For the factor F every cohesion and every ``tan(phi)`` is divided by F, which reduces the load
factor of all given loads together. If a strict lower bound of it is at least 1, the structure
stands; if a strict upper bound is below 1, it collapses: the two ends are proven. For
non-associated flow there is no bound theorem, and certified states are used instead.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from math import exp, inf, isnan, log, nan

import numpy as np
import pandas as pd

from lacore.analyses.ranges.weakened import require_weakening, weakened_problem
from lacore.bounds.enclosing import has_coulomb
from lacore.bounds.lower import lower_bound
from lacore.bounds.upper import upper_bound
from lacore.limit.outcome import strict_bound
from lacore.limit.solve import solve
from lacore.limit.state import LimitState
from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.continuum.body import Body
from lacore.model.problem.problem import Problem
from lacore.reporting import terms
from lacore.reporting.errors import InputError, require_positive, typed
from lacore.reporting.findings import Finding
from lacore.reporting.showing import Facts, counted, listed
from lacore.reporting.status import Result, Rigor, Standing, Status
from lacore.reporting.text import Term, text
from lacore.solvers.inner.preparing import require_exact

Weakened = Callable[[float], Problem | None]

_FARTHEST = 4.0  # factor to the next value if nothing brackets it
# share of a bracket, in logarithms, by which the next factor stays away from its ends
_INSIDE = 0.1
_MOST = 25  # limit of solves of one end: 4^25 is more than any strength
# smallest factor: a structure that collapses with strengths divided by it always collapses
_STRONGEST = 1e-3


@dataclass(frozen=True, repr=False)
class SafetyFactor(Result):
    """A factor of safety between two ends: proven, or of certified states.

    Attributes:
        lower: the structure stands with strengths divided by this factor; NaN if not proven. For
            certified states: the largest factor with one whose load factor is 1 or more.
        upper: with strengths divided by this one it collapses; NaN if not proven. For certified
            states: the smallest factor with one whose load factor is below 1.
        history: one row per bound: ``end``, ``factor``, ``load_factor`` of all given loads (NaN for
            a failed bound), ``proves``; or one row per state, with the load factor of the reference
            loads in addition to the dead ones, or of all loads if the dead loads alone are not
            carried.
        problem: the problem.
        findings: further findings on the mechanism at the upper end, such as sides of soils that it
            reaches: in a larger body both ends may be smaller.
        states: states at both ends for non-associated flow: they do not prove the ends, as others
            may have other load factors (`lacore.soil_range` and `lacore.coulomb_range` search for
            them). With associated flow the factor is at least as large: its `upper`, of the problem
            with ``Coulomb(mu, associated=True)`` and no dilation angles, is also proven for this
            one (T14, T54). Empty if ends are proven.
        interfaces: whether friction of interfaces is divided as well.
    """

    lower: float
    upper: float
    history: pd.DataFrame
    problem: Problem
    findings: tuple[Finding, ...] = ()
    states: tuple[LimitState, ...] = ()
    interfaces: bool = False

    @property
    def note(self) -> str:
        """The message; empty without findings."""
        return self.message

    @property
    def width(self) -> float:
        """``(upper - lower)/mean``."""
        return 2 * (self.upper - self.lower) / (self.upper + self.lower)

    @property
    def proven(self) -> bool:
        """Whether both ends are, by strict bounds of the continuum problem."""
        return not self.states and not isnan(self.width)

    @property
    def stands(self) -> bool | None:
        """Whether the structure carries the given loads without reduction; None without a proof."""
        if self.states:
            return None
        if self.lower >= 1:
            return True
        return False if self.upper <= 1 else None

    @property
    def _failed(self) -> str:
        """Text on the number of failed bounds."""
        number = int(self.history["load_factor"].isna().sum())
        return f", of which {number} failed and prove{'s' * (number == 1)} nothing" * bool(number)

    @property
    def _weakened(self) -> str:
        """Text on the divided strengths."""
        weaker, every = of_kind(self.problem.bodies, Body), list(self.problem.bodies)
        if len(weaker) == len(every):
            return "all bodies"
        return f"{listed(weaker)}; {listed([one for one in every if one not in weaker])} as stated"

    @property
    def _beside(self) -> str:
        """Text on the friction of interfaces."""
        if not self.problem.interfaces:
            return ""
        return f", friction of interfaces {'as well' if self.interfaces else 'as it is'}"

    def facts(self) -> Facts:
        """Return both ends, and their effort, for printing."""
        missing = [end for end in ("lower", "upper") if isnan(getattr(self, end))]
        proven, kind, ends = "both ends by strict bounds of the continuum problem", "bound", ""
        if self.states:
            proven, kind = "not proven: certified states; there may be others", "state"
            ends = " of certified states, not proven"
        told = {
            "rigor": f"not proven: {' and '.join(missing)} end" if missing else proven,
            "given": f"{counted(len(self.problem.loads), 'load')}, at their full size",
            "divided": f"strength of {self._weakened}" + self._beside,
            "solved by": counted(len(self.history), kind) + self._failed,
        }
        told |= {"note": self.note} if self.note else {}
        title = f"{self.lower:.6g} <= F <= {self.upper:.6g}{ends}"
        return Facts(title, told, "SafetyFactor")


@typed()
def safety_factor(
    problem: Problem,
    of: str = "strength",
    *,
    interfaces: bool = False,
    tolerance: float = 1e-3,
    backend: str = "auto",
) -> SafetyFactor:
    """Compute the factor that divides strengths until the given loads collapse the structure.

    The bounds are those on the mesh of the problem, which determine the distance of the ends.
    Refine it, or use the space ``p2-disc`` and a fan at its toe, for closer ones. With Coulomb
    friction, or non-associated soil, ends are factors of certified states (`SafetyFactor.states`)
    and within `tolerance`.

    Args:
        problem: its reference and dead loads count equally, at their full size (load factor 1).
        of: divided quantities: ``strength``, that is cohesion, ``tan(phi)``, shear strength and
            cut-offs of all deformable bodies; members of frames and joints of blocks keep theirs.
        interfaces: divide the friction of interfaces as well.
        tolerance: relative tolerance of the search for each end.
        backend: name of an exact backend.

    Raises:
        InputError: a criterion that cannot be weakened; a body without any cohesion, or no body at
            all, whose factor does not follow from a load factor; anything that bounds reject.
        CapabilityError: the backend is regularised, or does not support the problem.

    Example:
        >>> found = la.safety_factor(la.examples.footing(strength=0.25), tolerance=0.05)
        >>> round(found.lower, 2), round(found.upper, 2)  # exact: (2 + pi)/4
        (1.21, 1.46)
    """
    if of != "strength":
        raise InputError("of", of, "nothing that can be divided", "give 'strength'")
    require_positive("tolerance", tolerance)
    bodies = of_kind(problem.bodies, Body)
    if not bodies:
        why = "no body deforms: what is divided is the strength of criteria, and here is none"
        fix = text(
            "give a {}; of a frame whose loads are all reference loads the load factor is that of"
            " its strength, and {} friction at which blocks collapse",
            terms.CONTINUUM,
            Term("`lacore.critical` finds", "--critical finds, along a number that varies, the"),
        )
        raise InputError("Problem.bodies", list(problem.bodies), why, fix)
    for name, body in bodies.items():
        require_weakening(name, body)
    require_exact(backend, "a factor of safety")
    frictional = any(own.form.frictional for body in bodies.values() for own in body.regions)
    if has_coulomb(problem) or frictional:
        return _of_states(problem, interfaces, tolerance, backend)
    weakened = partial(weakened_problem, _together(problem), interfaces=interfaces)
    rows: list[dict[str, object]] = []
    seen: dict[float, tuple[Finding, ...]] = {}

    def below(weaker: Problem, factor: float) -> float:
        bound = lower_bound(weaker, backend)
        value = bound.load_factor if bound.rigor is Rigor.LOWER else nan
        return inf if bound.status is Status.LOCKED else value

    def above(weaker: Problem, factor: float) -> float:
        bound = upper_bound(weaker, backend)
        seen[factor] = bound.findings if bound.status is Status.SOLVED else ()
        value = bound.load_factor if bound.rigor is Rigor.UPPER else nan
        if bound.status is Status.FREE and strict_bound(bound.discretisation):
            return 0.0  # It moves without dissipation, as associated friction is overcome.
        return inf if bound.status is Status.LOCKED else value

    lower = _end("lower", True, weakened, below, 1.0, tolerance, rows)
    upper = _end("upper", False, weakened, above, lower if lower > 0 else 1.0, tolerance, rows)
    found, history = seen.get(upper, ()), pd.DataFrame(rows)
    return SafetyFactor(lower, upper, history, problem, found, interfaces=interfaces)


def _together(problem: Problem) -> Problem:
    """Return all loads as reference loads: at a load factor of 1 they have their given size."""
    loads = [*problem.reference_loads, *problem.dead_loads]
    return replace(problem, reference_loads=loads, dead_loads=[])


def _of_states(problem: Problem, interfaces: bool, tolerance: float, backend: str) -> SafetyFactor:
    """Return factors of certified states on either side of a load factor of 1.

    Only the reference loads grow, since weights that grow with the load close the contact, which
    then jams. If the structure does not carry the dead loads alone, all loads grow.
    """
    rows: list[dict[str, object]] = []
    states: dict[float, LimitState] = {}

    def certified(weaker: Problem, factor: float) -> float:
        state = solve(weaker, backend)
        if not _reached_from_dead(state):
            state = solve(_together(weaker), backend)
        if state.status in (Status.SOLVED, Status.LOCKED):
            states[factor] = state
        return 0.0 if state.status is Status.FREE else state.load_factor

    weakened = partial(weakened_problem, problem, interfaces=interfaces)
    lower = _end("state", True, weakened, certified, 1.0, tolerance, rows)
    history = pd.DataFrame(rows).drop(columns="proves")
    upper = float(min(history["factor"][history["load_factor"] < 1], default=nan))
    if isnan(lower) and upper <= _STRONGEST:
        friction = Term(", or take `interfaces=True`", ", or take --interfaces")
        fix = text("add supports, or less load{}", "" if interfaces else friction)
        why = f"it is not carried with strengths {1 / upper:.0f} times as large: friction decides"
        raise InputError("safety_factor.problem", ", ".join(problem.bodies), why, fix)
    ends = tuple(states[factor] for factor in (lower, upper) if factor in states)
    if not ends:
        why = f"none of {len(rows)} states of weakened strengths is certified"
        command = Term("`lacore.solve`", "`lacore solve` without --safety")
        fix = text("see what {} reports, and take a finer mesh or another backend", command)
        raise InputError("safety_factor.problem", ", ".join(problem.bodies), why, fix)
    found = ends[-1].findings if ends[-1].status is Status.SOLVED else ()
    return SafetyFactor(lower, upper, history, problem, found, ends, interfaces)


def _reached_from_dead(state: LimitState) -> bool:
    """Return whether a load factor of at least 1 is reached from dead loads that are carried.

    A structure that collapses under its loads may carry them at many times their size.
    """
    if state.status is Status.UNSAFE:
        return False
    return not state.load_factor >= 1 or state.stability().standing is Standing.STANDS


def _end(
    end: str,
    stands: bool,
    weakened: Weakened,
    load_factor: Callable[[Problem, float], float],
    start: float,
    tolerance: float,
    rows: list[dict[str, object]],
) -> float:
    """Return the last factor with a load factor of at least 1, or below 1; NaN without one.

    A failed solve (NaN) decides nothing: the search continues next to it.
    """
    above, below = (0.0, inf), (inf, -inf)  # logarithms of the factor and of the load factor
    low, high = -inf, inf
    failed: list[float] = []
    factor, best, least = start, nan, log(1 + tolerance)
    for tries in range(_MOST):
        weaker, here = weakened(factor), log(factor)
        known = nan if weaker is None else load_factor(weaker, factor)
        proves = known >= 1 if stands else known < 1
        rows.append({"end": end, "factor": factor, "load_factor": known, "proves": proves})
        if proves and not isnan(best):
            best = max(best, factor) if stands else min(best, factor)
        elif proves:
            best = factor
        size = log(known) if known > 0 else -inf
        # No problem is as weak, or as strong, and the problem itself is neither.
        if weaker is None:
            low, high = (low, here) if here > 0 else (here, high)
        elif isnan(known):
            failed.append(here)
        elif known >= 1:
            low, above = here, (here, size)
        else:
            high, below = here, (here, size)
        if high - low <= least:
            break
        bounded = low > -inf or high < inf
        # If strength hardly affects the load factor, the steps grow quickly.
        reach = 2**tries * size
        wanted = _next(low, high, above, below, reach) if bounded else failed[-1]
        clear = _clear(wanted, low, high, failed, stands, least)
        if clear is None:
            break
        factor = exp(clear)
    return best


def _clear(
    wanted: float, low: float, high: float, failed: list[float], down: bool, least: float
) -> float | None:
    """Return the wanted factor, or if a bound failed there the middle of the widest gap.

    Logarithms.

    Of two gaps of equal width, the one on the side of the proven end is chosen. None if all are too
    narrow.
    """
    if all(abs(wanted - one) > least for one in failed):
        return wanted
    marks = sorted([low, *(one for one in failed if low < one < high), high])
    gaps = list(pairwise(marks))
    begin, end = max(gaps if down else gaps[::-1], key=lambda gap: gap[1] - gap[0])
    if end - begin <= 2 * least:
        return None
    if begin == -inf:
        return end - log(_FARTHEST)
    return begin + log(_FARTHEST) if end == inf else (begin + end) / 2


def _next(
    low: float,
    high: float,
    stands: tuple[float, float],
    falls: tuple[float, float],
    reach: float,
) -> float:
    """Return the logarithm of the next factor, at which the load factor is about 1.

    If only one side is known, it is at most `reach` away, which is about the logarithm of the load
    factor.
    """
    if low == -inf or high == inf:
        here = high if low == -inf else low
        known = reach if np.isfinite(reach) else (log(_FARTHEST) if low > -inf else -log(_FARTHEST))
        step = float(np.clip(known, -log(_FARTHEST), log(_FARTHEST)))
        least = 1e-3 if low > -inf else -1e-3
        return here + (step if abs(step) > abs(least) else least)
    if not (np.isfinite(stands[1]) and np.isfinite(falls[1])) or stands[1] <= falls[1]:
        return (low + high) / 2
    share = stands[1] / (stands[1] - falls[1])
    inside = float(np.clip(share, _INSIDE, 1 - _INSIDE))
    return low + inside * (high - low)
