"""Loops on steps that harden: begun from rough solves or from friction nearby, they prove the same.

Pairs are certified to 1e-6 of the power, and their velocities are known to the root of that, with
which bodies harden within the step: by so much of what hardening has of the load may loads differ.
"""

import numpy as np
import pytest

import lacore as la
import lacore.coupling.certified as certified
from lacore.paths.flow import Moment, flow_of, limit_problem
from lacore.paths.stage import staged
from lacore.reporting.errors import InputError
from lacore.solvers.inner.preparing import ROUGH, rough_options
from lacore_backends.clarabel_socp import Clarabel
from tests.lacore.paths.path_billets import billet

BAR = 1e-6
STEEL = la.hardening.Linear(250e6, 250e6)
STAGE = staged(*billet(crossed=True, law=STEEL))
MOMENT = Moment(STAGE.start, STAGE.start, 0.05, 0.5)


@pytest.fixture(scope="module")
def step():
    """The limit problem of a first step whose side comes to the platen."""
    return limit_problem(STAGE, MOMENT)


@pytest.fixture(scope="module")
def cold(step):
    """From the associated state."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(certified, "resumed", lambda *_: None)
        return la.solve(step)


def same(state, other):
    """Certified, and of the same load."""
    assert state.status is la.Status.SOLVED, state.message
    assert state.certificate.holds(BAR)
    hardened = flow_of(other, MOMENT).hardened
    assert 0 < hardened < 0.1 * other.load_factor
    allowed = 2 * (BAR * other.load_factor + np.sqrt(BAR) * hardened)
    assert state.load_factor == pytest.approx(other.load_factor, abs=allowed)


def kinds(state):
    return list(state.history["kind"])


def test_rough_solves_come_first_and_prove_nothing(step, cold):
    state = la.solve(step)
    same(state, cold)
    first = [kind.startswith("rough") for kind in kinds(state)]
    assert first == sorted(first, reverse=True)
    assert any(first)
    assert not any(kind.startswith("rough") for kind in kinds(cold))
    assert kinds(state)[-1] in ("K", "S")
    # Of solves to 1e-10 forces are left to about that, of rough ones to 1e-4.
    assert state.certificate.equilibrium < 1e-7
    assert state.certificate.divergence < 1e-7


@pytest.mark.parametrize("factor", [1.0, 1.001, 0.0, 0.5, 1e3])
def test_where_it_begins_changes_nothing_that_is_proven(step, cold, factor):
    """Not even where nothing presses, or a thousand times too much."""
    reactions = factor * np.maximum(cold.point.normal_reaction, 0.0)
    state = la.solve(step, normal_reaction=reactions)
    same(state, cold)
    assert kinds(state)[0] == "K"
    if factor == 1.0:  # its own reactions: the first pair holds, or its K-step alone
        assert len(kinds(state)) <= 2


@pytest.mark.parametrize("factor", [1.0, 1.2, 0.0, 1e3])
def test_nor_does_the_slip_that_rough_solves_begin_with(step, cold, factor):
    slip = factor * np.linalg.norm(step.full.contact.slip(cold.point.velocity), axis=1)
    state = la.solve(step, slip=slip)
    same(state, cold)
    assert kinds(state)[0] == "rough S"
    assert "rough associated" not in kinds(state)
    if factor == 1.0:  # its own slip: one rough solve, and a pair that holds
        assert len(kinds(state)) <= 3


def test_where_rough_solves_fail_it_begins_as_ever(step, cold, monkeypatch):
    """And the history tells of both."""

    class Fails:
        def solve(self, _contact):
            return la.solvers.backend.InnerSolution(la.Status.FAILED, "broken", 0, 0.0, None)

        def close(self):
            pass

    prepare = Clarabel.prepare

    def failing(self, program, options):
        return Fails() if options.tolerance == ROUGH else prepare(self, program, options)

    monkeypatch.setattr(Clarabel, "prepare", failing)
    state = la.solve(step, "clarabel")
    same(state, cold)
    assert kinds(state)[:2] == ["rough associated", "associated"]


def test_what_is_judged_is_solved_as_tightly_as_asked_for(step, monkeypatch):
    """Rough are the first solves, and no others."""
    asked = []

    prepare = Clarabel.prepare

    def spying(self, program, options):
        solver = prepare(self, program, options)
        solve = solver.solve
        solver.solve = lambda contact: asked.append(options.tolerance) or solve(contact)
        return solver

    monkeypatch.setattr(Clarabel, "prepare", spying)
    state = la.solve(step, "clarabel", options={"tolerance": 1e-9})
    loose = [kind.startswith("rough") for kind in kinds(state)]
    assert asked == [ROUGH if rough else 1e-9 for rough in loose]


def test_a_moment_begins_where_the_one_before_in_its_step_ended():
    """So it is in a state that is solved again, and in a file; steps begin without."""
    problem, approaching = billet()
    path = la.sequential(problem, 0.05, 1, "implicit-euler", approaching=approaching)
    normal_reaction, state = path.snapshot(1).moment.friction_start.normal_reaction, path.state(1)
    assert kinds(state)[0] == "K"
    # The last two iterates of a step have the same velocity to 1e-5 of the body.
    reactions = state.point.normal_reaction
    assert normal_reaction == pytest.approx(reactions, abs=0.01 * reactions.max())


def test_a_step_begins_at_the_slip_of_the_one_before():
    """So does a state that is solved again, and of the first step there is none."""
    problem, _ = billet()
    path = la.sequential(problem, 0.15, 3)
    first, second = (path.snapshot(step).moment.friction_start for step in (1, 2))
    assert first.slip is second.normal_reaction is None
    state = path.state(2)
    assert kinds(state)[0] == "rough S"
    d, u = state.discretisation, np.zeros(state.discretisation.full.n)
    for name, dofs in d.continua.items():
        u[dofs.dofs] = path.snapshot(1).velocity[name]
    slip = np.linalg.norm(d.full.contact.slip(u), axis=1)
    assert second.slip == pytest.approx(slip, rel=1e-12)
    assert slip.max() > 0


def test_what_does_not_harden_begins_as_ever(monkeypatch):
    """There the pair of the first K-step and the associated state may hold: it is to be sharp."""
    monkeypatch.setattr(certified, "resumed", None)
    problem, _ = billet(law=la.hardening.Perfect(1.0))
    assert kinds(la.solve(problem))[0] == "associated"


@pytest.mark.parametrize("name", ["normal_reaction", "slip"])
@pytest.mark.parametrize("wrong", [np.zeros(3), [-1.0], [np.nan]])
def test_friction_of_other_points_is_refused(step, wrong, name):
    count = step.program.contact.count
    given = np.resize(wrong, count) if len(wrong) == 1 else wrong
    with pytest.raises(InputError, match=f"{name}: are not {count} numbers of 0 or more"):
        la.solve(step, **{name: given})


def test_rough_is_no_tighter_than_what_was_asked_for():
    """By the gap that a backend leaves, as elsewhere."""
    for name, expected in (("clarabel", ROUGH), ("auto", ROUGH * la.solvers.backend.TRUE_GAP)):
        backend = la.find_backend(name)
        assert rough_options(backend, backend.Options()).tolerance == expected
        assert rough_options(backend, backend.Options(tolerance=0.1)).tolerance == 0.1
        assert rough_options(backend, backend.Options(time_limit=7.0)).time_limit == 7.0
    assert rough_options(la.find_backend("clarabel"), None) is None
