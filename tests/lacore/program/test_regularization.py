"""The regularised laws (T17-T20) on programs of random numbers."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import lacore as la
from lacore.program.kinematic import Scales
from lacore.program.regularization import Penalties, beside, by_shifts, evaluate, penalties
from lacore.program.surfaces import Surfaces
from tests.lacore.random_programs import (
    CONES,
    POINTS,
    N,
    frozen,
    random_program,
    random_soil,
    random_step,
)

SEED = st.integers(0, 10**6)
# Stiffness per bound from far below to far above the kinks at velocities of order one.
STIFF = st.floats(-1.5, 2.5).map(lambda e: 10**e)
LAWS = st.sampled_from(["smooth", "friction", "dilatant", "shifted", "both"])


def law(name, rng):
    if name == "smooth":
        return frozen(0.0)
    if name == "friction":
        return frozen(rng.uniform(0, 1, POINTS))
    dilatancy = rng.uniform(0.1, 1, POINTS)
    bound = 1.0 if name == "both" else 0.0  # not counted where a point dilates
    return frozen(bound, dilatancy, rng.uniform(0, 1, POINTS) if name == "shifted" else 0.0)


def penalty(rng, stiff):
    return Penalties(*(stiff * rng.uniform(0.5, 2, 4)))


@pytest.mark.parametrize("make", [random_program, random_step, random_soil])
@given(seed=SEED, stiff=STIFF, name=LAWS)
def test_gradient_is_that_of_the_energy(make, seed, stiff, name):
    rng = np.random.default_rng(seed)
    program, contact, k = make(seed), law(name, rng), penalty(rng, stiff)
    u, direction = rng.uniform(-2, 2, (2, N))
    h = 1e-5
    up, down = (
        evaluate(program, contact, k, u + sign * h * direction).objective for sign in (1, -1)
    )
    slope = evaluate(program, contact, k, u).gradient @ direction
    # The gradient is Lipschitz with constant about stiffness * rows^2 * points < 200 stiff, so a
    # kink of the second derivative inside the interval costs at most h times that; round-off of the
    # energy, which is below 500 stiff, is divided by 2 h.
    assert (up - down) / (2 * h) == pytest.approx(
        slope, abs=200 * stiff * h + 500 * (stiff + 1) * 1e-16 / h
    )


@pytest.mark.parametrize("make", [random_program, random_step, random_soil])
@given(seed=SEED, stiff=STIFF, name=LAWS)
def test_energy_is_convex(make, seed, stiff, name):
    """Both by the chord and by the monotonicity of the gradient."""
    rng = np.random.default_rng(seed)
    program, contact, k = make(seed), law(name, rng), penalty(rng, stiff)
    u, v = rng.uniform(-2, 2, (2, N))
    at = [evaluate(program, contact, k, u + s * (v - u)) for s in (0.0, 0.5, 1.0)]
    values = [point.objective for point in at]
    round_off = 1e-13 * max(1.0, *map(abs, values))
    assert values[1] <= (values[0] + values[2]) / 2 + round_off
    assert (at[2].gradient - at[0].gradient) @ (v - u) >= -round_off


@pytest.mark.parametrize("make", [random_program, random_step, random_soil])
@given(seed=SEED, stiff=STIFF, name=LAWS)
def test_gradient_is_continuous(make, seed, stiff, name):
    """C1: along any line the gradient makes steps no larger than its Lipschitz constant allows."""
    rng = np.random.default_rng(seed)
    program, contact, k = make(seed), law(name, rng), penalty(rng, stiff)
    u, v = rng.uniform(-2, 2, (2, N))
    path = [evaluate(program, contact, k, u + s * (v - u)).gradient for s in np.linspace(0, 1, 51)]
    stack = [*(g.rows for g in program.groups), *(g.volumetric for g in program.groups)]
    stack += [program.contact.normal, program.contact.tangential]
    # Secants are at most the stiffness, and 2 of bulk and eta act on theta; d <= 1 mixes the two
    # contact rows: 4 is ample. Weights are at most 1.
    lipschitz = 4 * 2 * stiff * sum(np.linalg.norm(rows.toarray(), 2) ** 2 for rows in stack)
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    assert steps.max() <= lipschitz * np.linalg.norm(v - u) / 50


@pytest.mark.parametrize("make", [random_program, random_step, random_soil])
@given(seed=SEED, stiff=STIFF, name=st.sampled_from(["smooth", "friction", "dilatant"]))
def test_the_three_values(make, seed, stiff, name):
    """P <= alpha_reg <= lambda, and lambda = U.grad (T19)."""
    rng = np.random.default_rng(seed)
    program, contact, k = make(seed), law(name, rng), penalty(rng, stiff)
    u = rng.uniform(-2, 2, N)
    point = evaluate(program, contact, k, u)
    values = point.values
    assert values.plastic <= values.alpha_reg
    by_shift = values.load_factor - values.plastic - 2 * values.energy
    assert by_shift == pytest.approx(by_shifts(program, contact, point.state), abs=1e-12 * stiff)
    assert (by_shift == pytest.approx(0, abs=1e-12 * stiff)) == (make is not random_soil)
    scale = np.abs(point.gradient) @ np.abs(u)
    assert point.gradient @ u == pytest.approx(values.load_factor, abs=1e-13 * scale)


@given(seed=SEED, stiff=STIFF, angle=st.floats(0.1, 60))
def test_one_plane_in_closed_form(seed, stiff, angle):
    """T65 by hand, in all three regimes: elastic, on the cone, at the apex."""
    rng = np.random.default_rng(seed)
    k, cohesion = penalty(rng, stiff), rng.uniform(0.1, 2)
    form = la.MohrCoulomb(cohesion, angle).conic_form("plane_strain")
    own = form.surfaces_of(np.zeros(1, dtype=int))
    length, theta = rng.uniform(0, 2), rng.uniform(-2, 2)
    found = own.closest_point(np.array([[length, theta]]), k.of_rates(1)).stress[0]
    a, b = np.sin(np.radians(angle)), cohesion * np.cos(np.radians(angle))
    excess = k.eta * length + a * k.bulk * theta - b
    flow = max(excess, 0.0) / (k.eta + a**2 * k.bulk)
    wanted = [k.eta * (length - flow), k.bulk * (theta - a * flow)]
    if wanted[0] < 0:
        wanted = [0.0, b / a]
    # Round-off is that of the elastic stresses, seen along the cone from its far apex.
    size = 1e-14 * (k.eta * length + k.bulk * abs(theta) + b / a) * np.sqrt(1 + k.bulk / k.eta)
    assert found == pytest.approx(wanted, abs=size)


@given(seed=SEED, stiff=STIFF)
def test_a_plane_without_slope_is_the_law_of_metals(seed, stiff):
    """T65 is T17 there, with rows that have no part of theta."""
    rng = np.random.default_rng(seed)
    program, k, u = random_program(seed), penalty(rng, stiff), rng.uniform(-2, 2, N)
    metal = replace(program.groups[0], volumetric_factor=0.0)
    level = Surfaces(np.zeros((CONES, 1, 1)), metal.bound[:, None], np.ones(1))
    at = [
        evaluate(replace(program, groups=(group,)), frozen(0.0), k, u)
        for group in (metal, replace(metal, surfaces=level))
    ]
    values = [vars(point.values) for point in at]
    size = 1e-13 * (values[0]["load_factor"] + abs(program.dead_load) @ abs(u))
    assert values[1] == pytest.approx(values[0], abs=size, nan_ok=True)
    assert at[1].gradient == pytest.approx(at[0].gradient, abs=1e-13 * abs(at[0].gradient).max())


def plastic_share(group, k, u):
    """||v_p|| of T17, shape (m,)."""
    theta = group.volumetric_factor * (group.volumetric @ u)
    length = np.hypot(np.linalg.norm(group.cone_vectors(u), axis=1), theta)
    return length, np.maximum(k.eta * length - group.bound, 0) / (k.eta + group.rise)


@given(seed=SEED, stiff=STIFF)
def test_hardening_is_the_infimum_over_the_plastic_share(seed, stiff):
    """T17 by brute force: no share of a fine grid costs less, and ||v_p|| itself costs as much."""
    rng = np.random.default_rng(seed)
    program, k, u = random_step(seed), penalty(rng, stiff), rng.uniform(-2, 2, N)
    (group,) = program.groups
    length, best = plastic_share(group, k, u)

    def costs(p):
        elastic = k.eta * (length - p) ** 2 / 2
        return elastic + group.bound * p + group.rise * p**2 / 2

    for share in np.linspace(0, 1, 101):
        assert np.all(costs(best) <= costs(share * length) * (1 + 1e-12))
    bare = replace(program, groups=(replace(group, bound=0 * group.bound, modulus=None),))
    zero = replace(k, eta=1e-300)  # what is left without the group: penalties, contact, dead load
    rest = evaluate(bare, frozen(0.0), zero, u).objective
    found = evaluate(program, frozen(0.0), k, u).objective - rest
    size = abs(rest) + found
    assert found == pytest.approx(float(group.weights @ costs(best)), abs=1e-13 * size)


@given(seed=SEED, stiff=STIFF)
def test_a_law_that_hardens_is_a_huber_function_beside_a_spring(seed, stiff):
    """T17, what `newton` and `ipopt` are given: stress and energy are the sum of both."""
    rng = np.random.default_rng(seed)
    program, k, u = random_step(seed), penalty(rng, stiff), rng.uniform(-2, 2, N)
    (group,) = program.groups
    two = beside(k.eta, group.bound, group.rise)
    length, plastic = plastic_share(group, k, u)
    slope = np.minimum(two.stiffness * length, two.bound) + two.spring * length
    stress = np.where(plastic > 0, group.bound + group.rise * plastic, k.eta * length)
    assert slope == pytest.approx(stress, rel=1e-13)
    assert two.stiffness + two.spring == pytest.approx(np.full(CONES, k.eta), rel=1e-14)
    assert two.bound / two.stiffness == pytest.approx(group.bound / k.eta, rel=1e-14)


@given(seed=SEED, stiff=STIFF, name=st.sampled_from(["smooth", "friction", "dilatant"]))
def test_hardening_is_a_program_with_the_bounds_that_it_has_reached(seed, stiff, name):
    """T19: frozen at c + h ||v_p||, all values, the gradient, the stresses are the same."""
    rng = np.random.default_rng(seed)
    program, contact, k = random_step(seed), law(name, rng), penalty(rng, stiff)
    u = rng.uniform(-2, 2, N)
    (group,) = program.groups
    _, plastic = plastic_share(group, k, u)
    reached = replace(group, bound=group.bound + group.rise * plastic, modulus=None)
    hardens = evaluate(program, contact, k, u)
    held = evaluate(replace(program, groups=(reached,)), contact, k, u)
    size = abs(hardens.values.load_factor) + abs(program.dead_load) @ abs(u)
    for entry in ("plastic", "alpha_reg", "load_factor"):
        mine, other = (getattr(point.values, entry) for point in (hardens, held))
        assert mine == pytest.approx(other, abs=1e-13 * size), entry
    assert hardens.gradient == pytest.approx(held.gradient, abs=1e-13 * np.abs(held.gradient).max())
    assert hardens.state.stress[0] == pytest.approx(held.state.stress[0], rel=1e-12, abs=1e-15)
    spent = float((group.weights * group.rise) @ plastic**2) / 2
    assert hardens.values.alpha_reg - hardens.objective == pytest.approx(spent, abs=1e-13 * size)
    # Within the yield that the velocity hardens to: what a certificate will see.
    (limit,) = program.hardened(u).groups
    assert np.all(np.linalg.norm(hardens.state.stress[0], axis=1) <= limit.bound * (1 + 1e-14))


def admissible(program, rng):
    """A velocity with theta = 0 and u_n = 0, and with slip and strain."""
    rows = np.vstack([program.groups[0].volumetric.toarray(), program.contact.normal.toarray()])
    null = np.linalg.svd(rows)[2][rows.shape[0] :]
    return null.T @ rng.uniform(-1, 1, null.shape[0])


@given(seed=SEED)
def test_dissipation_is_approached_from_below_at_first_order(seed):
    rng = np.random.default_rng(seed)
    program, contact = random_program(seed), law("friction", rng)
    u = admissible(program, rng)
    exact = (
        program.plastic_dissipation(u)
        + program.friction_dissipation(u, contact.bound)
        - program.dead_load @ u
    )
    errors = []
    for r in (1e-1, 1e-2, 1e-3, 1e-8):
        values = evaluate(program, contact, penalties(Scales(), r), u).values
        assert values.alpha_reg <= exact + 1e-13
        errors.append(exact - values.alpha_reg)
    # A Huber function is bound^2 / (2 stiffness) below its bound: at r = 1e-8 less than 1e-7.
    assert errors[-1] <= 1e-7
    # It is below by no more than that anywhere, weights and bounds as in `random_program`.
    worst = sum(
        float(weights @ bound**2) / 2
        for weights, bound in (
            (program.groups[0].weights, program.groups[0].bound),
            (program.contact.weights, contact.bound / np.sqrt(10)),
        )
    )
    for r, error in zip((1e-1, 1e-2, 1e-3), errors, strict=False):
        assert error <= worst * r * (1 + 1e-9) + 1e-13


@given(seed=SEED, stiff=STIFF)
def test_stress_is_within_yield_and_along_the_strain_rate(seed, stiff):
    rng = np.random.default_rng(seed)
    program, k = random_program(seed), penalty(rng, stiff)
    (group,) = program.groups
    state = evaluate(program, frozen(0.0), k, rng.uniform(-2, 2, N)).state
    (stress,), cone = state.stress, group.cone_vectors(state.velocity)
    assert np.all(np.linalg.norm(stress, axis=1) <= group.bound * (1 + 1e-14))
    cross = stress[:, 0] * cone[:, 1] - stress[:, 1] * cone[:, 0]
    assert np.allclose(cross, 0, atol=1e-13)
    assert np.all(np.sum(stress * cone, axis=1) >= 0)


@given(seed=SEED, stiff=STIFF)
def test_frozen_reaction_is_the_projected_trial(seed, stiff):
    """T18: t_n on [0, inf), t_t on the disc of the frozen bound."""
    rng = np.random.default_rng(seed)
    program, contact, k = random_program(seed), law("friction", rng), penalty(rng, stiff)
    state = evaluate(program, contact, k, rng.uniform(-2, 2, N)).state
    rows, u = program.contact, state.velocity
    slip = rows.slip(u)[:, 0]
    assert np.allclose(
        state.normal_reaction, np.maximum(-k.normal * rows.opening(u), 0), rtol=1e-14
    )
    assert np.allclose(
        state.tangential_reaction[:, 0],
        np.clip(-k.tangential * slip, -contact.bound, contact.bound),
        rtol=1e-14,
    )


@given(seed=SEED, stiff=STIFF, name=st.sampled_from(["dilatant", "shifted"]))
def test_dilatant_reaction_is_the_trial_projected_onto_the_coulomb_cone(seed, stiff, name):
    """In the metric (1/K_n, 1/K_t): (trial - t, s - t) <= 0 for every s of the cone."""
    rng = np.random.default_rng(seed)
    program, contact, k = random_program(seed), law(name, rng), penalty(rng, stiff)
    state = evaluate(program, contact, k, rng.uniform(-2, 2, N)).state
    rows, u = program.contact, state.velocity
    t_n, t_t = state.normal_reaction, state.tangential_reaction[:, 0]
    d = contact.dilatancy
    size = stiff * 20
    assert np.all(t_n >= 0)
    assert np.all(np.abs(t_t) <= d * t_n + 1e-13 * size)
    trial_n = -k.normal * (rows.opening(u) + contact.shift)
    trial_t = -k.tangential * rows.slip(u)[:, 0]
    for s_n in rng.uniform(0, size, 20):
        for s_t in rng.uniform(-1, 1, 5)[:, None] * d * s_n:
            angle = (trial_n - t_n) * (s_n - t_n) / k.normal
            angle += (trial_t - t_t) * (s_t - t_t) / k.tangential
            assert np.all(angle <= 1e-12 * size**2 / stiff)


def test_stick_is_never_at_its_bound():
    program, contact = random_program(1), frozen(np.inf)
    state = evaluate(program, contact, Penalties(1.0, 1.0, 1.0, 2.0), np.ones(N)).state
    assert np.allclose(state.tangential_reaction, -2 * program.contact.slip(np.ones(N)))


def test_at_rest():
    program = random_program(2)
    point = evaluate(program, frozen(1.0), Penalties(1.0, 10.0, 10.0, 10.0), np.zeros(N))
    assert point.values.alpha_reg == 0
    assert np.array_equal(point.gradient, -program.dead_load)


def test_von_mises_law_of_a_single_strain_rate():
    """T17 by hand: eta = 3, k = 1 and eps = diag(a, b): e = dev eps, K_c = 10 eta."""
    a, b, eta = 0.02, -0.05, 3.0
    theta = a + b
    e = np.array([a, b, 0.0]) - theta / 3
    rows = replace(
        random_program(0).groups[0],
        rows=random_program(0).groups[0].rows[:2] * 0,
        volumetric=random_program(0).groups[0].volumetric[:1] * 0,
        weights=np.ones(1),
        bound=np.ones(1),
    )
    form = la.VonMises(shear_strength=1.0).conic_form("plane_strain")
    strain = np.zeros((3, N))
    strain[0, 0] = strain[1, 1] = 1  # unknowns 0 and 1 are eps_xx and eps_yy
    group = replace(
        rows,
        rows=type(rows.rows)(form.rows @ strain),
        volumetric=type(rows.rows)(form.volumetric[None] @ strain),
        volumetric_factor=form.volumetric_factor,
    )
    program = replace(random_program(0), groups=(group,), dead_load=np.zeros(N))
    k = Penalties(eta, 10 * eta, 1.0, 1.0)

    def energy(scale):
        u = np.zeros(N)
        u[:2] = scale * np.array([a, b])
        empty = replace(
            program,
            contact=replace(
                program.contact,
                normal=program.contact.normal * 0,
                tangential=program.contact.tangential * 0,
            ),
        )
        return evaluate(empty, frozen(0.0), k, u).values.alpha_reg

    size = np.linalg.norm(e)
    k_s = np.sqrt(2)
    threshold = k_s / (2 * eta)
    assert size < threshold < 100 * size
    assert energy(1) == pytest.approx(eta * size**2 + 10 * eta * theta**2 / 2, rel=1e-14)
    assert energy(100) == pytest.approx(
        k_s * 100 * size - k_s**2 / (4 * eta) + 10 * eta * (100 * theta) ** 2 / 2, rel=1e-14
    )


def test_penalties_of_r_and_given_ones():
    """T20, and SI values given instead are the same numbers in the units of the program."""
    scales = Scales(length=2.0, stress=5.0, velocity=0.1)
    r = 1e-3
    default = penalties(scales, r)
    assert vars(default) == pytest.approx(
        {"eta": 1 / r, "bulk": 10 / r, "normal": 10 / r, "tangential": 10 / r}
    )
    given_values = penalties(
        scales,
        r,
        eta=5.0 * 2.0 / (0.1 * r),
        bulk=10 * 5.0 * 2.0 / (0.1 * r),
        normal=10 * 5.0 / (0.1 * r),
        tangential=10 * 5.0 / (0.1 * r),
    )
    assert vars(given_values) == pytest.approx(vars(default))
    assert penalties(scales, r, eta=1.0).bulk == pytest.approx(10 * 0.1 / 10)


@pytest.mark.parametrize("name", ["r", "eta", "bulk", "normal", "tangential"])
@pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf])
def test_penalties_refuse(name, value):
    arguments = {"r": 1e-3, name: value}
    with pytest.raises(la.InputError, match=f"^{name} = .*> 0"):
        penalties(Scales(), **arguments)
