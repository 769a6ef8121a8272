"""Elements to refine: shares of an error, and the fewest elements with most of it."""

from collections.abc import Iterator, Mapping
from functools import partial
from typing import TypeVar

import numpy as np

from lacore.bounds.bracket.bracket import proven
from lacore.bounds.bracket.whole import of_all
from lacore.bounds.constants import LOWER_SHARE
from lacore.bounds.gap_identity import gap_identity
from lacore.bounds.lower import LowerBound
from lacore.bounds.upper import UpperBound
from lacore.model.bodies.continuum.regions.gathering import HasBody, by_body, gathered
from lacore.numerics.arrays import Floats
from lacore.program.dissipation import DissipationGroup

T = TypeVar("T")


def shares_of(
    last: Mapping[str, LowerBound | UpperBound], bodies: list[str], elements: int
) -> Floats:
    """Return the shares of elements in an error; equal shares if nothing was solved.

    Args:
        last: the last bounds on a mesh, by kind.
        bodies: names of the bodies on this mesh.
        elements: of all of them.
    """
    lower, upper = last.get("lower"), last.get("upper")
    if proven(lower, np.nan) <= proven(upper, np.nan):
        assert isinstance(lower, LowerBound)
        assert isinstance(upper, UpperBound)
        return shared_shares(upper, lower)
    if isinstance(upper, UpperBound) and np.all(np.isfinite(upper.velocity)):
        return of_all(bodies, partial(upper_shares, upper))
    if isinstance(lower, LowerBound) and lower.point is not None:
        return of_all(bodies, partial(lower_shares, lower))
    return np.ones(elements)


def upper_shares(bound: UpperBound, body: str) -> Floats:
    """Return the dissipation of each element in excess of its mean strain rate's (T26d).

    By convexity it is at least 0, and the smallest share of a gap (T26) for a constant stress in
    the element. Slip along supports counts as strain. The shape is (elements,), and the unit that
    of load factors.
    """
    discretisation = bound.discretisation
    if discretisation.continua[body].body.dimension == 3:
        # The jumps are included, so it shows where the mechanism is (T92).
        return bound.dissipation[body]
    groups, point = discretisation.full.groups, bound.state.point
    assert point is not None
    dofs, whole = discretisation.continua[body], bound.dissipation[body]
    slipped = np.zeros((whole.size, 3))
    if body in discretisation.slips:
        slip = discretisation.slips[body]
        beside = dofs.body.mesh.f2t[0, slip.facets]
        np.add.at(slipped, beside, slip.layer(dofs, bound.velocity))
    ours = _of(body, by_body(discretisation.continua, groups))
    means = _of(body, by_body(discretisation.continua, point.mean_stress))
    shares = []
    for region, group, mean in zip(dofs.body.regions, ours, means, strict=True):
        count = region.elements.size
        if group.surfaces is not None:
            shares.append(_varying(group, group.cone_vectors(bound.velocity), mean, count))
            continue
        rates = (group.weights[:, None] * group.cone_vectors(bound.velocity)).reshape(
            count, -1, group.dim
        )
        strength = _mean(group.bound.reshape(count, -1))
        total = rates.sum(axis=1) + slipped[region.elements] @ region.form.rows.T
        own = whole[region.elements] - strength * np.linalg.norm(total, axis=1)
        shares.append(np.asarray(own))
    return gathered(dofs.body, shares)


def _mean(values: Floats) -> Floats:
    """Return the means of values (e, q) of elements, exact for equal values."""
    return np.asarray(values[:, 0] + (values - values[:, :1]).mean(axis=1))


def _of(name: str, parts: Iterator[tuple[str, HasBody, tuple[T, ...]]]) -> tuple[T, ...]:
    """Return the parts of a body."""
    return next(own for body, _, own in parts if body == name)


def lower_shares(bound: LowerBound, body: str) -> Floats:
    """Return the variation of the multipliers of a lower bound, in geometric mean with dissipation.

    Multipliers of equilibrium elements vary in an element where stresses cannot follow; alone they
    refine too few elements at a time (T26d). In three dimensions only the dissipation is used. The
    shape is (elements,), and the unit that of load factors.
    """
    assert bound.point is not None
    bodies = bound.model.continua
    solid = bodies[body].body.dimension == 3
    corners = len(bodies[body].body.mesh.t)
    groups = _of(body, by_body(bodies, bound.model.program.groups))
    means = _of(body, by_body(bodies, bound.point.mean_stress))
    shares = []
    for group, mean in zip(groups, means, strict=True):
        rates = group.weights[:, None] * group.cone_vectors(bound.point.velocity)
        rates = rates.reshape(-1, corners, group.dim)
        # What a soil carries follows its pressure.
        strength = group.strength_at(mean).reshape(-1, corners).mean(axis=1)
        whole = strength * np.linalg.norm(rates, axis=2).sum(axis=1)
        varying = whole - strength * np.linalg.norm(rates.sum(axis=1), axis=1)
        own = whole if solid else np.sqrt(whole * np.maximum(varying, 0.0))
        shares.append(np.asarray(own))
    return gathered(bodies[body].body, shares)


def _varying(group: DissipationGroup, rates: Floats, mean: Floats, elements: int) -> Floats:
    """Return the variation of shear in elements times their strength, (elements,).

    The strength is that at the pressure of the element. The dissipation of a soil is linear in its
    strain rate (T38), and does not show this variation.
    """
    weighted = (group.weights[:, None] * rates).reshape(elements, -1, group.dim)
    strength = group.strength_at(mean).reshape(elements, -1).mean(axis=1)
    whole = np.linalg.norm(weighted, axis=2).sum(axis=1)
    return np.asarray(strength * (whole - np.linalg.norm(weighted.sum(axis=1), axis=1)))


def shared_shares(upper: UpperBound, lower: LowerBound) -> Floats:
    """Return the shares in the gap (T26), combined with those of the lower bound, of all bodies.

    Where the velocity of the upper bound has no strain, the gap has no share, however poor the
    stresses are; but there the multipliers of the lower bound move.
    """
    gap = np.concatenate(list(gap_identity(upper, lower).elements.values()))
    own = np.concatenate([lower_shares(lower, name) for name in lower.model.continua])
    gap = np.maximum(gap, 0.0)
    return np.asarray(_parts(gap) + LOWER_SHARE * _parts(own))


def _parts(shares: Floats) -> Floats:
    total = float(shares.sum())
    return shares / total if total > 0 else shares
