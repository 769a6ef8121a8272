"""Blocks in space: intervals up to a slack, published values, ranges (T74, T77)."""

import numpy as np
import pytest

import lacore as la
from lacore.coupling.blocks.slack import Slack
from lacore.limit.conversion import point_in_program
from lacore.program.kinematic import dimensionless

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


def test_published_domes_and_vaults_are_among_the_load_factors():
    """REFERENCES_3D: values of one certified state each, six digits, intervals not known."""
    plain = la.solve(shaken(la.masonry3d.dome(8, 4, 1.0, 0.15, 0.25, 0.5)), throw=True)
    assert plain.interval().low <= 0.403809 <= plain.interval().high
    vault = la.solve(shaken(la.masonry3d.cross_vault(9, 0.9, 0.2, 1.2, 0.6)), throw=True)
    assert vault.interval().low <= 0.240979 <= vault.interval().high


def test_ends_of_an_interval_are_certified_and_say_what_the_slack_is_worth(state):
    interval = state.interval()
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
    interval = la.solve(problem, throw=True).interval()
    for end in (interval.lower, interval.upper):
        # To first order; the second is the square of a slack of a millionth.
        assert abs(end.load_factor - exact) == pytest.approx(end.slack, rel=0.1, abs=1e-8)


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
    assert "path" in set(found.states.origin)
    assert set(found.states.restart) >= {0, 1}
    assert found.lowest.certificate.holds(BAR)
    assert found.highest.certificate.holds(BAR)
    assert found.bracket[0] <= found.low
    assert found.high <= found.bracket[1] * (1 + BAR)
