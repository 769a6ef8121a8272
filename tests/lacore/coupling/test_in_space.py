"""Coupling of blocks in space: proximal steps, restarts, intervals up to a slack (T74, T76)."""

from contextlib import closing
from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from lacore.backend import find_backend, read_options
from lacore.certificate import certify
from lacore.coupling.certified import averaged, mixed, restarted
from lacore.coupling.freezing import associated
from lacore.coupling.in_space.central_path import states_along, takes, tracked
from lacore.coupling.in_space.proximal import proximal, proximal_program
from lacore.coupling.in_space.slack import Slack
from lacore.coupling.run import CouplingOptions, Run
from lacore.inner.preparing import preparing
from lacore.limit.conversion import point_in_program
from lacore.program import dimensionless, reaction_contact

BAR = 1e-6


def shaken(blocks, azimuth=0.0):
    base = tuple(name for name in blocks.names if name.startswith("base"))
    return la.Problem(
        {"b": blocks},
        [la.BodyForce("b", (np.cos(azimuth), np.sin(azimuth), 0.0))],
        [la.Fix("b", base, "xyz")],
        dead_loads=[la.BodyForce("b", (0, 0, -1))],
    )


def dome(meridians=6, rings=3, friction=0.5):
    return shaken(la.masonry3d.dome(meridians, rings, 1.0, 0.15, 0.3, friction))


@pytest.fixture(scope="module")
def state():
    return la.solve(dome(), throw=True)


@pytest.fixture
def run(state):
    """A loop on the dome that has solved the associated problem."""
    stated = state.discretisation
    program = dimensionless(stated.program, stated.natural)
    engine = find_backend("clarabel")
    with (
        preparing(engine, read_options(engine, {}), good=0.1 * BAR) as prepare,
        closing(prepare(program.associated())) as solver,
    ):
        own = Run(program, solver, False, CouplingOptions(), lambda _: None, prepare)
        frozen = associated(program)
        own.solve("associated", frozen.contact, program=frozen.program)
        yield own


def test_a_coulomb_state_is_a_fixed_point_of_proximal_steps(state, run):
    point = point_in_program(state.discretisation, state.point)
    rows, program = run.program.contact, run.program
    forces = rows.weights * np.maximum(point.normal_reaction, 0)
    softness = 0.1 * np.abs(point.velocity).max() / forces.max()
    yielding = proximal_program(program, forces, softness)
    with closing(run.prepare(yielding)) as solver:
        answer = solver.solve(reaction_contact(rows, forces / rows.weights)).point
    # A gap of the bar per power is a distance of its root: e |w (t_n - x)|^2 is of the order of it.
    image = rows.weights * answer.normal_reaction
    assert np.abs(image - forces).max() <= 10 * np.sqrt(BAR) * forces.max()
    assert answer.load_factor == pytest.approx(point.load_factor, abs=1e-3)
    # What yields says by how much: w (t_n - x) = v/e where something presses.
    pressed = image > 1e-6 * forces.max()
    speed = answer.velocity[program.n :]
    assert (image - forces)[pressed] == pytest.approx(
        speed[pressed] / softness, abs=1e-6 * forces.max()
    )


@pytest.mark.parametrize("attempt", [averaged, tracked, mixed, proximal, restarted])
def test_each_attempt_certifies_a_dome(run, state, attempt):
    found = attempt(run, run.iterates[0].inner.point)
    assert found is not None
    assert found.certificate.holds(BAR)
    scale = state.discretisation.natural.load_factor
    # Load factors of domes are not unique: all are below the associated one.
    assert found.state.load_factor <= run.iterates[0].inner.point.load_factor * (1 + BAR)
    assert found.state.load_factor * scale == pytest.approx(state.load_factor, rel=0.05)


@pytest.mark.parametrize("spread", [0.0, 0.5])
def test_curves_end_at_coulomb_states_and_come_from_the_middle_of_all_cones(run, spread):
    """Smoothed complementarity: forces times velocities are the square of the smoothing."""
    start, program = run.iterates[0].inner.point, run.program
    rows = program.contact
    share = np.exp(spread * np.random.default_rng(3).standard_normal(rows.count))
    gaps = []
    for state, smoothing in states_along(program, start, share):
        residuals = certify(program, state)
        gaps.append((smoothing, residuals.slip))
        if residuals.holds(BAR) or len(gaps) > 300:
            break
    assert residuals.holds(BAR)
    smoothing, slips = np.array(gaps).T
    # The slip residual is a sum of what is not complementary: some powers of the smoothing below 1.
    small = smoothing < 1e-3
    assert np.all(slips[small] <= rows.count * smoothing[small])


def test_curves_are_followed_of_rigid_blocks_whose_friction_is_a_cone(run):
    assert takes(run.program)
    rows = run.program.contact
    for other in ({"limit": 1.0 + rows.limit}, {"dilatancy": 0.1 + rows.dilatancy}):
        assert not takes(replace(run.program, contact=replace(rows, **other)))


def test_without_a_backend_that_takes_squares_there_are_no_proximal_steps(run):
    assert proximal(replace(run, prepare=None), run.iterates[0].inner.point) is None


def test_published_domes_and_vaults_are_among_the_load_factors():
    """REFERENCES_3D: values of one certified state each, six digits, intervals not known."""
    plain = la.solve(shaken(la.masonry3d.dome(8, 4, 1.0, 0.15, 0.25, 0.5)), throw=True)
    assert plain.interval.low <= 0.403809 <= plain.interval.high
    vault = la.solve(shaken(la.masonry3d.cross_vault(9, 0.9, 0.2, 1.2, 0.6)), throw=True)
    assert vault.interval.low <= 0.240979 <= vault.interval.high


def test_ends_of_an_interval_are_certified_and_say_what_the_slack_is_worth(state):
    interval = state.interval
    assert interval.low <= state.load_factor <= interval.high
    assert interval.exact
    for end in (interval.lower, interval.upper):
        assert end.certificate.holds(BAR)
        assert state.certify(point=end.point).holds(2 * BAR)
        assert end.slack > 0
        assert f"{end.slack:.1e}" in str(interval)
    assert "turn continuously" in str(interval.facts())


def test_slack_is_worth_what_it_says():
    """A block across a slope: its load factor is unique, and so an end is off by the slack."""
    mu, beta = 0.7, 0.4
    block = la.Polyhedron(
        [(x, y, z) for z in (0, 0.2) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))],
        [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)],
    )
    problem = la.Problem(
        {"b": la.BlockAssembly3D([block], mu)},
        [la.BodyForce("b", (0, 1, 0))],
        interfaces=[
            la.Interface(("b", lambda x: x[2] == 0), la.RigidObstacle((0, 0, 0), (0, 0, 1)), mu)
        ],
        dead_loads=[la.BodyForce("b", (np.sin(beta), 0, -np.cos(beta)))],
    )
    exact = np.sqrt((mu * np.cos(beta)) ** 2 - np.sin(beta) ** 2)
    interval = la.solve(problem, throw=True).interval
    for end in (interval.lower, interval.upper):
        # To first order; the second is the square of a slack of a millionth.
        assert abs(end.load_factor - exact) <= end.slack + 1e-8


def test_what_a_slack_leaves_is_the_gap_of_its_ends(state):
    point = point_in_program(state.discretisation, state.point)
    program = dimensionless(state.discretisation.program, state.discretisation.natural)
    own = Slack.of(program, point, 1.0, BAR)
    assert own.program.n == program.n + 1
    assert own.program.contact.count == program.contact.count + 1
    wider = Slack.of(program, point, 1.0, 10 * BAR)
    assert wider.gap == pytest.approx(10 * own.gap)


def test_blocks_in_space_get_more_solves(state):
    """Named in the history where they are spent; here 7 are enough, and one is not."""
    assert state.status is la.Status.SOLVED
    short = la.solve(dome(), max_iterations=1)
    assert short.status is la.Status.NOT_CERTIFIED
    assert np.isnan(short.load_factor)
    low, high = short.bracket
    assert low <= state.load_factor <= high


@pytest.mark.slow
def test_a_range_of_a_dome():
    found = la.coulomb_range(dome(4, 2), restarts=1)
    alone = la.solve(dome(4, 2), throw=True)
    assert found.low <= alone.load_factor <= found.high
    assert found.lowest.certificate.holds(BAR)
    assert found.highest.certificate.holds(BAR)
    assert found.bracket[0] <= found.low
    assert found.high <= found.bracket[1] * (1 + BAR)
