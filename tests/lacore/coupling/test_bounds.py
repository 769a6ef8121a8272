"""Bounds of Coulomb load factors from states that are a little wrong: they still enclose."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.coupling.bounds import lower_bound, upper_bound
from lacore.program.kinematic import associated_contact, frictionless_contact
from lacore.program.power import kinematic_load_factor
from lacore.reporting.status import Status
from lacore.solvers.backend import InnerSolution
from tests.lacore.planted import P0, flowing, flowing_field, on_free_unknowns
from tests.lacore.solvers.inner.test_light_blocks import stone_on_a_wall

EXACT = 2 - P0  # load factor of `flowing`, of the continuum and of the mesh
TOLERANCE = 1e-6


def wrong_velocity(field):
    """`flowing` with another velocity, and with the load factor that this velocity has."""
    d, state = flowing()
    moved = replace(state, velocity=on_free_unknowns(d, field))
    own = kinematic_load_factor(d.program, moved, frictionless_contact(d.program.contact))
    return d.program, InnerSolution(Status.SOLVED, "", 0, 0.0, replace(moved, load_factor=own))


def bent(x):
    """Incompressible and normalised; it dissipates more than the mechanism, by some 1e-7."""
    y = x[1] - 0.5
    return np.stack([x[0] * (1 + 1e-3 * y), -x[1] - 5e-4 * (y**2 - 0.25)])


def sunk(x):
    """It penetrates the floor by 1e-7, and falls with its dead load as far."""
    return flowing_field(x) - np.array([[0.0], [1e-7]])


def test_forces_out_of_balance_lower_the_lower_bound():
    """The stresses balance less than the load factor: its excess is no load that they carry."""
    program, inner = wrong_velocity(bent)
    assert EXACT + 1e-8 < inner.point.load_factor < EXACT + 1e-6
    bound = lower_bound(program, inner, TOLERANCE)
    assert EXACT - 1e-5 < bound <= EXACT


def test_penetration_raises_the_upper_bound():
    """The dead load moves into the floor: the load factor lacks the power of the reactions."""
    program, inner = wrong_velocity(sunk)
    assert inner.point.load_factor == pytest.approx(EXACT - P0 * 1e-7, abs=1e-12)
    bound = upper_bound(program, inner, TOLERANCE)
    assert bound == pytest.approx(EXACT, abs=1e-12)  # that power, at the reactions p0


def test_states_outside_the_tolerance_prove_no_bound():
    d, state = flowing()
    contact = associated_contact(d.program.contact)
    assert np.array_equal(contact.bound, frictionless_contact(d.program.contact).bound)
    fields = {
        "stress": tuple(1.001 * own for own in state.stress),  # beyond yield, out of balance
        "normal_reaction": -state.normal_reaction,
    }
    for name, wrong in fields.items():
        inner = InnerSolution(Status.SOLVED, "", 0, 0.0, replace(state, **{name: wrong}))
        assert lower_bound(d.program, inner, TOLERANCE) == -np.inf
    for factor in (1.001, -1.0):  # not normalised, penetrating
        moved = replace(state, velocity=factor * state.velocity)
        inner = InnerSolution(Status.SOLVED, "", 0, 0.0, moved)
        assert upper_bound(d.program, inner, TOLERANCE) == np.inf
    nothing = InnerSolution(Status.STALLED, "", 0, 0.0, None)
    assert lower_bound(d.program, nothing, TOLERANCE) == -np.inf
    assert upper_bound(d.program, nothing, TOLERANCE) == np.inf


def test_above_the_associated_load_nothing_is_solved(monkeypatch):
    """A loop whose residuals would let it pass is stopped by the upper bound that it has."""
    import lacore.coupling.certified as certified

    true = certified.averaged

    def lifted(run, static):
        found = true(run, static)
        return replace(found, state=replace(found.state, load_factor=found.state.load_factor + 0.1))

    monkeypatch.setattr(certified, "_OF_CONTACT", (lifted,))
    monkeypatch.setattr(certified.Run, "proven", lambda run, iterate: iterate.kind != "associated")
    state = la.solve(stone_on_a_wall(1.0))
    assert state.status is la.Status.NOT_CERTIFIED
    assert "associated law has a mechanism at a lower load factor" in state.message


def test_what_a_solve_leaves_between_both_values_widens_bounds():
    """Stresses in equilibrium prove less, and velocities more, than a solve says, by its gap."""
    program, inner = wrong_velocity(bent)
    own = inner.point.load_factor
    exact = replace(inner, point=replace(inner.point, load_factor=EXACT))
    gap = own - EXACT
    assert gap > 1e-8
    assert lower_bound(program, exact, TOLERANCE) == pytest.approx(EXACT - gap, abs=1e-12)
    assert upper_bound(program, exact, TOLERANCE) == pytest.approx(own + gap, abs=1e-12)
