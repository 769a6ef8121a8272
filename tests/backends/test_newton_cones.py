"""The laws as cones, as `newton` solves them, against those of `lacore.program.regularization`."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from lacore.program.regularization import penalties
from lacore.reporting.status import Status
from lacore_backends.newton import NewtonOptions, NewtonSolver, PressedSolver
from tests.backends.one_law import check_law
from tests.lacore.random_programs import frozen, random_program, random_soil, random_step

R = 0.1
CONTACTS = [
    frozen(0.6),
    frozen(0.0, shift=0.1),
    frozen([np.inf, 0.5, 0.0], dilatancy=[0.0, 0.0, 0.4], shift=[0.0, 0.2, -0.1]),
]
# The tolerance on forces, 1e-8, leaves a gap of 1e-10 of the power.
GAP = 1e-10


@pytest.mark.parametrize("make", [random_program, random_step, random_soil])
@given(st.integers(0, 10_000), st.sampled_from(CONTACTS))
def test_one_law_in_two_forms(make, seed, contact):
    """Energies, stresses and reactions of the answer are those of the law at its velocity."""
    program = make(seed)
    answer = PressedSolver(program, NewtonOptions(r=R)).solve(contact)
    check_law(program, contact, penalties(program.scales, R), answer, GAP)


@pytest.mark.parametrize("seed", range(5))
def test_the_path_through_cones_ends_where_newton_without_them_does(seed):
    """Of what does not depend on pressure both know the answer."""
    program, contact = random_step(seed), frozen(0.6)
    one, other = (
        kind(program, NewtonOptions(r=R)).solve(contact) for kind in (PressedSolver, NewtonSolver)
    )
    assert one.status is other.status
    if other.status is Status.SOLVED:
        power = 1 + abs(other.regularised.load_factor)
        for entry in ("plastic", "alpha_reg", "load_factor"):
            wanted = getattr(other.regularised, entry)
            off = 2 * np.sqrt(other.regularised.energy * GAP * power) + 1e-8 * power
            assert getattr(one.regularised, entry) == pytest.approx(wanted, abs=off), entry
