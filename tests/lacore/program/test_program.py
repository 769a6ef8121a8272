"""The kinematic program: units, reduction, what the loop freezes."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse import csr_matrix

import lacore as la
from lacore.program.kinematic import (
    Scales,
    associated_contact,
    dimensionless,
    reaction_contact,
    require_homogeneous,
)
from lacore.program.reduction import reduced
from tests.lacore.models import deformable_block
from tests.lacore.random_programs import POINTS, N, frozen, random_program, random_step

EXPONENT = st.floats(-9, 9)


@given(seed=st.integers(0, 10**6), length=EXPONENT, stress=EXPONENT, velocity=EXPONENT)
def test_every_power_has_one_unit(seed, length, stress, velocity):
    """Dissipation, friction and dead power scale with stress length velocity; F0.U is a number."""
    si = random_program(seed)
    scales = Scales(10**length, 10**stress, 10**velocity)
    other = dimensionless(si, scales)
    rng = np.random.default_rng(seed + 1)
    u, g = rng.uniform(-1, 1, N), rng.uniform(0, 1, POINTS)
    v = u / scales.velocity
    power = scales.load_factor
    rel = {"rel": 1e-12}
    assert other.scales == scales
    assert other.plastic_dissipation(v) * power == pytest.approx(si.plastic_dissipation(u), **rel)
    assert other.friction_dissipation(v, g / scales.stress) * power == pytest.approx(
        si.friction_dissipation(u, g), **rel
    )
    assert other.dead_load @ v * power == pytest.approx(si.dead_load @ u, rel=1e-10)
    assert other.reference_load @ v == pytest.approx(si.reference_load @ u, rel=1e-10)
    assert np.allclose(other.contact.opening(v) * scales.velocity, si.contact.opening(u), rtol=1e-9)
    t_n = rng.uniform(-1, 1, POINTS)
    assert np.allclose(
        reaction_contact(other.contact, t_n / scales.stress).bound * scales.stress,
        reaction_contact(si.contact, t_n).bound,
        rtol=1e-12,
    )


@given(length=st.floats(-2, 2), stress=st.floats(-2, 2), velocity=st.floats(-2, 2))
def test_the_solution_does_not_depend_on_units(length, stress, velocity):
    """Within the accuracy of the solve, 1e-6 of the power; units within a hundred of the natural.

    (Far from them solvers lose digits: that is why there are natural scales.)
    """
    d = la.discretise(deformable_block(0.3))
    natural = d.natural
    units = replace(
        natural,
        length=natural.length * 10**length,
        stress=natural.stress * 10**stress,
        velocity=natural.velocity * 10**velocity,
    )
    state = la.solve(replace(d, natural=units), coupling="associated")
    assert state.load_factor == pytest.approx(1.2, rel=1e-5)


@given(seed=st.integers(0, 10**6), free=st.integers(1, N))
def test_reduced_is_the_program_on_a_subspace(seed, free):
    full = random_program(seed)
    rng = np.random.default_rng(seed + 2)
    basis = csr_matrix(rng.uniform(-1, 1, (N, free)) * (rng.uniform(size=(N, free)) < 0.5))
    small = reduced(full, basis)
    q, g = rng.uniform(-1, 1, free), rng.uniform(0, 1, POINTS)
    u = basis @ q
    assert small.n == free
    for one, other in (
        (small.plastic_dissipation(q), full.plastic_dissipation(u)),
        (small.friction_dissipation(q, g), full.friction_dissipation(u, g)),
        (small.reference_load @ q, full.reference_load @ u),
        (small.dead_load @ q, full.dead_load @ u),
        (small.contact.opening(q), full.contact.opening(u)),
        (small.contact.slip(q), full.contact.slip(u)),
        (small.groups[0].volumetric @ q, full.groups[0].volumetric @ u),
    ):
        assert np.allclose(one, other, atol=1e-12)
    assert np.array_equal(small.groups[0].weights, full.groups[0].weights)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("bound", np.nan),
        ("bound", -1.0),
        ("dilatancy", np.nan),
        ("dilatancy", np.inf),
        ("dilatancy", -0.1),
        ("shift", np.nan),
        ("shift", np.inf),
    ],
)
def test_a_frozen_contact_holds_only_what_a_solver_may_see(field, value):
    with pytest.raises(la.InputError, match=f"contact {field} = {value}"):
        frozen(**{"bound": [0.5, 1.0, 2.0], field: [0.0, value, 0.0]})


def test_friction_bounds_follow_compression_only():
    contact = random_program(0).contact
    t_n = np.array([-1.0, 0.0, 2.0])
    bound = reaction_contact(contact, t_n).bound
    assert np.allclose(bound - contact.limit, contact.coefficient * [0, 0, 2], atol=1e-15)


def test_associated_turns_friction_into_dilatancy():
    contact = random_program(0).contact
    made = associated_contact(contact)
    assert np.array_equal(made.dilatancy, contact.coefficient)
    assert np.array_equal(made.bound, contact.limit)
    assert not made.shift.any()


def test_stick_dissipates_nothing():
    program = random_program(0)
    u = np.ones(N)
    bound = np.array([np.inf, 0.0, 1.0])
    slip = np.abs(program.contact.slip(u)[2, 0])
    assert program.friction_dissipation(u, bound) == pytest.approx(
        program.contact.weights[2] * slip
    )


@pytest.mark.parametrize("hardens", [True, False])
@pytest.mark.parametrize("closes", [True, False])
def test_a_step_of_a_path_prescribes_how_fast_it_moves(hardens, closes):
    """Hardening, and a distance that closes, each set a speed; bounds refuse either."""
    step = random_step(0)
    if not hardens:
        step = replace(step, groups=tuple(replace(own, modulus=None) for own in step.groups))
    if not closes:
        step = replace(step, contact=replace(step.contact, closing=None))
    assert step.homogeneous == (not hardens and not closes)
    if hardens or closes:
        with pytest.raises(la.InputError, match="at a given speed"):
            require_homogeneous(step, "problem", "give another")
