"""Steps that make states of a solver admissible, on states that are known in closed form."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import dblquad
from scipy.sparse import csr_matrix

import lacore as la
from lacore.bounds.possible import possible_velocity
from lacore.bounds.precision import exactness, smallest_angle
from lacore.bounds.static_corners import _free, _resisted
from lacore.bounds.stresses.admissible import lacking, margins, scaled, weaker, within_friction
from lacore.bounds.stresses.within_strength import beyond, within_strength
from lacore.bounds.upper import plastic_power
from lacore.bounds.velocity_projection import admissible_velocity
from lacore.program.certificate import certify
from lacore.program.kinematic import associated_contact
from lacore.program.projection import alike, by_area, onto_equilibrium
from lacore.program.state import out_of_balance
from lacore.solvers.inner.preparing import preparer_named
from tests.lacore.models import CRITERION, square
from tests.lacore.planted import MU, P0, flowing, flowing_field, on_free_unknowns, sliding

EPS = float(np.finfo(float).eps)
D, STATE = flowing()
PROGRAM = D.program
SLIDING, RUBBING = sliding()
LIMITED = replace(
    SLIDING.program,
    contact=replace(
        SLIDING.program.contact,
        coefficient=0 * SLIDING.program.contact.coefficient,
        limit=np.full(SLIDING.program.contact.count, 2 * MU * P0),
    ),
)


def at(state, share):
    """A state times a share."""
    return state.scaled(share, load_factor=share)


@pytest.mark.parametrize("share", [0.1, 0.5, 3.0])
def test_a_state_is_scaled_to_its_strength(share):
    """Yield stresses of 1 are reached, and exceeded by no digit; so are limits of friction."""
    found = scaled(PROGRAM, at(STATE, share))
    assert beyond(PROGRAM, found) <= 0
    assert beyond(PROGRAM, found) == pytest.approx(0.0, abs=8 * EPS)
    assert found.load_factor == pytest.approx(STATE.load_factor, rel=1e-14)
    assert found.normal_reaction == pytest.approx(STATE.normal_reaction, rel=1e-14)
    # Sliding at half of its limit 2 mu p0, with stresses far below those of yield.
    found = scaled(LIMITED, at(RUBBING, share))
    size = np.linalg.norm(found.tangential_reaction, axis=1)
    assert size.max() <= 2 * MU * P0
    assert found.load_factor == pytest.approx(2 * RUBBING.load_factor, rel=1e-14)


def test_a_soil_under_any_pressure_is_scaled_to_its_strength():
    """Terms of a million strengths cancel to a strength; no digit of it is exceeded."""
    program = soil().program
    (group,) = program.groups
    rng, count = np.random.default_rng(3), group.weights.size
    for _ in range(20):
        pressure = 10 ** rng.uniform(0, 6, count)
        way = rng.normal(size=(count, 2))
        strength = group.strength_at(-pressure) * rng.uniform(0.5, 1, count)
        stress = way * (strength / np.linalg.norm(way, axis=1))[:, None]
        at_rest = {"normal_reaction": np.zeros(0), "tangential_reaction": np.zeros((0, 1))}
        state = replace(STATE, stress=(stress,), mean_stress=(-pressure,), **at_rest)
        found = scaled(program, state)
        assert beyond(program, found) <= 0
        assert beyond(program, found) == pytest.approx(0, abs=1e-8)


def test_a_state_without_load_is_scaled_to_nothing():
    found = scaled(PROGRAM, replace(STATE, load_factor=1e-12))
    assert found.load_factor == 0
    assert not any(stress.any() for stress in found.stress)
    assert not found.normal_reaction.any()


@pytest.mark.parametrize(("beside", "margin"), [(0.5, 0.0), (2.0, 0.0), (2.0, 0.1)])
def test_reactions_are_moved_into_their_cones(beside, margin):
    """Friction beside its limit is shortened to the limit less a margin, its direction kept."""
    rows = LIMITED.contact
    tangential = beside * 2 * MU * P0 * np.ones((rows.count, 1))
    tangential[::2] *= -1
    found = within_friction(LIMITED, replace(RUBBING, tangential_reaction=tangential), margin)
    expected = min(beside, 1 - margin) * 2 * MU * P0
    assert found.tangential_reaction == pytest.approx(np.sign(tangential) * expected)
    assert np.array_equal(found.normal_reaction, RUBBING.normal_reaction)


def test_dilatant_friction_is_moved_into_its_cone():
    rows = SLIDING.program.contact
    dilatant = replace(rows, coefficient=0 * rows.coefficient, dilatancy=rows.coefficient)
    program = replace(SLIDING.program, contact=dilatant)
    found = within_friction(
        program, replace(RUBBING, normal_reaction=RUBBING.normal_reaction / 2), 0.0
    )
    assert found.tangential_reaction == pytest.approx(RUBBING.tangential_reaction / 2)


@pytest.mark.parametrize("noise", [-1e-3, 1e-11])
def test_tension_and_noise_are_no_reaction(noise):
    pressed = RUBBING.normal_reaction.copy()
    pressed[0] = noise
    found = within_friction(LIMITED, replace(RUBBING, normal_reaction=pressed), 0.0)
    assert found.normal_reaction[0] == 0
    assert np.array_equal(found.normal_reaction[1:], RUBBING.normal_reaction[1:])


def test_margins_are_taken_where_a_state_cannot_be_scaled():
    free = replace(PROGRAM, dead_load=0 * PROGRAM.dead_load)
    assert margins(free, 1e-8) == [0.0]
    assert margins(PROGRAM, 1e-8) == pytest.approx([1e-7, 1e-5, 1e-3])
    assert margins(PROGRAM, 1e-4) == pytest.approx([4e-4, 1e-2])
    dilatant = replace(free, contact=replace(free.contact, dilatancy=1 + 0 * free.contact.limit))
    assert len(margins(dilatant, 1e-8)) == 3


@pytest.mark.parametrize(("strength", "margin"), [(1e-5, 1e-2), (2e-4, 1e-7), (10.0, 1e-7)])
def test_margins_are_by_the_least_strength_where_it_is_negligible(strength, margin):
    """A change of stresses by 1e-7 is a hundredth of a strength of 1e-5."""
    problem = replace(
        D.problem,
        bodies={"block": replace(square(), criterion=la.MohrCoulomb(1.0, 30.0))},
        supports=[la.Fix("block", "bottom")],
        interfaces=(),
        reference_loads=[la.BodyForce("block", (1, 0))],
        dead_loads=[la.BodyForce("block", (0, -1))],
    )
    program = la.discretise(problem).program
    (group,) = program.groups
    surfaces = replace(group.surfaces, strength=np.full_like(group.surfaces.strength, strength))
    weak = replace(program, groups=(replace(group, surfaces=surfaces),))
    assert margins(weak, 1e-8)[0] == pytest.approx(margin)


def test_all_strengths_are_weaker_by_a_share():
    rows = replace(LIMITED.contact, dilatancy=np.full(LIMITED.contact.count, 0.3))
    found = weaker(replace(LIMITED, contact=rows), 0.1)
    assert found.groups[0].bound == pytest.approx(0.9 * LIMITED.groups[0].bound)
    assert found.contact.limit == pytest.approx(0.9 * rows.limit)
    assert found.contact.dilatancy == pytest.approx(0.9 * rows.dilatancy)


def soil(cohesion=1.0):
    body = replace(square(), criterion=la.MohrCoulomb(cohesion, 30))
    return la.discretise(
        la.Problem(
            {"b": body},
            [la.Traction("b", "right", (1, 0))],
            [la.Fix("b", "left"), la.Fix("b", "bottom")],
        )
    )


def test_a_weaker_soil_carries_less_at_any_pressure():
    program = soil().program
    less = weaker(program, 1e-7)
    own, other = program.groups[0], less.groups[0]
    for pressure in (0.0, 1.0, 1e3, -1.0):
        mean = np.full(own.weights.size, -pressure)
        assert np.all(other.strength_at(mean) < own.strength_at(mean))
        assert other.strength_at(mean) == pytest.approx(own.strength_at(mean), rel=1e-5)


def test_what_a_stress_lacks_is_its_excess_over_the_strength_of_a_surface():
    """c cos(phi) is the strength; a shear stress of 1.2 times as much lacks a fifth."""
    program = soil().program
    (group,) = program.groups
    strength = np.cos(np.radians(30))
    count, points = group.weights.size, program.contact.count
    stress = np.zeros((count, 2))
    for share, lacks in ((0.8, 0.0), (1.2, 0.2)):
        stress[3, 1] = share * strength
        state = replace(
            STATE,
            stress=(stress.copy(),),
            mean_stress=(np.zeros(count),),
            normal_reaction=np.zeros(points),
            tangential_reaction=np.zeros((points, 1)),
        )
        assert lacking(program, state) == pytest.approx(lacks)
    assert lacking(PROGRAM, at(STATE, 2.0)) == 0  # no surface: the state is scaled


@pytest.mark.parametrize("moves", [alike, by_area])
def test_stresses_are_projected_onto_equilibrium(moves):
    """What is in equilibrium stays; what is not is, and moves no further than it was moved."""
    rng = np.random.default_rng(0)
    spoilt = replace(
        STATE, stress=tuple(own + 1e-3 * rng.uniform(-1, 1, own.shape) for own in STATE.stress)
    )
    with onto_equilibrium(PROGRAM, STATE, moves) as nearest:
        same, found = nearest(STATE), nearest(spoilt)
    assert np.abs(out_of_balance(PROGRAM, spoilt)).max() > 1e-5
    assert np.abs(out_of_balance(PROGRAM, found)).max() <= 1e-14
    assert np.allclose(same.stress[0], STATE.stress[0], atol=1e-14)
    assert found.load_factor == pytest.approx(STATE.load_factor, abs=1e-8)
    if moves is alike:
        # Orthogonal in the norm in which all points count alike.
        change = [a - b for a, b in zip(found.stress, spoilt.stress, strict=True)]
        assert sum(float((own**2).sum()) for own in change) <= sum(
            float(((a - b) ** 2).sum()) for a, b in zip(STATE.stress, spoilt.stress, strict=True)
        )


def test_stresses_are_moved_back_within_the_strength():
    """A state beyond yield by 1e-3 next to one that is not: projections lead there."""
    rng = np.random.default_rng(1)
    inner = replace(STATE, load_factor=STATE.load_factor - 1e-3)
    with onto_equilibrium(PROGRAM, STATE, alike) as nearest:
        state = nearest(
            replace(
                inner, stress=tuple(o + 1e-2 * rng.uniform(-1, 1, o.shape) for o in inner.stress)
            )
        )
        before = beyond(PROGRAM, state)
        found = within_strength(PROGRAM, PROGRAM, state, nearest, 0.0, 0.0)
    assert 0 < before < 1e-2
    assert beyond(PROGRAM, found) < before / 10
    assert np.abs(out_of_balance(PROGRAM, found)).max() <= 1e-13


def test_a_velocity_is_projected_onto_what_is_admissible():
    """It swells, and it penetrates: the nearest one does neither, and is normalised."""

    def field(x):
        return flowing_field(x) + np.stack([1e-4 * x[0], 1e-4 * x[1] ** 2 - 1e-5])

    velocity = on_free_unknowns(D, field)
    state = replace(STATE, velocity=velocity)
    contact = associated_contact(PROGRAM.contact)
    before = certify(PROGRAM, state, contact)
    assert min(before.divergence, before.penetration) > 1e-6
    moved = admissible_velocity(PROGRAM, velocity)
    after = certify(PROGRAM, replace(state, velocity=moved), contact)
    assert max(after.divergence, after.penetration, after.normalisation) <= 1e-13
    assert np.abs(moved - velocity).max() <= 1e-3


def test_flow_of_soil_is_moved_to_what_is_possible():
    """Rates of shear that dilate by 1e-6 too little: the next velocity flows exactly."""
    d = soil()
    (group,) = d.program.groups
    state = la.solve(d)
    basis = d.free_basis.toarray()
    velocity = np.linalg.lstsq(basis, state.point.velocity, rcond=None)[0]
    moved = possible_velocity(d.program, velocity, preparer_named("clarabel", {}))
    assert group.impossible(moved).max() <= 0
    assert np.abs(moved - velocity).max() <= 1e-3 * np.abs(velocity).max()
    assert d.program.reference_load @ moved == pytest.approx(1.0)


@pytest.mark.parametrize(("shift", "expected"), [(0.0, 1e-12), (1e6, 1e6 * EPS / np.sqrt(2))])
def test_coordinates_far_from_the_origin_are_less_exact(shift, expected):
    """The precision of 1e6 per size of the body, the diagonal of a unit square."""
    mesh = la.meshes.rectangle((shift, shift + 1), (0, 1), 1, 1)
    body = la.Body(mesh, CRITERION)
    assert exactness([body]) == pytest.approx(expected, rel=1e-5)
    assert exactness([]) == 1e-12


def test_the_smallest_angle_of_a_mesh():
    """Of crossed squares 45 degrees; of ones twice as long as high atan 1/2."""
    for width, angle in ((1.0, 45.0), (2.0, np.degrees(np.arctan(0.5)))):
        mesh = la.meshes.rectangle((0, width), (0, 1), 1, 1)
        assert smallest_angle(la.Body(mesh, CRITERION)) == pytest.approx(angle)
    square = la.meshes.quadrilaterals((0, 1), (0, 1), 1, 1)
    assert np.isnan(smallest_angle(la.Body(square, CRITERION, space="q2")))


@pytest.mark.parametrize("parts", [1, 2, 8])
def test_the_power_of_a_uniform_strain_rate_needs_no_lattice(parts):
    """2 k of a unit square at a rate of 1, an element its share of the area."""
    velocity = D.free_basis @ STATE.velocity
    (power,) = plastic_power(D, velocity, parts).values()
    areas = np.full(power.size, 1 / power.size)
    assert power == pytest.approx(2.0 * areas)


def test_a_finer_lattice_is_closer_to_the_integral_from_above():
    """Of ``(x y, -y^2/2)``: the vertex rule is above that of a convex power, by the square."""

    def field(x):
        return np.stack([x[0] * x[1], -(x[1] ** 2) / 2])

    velocity = np.zeros(D.full.n)
    velocity[D.continua["block"].dofs] = field(D.continua["block"].nodes)
    exact, _ = dblquad(lambda y, x: np.hypot(2 * y, x), 0, 1, 0, 1)
    one, two, four, eight = (
        sum(float(own.sum()) for own in plastic_power(D, velocity, parts).values()) - exact
        for parts in (1, 2, 4, 8)
    )
    assert one > two > four > eight > 0
    assert one / two == pytest.approx(4, rel=0.2)
    assert four / eight == pytest.approx(4, rel=0.2)


def test_a_jump_gives_half_of_its_power_to_either_side():
    """The upper half of a square slides over the lower one: k times its length of 1."""
    mesh = la.meshes.rectangle((0, 1), (0, 1), 1, 2)
    body = la.Body(mesh, CRITERION, space="p1-disc")
    d = la.discretise(
        la.Problem({"b": body}, [la.Traction("b", "top", (1, 0))], [la.Fix("b", "bottom")])
    )
    dofs = d.continua["b"]
    middle = mesh.p[:, mesh.t].mean(axis=1)
    velocity = np.zeros(d.full.n)
    upper = np.flatnonzero(middle[1] > 0.5)
    velocity[dofs.dofs[0][np.unique(dofs.element_nodes[:, upper])]] = 1.0
    (power,) = plastic_power(d, velocity, 8).values()
    assert power.sum() == pytest.approx(1.0)
    assert power[upper].sum() == pytest.approx(0.5)
    assert np.count_nonzero(power > 1e-12) == 2


@pytest.mark.parametrize("unit", [1e-6, 1.0, 1e6])
def test_noise_is_relative_to_the_forces(unit):
    """A small reaction stays, and noise goes, in units of any size."""
    program = replace(
        LIMITED,
        dead_load=unit * LIMITED.dead_load,
        contact=replace(LIMITED.contact, limit=unit * LIMITED.contact.limit),
    )
    state = at(RUBBING, unit)
    pressed = state.normal_reaction.copy()
    pressed[:2] = 1e-6 * unit, 1e-13 * unit
    found = within_friction(program, replace(state, normal_reaction=pressed), 0.0)
    assert found.normal_reaction[:2].tolist() == [1e-6 * unit, 0.0]
    assert np.array_equal(found.normal_reaction[2:], pressed[2:])


@pytest.mark.parametrize("kind", ["reference_load", "dead_load"])
def test_reactions_are_noise_by_the_mean_traction_of_loads_that_cancel(kind):
    """A billionth of 40 N on 1 m, as forces of either sign; what is larger stays."""
    none = 0 * LIMITED.dead_load
    loads = np.resize([1.0, -1.0], none.size)
    loads *= {"reference_load": 4.0, "dead_load": 40.0}[kind] / np.abs(loads).sum()
    program = replace(LIMITED, **({"reference_load": none, "dead_load": none} | {kind: loads}))
    assert program.contact.weights.sum() == pytest.approx(1.0)
    state = at(RUBBING, 0.1)
    pressed = 0 * state.normal_reaction
    pressed[:2] = 2e-8, 8e-8
    for load_factor in (10.0, -10.0):
        own = replace(state, load_factor=load_factor, normal_reaction=pressed)
        found = within_friction(program, own, 0.0).normal_reaction
        assert found.tolist() == [0.0, 8e-8, *pressed[2:]]


@pytest.mark.parametrize("margin", [1e-4, 1e-2])
def test_reactions_below_a_tenth_of_the_margin_are_noise(margin):
    """By the largest reaction: strengths are reduced by the margin for them."""
    pressed = RUBBING.normal_reaction.copy()
    pressed[:2] = pressed.max() * margin * np.array([0.05, 0.2])
    light = replace(LIMITED, dead_load=0 * LIMITED.dead_load)
    state = replace(RUBBING, normal_reaction=pressed, load_factor=0.0)
    found = within_friction(light, state, margin).normal_reaction
    assert found.tolist() == [0.0, *pressed[1:]]


def test_supports_allow_a_motion_in_the_span_of_what_they_leave_free():
    """Columns are orthogonal, of any length."""
    basis = csr_matrix(np.array([[3.0, 0.0], [4.0, 0.0], [0.0, 0.1], [0.0, 0.0]]))
    assert _free(np.array([6.0, 8.0, -7.0, 0.0]), basis)
    assert not _free(np.array([6.0, 8.0, -7.0, 1e-3]), basis)
    assert not _free(np.array([-4.0, 3.0, 0.0, 0.0]), basis)


def test_contact_resists_what_opens_and_what_rubs():
    """Slip without friction is free; penetration counts as opening does."""
    full = SLIDING.full
    q = on_free_unknowns(SLIDING, lambda x: np.stack([np.ones_like(x[0]), 0 * x[0]]))
    lifted = on_free_unknowns(SLIDING, lambda x: np.stack([0 * x[0], np.ones_like(x[0])]))
    slides, opens = (SLIDING.free_basis @ own for own in (q, lifted))
    none = np.zeros(full.contact.count)
    smooth = replace(full, contact=replace(full.contact, limit=none, dilatancy=none))
    assert not _resisted(slides, smooth)
    assert _resisted(opens, smooth)
    assert _resisted(-opens, smooth)
    for rough in ("limit", "dilatancy"):
        contact = replace(smooth.contact, **{rough: none + 0.1})
        assert _resisted(slides, replace(smooth, contact=contact))
