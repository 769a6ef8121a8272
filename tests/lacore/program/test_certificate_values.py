"""Residuals of a certificate in closed form, and what they must not depend on."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.sparse import block_diag, csr_matrix, diags_array

import lacore as la
from lacore.program.certificate import certify
from lacore.program.kinematic import (
    FrozenContact,
    KinematicProgram,
    associated_contact,
)
from lacore.program.state import ProgramState
from tests.lacore.planted import P0, pushed_weight, sliding, wrong_state
from tests.lacore.random_programs import (
    N,
    random_program,
    random_soil,
    random_state,
    random_step,
)


def test_residuals_of_coulomb_friction_in_closed_form():
    seen = certify(pushed_weight(), wrong_state())
    # Dissipation of the spring and of friction, and the power of the weight that sinks.
    power = 2 * 0.5 * 0.6 + (1 * 0.5 + 3 * 1.0) * 0.6 + 8 * 0.1
    assert seen.equilibrium == pytest.approx((6 - 0.8 - 0.7 - 3 * 0.8) / (3 * 2 + 8))
    assert seen.yield_violation == 0.0
    # 0.2 Pa beyond the cone, compared with the loads over the contact area.
    assert seen.cone == pytest.approx((0.7 - 0.5) / (14 / 4))
    assert seen.penetration == pytest.approx(0.1 / 0.6)
    assert seen.divergence == 0.0
    assert seen.normalisation == pytest.approx(2 * 0.6 - 1)
    assert seen.flow == pytest.approx(2 * (0.5 - 0.4) * 0.6 / power)
    contact = (0.3 - 0.1 - 0.42, 3 * (0.6 - 0.2 - 0.48))
    assert seen.slip == pytest.approx(-sum(contact) / power)
    assert seen.gap == pytest.approx((3 + 0.8 - 0.6 - 2.1) / power)
    assert seen.load == pytest.approx((2.1 * 0.6 + 1.0 * 0.1 - sum(contact)) / power)


def test_residuals_of_frozen_contact_in_closed_form():
    """Bounds, dilatancies and shifts of one solve take the place of the laws."""
    contact = FrozenContact(np.array([0.2, 0.0]), np.array([0.25, 0.5]), np.array([0.05, 0.1]))
    seen = certify(pushed_weight(), wrong_state(), contact)
    lifted = (0.25 * 1 + 3 * 0.5 * 2) * 0.6
    dissipated = 0.6 + 0.2 * 0.6
    power = dissipated + lifted + 0.8
    assert seen.cone == pytest.approx((0.7 - 0.2 - 0.25) / (14 / 4))
    assert seen.penetration == pytest.approx(0.5 * 0.6 / 0.6)
    assert seen.slip == pytest.approx((0.42 + 0.05 - 0.12 + 3 * 0.48) / power)
    by_shift = 1 * 1 * 0.05 + 3 * 2 * 0.1
    assert seen.gap == pytest.approx((3 + 0.8 - dissipated - by_shift) / power)


def test_a_load_factor_below_the_power_of_the_velocity_is_off_by_gap_and_penetration():
    """The stress of the spring balances the forces along x, far beyond its strength."""
    seen = certify(pushed_weight(), wrong_state(load_factor=-3.0, stress=-4.55))
    power = 3.5
    gap = 0.6 + 2.1 - 0.8 + 3
    penetrating = 0.1 * (np.hypot(1, 0.7) + 3 * np.hypot(2, 0.8))
    assert seen.yield_violation == pytest.approx(4.55 / 0.5 - 1)
    assert seen.gap == pytest.approx(gap / power)
    assert seen.load == pytest.approx((gap + penetrating) / power)


def test_a_state_at_rest_without_loads_leaves_no_residual_but_the_power_of_the_load():
    d, _ = sliding()
    program = replace(d.program, reference_load=0 * d.program.reference_load)
    program = replace(program, dead_load=0 * program.dead_load)
    seen = certify(program, ProgramState.unstressed(program, np.zeros(program.n), 0.0))
    assert seen.worst == ("normalisation", 1.0)
    assert sum(vars(seen).values()) == 1.0


def test_tension_at_one_point_without_friction_is_outside_the_cone():
    d, state = sliding()
    normal, tangential = state.normal_reaction.copy(), state.tangential_reaction.copy()
    normal[1], tangential[1] = -0.01 * P0, 0.0
    wrong = replace(state, normal_reaction=normal, tangential_reaction=tangential)
    largest = np.hypot(normal, tangential[:, 0]).max()
    seen = certify(d.program, wrong)
    # The loads over the contact length are more than any reaction.
    forces = abs(state.load_factor) * np.abs(d.program.reference_load).sum()
    forces += np.abs(d.program.dead_load).sum()
    reaction = max(largest, forces / d.program.contact.weights.sum())
    assert seen.cone == pytest.approx(0.01 * P0 / reaction)


@given(seed=st.integers(0, 10**6), kind=st.sampled_from([random_program, random_step, random_soil]))
def test_no_residual_depends_on_the_direction_of_axes(seed, kind):
    """The sign of an unknown, of its loads and of the rows that it moves is a convention."""
    rng = np.random.default_rng(seed)
    program = replace(kind(seed), parts=np.repeat([0, 1, 2], N // 3))
    state = random_state(program, rng)
    signs = rng.choice([-1.0, 1.0], N)
    turn = diags_array(signs)
    turned = replace(
        program,
        groups=tuple(
            replace(g, rows=csr_matrix(g.rows @ turn), volumetric=csr_matrix(g.volumetric @ turn))
            for g in program.groups
        ),
        contact=replace(
            program.contact,
            normal=csr_matrix(program.contact.normal @ turn),
            tangential=csr_matrix(program.contact.tangential @ turn),
        ),
        reference_load=signs * program.reference_load,
        dead_load=signs * program.dead_load,
    )
    other = replace(state, velocity=signs * state.velocity)
    contact = associated_contact(program.contact)
    for law in (None, contact):
        one, two = certify(program, state, law), certify(turned, other, law)
        for name, size in vars(one).items():
            assert getattr(two, name) == pytest.approx(size, rel=1e-12), name


@pytest.mark.parametrize("sign", [1, -1])
def test_all_parts_of_a_rigid_motion_count_as_fast_whatever_their_direction(sign):
    """The largest velocity is the scale of penetration, also where it is negative."""
    program = pushed_weight()
    turned = replace(
        program,
        reference_load=sign * program.reference_load,
        contact=replace(program.contact, tangential=sign * program.contact.tangential),
    )
    state = wrong_state()
    velocity = np.array([sign * 0.6, -0.1])
    assert certify(turned, replace(state, velocity=velocity)).penetration == pytest.approx(1 / 6)


def test_a_state_of_another_program_is_rejected():
    d, state = sliding()
    for name in ("velocity", "normal_reaction", "tangential_reaction"):
        other = replace(state, **{name: getattr(state, name)[1:]})
        with pytest.raises(la.InputError, match=f"{name} of shape"):
            certify(d.program, other)
    for name in ("stress", "mean_stress"):
        with pytest.raises(la.InputError, match=f"{name} of 'block' of shape"):
            certify(d.program, replace(state, **{name: (getattr(state, name)[0][1:],)}))
        with pytest.raises(la.InputError, match="stresses for 0 of 1 groups"):
            certify(d.program, replace(state, **{name: ()}))


@pytest.mark.parametrize(("up", "penetration"), [(-0.1, 0.2), (0.1, 0.0)])
def test_points_that_stick_may_open_and_not_penetrate(up, penetration):
    """Where the velocity along the patches is zero, next to one of 0.5 that nothing touches."""
    program = pushed_weight()
    rows = replace(program.contact, tangential=0 * program.contact.tangential)
    stuck = replace(program, contact=replace(rows, limit=np.full(2, np.inf)))
    state = replace(wrong_state(), velocity=np.array([0.5, up]))
    assert certify(stuck, state).penetration == pytest.approx(penetration)


@pytest.mark.parametrize(
    ("normal", "along", "share"), [(-0.02, 0.0, 0.002 / 0.012), (0.02, 0.03, 0.002 / 0.015)]
)
def test_forces_outside_the_cone_of_a_light_part_count_by_its_own_forces(normal, along, share):
    """A chip of 0.01 N on 0.1 m^2: tension, or 0.02 Pa of shear beyond what 0.02 Pa carry."""
    weight, state = pushed_weight(), wrong_state()
    rows = weight.contact
    chip = csr_matrix([[1.0, 0.0]]), csr_matrix([[0.0, 1.0]])
    (spring,) = weight.groups
    program = KinematicProgram(
        (
            replace(
                spring,
                rows=csr_matrix([[1.0, 0.0, 0.0, 0.0]]),
                volumetric=csr_matrix((1, 4)),
            ),
        ),
        replace(
            rows,
            normal=csr_matrix(block_diag([rows.normal, chip[1]])),
            tangential=csr_matrix(block_diag([rows.tangential, chip[0]])),
            weights=np.append(rows.weights, 0.1),
            coefficient=np.full(3, 0.5),
            limit=np.zeros(3),
            dilatancy=np.zeros(3),
            interface=np.zeros(3, dtype=int),
        ),
        np.append(weight.reference_load, [0.0, 0.0]),
        np.append(weight.dead_load, [0.0, -0.01]),
        parts=np.array([0, 0, 1, 1]),
    )
    both = replace(
        state,
        velocity=np.append(state.velocity, [0.0, 0.0]),
        normal_reaction=np.append([4.0, 4.0], normal),
        tangential_reaction=np.array([[-0.1], [-0.1], [along]]),
    )
    assert certify(program, both).cone == pytest.approx(share)
