"""The independent checker accepts what lacore certifies and refuses planted errors (T12c)."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from tests.coulomb_checker import accepts, centroid, residuals
from tests.rigid_problems import PROBLEMS
from tests.statements import stated

FRICTION = {name: build.__defaults__[0] for name, build in PROBLEMS.items()}


@pytest.fixture(scope="module")
def states():
    found = {}
    for name, build in PROBLEMS.items():
        problem = build()
        state = la.solve(problem, throw=True)
        found[name] = (problem, state, stated(problem, state, FRICTION[name]))
    return found


@pytest.mark.parametrize("name", PROBLEMS)
def test_certified_states_are_accepted(states, name):
    _, _, s = states[name]
    assert accepts(s), residuals(s)
    assert pointwise(s)


def pointwise(s, tolerance=1e-5):
    """Whether each point sticks, slips or is open as Coulomb says (T2), in words of its own.

    Products of a force and a velocity below 1e-6 each in the checker leave one of both below
    1e-3; equilibrium and tension are the checker's business.
    """
    tangent = np.stack([-s.normal[:, 1], s.normal[:, 0]], axis=1)
    points = []
    for block in (s.slave, s.master):
        centre = np.array([centroid(s.outlines[b]) for b in block])
        u, arm = s.velocity[block], s.place - centre
        points.append(u[:, :2] + u[:, 2:] * np.stack([-arm[:, 1], arm[:, 0]], axis=1))
    jump = points[0] - points[1]
    u_n, u_t = np.sum(jump * s.normal, axis=1), np.sum(jump * tangent, axis=1)
    speed, force = np.abs(s.velocity).max(), np.abs(s.dead).sum() + np.abs(s.normal_force).max()
    rest = 1e-3
    opens, slips = u_n > rest * speed, np.abs(u_t) > rest * speed
    free = np.hypot(s.normal_force, s.tangential_force) <= rest * force
    drags = np.abs(s.tangential_force + s.mu * s.normal_force * np.sign(u_t)) <= rest * force
    within = np.abs(s.tangential_force) <= s.mu * s.normal_force + rest * force
    return bool(np.all(np.where(opens, free, np.where(slips, drags, within))))


def without_dead_load(s):
    heaviest = np.argmin(np.where(s.fixed, 0, s.dead[:, 1]))
    dead = s.dead.copy()
    dead[heaviest] = 0
    return replace(s, dead=dead)


def changed(values, index, factor=None, add=0.0):
    values = np.array(values, dtype=float)
    values[index] = values[index] * (1 if factor is None else factor) + add
    return values


def moving(s):
    """The block that moves fastest."""
    return int(np.argmax(np.linalg.norm(s.velocity, axis=1)))


def loaded(s):
    """The contact point that carries the most."""
    return int(np.argmax(s.normal_force))


def sinking(s):
    velocity = s.velocity.copy()
    velocity[~s.fixed, 1] -= 1e-3 * np.abs(velocity).max()
    return replace(s, velocity=velocity)


PLANTED = {
    "alpha by 1e-4": lambda s: replace(s, load_factor=s.load_factor * (1 + 1e-4) + 1e-12),
    "alpha reversed": lambda s: replace(s, load_factor=-s.load_factor),
    "all friction reversed": lambda s: replace(s, tangential_force=-s.tangential_force),
    "all reactions reversed": lambda s: replace(s, normal_force=-s.normal_force),
    "one cone by 1e-3": lambda s: replace(
        s,
        tangential_force=changed(
            s.tangential_force, loaded(s), add=1e-3 * s.normal_force[loaded(s)]
        ),
    ),
    "all reactions by 1e-3": lambda s: replace(
        s,
        normal_force=s.normal_force * (1 + 1e-3),
        tangential_force=s.tangential_force * (1 + 1e-3),
    ),
    "friction coefficient 1 % too large": lambda s: replace(s, mu=s.mu / 1.01),
    "missing dead load": without_dead_load,
    "dead load upwards": lambda s: replace(s, dead=-s.dead),
    "penetration": sinking,
    "reversed mechanism": lambda s: replace(s, velocity=-s.velocity),
    "reversed rotation": lambda s: replace(s, velocity=s.velocity * [1, 1, -1]),
    "not normalised": lambda s: replace(s, velocity=2 * s.velocity),
    "a block left behind": lambda s: replace(s, velocity=changed(s.velocity, moving(s), 0.0)),
    "a support that moves": lambda s: replace(
        s, velocity=s.velocity + s.fixed[:, None] * np.abs(s.velocity).max() * [1e-3, 0, 0]
    ),
    "no reactions": lambda s: replace(
        s, normal_force=0 * s.normal_force, tangential_force=0 * s.tangential_force
    ),
    "reactions of two points exchanged": lambda s: replace(
        s, normal_force=np.roll(s.normal_force, 1)
    ),
    "contact points shifted": lambda s: replace(s, place=np.add(s.place, 0.01)),
    "other load direction": lambda s: replace(s, reference=s.reference[:, [1, 0, 2]]),
    "reaction is NaN": lambda s: replace(s, normal_force=changed(s.normal_force, 0, np.nan)),
    "velocity is NaN": lambda s: replace(s, velocity=changed(s.velocity, (moving(s), 0), np.nan)),
    "load factor is NaN": lambda s: replace(s, load_factor=np.nan),
}


@pytest.mark.parametrize("planted", PLANTED)
def test_planted_errors_are_refused(states, planted):
    """In each assembly, unless what was planted is a true Coulomb state, shown point by point."""
    refused = 0
    for name, (_, _, s) in states.items():
        wrong = PLANTED[planted](s)
        if accepts(wrong):
            assert pointwise(wrong), name
            worst = max(residuals(wrong).values())
            assert worst <= 1e-6, name
        else:
            refused += 1
    assert refused >= 3


@pytest.mark.parametrize("coupling", ["associated"])
def test_states_of_other_laws_are_refused(states, coupling):
    """An associated state passed off as one of Coulomb, wherever it slips at all."""
    refused = 0
    for name, (problem, state, _) in states.items():
        other = la.solve(problem, coupling=coupling, throw=True)
        s = stated(problem, other, FRICTION[name])
        if accepts(s):
            assert pointwise(s), name
            assert other.load_factor == pytest.approx(state.load_factor, rel=1e-5), name
        else:
            refused += 1
    assert refused >= 7
