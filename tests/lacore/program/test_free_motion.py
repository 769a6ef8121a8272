"""Each limit of a motion that dissipates nothing, on a program with known forces and speeds."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csr_matrix

import lacore as la
from lacore.program.free_motion import without_dissipation
from lacore.program.kinematic import FrozenContact
from lacore.program.state import ProgramState
from tests.lacore.planted import on_free_unknowns, pushed_weight

TOLERANCE = 1e-6
BELOW, ABOVE = pytest.param(0.99, True, id="below"), pytest.param(1.01, False, id="above")


def two_parts(spring=False, dead=8.0, limit=0.0, slip=(1.0, 0.0, 0.0)):
    """The weight of 8 N on patches of 1 and 3 m^2, and a part that no load and no contact holds.

    The unknowns are both velocities of the weight and that of the other part.
    """
    weight = pushed_weight()
    (own,) = weight.groups
    spring_of_weight = replace(
        own, rows=csr_matrix([[1.0, 0.0, 0.0]]), volumetric=csr_matrix((1, 3))
    )
    return replace(
        weight,
        groups=(spring_of_weight,) if spring else (),
        contact=replace(
            weight.contact,
            normal=csr_matrix([[0.0, 1.0, 0.0]] * 2),
            tangential=csr_matrix([slip] * 2),
            limit=np.full(2, limit),
        ),
        reference_load=np.array([2.0, 0.0, 0.0]),
        dead_load=np.array([0.0, -dead, 0.0]),
        parts=np.array([0, 0, 1]),
    )


def free(program, velocity, load_factor=0.0, reaction=0.0, bound=0.0, dilatancy=0.0):
    state = replace(
        ProgramState.unstressed(program, np.array(velocity), load_factor),
        normal_reaction=np.array([0.0, reaction]),
    )
    last = np.array([0.0, 1.0])  # only at the larger patch
    contact = FrozenContact(np.where(last, bound, 0.0), dilatancy * last, np.zeros(2))
    return without_dissipation(program, state, contact, TOLERANCE)


@pytest.mark.parametrize(("share", "expected"), [BELOW, ABOVE])
@pytest.mark.parametrize("speed", [1e-3, 1.0, 1e3])
def test_strain_rates_are_compared_with_the_largest_velocity_over_a_length(speed, share, expected):
    """The length of a spring of area 2 is the square root of it."""
    program = two_parts(spring=True, dead=0.0)
    for sign in (-1, 1):
        strain = sign * share * TOLERANCE / np.sqrt(2)
        assert free(program, speed * np.array([strain, 0.0, 1.0])) == expected


@pytest.mark.parametrize(("share", "expected"), [BELOW, ABOVE])
@pytest.mark.parametrize("sign", [-1, 1])
def test_slip_of_contact_with_a_limit_is_compared_with_the_largest_velocity(sign, share, expected):
    program = two_parts(dead=0.0, limit=0.3)
    assert free(program, [sign * share * TOLERANCE, 0.0, 1.0]) == expected
    stuck = two_parts(dead=0.0, limit=np.inf)
    assert free(stuck, [sign * share * TOLERANCE, 0.0, 1.0])


@pytest.mark.parametrize(("share", "expected"), [BELOW, ABOVE])
@pytest.mark.parametrize("speed", [1e-3, 1.0, 1e3])
def test_friction_is_compared_with_the_forces_of_the_part(speed, share, expected):
    """The patch of 3 m^2 rubs at the speed of the weight, on which 8 N act."""
    program, velocity = two_parts(), speed * np.array([1.0, 0.0, 0.0])
    assert free(program, velocity, bound=share * 8 * TOLERANCE / 3) == expected
    # A pressure of 4 Pa on 3 m^2 adds 12 N to the forces, and lifts by the dilatancy.
    lifting = share * (8 + 12) * TOLERANCE / 12
    assert free(program, velocity, reaction=4.0, dilatancy=lifting) == expected
    # Tension lifts nothing.
    assert free(program, velocity, reaction=-4.0, dilatancy=1.0)


@pytest.mark.parametrize(("share", "expected"), [BELOW, ABOVE])
def test_friction_between_parts_counts_at_the_speed_of_the_faster_one(share, expected):
    program = two_parts(slip=(1.0, 0.0, -1.0))
    # A slip of 1.5, and a largest velocity of 1.
    limit = share * 8 * TOLERANCE / 3 / 1.5
    assert free(program, [0.5, 0.0, -1.0], bound=limit) == expected
    assert free(program, [-1.0, 0.0, 0.5], bound=limit) == expected


@pytest.mark.parametrize(("share", "expected"), [BELOW, ABOVE])
@pytest.mark.parametrize("sign", [-1, 1])
def test_the_power_of_dead_loads_is_compared_with_their_size_and_speed(sign, share, expected):
    assert free(two_parts(), [1.0, sign * share * TOLERANCE, 5.0]) == expected
    assert free(two_parts(dead=-8.0), [1.0, sign * share * TOLERANCE, 5.0]) == expected


@pytest.mark.parametrize(("share", "expected"), [BELOW, ABOVE])
@pytest.mark.parametrize("sign", [-1, 1])
def test_the_load_factor_is_compared_with_the_least_strength_or_load(sign, share, expected):
    for program, weakest in (
        (two_parts(), 8.0),
        (two_parts(limit=0.3), 0.3),
        (two_parts(limit=20.0), 8.0),
        (two_parts(limit=20.0, spring=True), 0.5),
        (two_parts(dead=0.0), 1.0),
        (two_parts(limit=np.inf), 8.0),
    ):
        factor = sign * share * TOLERANCE * weakest
        assert free(program, [0.0, 0.0, 1.0], load_factor=factor) == expected


@pytest.mark.parametrize(("share", "expected"), [BELOW, ABOVE])
@pytest.mark.parametrize("speed", [0.1, 1.0, 10.0])
def test_without_dead_loads_friction_is_compared_with_round_off(speed, share, expected):
    """A ten-millionth of stress, length and velocity, of which the velocity is at least 1."""
    program = two_parts(dead=0.0)
    bound = share * 1e-7 * max(1.0, speed) / 3 / speed
    assert free(program, [speed, 0.0, 0.0], bound=bound) == expected


def test_points_that_stick_rub_nowhere():
    assert free(two_parts(), [0.0, 0.0, 1.0], bound=np.inf)


@pytest.mark.parametrize("velocity", [[0.0, 0.0, 0.0], [np.nan, 0.0, 1.0], [1.0, np.nan, 1.0]])
def test_no_velocity_and_velocities_that_are_no_number_are_no_motion(velocity):
    assert not free(two_parts(), velocity)


@pytest.mark.parametrize("sign", [-1, 1])
@pytest.mark.parametrize("criterion", [la.MohrCoulomb(1.0, 30.0), la.Rankine(1.0, 2.0)])
def test_soil_that_changes_its_volume_alone_dissipates(criterion, sign):
    """The square grows or shrinks alike in both directions: it has no shear at all."""
    problem = la.Problem(
        {"block": la.Body(la.meshes.rectangle((0, 1), (0, 1), 2, 2), criterion)},
        [la.Traction("block", "right", (1.0, 0.0))],
        [la.Fix("block", "left", "x"), la.Fix("block", "bottom", "y")],
    )
    d = la.discretise(problem)
    velocity = on_free_unknowns(d, lambda x: sign * x)
    still = ProgramState.unstressed(d.program, velocity, 0.0)
    contact = FrozenContact(np.zeros(0), np.zeros(0), np.zeros(0))
    (group,) = d.program.groups
    assert np.abs(group.cone_vectors(velocity)).max() <= 1e-12
    assert not without_dissipation(d.program, still, contact, TOLERANCE)
