"""Iterates of a loop that are wrong in exactly one way are not accepted."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import lacore as la
from lacore.coupling import certified
from lacore.coupling.fixed_point import fixed_point
from lacore.coupling.freezing import friction_of, generous, pressing
from lacore.coupling.friction_start import FrictionStart
from lacore.coupling.options import CouplingOptions
from lacore.coupling.run import Iterate, Run, answered_by, paired, worst
from lacore.program.certificate import certify
from lacore.program.kinematic import Scales, dimensionless, frictionless_contact, reaction_contact
from lacore.program.power import kinematic_load_factor, kinematic_power
from lacore.program.regularization import RegularisedValues
from lacore.reporting.status import Status
from lacore.solvers.backend import InnerSolution
from tests.lacore.planted import MU, P0, flowing, sliding

TOLERANCE = 1e-6
D, STATE = flowing()
PLASTIC = 2.0  # of `flowing`: 2 k at a rate of 1
VALUES = RegularisedValues(plastic=2 - P0, alpha_reg=2 - P0, load_factor=2 - P0, multiplier=2 - P0)


def run_of(program=D.program, regularised=False):
    return Run(program, None, regularised, CouplingOptions(tolerance=TOLERANCE), lambda _: None)


def iterate(state=STATE, program=D.program, status=Status.SOLVED, regularised=None, **changes):
    inner = InnerSolution(status, "", 1, 0.0, state, regularised)
    own = Iterate(0, "K", inner, state, certify(program, state), 0.0)
    return replace(own, **changes)


def test_an_exact_state_is_accepted():
    run = run_of()
    assert run.proven(iterate())
    assert run.finish(iterate()).status is Status.SOLVED
    assert run.finish(iterate(status=Status.ITERATION_LIMIT)).status is Status.SOLVED
    assert not run.free(iterate())


def test_the_best_of_proven_iterates_has_the_least_residual():
    """Whichever came first; what is not proven does not count."""
    run = run_of()
    assert run.best_proven() is None
    exact, wrong = iterate(), iterate(replace(STATE, load_factor=1.01 * STATE.load_factor))
    close = iterate(replace(STATE, load_factor=(1 + 1e-7) * STATE.load_factor))
    for order in ([wrong, exact, close], [close, wrong, exact]):
        run.iterates[:] = order
        assert run.best_proven() is exact
    run.iterates[:] = [wrong]
    assert run.best_proven() is None


@pytest.mark.parametrize("name", ["load_factor", "normal_reaction", "velocity"])
def test_a_state_that_is_off_is_not(name):
    run, wrong = run_of(), replace(STATE, **{name: 1.0001 * getattr(STATE, name)})
    assert not run.proven(iterate(wrong))
    assert run.finish(iterate(wrong)).status is Status.NOT_CERTIFIED
    stalled = run.finish(iterate(wrong, status=Status.STALLED))
    assert stalled.status is Status.STALLED
    assert not run.proven(iterate(certificate=None))
    assert not run.proven(iterate(state=STATE, certificate=None))


REGULARISED = run_of(regularised=True)


def test_a_regularised_state_is_accepted_by_its_equilibrium():
    assert REGULARISED.proven(iterate(regularised=VALUES))
    # What the penalties let through is reported and not judged.
    leaking = replace(certify(D.program, STATE), divergence=0.01, penetration=0.01, flow=0.01)
    assert REGULARISED.proven(iterate(regularised=VALUES, certificate=leaking))
    for multiplier in (np.nan, VALUES.multiplier * (1 + 6e-7)):
        own = replace(VALUES, multiplier=multiplier)
        assert REGULARISED.proven(iterate(regularised=own))


@pytest.mark.parametrize("name", ["equilibrium", "yield_violation", "normalisation"])
def test_a_regularised_state_is_refused_by_one_residual(name):
    wrong = replace(certify(D.program, STATE), **{name: 2 * TOLERANCE})
    assert not REGULARISED.proven(iterate(regularised=VALUES, certificate=wrong))


@pytest.mark.parametrize(
    "changes",
    [
        {"mismatch": 2 * TOLERANCE},
        # The energy of penalties is a fifth of what is dissipated.
        {"regularised": replace(VALUES, alpha_reg=VALUES.plastic + PLASTIC / 5)},
        {"regularised": replace(VALUES, multiplier=VALUES.multiplier * (1 + 1e-5))},
        {"regularised": replace(VALUES, multiplier=VALUES.multiplier * (1 - 1e-5))},
    ],
)
def test_a_regularised_state_is_refused_by_one_value(changes):
    assert not REGULARISED.proven(iterate(**{"regularised": VALUES, **changes}))


@pytest.mark.parametrize("regularised", [False, True])
def test_a_motion_that_nothing_resists_is_free(regularised):
    """A block on a smooth floor, pushed along it: no power at all."""
    block = la.BlockAssembly({"b": la.masonry.rectangle(0, 1, 0, 1)}, 0.0)
    floor = la.Interface(("b", lambda x: x[1] == 0), la.RigidObstacle((0, 0), (0, 1)), la.SMOOTH)
    d = la.discretise(
        la.Problem(
            {"b": block},
            [la.BodyForce("b", (1, 0))],
            interfaces=[floor],
            dead_loads=[la.BodyForce("b", (0, -1))],
        )
    )
    program = d.program
    moving = np.zeros(program.n)
    moving[0] = 1 / program.reference_load[0]
    rows = program.contact
    state = replace(
        STATE,
        velocity=moving,
        load_factor=0.0,
        stress=(),
        mean_stress=(),
        normal_reaction=np.full(rows.count, 1.0),
        tangential_reaction=np.zeros((rows.count, 1)),
    )
    values = RegularisedValues(0.0, 0.0, 0.0, 0.0) if regularised else None
    run = run_of(program, regularised)
    assert run.free(iterate(state, program, regularised=values))
    assert run.finish(iterate(state, program, regularised=values)).status is Status.FREE
    run.iterates.append(iterate(state, program, regularised=values))
    assert run.best_proven() is None  # a load factor of zero is no answer
    loaded = replace(state, load_factor=1e-3)
    values = RegularisedValues(1e-3, 1e-3, 1e-3, 1e-3) if regularised else None
    assert not run.free(iterate(loaded, program, regularised=values))
    faster = replace(state, velocity=2 * moving)
    values = RegularisedValues(0.0, 0.0, 0.0, 0.0) if regularised else None
    assert not run.free(iterate(faster, program, regularised=values))
    assert not run.free(iterate(state, program, status=Status.STALLED, regularised=values))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_rigid_motion_is_rigid_both_ways(sign):
    """Strain rates of 1 per unit length are flow, those of round-off are not, in any direction."""
    slides, state = sliding()
    assert run_of(slides.program)._rigid(sign * state.velocity)
    assert not run_of()._rigid(sign * STATE.velocity)
    mixed = state.velocity + 1e-9 * np.random.default_rng(0).standard_normal(slides.program.n)
    assert run_of(slides.program)._rigid(sign * mixed)


@pytest.mark.parametrize(
    ("statuses", "solves"),
    [
        ([Status.SOLVED], 1),
        ([Status.UNSAFE, Status.SOLVED], 2),
        ([Status.UNSAFE, Status.UNSAFE], 2),
        ([Status.LOCKED], 1),  # for any friction (T13)
    ],
)
def test_friction_that_carries_too_little_is_raised_once(monkeypatch, statuses, solves):
    """Dead loads fall where friction is too small to carry them; more of it may hold them."""
    d, state = sliding()
    pressures = []

    def solve(kind, contact, program):
        pressures.append(contact.bound.max())
        status = statuses[len(pressures) - 1]
        point = state if status is Status.SOLVED else None
        return SimpleNamespace(inner=SimpleNamespace(status=status, point=point))

    monkeypatch.setattr(certified, "s_step", lambda run, point, reactions: ("S", point))
    found = certified.anchored(SimpleNamespace(program=d.program, solve=solve))
    assert len(pressures) == solves
    assert pressures == sorted(pressures)
    assert pressures[0] > 10 * MU * P0  # generous: far more than the load presses
    if statuses[-1] is Status.SOLVED:
        assert found == ("S", state)
    else:
        assert found.inner.status is statuses[-1]


@pytest.mark.parametrize(
    ("point", "status", "proven", "free", "solves"),
    [
        (False, Status.LOCKED, False, False, 1),
        (True, Status.TIME_LIMIT, False, False, 1),
        (True, Status.ITERATION_LIMIT, False, False, 1),
        (True, Status.SOLVED, True, False, 1),
        (True, Status.SOLVED, False, True, 1),
        (True, Status.SOLVED, False, False, 3),  # the budget
    ],
)
def test_a_fixed_point_loop_ends_with_its_first_answer(point, status, proven, free, solves):
    """Each of these alone ends it: nothing to go on from, no time, a certificate, no power."""
    d, state = sliding()
    own = SimpleNamespace(inner=SimpleNamespace(point=state if point else None, status=status))

    class Loop(SimpleNamespace):
        exhausted = property(lambda own: len(own.iterates) >= 3)

    run = Loop(
        program=d.program,
        iterates=[],
        proven=lambda _: proven,
        free=lambda _: free,
        mapped=lambda *_: None,
        finish=lambda iterate: iterate,
        end=lambda status: status,
    )
    run.solve = lambda *_: run.iterates.append(own) or own
    mixing = SimpleNamespace(step=lambda values, image: image)
    end = fixed_point(run, "K", 0.0, state, mixing)
    assert len(run.iterates) == solves
    assert end is (own if solves == 1 else Status.NOT_CONVERGED)


def test_the_mismatch_is_the_change_of_friction_per_reaction():
    d, state = sliding()
    run = run_of(d.program)
    for share in (0.5, 1.0, 1.5):
        contact = reaction_contact(d.program.contact, share * state.normal_reaction)
        found = run._mismatch(contact, state.normal_reaction)
        assert found == pytest.approx(MU * abs(1 - share), abs=1e-15)


@pytest.mark.parametrize("rate", [0.3, 2.0])
def test_the_contraction_is_how_much_closer_images_are(rate):
    """Of an affine map the slope, whatever its arguments."""
    run, rng = run_of(), np.random.default_rng(0)
    assert np.isnan(run.contraction)
    for _ in range(3):
        argument = rng.uniform(-1, 1, 4)
        run.mapped("K", argument, 1 - rate * argument)
    run.mapped("S", argument, 5 * argument)  # of another map the first
    run.mapped("K", argument * (1 + 1e-9), 7 * argument)  # no change says nothing
    assert run.rates == pytest.approx([rate, rate])
    assert run.contraction == pytest.approx(rate)


def test_friction_is_that_of_what_presses():
    d, state = sliding()
    program = d.program
    pulled = replace(state, normal_reaction=state.normal_reaction - 2 * P0)
    assert friction_of(program, pressing(program, state)) == pytest.approx(MU * P0)
    assert not friction_of(program, pressing(program, pulled)).any()
    assert friction_of(program, generous(program, 7.0)) == pytest.approx(7.0 * MU)


def test_friction_of_another_state_is_taken_in_the_units_of_a_program():
    d, state = sliding()
    scales = Scales(length=2.0, stress=10.0, velocity=0.5)
    program = dimensionless(d.program, scales)
    slip = np.full(program.contact.count, 3.0)
    found = FrictionStart(state.normal_reaction, slip).within(program)
    assert found.normal_reaction == pytest.approx(P0 / 10)
    assert found.slip == pytest.approx(6.0)
    for wrong in (slip[1:], -slip, np.nan * slip):
        with pytest.raises(la.InputError, match="numbers of 0 or more"):
            FrictionStart(slip=wrong).within(program)


def test_powers_of_a_mechanism():
    """2 k of plastic power and p0 of the dead load; mu p0 of friction where it slides."""
    assert kinematic_power(D.program, STATE) == pytest.approx(PLASTIC + P0)
    slides, state = sliding()
    assert kinematic_power(slides.program, state) == pytest.approx(MU * P0)
    smooth = frictionless_contact(slides.program.contact)
    assert kinematic_load_factor(slides.program, state, smooth) == pytest.approx(0.0, abs=1e-12)
    # Per power of the load, however fast.
    faster = replace(STATE, velocity=3 * STATE.velocity)
    assert kinematic_load_factor(D.program, faster, None) == pytest.approx(2 - P0)


def test_pairs_and_who_answered():
    reactions = STATE.normal_reaction.copy()
    other = replace(STATE, velocity=2 * STATE.velocity, normal_reaction=reactions, load_factor=7.0)
    pair = paired(other, STATE)
    assert pair.velocity is other.velocity
    assert pair.load_factor == STATE.load_factor
    one = iterate()
    two = replace(iterate(other), kind="path", step=1)
    final = replace(one, state=pair)
    coupled = run_of()
    coupled.iterates += [one, two]
    assert answered_by(coupled.end(Status.SOLVED, final), "ours") == (
        "lacore (path following) and ours"
    )
    assert answered_by(coupled.end(Status.SOLVED, one), "ours") == "ours"
    assert worst(replace(one, certificate=None)) == np.inf
    assert worst(one) <= 1e-12


def undecided(monkeypatch, status=Status.SOLVED, rates=(), homogeneous=True, frictional=False):
    """The end of a loop that found no certificate, with bounds of 0.5 and 2."""
    worse, better = (
        SimpleNamespace(certificate=SimpleNamespace(worst=("gap", own)), free=False)
        for own in (0.5, 0.1)
    )
    none = SimpleNamespace(certificate=None, free=False)
    least = SimpleNamespace(contact=None, program="least")
    program = SimpleNamespace(
        homogeneous=homogeneous, frictional=frictional, associated=lambda: "associated"
    )
    run = SimpleNamespace(
        program=program,
        iterates=[none, worse, better],
        rates=list(rates),
        options=SimpleNamespace(tolerance=TOLERANCE),
        free=lambda own: own.free,
        solve=lambda kind, contact, program: SimpleNamespace(inner=kind),
        end=lambda status, final, **more: (status, final, more),
    )
    first = SimpleNamespace(inner=SimpleNamespace(status=status))
    monkeypatch.setattr(certified, "upper_bound", lambda *given: 2.0)
    monkeypatch.setattr(certified, "lower_bound", lambda *given: 0.5)
    monkeypatch.setattr(certified, "frictionless", lambda program: least)
    return run, better, lambda: certified._undecided(run, first)


@pytest.mark.parametrize(
    ("status", "rates", "frictional", "expected"),
    [
        (Status.LOCKED, (0.5, 1.2), False, Status.JAM),  # T13: locked, and the map expands
        (Status.LOCKED, (1.0,), False, Status.JAM),
        (Status.LOCKED, (0.5, 0.9), False, Status.NOT_CERTIFIED),
        (Status.LOCKED, (), False, Status.NOT_CERTIFIED),
        (Status.SOLVED, (1.2,), False, Status.NOT_CERTIFIED),
        (Status.LOCKED, (1.2,), True, Status.NOT_CERTIFIED),  # soils may lock and slide
    ],
)
def test_a_loop_without_a_certificate_ends_with_bounds(
    monkeypatch, status, rates, frictional, expected
):
    _, better, end = undecided(monkeypatch, status, rates, frictional=frictional)
    found, final, more = end()
    assert found is expected
    assert final is better  # the least residual
    assert more["bracket"] == (0.5, 2.0)


def test_hardening_has_no_bounds_and_a_free_motion_needs_none(monkeypatch):
    run, better, end = undecided(monkeypatch, homogeneous=False)
    assert end() == (Status.NOT_CERTIFIED, better, {})
    run.iterates[1].free = True
    found, final, _ = end()
    assert found is Status.FREE
    assert final is run.iterates[1]


def from_associated(monkeypatch, status=Status.SOLVED, point="point", proven=False, free=False):
    """A loop whose first answer is given; its only attempt finds nothing."""
    tried = []
    first = SimpleNamespace(inner=SimpleNamespace(status=status, point=point))
    anchor = first
    if status is Status.LOCKED:
        anchor = SimpleNamespace(inner=SimpleNamespace(status=Status.SOLVED, point=point))
    run = SimpleNamespace(
        program=SimpleNamespace(frictional=False),
        solve=lambda *given, **more: first,
        free=lambda own: free,
        proven=lambda own: proven,
        finish=lambda own, findings=(): ("finished", own, findings),
        relax_tolerance=lambda: False,
    )
    frozen = SimpleNamespace(contact=None, program=None)
    monkeypatch.setattr(certified, "associated", lambda program: frozen)
    monkeypatch.setattr(certified, "anchored", lambda run: anchor)
    monkeypatch.setattr(certified, "closest", lambda run, static: static)
    monkeypatch.setattr(certified, "_OF_CONTACT", (lambda run, static: tried.append(static),))
    monkeypatch.setattr(certified, "_undecided", lambda run, first: ("undecided", first, ()))
    return first, anchor, tried, certified._from_associated(run)


@pytest.mark.parametrize(
    ("given", "attempts"),
    [
        ({}, 1),
        ({"status": Status.LOCKED}, 1),  # from the anchor, a state of another friction
        ({"proven": True}, 0),
        ({"point": None}, 0),
        ({"status": Status.TIME_LIMIT}, 0),
        ({"free": True}, 0),
        ({"status": Status.LOCKED, "free": True}, 0),
    ],
    ids=str,
)
def test_a_loop_attempts_nothing_after_an_answer_or_without_a_start(monkeypatch, given, attempts):
    first, anchor, tried, (how, end, findings) = from_associated(monkeypatch, **given)
    assert len(tried) == attempts
    assert how == ("undecided" if attempts else "finished")
    assert end is (first if attempts else anchor)
    assert bool(findings) == given.get("free", False)
