"""Cohesion that is lent to soils and masonry without any, so that bounds can be proven (T45).

A solver cannot find stresses that are exactly admissible where a body has no strength without
pressure. With lent strength the body carries more: upper bounds remain bounds of the body as
stated, and lower bounds are bounds of the body with the lent strength.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import singledispatch
from typing import TypeVar

import numpy as np

from lacore.bounds.enclosing import named_criterion
from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.regions.lending import strengthless
from lacore.model.materials.criterion import Criterion
from lacore.model.materials.drucker_prager import DruckerPrager
from lacore.model.materials.mohr_coulomb import MohrCoulomb, NoTension, Rankine
from lacore.model.problem.problem import Problem
from lacore.reporting.errors import InputError, require_positive
from lacore.reporting.findings import Finding, Severity
from lacore.reporting.kinds import Kind
from lacore.reporting.text import Quantity

_Stated = TypeVar("_Stated")


def with_lent_cohesion(
    problem: _Stated, cohesion: float | None
) -> tuple[_Stated | Problem, tuple[Finding, ...]]:
    """Return a problem with strength lent to all bodies that have none, and a note of it.

    Args:
        problem: The problem, which has not been assembled.
        cohesion: Pa; None: the problem stays as it is.

    Raises:
        InputError: A cohesion that is not positive, an assembled problem, no body without strength,
            or a criterion to which none can be lent.
    """
    if cohesion is None:
        return problem, ()
    require_positive("lent_cohesion", cohesion)
    if not isinstance(problem, Problem):
        why, fix = "the problem is already assembled", "give the lacore.Problem"
        raise InputError("lent_cohesion", cohesion, why, fix)
    lent = {
        name: replace(body, criterion=_lent_to(name, body, cohesion))
        for name, body in of_kind(problem.bodies, Body).items()
        if any(strengthless(body))
    }
    if not lent:
        why, fix = "no body without cohesion or tension needs it", "leave it out"
        raise InputError("lent_cohesion", cohesion, why, fix)
    values = {"lent": Quantity(float(cohesion), "Pa", ".4g")}
    note = Finding(Kind.LENT_COHESION, tuple(lent), values, Severity.WARNING)
    return replace(problem, bodies={**problem.bodies, **lent}), (note,)


def _lent_to(name: str, body: Body, cohesion: float) -> Criterion | Mapping[str, Criterion]:
    """Return the criteria of a body, with strength lent to its regions without any."""
    stronger = {}
    for region in strengthless(body):
        try:
            stronger[region.name] = _stronger(region.criterion, cohesion)
        except _NotLentError as error:
            raise InputError(
                named_criterion(name, region),
                region.criterion.label,
                f"no cohesion can be lent to it: {error}",
                "give it a cohesion, or a tensile strength, of its own",
            ) from error
    if isinstance(body.criterion, Mapping):
        return {**body.criterion, **stronger}
    (own,) = stronger.values()
    return own


class _NotLentError(Exception):
    """Nothing can be lent to a criterion; its text says why."""


@singledispatch
def _stronger(criterion: Criterion, cohesion: float) -> Criterion:
    """Return a criterion with a strength without pressure of at least `cohesion`, Pa."""
    raise _NotLentError("its criterion is not one of MohrCoulomb, DruckerPrager and NoTension")


@_stronger.register
def _(criterion: NoTension, cohesion: float) -> Criterion:
    return Rankine(cohesion, criterion.compressive_strength)


@_stronger.register
def _(criterion: Rankine, cohesion: float) -> Criterion:
    return replace(criterion, tensile_strength=_least(criterion.tensile_strength, cohesion))


@_stronger.register
def _(criterion: DruckerPrager, cohesion: float) -> Criterion:
    return replace(criterion, cohesion=_least(criterion.cohesion, cohesion))


@_stronger.register
def _(criterion: MohrCoulomb, cohesion: float) -> Criterion:
    made = replace(criterion, tension_cutoff=None, cohesion=_least(criterion.cohesion, cohesion))
    if criterion.tension_cutoff is None:
        return made
    angle = _number(criterion.friction_angle)
    most = np.inf if angle == 0 else _number(made.cohesion) / np.tan(np.radians(angle))
    cut = min(_least(criterion.tension_cutoff, cohesion), float(most))
    return replace(made, tension_cutoff=cut)


def _least(strength: object, lent: float) -> float:
    """Return the larger one of a strength and what is lent."""
    return max(_number(strength), float(lent))


def _number(strength: object) -> float:
    """Return a strength that does not vary."""
    if not isinstance(strength, int | float):
        raise _NotLentError("its strength varies from place to place")
    return float(strength)
