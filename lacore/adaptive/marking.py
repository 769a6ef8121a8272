"""Which elements to refine: shares of an error, and the fewest elements that hold most of it."""

import numpy as np

from lacore.arrays import Floats
from lacore.bounds.gap_identity import gap_identity
from lacore.bounds.lower import LowerBound
from lacore.bounds.upper import UpperBound

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
    group = next(group for group in bound.model.program.groups if group.name == body)
    rates = group.weights[:, None] * group.cone_vectors(bound.point.velocity)
    rates = rates.reshape(-1, 3, group.dim)
    strength = group.bound.reshape(-1, 3)[:, 0]
    whole = strength * np.linalg.norm(rates, axis=2).sum(axis=1)
    varying = whole - strength * np.linalg.norm(rates.sum(axis=1), axis=1)
    return np.asarray(np.sqrt(whole * np.maximum(varying, 0.0)))


def shared_shares(upper: UpperBound, lower: LowerBound, body: str) -> Floats:
    """Shares in the gap (T26), with those of the lower bound itself: parts, shape (elements,).

    Where the velocity of the upper bound has no strain the gap has no share, whatever stresses lack
    there; the multipliers of the lower bound move there.
    """
    gap = np.maximum(gap_identity(upper, lower).elements[body], 0.0)
    own = lower_shares(lower, body)
    return np.asarray(_parts(gap) + _LOWER * _parts(own))


def _parts(shares: Floats) -> Floats:
    total = float(shares.sum())
    return shares / total if total > 0 else shares
