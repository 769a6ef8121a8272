"""Ends of intervals whose proofs fail in one way, and loops with friction of two kinds."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import lacore as la
from lacore.coupling import interval as module
from lacore.coupling.faces import _gaps, _Speeds, _speeds, faces
from lacore.coupling.interval import EndStatus
from lacore.program.certificate import certify
from lacore.program.kinematic import associated_contact
from tests.lacore.planted import MU, P0, flowing, sliding

D, STATE = sliding()
PROGRAM = D.program
TOLERANCE = 1e-6


def slack_end(monkeypatch, bound, state, sign=1.0, dual=STATE):
    """The end of a mechanism in space, whose program has a given dual solution and bound."""
    own = SimpleNamespace(program=PROGRAM, contact=None, widening=lambda dual: 0.25)
    own.state = lambda dual, alpha: replace(state, load_factor=alpha)
    monkeypatch.setattr(module, "Slack", SimpleNamespace(of=lambda *given: own))
    monkeypatch.setattr(module, "_solve", lambda *given: (dual, None))
    monkeypatch.setattr(module, "_bound", lambda *given: bound)
    return module._slack_end(PROGRAM, STATE, sign, None, TOLERANCE)


def test_an_end_is_proven_by_its_state_and_by_its_bound(monkeypatch):
    """The larger of both is its load factor; the power dissipated, mu p0, is the scale."""
    exact = STATE.load_factor
    off = 0.5 * TOLERANCE * MU * P0
    end = slack_end(monkeypatch, exact + off, STATE)
    assert end.status is EndStatus.EXACT
    assert end.load_factor == exact + off
    assert end.slack == 0.25
    assert slack_end(monkeypatch, exact - off, STATE).load_factor == exact
    assert slack_end(monkeypatch, exact, STATE, dual=None) is None


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_an_end_without_a_bound_next_to_it_is_none(monkeypatch, sign):
    exact = STATE.load_factor
    for bound in (exact + sign * 3 * TOLERANCE, np.nan):
        assert slack_end(monkeypatch, bound, STATE) is None


def test_an_end_whose_state_violates_a_law_is_none(monkeypatch):
    wrong = replace(STATE, tangential_reaction=1.1 * STATE.tangential_reaction)
    assert slack_end(monkeypatch, STATE.load_factor, wrong) is None


def plane_end(monkeypatch, bound, wrong=False):
    (face, *_) = faces(PROGRAM, STATE)
    dual = replace(STATE, load_factor=STATE.load_factor)
    monkeypatch.setattr(module, "_bound", lambda *given: bound)
    state = replace(STATE, tangential_reaction=(1.1 if wrong else 1.0) * STATE.tangential_reaction)
    made_up = SimpleNamespace(
        contact=face.contact,
        original=PROGRAM,
        state=lambda dual, alpha: replace(state, load_factor=alpha),
    )
    return module._end(made_up, PROGRAM, dual, 1.0, TOLERANCE)


def test_the_same_holds_in_the_plane(monkeypatch):
    exact = STATE.load_factor
    assert plane_end(monkeypatch, exact).status is EndStatus.EXACT
    assert plane_end(monkeypatch, exact * (1 + 1e-5)) is None
    assert plane_end(monkeypatch, np.nan) is None
    assert plane_end(monkeypatch, exact, wrong=True) is None


@pytest.mark.parametrize("name", ["penetration", "divergence", "normalisation"])
def test_a_velocity_that_is_not_admissible_bounds_nothing(monkeypatch, name):
    d, state = flowing()
    laws = associated_contact(d.program.contact)
    assert module._bound(d.program, laws, state, TOLERANCE) == pytest.approx(state.load_factor)
    seen = replace(certify(d.program, state), **{name: 2 * TOLERANCE})
    monkeypatch.setattr(module, "Certificate", SimpleNamespace(of=lambda *given: seen))
    assert np.isnan(module._bound(d.program, laws, state, TOLERANCE))


@pytest.mark.parametrize("factor", [1e-6, 1.0, 1e6])
def test_speeds_are_those_per_the_fastest(factor):
    """Of a body at rest all are zero; opening counts beyond what slip dilates."""
    d, state = flowing()
    one, other = (_speeds(d.program, own * state.velocity) for own in (1.0, factor))
    assert other.opening == pytest.approx(one.opening, abs=1e-12)
    assert other.slip == pytest.approx(one.slip, abs=1e-12)
    for a, b in zip(one.strain, other.strain, strict=True):
        assert b == pytest.approx(a)
        assert b.max() == pytest.approx(1.0)
    rest = _speeds(d.program, 0 * state.velocity)
    assert not rest.opening.any()
    assert not any(own.any() for own in rest.strain)
    dilatancy = np.full(d.program.contact.count, 0.5)
    dilatant = replace(d.program, contact=replace(d.program.contact, dilatancy=dilatancy))
    found = _speeds(dilatant, state.velocity)
    assert found.opening == pytest.approx(one.opening - 0.5 * one.slip)


def test_strain_rates_of_a_rigid_motion_are_noise():
    """Relative to speed per length, and not to the largest of them."""
    (strain,) = _speeds(PROGRAM, STATE.velocity).strain
    assert strain.max() <= 1e-12
    assert _speeds(PROGRAM, STATE.velocity).slip == pytest.approx(1.0)


def test_thresholds_lie_in_the_gaps_between_noise_and_motion():
    """The widest first, at its geometric mean; ratios below ten are no gaps."""
    speeds = _Speeds(np.array([1.0, -1e-3, 1e-9]), np.array([2e-9, 5e-3]), (np.array([1e-5]),))
    assert _gaps(speeds) == pytest.approx([np.sqrt(2e-9 * 1e-5), np.sqrt(1e-5 * 1e-3)])
    assert _gaps(_Speeds(np.array([1.0]), np.array([0.5]), ())) == []


def two_blocks(one, other):
    """Two blocks of weight 1, each on an obstacle with its own friction, under the same push."""
    bodies, interfaces = {}, []
    for name, x, friction in (("one", 0.0, one), ("other", 3.0, other)):
        square = [(x, 0), (x + 1, 0), (x + 1, 1), (x, 1)]
        bodies[name] = la.BlockAssembly({"b": square}, 0.0)
        floor = la.RigidObstacle((0, 0), (0, 1))
        interfaces.append(la.Interface((name, lambda x: x[1] == 0), floor, friction))
    return la.Problem(
        bodies,
        [la.BodyForce(name, (1, 0)) for name in bodies],
        interfaces=interfaces,
        dead_loads=[la.BodyForce(name, (0, -1)) for name in bodies],
    )


@pytest.mark.parametrize("coupling", ["reaction", "shift", "certified"])
@pytest.mark.parametrize(
    ("one", "other", "load_factor"),
    [(0.3, la.Tresca(0.5), 0.3), (0.3, la.Tresca(0.2), 0.2), (la.Tresca(0.2), 0.1, 0.1)],
)
def test_loops_iterate_where_any_point_has_coulomb_friction(coupling, one, other, load_factor):
    """The weaker of the two blocks slides first."""
    state = la.solve(two_blocks(one, other), coupling=coupling)
    assert state.load_factor == pytest.approx(load_factor, abs=1e-6)
