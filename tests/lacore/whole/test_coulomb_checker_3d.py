"""In space the independent checker accepts what lacore certifies and refuses planted errors."""

from dataclasses import replace

import numpy as np
import pytest

import lacore as la
from tests.coulomb_checker_3d import accepts, residuals
from tests.statements_3d import stated
from tests.structures import problem

SEEDS = {"corner": 0, "panel": 10, "Voronoi wall": 4}  # small ones


@pytest.fixture(scope="module")
def states():
    found = {}
    for kind, seed in SEEDS.items():
        own = problem(kind, seed)
        found[kind] = own, stated(own, la.solve(own, throw=True))
    return found


@pytest.mark.parametrize("kind", SEEDS)
def test_certified_states_are_accepted(states, kind):
    _, s = states[kind]
    assert accepts(s), residuals(s)


def changed(values, index, factor=1.0, add=0.0):
    values = np.array(values, dtype=float)
    values[index] = values[index] * factor + add
    return values


def moving(s):
    """The block that moves fastest."""
    return int(np.argmax(np.linalg.norm(s.velocity, axis=1)))


def loaded(s):
    """The contact point that carries the most."""
    return int(np.argmax(s.normal_force))


def slipping(s):
    """The contact point that carries the most friction."""
    return int(np.argmax(np.linalg.norm(s.tangential_force, axis=1)))


def turned(s, angle):
    """All friction, in its plane."""
    across = np.cross(s.normal, s.tangential_force)
    return np.cos(angle) * s.tangential_force + np.sin(angle) * across


def sunk(s):
    velocity = s.velocity.copy()
    velocity[~s.fixed, 2] -= 1e-3 * np.abs(velocity).max()
    return velocity


def moved_places(s):
    """Along their faces where these are wide, out of their planes elsewhere."""
    return s.place + 0.01 * s.normal


PLANTED = {
    "alpha by 1e-4": lambda s: {"load_factor": s.load_factor * (1 + 1e-4)},
    "alpha reversed": lambda s: {"load_factor": -s.load_factor},
    "all friction reversed": lambda s: {"tangential_force": -s.tangential_force},
    "all friction turned by .01": lambda s: {"tangential_force": turned(s, 0.01)},
    "all reactions reversed": lambda s: {"normal_force": -s.normal_force},
    "one reaction by 1e-3": lambda s: {
        "normal_force": changed(s.normal_force, loaded(s), 1 + 1e-3)
    },
    "friction at one point by 1e-3": lambda s: {
        "tangential_force": changed(s.tangential_force, slipping(s), 1 + 1e-3)
    },
    "friction out of its plane": lambda s: {
        "tangential_force": s.tangential_force + 1e-3 * s.normal_force.max() * s.normal
    },
    "all reactions by 1e-3": lambda s: {
        "normal_force": s.normal_force * (1 + 1e-3),
        "tangential_force": s.tangential_force * (1 + 1e-3),
    },
    "friction coefficient 1 % too large": lambda s: {"mu": s.mu / 1.01},
    "friction coefficient 1 % too small": lambda s: {"mu": s.mu * 1.01},
    "no dead load": lambda s: {"dead": 0 * s.dead},
    "dead load upwards": lambda s: {"dead": -s.dead},
    "penetration": lambda s: {"velocity": sunk(s)},
    "reversed mechanism": lambda s: {"velocity": -s.velocity},
    "reversed rotation": lambda s: {"velocity": s.velocity * [1, 1, 1, -1, -1, -1]},
    "not normalised": lambda s: {"velocity": 2 * s.velocity},
    "a block left behind": lambda s: {"velocity": changed(s.velocity, moving(s), 0.0)},
    "a block spins": lambda s: {
        "velocity": changed(s.velocity, (moving(s), 5), 1.0, 1e-2 * np.abs(s.velocity).max())
    },
    "a support that moves": lambda s: {
        "velocity": s.velocity + s.fixed[:, None] * np.abs(s.velocity).max() * 1e-3
    },
    "no reactions": lambda s: {
        "normal_force": 0 * s.normal_force,
        "tangential_force": 0 * s.tangential_force,
    },
    "reactions of two points exchanged": lambda s: {"normal_force": np.roll(s.normal_force, 1)},
    "contact points off their faces": lambda s: {"place": moved_places(s)},
    "normals reversed": lambda s: {"normal": -s.normal},
    "normals tilted": lambda s: {"normal": np.add(s.normal, (0.01, 0.02, 0.03))},
    "master and slave exchanged": lambda s: {"slave": s.master, "master": s.slave},
    "another load direction": lambda s: {"reference": s.reference[:, [1, 0, 2]]},
    "a corner of a block moved": lambda s: {
        "corners": (
            *s.corners[: moving(s)],
            changed(s.corners[moving(s)], 0, 1.0, 0.01),
            *s.corners[moving(s) + 1 :],
        )
    },
    "reaction is NaN": lambda s: {"normal_force": changed(s.normal_force, 0, np.nan)},
    "friction is NaN": lambda s: {"tangential_force": changed(s.tangential_force, 0, np.nan)},
    "velocity is NaN": lambda s: {"velocity": changed(s.velocity, (moving(s), 0), np.nan)},
    "load factor is NaN": lambda s: {"load_factor": np.nan},
}


@pytest.mark.parametrize("planted", PLANTED)
def test_planted_errors_are_refused(states, planted):
    # To check the corner takes as long as ten of the others.
    some = [s for kind, (_, s) in states.items() if kind != "corner"]
    refused = [not accepts(replace(s, **PLANTED[planted](s))) for s in some]
    # What only rocks has the same states whatever the coefficient.
    assert any(refused) if planted.startswith("friction coefficient") else all(refused)


@pytest.mark.parametrize("kind", SEEDS)
def test_states_of_other_laws_are_refused(states, kind):
    """An associated state passed off as one of Coulomb, unless it is one of the same load."""
    own, s = states[kind]
    other = stated(own, la.solve(own, coupling="associated", throw=True))
    if accepts(other):
        assert other.load_factor == pytest.approx(s.load_factor, rel=1e-5)
