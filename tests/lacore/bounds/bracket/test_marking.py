"""Shares of elements in the error of a bound, on velocities that are known in closed form."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.bounds.bracket.marking import lower_shares, shares_of, upper_shares
from lacore.bounds.upper import plastic_power
from tests.lacore.assembly.test_slips import sheared
from tests.lacore.models import punch


@pytest.mark.parametrize("rate", [1.0, -0.5])
def test_slip_along_supports_is_strain_of_the_elements_next_to_it(rate):
    """A square shears at a uniform rate between a base at rest and a footing at 3, and slips past.

    One stress dissipates all of a shear of one way. Where slip is of the other way, an element at
    the edge dissipates twice the smaller one in excess.
    """
    bound = la.upper_bound(sheared())
    d = bound.discretisation
    dofs, velocity = d.continua["block"], np.zeros(d.full.n)
    velocity[dofs.dofs[0]] = 1 + rate * dofs.nodes[1]
    velocity[d.footings] = 3.0
    power = plastic_power(d, velocity, 8)
    assert power["block"].sum() == pytest.approx(3.0 if rate > 0 else 1 + 0.5 + 2.5)
    shares = upper_shares(replace(bound, velocity=velocity, dissipation=power), "block")
    mesh = dofs.body.mesh
    ends = np.concatenate([mesh.boundaries[side] for side in ("bottom", "top")])
    expected = np.zeros(mesh.nelements)
    if rate < 0:
        expected[mesh.f2t[0, ends]] = 2 * -rate / mesh.nelements
    assert shares == pytest.approx(expected, abs=1e-12)


def test_meshes_on_which_nothing_was_found_are_refined_evenly():
    """Dead loads that are not carried leave no stresses, and locked ones no velocity."""
    upper = la.upper_bound(sheared())
    lower = la.lower_bound(sheared())
    unsafe = replace(lower, status=la.Status.UNSAFE, load_factor=np.nan, point=None)
    still = np.full_like(upper.velocity, np.nan)
    locked = replace(upper, status=la.Status.LOCKED, load_factor=np.inf, velocity=still)
    count = lower.model.n_elements
    for last in ({}, {"lower": unsafe}, {"upper": locked}, {"lower": unsafe, "upper": locked}):
        assert shares_of(last, ["block"], count).tolist() == [1.0] * count
    for last in ({"lower": lower, "upper": locked}, {"lower": lower}):
        assert shares_of(last, ["block"], count).tolist() == lower_shares(lower, "block").tolist()
    for last in ({"lower": unsafe, "upper": upper}, {"upper": upper}):
        assert shares_of(last, ["block"], count).tolist() == upper_shares(upper, "block").tolist()


def test_most_of_a_shared_mesh_is_refined_for_the_gap():
    """And some of it where the stresses of the lower bound cannot follow."""
    problem = punch()
    upper, lower = la.upper_bound(problem), la.lower_bound(problem)
    gap = np.maximum(la.gap_identity(upper, lower).elements["soil"], 0.0)
    rest = shares_of({"upper": upper, "lower": lower}, ["soil"], gap.size) - gap / gap.sum()
    assert rest.min() >= -1e-12
    assert 0.1 < rest.sum() < 0.5
    own = lower_shares(lower, "soil")
    assert rest / rest.sum() == pytest.approx(own / own.sum(), abs=1e-9)
