"""K- and S-steps of a loop, on gaps and points that are made up."""

from types import SimpleNamespace

import numpy as np
import pytest

from lacore.coupling import steps
from lacore.coupling.steps import alternate, closest, least_gap, mean, s_steps, vanishes
from lacore.reporting.status import Status

ROWS = 3


def point(load_factor=1.0, pressed=1.0):
    return SimpleNamespace(load_factor=load_factor, normal_reaction=np.full(ROWS, pressed))


class Loop:
    """A run whose S-steps leave given gaps; `ends` is what its step with a number is."""

    def __init__(self, monkeypatch, gaps=(), ends=None, loads=None, dead=1.0, budget=99):
        self.program = SimpleNamespace(dead_load=np.full(2, dead))
        self.gaps, self.ends, self.budget = list(gaps), ends or {}, budget
        self.loads = list(loads or [])
        self.iterates, self.statics, self.frozen, self.noted = [], [], [], []
        monkeypatch.setattr(steps, "pressing", lambda program, own: own.normal_reaction)
        monkeypatch.setattr(steps, "feasible_k_step", self.k_step)
        monkeypatch.setattr(steps, "s_step", self.s_step)

    @property
    def exhausted(self):
        return len(self.iterates) >= self.budget

    def step(self, kind, gap, load_factor):
        kinds = [own.kind for own in self.iterates]
        what = self.ends.get((kind, kinds.count(kind) + 1), "")
        own = None if what == "none" else point(load_factor, len(self.iterates) + 1.0)
        certificate = None if gap is None else SimpleNamespace(gap=gap)
        iterate = SimpleNamespace(
            kind=kind, what=what, certificate=certificate, inner=SimpleNamespace(point=own)
        )
        self.iterates.append(iterate)
        return iterate

    def k_step(self, run, reactions, static, kind):
        self.statics.append(static)
        self.frozen.append(float(reactions[0]))
        return reactions, self.step(kind, None, 1.0)

    def s_step(self, run, kinematic, reactions):
        return self.step("S", self.gaps.pop(0), self.loads.pop(0) if self.loads else 1.0)

    def free(self, iterate):
        return iterate.what == "free"

    def proven(self, iterate):
        return iterate.what == "proven"

    def alternated(self, patience=0, blend=steps.static_alone, **more):
        return alternate(self, point(), "K", patience, blend, **more)

    def count(self, kind):
        return sum(own.kind == kind for own in self.iterates)


@pytest.mark.parametrize(
    ("patience", "gaps", "rounds"),
    [
        (0, [1.0, 0.5, 0.5], 3),  # 0.5 is no progress after 0.5
        (1, [1.0, 0.5, 0.5, 0.6], 4),
        (1, [1.0, 0.5, 0.5, 0.4, 0.4, 0.4], 6),  # progress forgives a stall
        (0, [1.0, 0.91], 2),  # less than a tenth
        (2, [1.0, 2.0, 1.5, 0.95], 4),  # compared with the least gap, not with the last
    ],
)
def test_a_loop_ends_after_stalls_in_a_row(monkeypatch, patience, gaps, rounds):
    run = Loop(monkeypatch, gaps)
    assert run.alternated(patience) is None
    assert run.count("S") == run.count("K") == rounds


def test_a_fast_loop_asks_for_more_progress(monkeypatch):
    run = Loop(monkeypatch, [1.0, 0.5])
    assert run.alternated(falls=0.4) is None
    assert run.count("S") == 2


@pytest.mark.parametrize("most", [2, 4])
def test_a_loop_has_so_many_solves(monkeypatch, most):
    run = Loop(monkeypatch, [1.0, 0.5, 0.2, 0.1])
    assert run.alternated(most=most) is None
    assert len(run.iterates) == most
    spent = Loop(monkeypatch, [1.0, 0.5, 0.2, 0.1], budget=most)
    assert spent.alternated() is None
    assert len(spent.iterates) == most


@pytest.mark.parametrize("kind", ["K", "S"])
@pytest.mark.parametrize("what", ["none", "free", "proven"])
def test_a_step_without_a_state_or_with_a_proof_ends_the_loop(monkeypatch, kind, what):
    """Only a proven one is the answer."""
    run = Loop(monkeypatch, [1.0, 0.5, 0.2], {(kind, 2): what})
    found = run.alternated()
    assert (found is not None) == (what == "proven")
    assert found is None or found is run.iterates[-1]
    assert (run.count("K"), run.count("S")) == ((2, 1) if kind == "K" else (2, 2))


def test_each_round_starts_from_the_state_of_the_one_before(monkeypatch):
    """What the next K-step freezes is blended from the reactions of both steps."""
    run = Loop(monkeypatch, [1.0, 0.5, 0.2, 0.2])
    run.alternated(blend=mean)
    states = [own.inner.point for own in run.iterates if own.kind == "S"]
    assert run.statics[1:] == states[:-1]
    assert run.frozen == [1.0, 1.5, 3.5, 5.5]  # steps press by their numbers
    alone = Loop(monkeypatch, [1.0, 0.5, 0.2, 0.2])
    alone.alternated()
    assert alone.frozen == [1.0, 2.0, 4.0, 6.0]


@pytest.mark.parametrize(
    ("dead", "load", "gone"),
    [(0.0, 1e-7, True), (0.0, -1e-7, True), (0.0, 1e-5, False), (1.0, 1e-7, False)],
)
def test_reactions_that_vanish_end_a_loop_without_dead_loads(monkeypatch, dead, load, gone):
    """Zero is a state of weightless contact: relative to the associated load factor."""
    run = Loop(monkeypatch, [1.0, 0.5, 0.5], loads=[1.0, load, load], dead=dead)
    assert run.alternated() is None
    assert run.count("S") == (2 if gone else 3)
    assert vanishes(run, point(load)) == gone
    run.iterates[0].inner.point = None
    assert not vanishes(run, point(0.0))


def test_the_closest_state_is_that_of_the_least_gap(monkeypatch):
    """Of S-steps that carry a load; without any it is the given one."""
    run = Loop(monkeypatch, [1.0, 0.2, 0.5, 0.0], {("S", 4): "none"}, loads=[1.0, 2.0, 1.0])
    given = point(9.0)
    assert closest(run, given) is given
    assert least_gap(run) == np.inf
    run.alternated(1)
    assert [own.kind for own in s_steps(run)] == ["S"] * 3
    assert closest(run, given).load_factor == 2.0
    assert least_gap(run) == 0.2
    run.iterates[3].certificate = None
    assert len(s_steps(run)) == 2
    assert least_gap(run) == 0.5


def resumed(monkeypatch, ends, gaps=(0.5, 0.5), start=2.0):
    """A loop from friction nearby: the first K-step freezes it."""
    run = Loop(monkeypatch, gaps, ends)
    reactions = None if start is None else np.full(ROWS, start)
    run.friction_start = SimpleNamespace(normal_reaction=reactions, slip="slip")
    monkeypatch.setattr(
        steps, "k_step", lambda run, r, static, kind: run.k_step(run, r, 0, kind)[1]
    )
    return run, steps.resumed(run, steps.static_alone, 0)


@pytest.mark.parametrize("kind", ["K", "S"])
@pytest.mark.parametrize("what", ["none", "free", "proven"])
def test_a_resumed_loop_ends_with_its_first_pair(monkeypatch, kind, what):
    run, found = resumed(monkeypatch, {(kind, 1): what})
    assert (found is not None) == (what == "proven")
    assert (run.count("K"), run.count("S")) == ((1, 0) if kind == "K" else (1, 1))
    assert run.frozen == [2.0]


def test_a_resumed_loop_alternates_for_a_few_solves(monkeypatch):
    run, found = resumed(monkeypatch, {}, [0.5**k for k in range(20)])
    assert found is None
    assert len(run.iterates) == steps._SOON
    run, found = resumed(monkeypatch, {("S", 2): "proven"})
    assert found is run.iterates[-1]


def test_without_reactions_a_loop_starts_from_what_rough_solves_find(monkeypatch):
    """Or not at all."""
    monkeypatch.setattr(steps, "_found_roughly", lambda run, slip: None)
    run, found = resumed(monkeypatch, {}, start=None)
    assert found is None
    assert not run.iterates
    monkeypatch.setattr(steps, "_found_roughly", lambda run, slip: np.full(ROWS, 7.0))
    run, _ = resumed(monkeypatch, {("K", 1): "proven"}, start=None)
    assert run.frozen == [7.0]


class Rough:
    """A run of rough solves, which leave given gaps; None: no point."""

    def __init__(self, monkeypatch, gaps):
        self.gaps, self.kinds, self.closed = list(gaps), [], 0
        self.program = SimpleNamespace(
            contact=SimpleNamespace(slip=lambda velocity: np.full((ROWS, 1), velocity))
        )
        self.prepare_roughly = lambda program: self
        monkeypatch.setattr(steps, "associated_contact", lambda rows: "associated")
        monkeypatch.setattr(steps, "shift_contact", lambda rows, slip: float(slip[0]))
        monkeypatch.setattr(steps, "pressing", lambda program, own: own.normal_reaction)

    def close(self):
        self.closed += 1

    def solve(self, kind, contact, solver):
        gap = self.gaps.pop(0)
        self.kinds.append((kind, contact))
        number = len(self.kinds)
        own = None if gap is None else point(1.0, float(number))
        if own is not None:
            own.velocity = 10.0 * number
            own.normal_reaction[0] = 1e-4 * number
        inner = SimpleNamespace(point=own)
        return SimpleNamespace(inner=inner, certificate=gap and SimpleNamespace(gap=gap))


@pytest.mark.parametrize(
    ("slip", "gaps", "kinds"),
    [
        (None, [1.0, 0.5, 0.005], [("rough associated", "associated"), 10.0, 20.0]),
        (np.full(ROWS, 3.0), [0.005], [("rough S", 3.0)]),
        (None, [1.0] * 9, [("rough associated", "associated"), 10.0, 20.0, 30.0]),
    ],
)
def test_rough_solves_follow_the_slip_until_the_gap_is_small(monkeypatch, slip, gaps, kinds):
    """At most three after the first one; reactions that are noise are none."""
    run = Rough(monkeypatch, gaps)
    found = steps._found_roughly(run, slip)
    assert run.kinds == [own if isinstance(own, tuple) else ("rough S", own) for own in kinds]
    assert run.closed == 1
    assert found.tolist() == [0.0] + [float(len(kinds))] * (ROWS - 1)


@pytest.mark.parametrize("gaps", [[None], [1.0, None]])
def test_rough_solves_without_a_point_find_nothing(monkeypatch, gaps):
    assert steps._found_roughly(Rough(monkeypatch, gaps), None) is None


@pytest.mark.parametrize(
    ("statuses", "frozen"),
    [
        ([Status.SOLVED], [1.0, 4.0, 1.0]),
        ([Status.UNSAFE, Status.SOLVED], [2.0, 4.0, 2.0]),
        ([Status.LOCKED], [1.0, 4.0, 1.0]),
    ],
)
def test_a_step_that_would_collapse_freezes_what_an_admissible_state_needs(
    monkeypatch, statuses, frozen
):
    """The larger of both reactions at each point, and only then."""
    left = list(statuses)

    def step(run, reactions, static, kind):
        return SimpleNamespace(inner=SimpleNamespace(status=left.pop(0)))

    monkeypatch.setattr(steps, "k_step", step)
    monkeypatch.setattr(steps, "pressing", lambda program, own: own.normal_reaction)
    run, given = SimpleNamespace(program=None), np.array([1.0, 4.0, 1.0])
    found, last = steps.feasible_k_step(run, given, point(pressed=2.0), "K")
    assert found.tolist() == frozen
    assert last.inner.status is statuses[-1]
    assert not left
