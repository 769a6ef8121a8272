"""Answers of inner solves that are a little wrong, and programs in other units."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lacore as la
from lacore.program.kinematic import frictionless_contact, reaction_contact
from lacore.reporting.status import Status
from lacore.solvers.backend import InnerSolution
from lacore.solvers.inner import strong_bodies
from lacore.solvers.inner.rescaling import PartUnits, proven
from lacore.solvers.inner.strong_bodies import StrongBodySolver
from tests.lacore.planted import flowing
from tests.lacore.random_programs import POINTS, N, random_step
from tests.lacore.solvers.inner.test_strong_bodies import steel_block


def cost(program, contact, velocity):
    """What a step of a path minimises (T29): it hardens, rubs and moves dead loads."""
    plastic = 0.0
    for group in program.groups:
        rates = np.linalg.norm(group.cone_vectors(velocity), axis=1)
        plastic += group.weights @ (group.bound * rates + group.rise * rates**2 / 2)
    friction = program.friction_dissipation(velocity, contact.bound)
    return plastic + friction - program.dead_load @ velocity


@given(seed=st.integers(0, 10**6))
def test_units_of_parts_change_no_power_of_a_step(seed):
    """Of any velocity: the cost in units of parts, times their load factor, is that in others."""
    rng = np.random.default_rng(seed)
    program = replace(random_step(seed), parts=np.repeat([0, 1, 2], N // 3))
    contact = reaction_contact(program.contact, rng.uniform(0, 1, POINTS))
    units = PartUnits.of(program, 10 ** rng.uniform(-3, 3, 3), rng.uniform(-1, 1, N))
    scaled, frozen = units.program(program), units.contact(contact)
    own = rng.uniform(-1, 1, N)
    velocity = units.unknowns * own
    assert cost(program, contact, velocity) == pytest.approx(
        units.velocity * cost(scaled, frozen, own), rel=1e-9
    )
    assert program.reference_load @ velocity == pytest.approx(scaled.reference_load @ own)
    opening = program.contact.opening(velocity) + contact.shift
    other = scaled.contact.opening(own) + frozen.shift
    assert np.allclose(opening, units.velocity * units.points * other, rtol=1e-9)


@pytest.mark.parametrize(
    ("error", "status"),
    [(0.0, Status.SOLVED), (1e-8, Status.SOLVED), (1e-4, Status.ALMOST_SOLVED)],
)
def test_an_answer_is_solved_within_the_tolerance_only(error, status):
    """A load factor off by 1e-4 of the power is out of balance by as much."""
    d, state = flowing()
    contact = frictionless_contact(d.program.contact)
    point = replace(state, load_factor=state.load_factor + error)
    answer = InnerSolution(Status.SOLVED, "optimal", 1, 0.0, point)
    found = proven(d.program, answer, contact, good=1e-8)
    assert found.status is status
    assert ("recomputed" in found.message) == (status is Status.ALMOST_SOLVED)


@pytest.mark.parametrize("share", [0.99, 0.9999, 1.0])
def test_a_rigid_answer_that_is_out_of_balance_is_solved_as_a_whole(monkeypatch, share):
    """Elastic stresses that carry 99 % of the weight prove nothing; all of it is enough."""
    asked = []
    plain, bent = StrongBodySolver._plain, strong_bodies._Stiff._bent
    monkeypatch.setattr(
        StrongBodySolver, "_plain", lambda self, contact: asked.append(1) or plain(self, contact)
    )
    monkeypatch.setattr(
        strong_bodies._Stiff, "_bent", lambda self, force: share * bent(self, force)
    )
    la.solve(steel_block(2), max_iterations=2)
    assert bool(asked) == (share < 1)
