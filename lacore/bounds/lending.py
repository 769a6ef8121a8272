"""Cohesion that is lent to soils and masonry without any, so that bounds can be proven (T45).

A solver cannot find stresses that are exactly admissible where a body has no strength without
pressure. With lent strength the body carries more: upper bounds remain bounds of the body as
stated, and lower bounds are bounds of the body with the lent strength.
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import singledispatch
from typing import TypeVar

import numpy as np

from lacore.bounds.enclosing import named_criterion
from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.body_forces import largest
from lacore.model.bodies.continuum.regions.lending import strengthless
from lacore.model.conditions.body_forces import BodyForce
from lacore.model.conditions.loads import Load
from lacore.model.materials.criterion import Criterion
from lacore.model.materials.drucker_prager import DruckerPrager
from lacore.model.materials.mohr_coulomb import MohrCoulomb, NoTension, Rankine
from lacore.model.problem.problem import Problem
from lacore.reporting.errors import InputError, require_positive
from lacore.reporting.findings import Finding, Severity
from lacore.reporting.kinds import Kind
from lacore.reporting.text import Quantity

# Default cohesion by the weight and size of a body, and by the target width of a bracket. It raises
# N_gamma of a rough footing at 25 degrees by a tenth of the target, and solvers converge.
_SHARE = 3e-3

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
    weak = list(_weak(problem))
    if not weak:
        why, fix = "no body without cohesion or tension needs it", "leave it out"
        raise InputError("lent_cohesion", cohesion, why, fix)
    return _lent(problem, dict.fromkeys(weak, float(cohesion)))


def with_default_cohesion(
    problem: Problem, target_width: float
) -> tuple[Problem, tuple[Finding, ...]]:
    """Return a problem with a small cohesion lent to all heavy bodies that have none.

    Args:
        problem: The problem.
        target_width: Width of a bracket, of which the change by this cohesion is a small part.

    Raises:
        InputError: A criterion to which none can be lent.
    """
    weight = {name: weight_per_area(problem, name) for name in _weak(problem)}
    share = _SHARE * target_width
    return _lent(problem, {name: share * own for name, own in weight.items() if own > 0})


def weight_per_area(problem: Problem, name: str) -> float:
    """Return the largest dead body force of a body times its size, Pa."""
    body = of_kind(problem.bodies, Body)[name]
    return body.size * sum(
        _per_volume(load, body) for load in problem.dead_loads if load.body == name
    )


@singledispatch
def _per_volume(load: Load, body: Body) -> float:
    """Return the size of a force per volume, N/m^3; zero for loads on boundaries."""
    return 0.0


@_per_volume.register(BodyForce)
def _of_volume(load: BodyForce, body: Body) -> float:
    return largest(load, body.mesh, "BodyForce")


def _weak(problem: Problem) -> Iterator[str]:
    """Yield the names of bodies with regions without strength."""
    for name, body in of_kind(problem.bodies, Body).items():
        if any(strengthless(body)):
            yield name


def _lent(problem: Problem, cohesions: Mapping[str, float]) -> tuple[Problem, tuple[Finding, ...]]:
    """Return the problem with cohesions lent to bodies, Pa by name, and a note of each size."""
    bodies = of_kind(problem.bodies, Body)
    lent = {
        name: replace(bodies[name], criterion=_lent_to(name, bodies[name], own))
        for name, own in cohesions.items()
    }
    names: dict[float, tuple[str, ...]] = {}
    for name, own in cohesions.items():
        names[own] = (*names.get(own, ()), name)
    notes = (
        Finding(Kind.LENT_COHESION, some, {"lent": Quantity(own, "Pa", ".4g")}, Severity.WARNING)
        for own, some in names.items()
    )
    return replace(problem, bodies={**problem.bodies, **lent}), tuple(notes)


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
