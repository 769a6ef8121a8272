"""Strict bounds of a problem compared with each other, and checks of safety factors."""

from collections.abc import Callable, Iterator
from math import inf, isfinite, isnan, nan
from typing import Any

import lacore as la
from lacore_verification.fuzz.checks.verdict import BAR, Wrong
from lacore_verification.fuzz.drawn.copies import has_coulomb, weakened, with_law
from lacore_verification.fuzz.drawn.draw import Rng
from lacore_verification.fuzz.drawn.recipe import Recipe, build
from lacore_verification.fuzz.solving import RecipeResult, answer

_TOLERANCE = 0.02  # Relative tolerance of safety factors.
_REFUSALS = (la.InputError, la.CapabilityError)


def wrong_bounds(base: RecipeResult, scale: float) -> Iterator[Wrong]:
    """Compare the lower bound, the upper bound and the load factor of a problem without Coulomb.

    Args:
        base: result of the problem.
        scale: dissipation of its state, in units of load factors.
    """
    problem, state = base.problem, base.state
    if problem is None or state is None:
        return
    lower, upper = (_bound(compute, problem) for compute in (la.lower_bound, la.upper_bound))
    if base.status == la.Status.UNSAFE.label and isfinite(lower):
        yield Wrong("word unsafe", f"equilibrium elements carry {lower:.6g}")
    above = {"the upper bound": upper}
    if base.solved and state.rigor is la.Rigor.UPPER:
        above["the load factor"] = base.load_factor
    for name, value in above.items():
        room = BAR * (scale + abs(value))
        if value < lower - room:  # False for NaN.
            yield Wrong("bounds", f"{name} {value:.9g} is below the lower bound {lower:.9g}")


def _bound(compute: Callable[[la.Problem], Any], problem: la.Problem) -> float:
    """Return a strict bound; NaN if there is none."""
    try:
        found = compute(problem)
    except _REFUSALS:
        return nan
    strict = found.rigor in (la.Rigor.LOWER, la.Rigor.UPPER)
    return float(found.load_factor) if strict else nan


def wrong_safety(recipe: Recipe, rng: Rng) -> Iterator[Wrong]:
    """Compare both ends of a safety factor with bounds of problems that are weakened by them.

    With Coulomb friction the ends are of certified states, whose load factors are no larger than
    those with associated friction on the same mesh.
    """
    friction = bool(rng.random() < 0.5)
    found = _safety(recipe, friction)
    if found is None:
        return
    if found.lower > found.upper * (1 + BAR):
        yield Wrong("safety factor", f"its ends are {found.lower:.6g} and {found.upper:.6g}")
    if has_coulomb(recipe):
        if not isnan(found.lower):
            weak = with_law(weakened(recipe, found.lower, friction), "associated")
            most = answer(weak, rng, checked=False)
            if most.solved and most.load_factor < 1 - BAR:
                text = f"stands at {found.lower:.6g}; associated it carries {most.load_factor:.6g}"
                yield Wrong("safety factor", text)
        return
    for end, compute, sign in ((found.lower, la.upper_bound, 1), (found.upper, la.lower_bound, -1)):
        if isnan(end) or not 0 < end < inf:
            continue
        value = _bound(compute, build(weakened(recipe, end, friction)))
        if sign * value < sign * (1 - sign * BAR):
            text = f"{end:.6g} is proven, but strengths divided by it have a bound of {value:.9g}"
            yield Wrong("safety factor", text)


def _safety(recipe: Recipe, interfaces: bool) -> la.SafetyFactor | None:
    """Return a safety factor; None where it is refused."""
    try:
        return la.safety_factor(build(recipe), interfaces=interfaces, tolerance=_TOLERANCE)
    except _REFUSALS:
        return None
