"""The certificate: exact states pass, planted errors do not (T12c)."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

import lacore as la
from lacore.program.certificate import certify
from lacore.program.kinematic import Scales, associated_contact, dimensionless
from lacore.program.power import kinematic_load_factor
from lacore_verification.cases.strip_footing_gamma import CASE as SAND
from tests.lacore.models import deformable_block
from tests.lacore.planted import (
    MU,
    P0,
    flowing,
    flowing_field,
    on_free_unknowns,
    sliding,
    sliding_field,
)
from tests.lacore.random_programs import (
    POINTS,
    N,
    random_program,
    random_soil,
    random_state,
    random_step,
)

EXACT = 1e-12  # round-off of sums of a hundred terms of order one
BAR = 1e-6  # of `solve`

SLIDING, FLOWING = sliding(), flowing()


@pytest.mark.parametrize("planted", [SLIDING, FLOWING], ids=["sliding", "flowing"])
def test_an_exact_state_passes(planted):
    d, state = planted
    certificate = certify(d.program, state)
    assert certificate.holds(EXACT), certificate
    assert certificate.worst[1] <= EXACT
    assert kinematic_load_factor(d.program, state, None) == pytest.approx(
        state.load_factor, rel=EXACT
    )


@given(
    length=st.floats(-6, 6), stress=st.floats(-3, 9), velocity=st.floats(-6, 6), flow=st.booleans()
)
def test_residuals_do_not_depend_on_units(length, stress, velocity, flow):
    d, state = FLOWING if flow else SLIDING
    scales = Scales(10**length, 10**stress, 10**velocity)
    scaled = replace(
        state,
        velocity=state.velocity / scales.velocity,
        load_factor=(state.load_factor + 1e-4) / scales.load_factor,
        stress=tuple(s / scales.stress for s in state.stress),
        mean_stress=tuple(s / scales.stress for s in state.mean_stress),
        normal_reaction=state.normal_reaction / scales.stress,
        tangential_reaction=state.tangential_reaction / scales.stress,
    )
    wrong = replace(state, load_factor=state.load_factor + 1e-4)
    one, other = certify(d.program, wrong), certify(dimensionless(d.program, scales), scaled)
    # Both see the same error; strain rates are compared with velocity over a length in both.
    assert other.equilibrium == pytest.approx(one.equilibrium, rel=1e-9)
    assert other.gap == pytest.approx(one.gap, rel=1e-9)
    assert other.divergence <= EXACT


def rotated(x):
    """Slides, and turns about the middle of the base: one half of it penetrates by 1e-3."""
    return sliding_field(x) + 2e-3 * np.stack([-(x[1] - 1), x[0] - 0.5])


def bent(x):
    """Incompressible, admissible and normalised, but not normal to the yield surface."""
    y = x[1]
    return np.stack([x[0] * (1 + 0.1 * (y - 0.5)), -y - 0.05 * (y**2 - y)])


def lifted(x):
    return sliding_field(x) + np.array([[0.0], [1e-3]])


def swollen(x):
    return sliding_field(x) + 1e-3 * np.stack([0 * x[0], x[1]])


def sunk(x):
    return flowing_field(x) - np.array([[0.0], [1e-4]])


def given_state(**changes):
    """An error of the answer: fields and what becomes of them."""

    def error(d, state):
        return d.program, replace(
            state, **{name: change(getattr(state, name)) for name, change in changes.items()}
        )

    return error


def given_velocity(field):
    return lambda d, state: (d.program, replace(state, velocity=on_free_unknowns(d, field)))


def given_dead_load(factor):
    return lambda d, s: (replace(d.program, dead_load=factor * d.program.dead_load), s)


def given_contact(**changes):
    """The laws are others than those that the answer obeys."""

    def error(d, state):
        rows = d.program.contact
        new = {name: change(getattr(rows, name)) for name, change in changes.items()}
        return replace(d.program, contact=replace(rows, **new)), state

    return error


def given_strength(factor):
    def error(d, state):
        (group,) = d.program.groups
        return replace(d.program, groups=(replace(group, bound=factor * group.bound),)), state

    return error


def times(factor):
    return lambda value: factor * value


def in_one_cone(factor):
    def change(stress):
        spoilt = stress[0].copy()
        spoilt[7] *= factor
        return (spoilt,)

    return change


def without_the_first(reaction):
    return np.where(np.arange(reaction.size) == 0, 0.0, reaction)


SLIDING_ERRORS = {
    "friction along the slip": given_state(tangential_reaction=times(-1)),
    "reversed slip": given_state(velocity=times(-1)),
    "tension": given_state(normal_reaction=times(-1)),
    "load factor off by 1e-4": given_state(load_factor=lambda value: value + 1e-4),
    "no dead load": given_dead_load(0),
    "dead load off by 1e-4": given_dead_load(1.0001),
    "cone violated by 1e-3": given_contact(coefficient=times(0.999)),
    "too little friction for the slip": given_contact(coefficient=times(1.001)),
    "slip where the law sticks": given_contact(coefficient=times(0), limit=lambda v: v + np.inf),
    "slip of a dilatant law without opening": given_contact(
        coefficient=times(0), dilatancy=lambda v: v + MU
    ),
    "penetration": given_velocity(rotated),
    "open and pressed": given_velocity(lifted),
    "swells": given_velocity(swollen),
    "not normalised": given_state(velocity=times(1.0001)),
    "stress off by 1e-3": given_state(stress=lambda value: (1.001 * value[0],)),
    "mean stress off by 1e-3": given_state(mean_stress=lambda value: (1.001 * value[0],)),
    "one reaction missing": given_state(normal_reaction=without_the_first),
}
FLOWING_ERRORS = {
    "beyond yield by 1e-3": given_strength(0.999),
    "flow below yield": given_strength(1.001),
    "flow against the stress": given_state(stress=lambda value: (-value[0],)),
    "flow not normal": given_velocity(bent),
    "load factor off by 1e-4": given_state(load_factor=lambda value: value - 1e-4),
    "sinks into the floor": given_velocity(sunk),
    "one cone beyond yield": given_state(stress=in_one_cone(1.01)),
    "one cone without a number": given_state(stress=in_one_cone(np.nan)),
}


@pytest.mark.parametrize(
    ("planted", "error"),
    [
        *(pytest.param(SLIDING, e, id=f"sliding: {name}") for name, e in SLIDING_ERRORS.items()),
        *(pytest.param(FLOWING, e, id=f"flowing: {name}") for name, e in FLOWING_ERRORS.items()),
    ],
)
def test_a_planted_error_is_refused(planted, error):
    certificate = certify(*error(*planted))
    assert not certificate.holds(BAR), certificate
    name, size = certificate.worst
    assert np.isnan(size) or size > BAR
    assert (
        getattr(certificate, name) is size or np.isnan(size) or getattr(certificate, name) == size
    )


@pytest.mark.parametrize(
    "name",
    ["velocity", "load_factor", "stress", "mean_stress", "normal_reaction", "tangential_reaction"],
)
def test_one_nan_is_refused(name):
    d, state = SLIDING
    value = getattr(state, name)
    if name == "load_factor":
        spoilt = float("nan")
    else:
        array = (value[0] if isinstance(value, tuple) else value).copy()
        array.flat[array.size // 2] = np.nan
        spoilt = (array,) if isinstance(value, tuple) else array
    assert not certify(d.program, replace(state, **{name: spoilt})).holds(1e300)


def test_what_has_no_strength_carries_no_stress():
    d, state = SLIDING
    (group,) = d.program.groups
    program = replace(d.program, groups=(replace(group, bound=0 * group.bound),))
    assert certify(program, state).yield_violation == np.inf
    slack = replace(state, stress=tuple(0 * stress for stress in state.stress))
    assert certify(program, slack).yield_violation == 0.0


def test_the_right_residual_speaks():
    """Errors that touch one law only are reported under its name, the others stay silent."""

    def loud(planted, error):
        certificate = certify(*error(*planted))
        return {name for name, value in vars(certificate).items() if not value <= EXACT}

    load_off = loud(SLIDING, SLIDING_ERRORS["load factor off by 1e-4"])
    assert load_off == {"equilibrium", "gap", "load"}
    assert loud(SLIDING, SLIDING_ERRORS["too little friction for the slip"]) == {
        "slip",
        "gap",
        "load",
    }
    assert loud(SLIDING, SLIDING_ERRORS["mean stress off by 1e-3"]) == {"equilibrium", "load"}
    beyond = {"yield_violation", "load"}
    assert loud(FLOWING, FLOWING_ERRORS["beyond yield by 1e-3"]) >= beyond
    assert loud(FLOWING, FLOWING_ERRORS["flow not normal"]) == {"flow", "gap", "load"}


def test_what_penetrates_may_carry_as_much_as_reactions_do_there():
    """T15: of two errors of one velocity the load feels both, pair gap and penetration."""
    program, state = SLIDING_ERRORS["penetration"](*SLIDING)
    rows, seen = program.contact, certify(program, state)
    reaction = np.hypot(state.normal_reaction, np.linalg.norm(state.tangential_reaction, axis=1))
    inward = np.maximum(-rows.opening(state.velocity), 0.0)
    power = state.load_factor  # at unit power of the load all of it goes into friction, but the gap
    assert (inward > 0).any()
    works = float(rows.weights @ (reaction * inward))
    assert seen.load - seen.gap == pytest.approx(works / power, rel=2 * seen.gap)


def test_a_millionth_of_the_forces_is_no_millionth_of_the_load_where_soil_outruns_it():
    """Forces on the fastest soil that cancel each other's power: only their size tells."""
    variant = next(v for v in SAND.variants if v.name == "smooth-30")
    state = la.solve(SAND.problem(variant, "coarse"), throw=True)
    d = state.discretisation
    velocity = np.linalg.lstsq(d.free_basis.toarray(), state.point.velocity)[0]
    point, program = replace(state.point, velocity=velocity), d.program
    assert certify(program, point).holds(BAR)
    forces = abs(point.load_factor) * np.abs(program.reference_load).sum()
    forces += np.abs(program.dead_load).sum()
    one, other = np.argsort(-np.abs(velocity))[:2]
    left = np.zeros(program.n)
    left[one] = 5e-7 * forces
    left[other] = -left[one] * velocity[one] / velocity[other]
    seen = certify(replace(program, dead_load=program.dead_load + left), point)
    others = {name: value for name, value in vars(seen).items() if name != "load"}
    assert all(value <= BAR for value in others.values()), seen
    # Twice 5e-7 of the forces at forty times the speed of the load.
    assert seen.load > 10 * BAR


def test_an_associated_state_is_no_coulomb_state():
    """C14 with mu = 0.5: the dilatant mechanism lifts the block that it slides."""
    d = la.discretise(deformable_block(0.5))
    state = la.solve(d, coupling="associated")
    assert state.status is la.Status.SOLVED
    assert not la.program.certificate.certify(d.full, state.point).holds(BAR)
    point = replace(
        state.point, velocity=np.linalg.lstsq(d.free_basis.toarray(), state.point.velocity)[0]
    )
    program = d.program
    assert certify(program, point, associated_contact(program.contact)).holds(BAR)
    coulomb = certify(program, point)
    assert coulomb.slip > 1e-2
    assert not coulomb.holds(BAR)


def test_a_frozen_contact_is_judged_by_its_own_law():
    """The sliding state is that of a Tresca interface with limit mu p0 as well."""
    d, state = SLIDING
    rows = d.program.contact
    tresca = replace(rows, coefficient=0 * rows.coefficient, limit=np.full(rows.count, MU * 0.8))
    assert certify(replace(d.program, contact=tresca), state).holds(EXACT)


def test_all_of_the_slip_of_points_that_stick_is_a_residual():
    """Slip at the speed of the fastest point is all of it, though nothing penetrates."""
    program, state = SLIDING_ERRORS["slip where the law sticks"](*SLIDING)
    assert certify(program, state).penetration == pytest.approx(1.0)


def test_a_load_the_other_way_round_is_judged_alike():
    """Forces and the sign of the load factor: what is out of balance is as much of the load."""
    program, state = SLIDING_ERRORS["cone violated by 1e-3"](*SLIDING)
    state = replace(state, stress=tuple(1.001 * own for own in state.stress))
    other = replace(program, reference_load=-program.reference_load)
    one, turned = certify(program, state), certify(other, replace(state, load_factor=-MU * P0))
    assert one.equilibrium > 1e-6
    for name in ("equilibrium", "yield_violation", "cone"):
        assert getattr(turned, name) == pytest.approx(getattr(one, name), rel=1e-12)


def test_what_swells_is_as_large_as_the_strain_rate_lets_it_count():
    """theta = 1e-3 where all moves at 1 and strains by no more: per velocity over body length."""
    program, state = SLIDING_ERRORS["swells"](*SLIDING)
    assert certify(program, state).divergence == pytest.approx(1e-3, rel=1e-2)
    program, state = FLOWING_ERRORS["beyond yield by 1e-3"](*FLOWING)
    faster = replace(state, velocity=on_free_unknowns(FLOWING[0], wider))
    # theta = 0.5 beside a rate eps_xx - eps_yy of 2.5.
    assert certify(program, faster).divergence == pytest.approx(0.5 / 2.5, rel=1e-9)


def wider(x):
    return np.stack([1.5 * x[0], -x[1]])


def in_units(state, scales):
    return replace(
        state,
        velocity=state.velocity / scales.velocity,
        load_factor=state.load_factor / scales.load_factor,
        stress=tuple(own / scales.stress for own in state.stress),
        mean_stress=tuple(own / scales.stress for own in state.mean_stress),
        normal_reaction=state.normal_reaction / scales.stress,
        tangential_reaction=state.tangential_reaction / scales.stress,
    )


@given(
    seed=st.integers(0, 10**6),
    kind=st.sampled_from([random_program, random_step, random_soil]),
    length=st.floats(-6, 6),
    stress=st.floats(-3, 9),
    velocity=st.floats(-6, 6),
    sticks=st.booleans(),
)
@settings(max_examples=20, phases=[Phase.generate])  # a smaller seed is no simpler
def test_no_residual_depends_on_units(seed, kind, length, stress, velocity, sticks):
    """Of a state that is wrong in everything, so that none of them vanishes."""
    rng = np.random.default_rng(seed)
    program = replace(kind(seed), parts=np.repeat([0, 1, 2], N // 3))
    if sticks:
        limit = np.where(np.arange(POINTS) == 0, np.inf, program.contact.limit)
        program = replace(program, contact=replace(program.contact, limit=limit))
    state = random_state(program, rng)
    scales = Scales(10**length, 10**stress, 10**velocity)
    other, scaled = dimensionless(program, scales), in_units(state, scales)
    contact = associated_contact(program.contact)
    frozen = associated_contact(other.contact)
    for one, two in (
        (certify(program, state), certify(other, scaled)),
        (certify(program, state, contact), certify(other, scaled, frozen)),
    ):
        for name, size in vars(one).items():
            # F0.U is a number, and its error may be anything.
            assert getattr(two, name) == pytest.approx(size, rel=1e-8), name


def test_slip_of_points_that_stick_dissipates_nothing():
    """They have no bound to slip at: the gap is all of the load factor, mu p0."""
    program, state = SLIDING_ERRORS["slip where the law sticks"](*SLIDING)
    assert certify(program, state).gap == pytest.approx(MU * P0)


def test_what_swells_may_take_as_much_as_mean_stresses_do_there():
    """T15: the load feels the pair gap and the power of mean stresses on the growth of 1e-3."""
    program, state = SLIDING_ERRORS["swells"](*SLIDING)
    seen = certify(program, state)
    # Friction, strain and the dead load that is lifted: what powers are relative to.
    power = MU * P0 + 1e-3 + P0 * 1e-3
    assert seen.gap * power == pytest.approx(1e-3 + P0 * 1e-3)
    assert (seen.load - seen.gap) * power == pytest.approx(P0 / 2 * 1e-3)


def test_opening_at_one_point_makes_up_for_no_penetration_at_another():
    """The square turns by 2e-3 about the middle of its base, where a pressure of p0 does no power.

    The power of the reactions at each point counts: |x - 1/2| is 1/4 on the average.
    """
    program, state = SLIDING_ERRORS["penetration"](*SLIDING)
    power = MU * P0 * (1 + 2e-3)  # of friction; the slip at the base is faster by the turn
    assert certify(program, state).slip == pytest.approx(P0 * 2e-3 / 4 / power)


def test_forces_out_of_balance_count_by_the_speed_that_they_act_on():
    """A dead load along a velocity against its axis: its power is what the load factor lacks."""
    d, state = FLOWING
    last = int(np.argmin(state.velocity))
    assert state.velocity[last] < -0.5
    more = np.zeros(d.program.n)
    more[last] = -1e-4
    program = replace(d.program, dead_load=d.program.dead_load + more)
    missing = 1e-4 * -float(state.velocity[last])
    power = 2 + P0 + missing  # of plastic flow at the yield stress 2 k, and of the dead load
    assert certify(program, state).load == pytest.approx(missing / power)


@pytest.mark.parametrize("share", [0.999, 1.001])
def test_stresses_off_the_yield_surface_make_flow_that_is_not_normal(share):
    """By what they and the dissipation differ, whichever is larger, of all power."""
    d, state = FLOWING
    wrong = replace(state, stress=tuple(share * own for own in state.stress))
    assert certify(d.program, wrong).flow == pytest.approx(1e-3 * 2 / (2 + P0))


def test_contact_may_close_a_distance_within_a_step():
    """The square sinks as fast as its distance from the base closes: an exact state."""
    d, state = SLIDING
    speed = 0.1
    rows = replace(d.program.contact, closing=np.full(d.program.contact.count, speed))
    program = replace(d.program, contact=rows)

    def sinking(x):
        return sliding_field(x) - np.array([[0.0], [speed]])

    sunk = replace(state, velocity=on_free_unknowns(d, sinking))
    assert certify(program, sunk).holds(EXACT)
    # Without the distance it penetrates, and does not touch without sinking.
    assert certify(d.program, sunk).penetration == pytest.approx(speed)
    assert certify(program, state).slip > speed * P0 / 2
