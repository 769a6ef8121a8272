"""Problems with strengths divided by a factor."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Protocol, runtime_checkable

from lacore.bounds.enclosing import named_criterion
from lacore.model.bodies.any_body import of_kind
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.continuum.regions.lending import largest_strength
from lacore.model.materials.criterion import Criterion
from lacore.model.problem.problem import Problem
from lacore.reporting.errors import InputError


def weakened_problem(problem: Problem, factor: float, interfaces: bool) -> Problem | None:
    """Return the problem with strengths divided by a factor; None if no criterion supports it."""
    weaker = {}
    for name, body in of_kind(problem.bodies, Body).items():
        try:
            weaker[name] = replace(body, criterion=_divided_criterion(body.criterion, factor))
        except InputError:  # The angle is outside the accepted range.
            return None
    pairs = problem.interfaces
    if interfaces:
        pairs = tuple(replace(pair, friction=pair.law.divided(factor)) for pair in pairs)
    return replace(problem, bodies={**problem.bodies, **weaker}, interfaces=pairs)


def _divided_criterion(
    criterion: Criterion | Mapping[str, Criterion], factor: float
) -> Criterion | Mapping[str, Criterion]:
    if isinstance(criterion, Mapping):
        return {name: _weaker(own, factor) for name, own in criterion.items()}
    return _weaker(criterion, factor)


def _weaker(criterion: Criterion, factor: float) -> Criterion:
    assert isinstance(criterion, Weakening)
    return criterion.weakened(factor)


def require_weakening(name: str, body: Body) -> None:
    """Raise `InputError` unless all criteria of a body can be weakened, and one has a strength."""
    for region in body.regions:
        if not isinstance(region.criterion, Weakening):
            raise InputError(
                named_criterion(name, region),
                type(region.criterion).__name__,
                "does not say how it is when its strength is divided",
                "give lacore's criteria, or one with a method `weakened(factor)`",
            )
    if not largest_strength(body) > 0:
        raise InputError(
            f"Problem.bodies[{name!r}].criterion",
            body.label,
            "without cohesion all loads together have no size: the load factor is 0 or endless",
            "give it a small cohesion; that of an infinite slope of sand is tan(phi)/tan(slope)",
        )


@runtime_checkable
class Weakening(Protocol):
    """Criterion that can be weakened."""

    @property
    def strength(self) -> float:
        """Shear strength at zero pressure, Pa."""
        ...

    @property
    def label(self) -> str:
        """Its strengths, as text."""
        ...

    def weakened(self, factor: float) -> Criterion:
        """Return it with cohesion, ``tan(phi)``, strengths and cut-offs divided by a factor > 0."""
        ...
