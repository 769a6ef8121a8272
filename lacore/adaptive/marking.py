"""Which elements to refine: shares of an error, and the fewest elements that hold most of it."""

import numpy as np

from lacore.arrays import Floats
from lacore.bounds.gap_identity import gap_identity
from lacore.bounds.lower import LowerBound
from lacore.bounds.upper import UpperBound
from lacore.dissipation import DissipationGroup

_LOWER = 0.3  # of all shares: lower bounds may be weak where nothing moves


def upper_shares(bound: UpperBound, body: str) -> Floats:
    """How far the dissipation of each element is above that of its mean strain rate (T26d).

    By convexity no less than 0, and the least share of a gap (T26) that any stress constant in the
    element can leave. Its slip past what holds it is strain like any other. Shape (elements,), in
    the unit of load factors.
    """
    discretisation = bound.discretisation
    groups = discretisation.full.groups
    group = next(group for group in groups if group.name == body)
    whole = bound.dissipation[body]
    if group.surfaces is not None:
        assert bound.state.point is not None
        means = dict(zip((g.name for g in groups), bound.state.point.mean_stress, strict=True))
        return _varying(group, group.cone_vectors(bound.velocity), means[body], whole.size)
    rates = (group.weights[:, None] * group.cone_vectors(bound.velocity)).reshape(
        whole.size, -1, group.dim
    )
    strength = group.bound.reshape(whole.size, -1)[:, 0]
    total = rates.sum(axis=1)
    if body in discretisation.slips:
        dofs, slip = discretisation.bodies[body], discretisation.slips[body]
        form = dofs.body.form
        elements = dofs.body.mesh.f2t[0, slip.facets]
        np.add.at(total, elements, slip.layer(dofs, bound.velocity) @ form.rows.T)
    return np.asarray(whole - strength * np.linalg.norm(total, axis=1))


def lower_shares(bound: LowerBound, body: str) -> Floats:
    """The same of the multipliers of a lower bound, in geometric mean with their dissipation.

    Multipliers of equilibrium elements vary in an element where stresses cannot follow; alone they
    refine too few elements at a time (T26d). Shape (elements,), in the unit of load factors.
    """
    assert bound.point is not None
    groups = bound.model.program.groups
    number = next(number for number, group in enumerate(groups) if group.name == body)
    group = groups[number]
    rates = group.weights[:, None] * group.cone_vectors(bound.point.velocity)
    rates = rates.reshape(-1, 3, group.dim)
    # What a soil carries follows its pressure.
    strength = group.carried(bound.point.mean_stress[number]).reshape(-1, 3).mean(axis=1)
    whole = strength * np.linalg.norm(rates, axis=2).sum(axis=1)
    varying = whole - strength * np.linalg.norm(rates.sum(axis=1), axis=1)
    return np.asarray(np.sqrt(whole * np.maximum(varying, 0.0)))


def _varying(group: DissipationGroup, rates: Floats, mean: Floats, elements: int) -> Floats:
    """How far shear varies in elements, times what they carry at their pressure, (elements,).

    The dissipation of a soil is linear in its strain rate (T38), and says nothing of it.
    """
    weighted = (group.weights[:, None] * rates).reshape(elements, -1, group.dim)
    strength = group.carried(mean).reshape(elements, -1).mean(axis=1)
    whole = np.linalg.norm(weighted, axis=2).sum(axis=1)
    return np.asarray(strength * (whole - np.linalg.norm(weighted.sum(axis=1), axis=1)))


def shared_shares(upper: UpperBound, lower: LowerBound) -> Floats:
    """Shares in the gap (T26), with those of the lower bound itself: parts, of all bodies.

    Where the velocity of the upper bound has no strain the gap has no share, whatever stresses lack
    there; the multipliers of the lower bound move there.
    """
    gap = np.concatenate(list(gap_identity(upper, lower).elements.values()))
    own = np.concatenate([lower_shares(lower, name) for name in lower.model.bodies])
    gap = np.maximum(gap, 0.0)
    return np.asarray(_parts(gap) + _LOWER * _parts(own))


def _parts(shares: Floats) -> Floats:
    total = float(shares.sum())
    return shares / total if total > 0 else shares
