"""Undamped K-steps of soils, on gaps that are made up."""

from types import SimpleNamespace

import numpy as np
import pytest

from lacore.coupling import constants, settling


class Steps:
    """A run whose S-steps leave given gaps, and whose K-steps have a point or none."""

    def __init__(self, monkeypatch, first, gaps, end=None):
        self.program, self.exhausted = None, False
        self.gaps, self.end, self.k, self.s = list(gaps), end, 0, 0
        self.starts = []
        first = [SimpleNamespace(gap=own) for own in first]
        for name, function in {
            "closest": lambda run, static: "closest",
            "s_steps": lambda run: first,
            "gap": lambda step: step.gap,
            "pressing": lambda program, point: np.zeros(1),
            "feasible_k_step": self.k_step,
            "s_step": self.s_step,
            "proves_load": lambda run, step: step.carries,
        }.items():
            monkeypatch.setattr(settling, name, function)

    def step(self, kind, gap=None):
        ends = self.end == (kind, getattr(self, kind))
        point = None if ends and kind == "k" else f"{kind}{getattr(self, kind)}"
        return SimpleNamespace(
            kind=kind, gap=gap, proves=ends, carries=ends, inner=SimpleNamespace(point=point)
        )

    def k_step(self, run, reactions, static, kind):
        self.k += 1
        self.starts.append(static)
        return reactions, self.step("k")

    def s_step(self, run, point, frozen):
        self.s += 1
        return self.step("s", self.gaps.pop(0))

    def free(self, step):
        return False

    def proven(self, step):
        return step.proves


BATCH = settling._BATCH


@pytest.mark.parametrize(
    ("first", "gaps", "checks"),
    [
        ([4.0, 2.0], [2.0], 1),  # the gap does not fall below that before
        ([2.0], [1.0, 0.5, 0.4], 3),  # it halves twice, and then does not
        ([2.0], [1.1], 1),
        ([], [1.0], 1),
    ],
)
def test_undamped_steps_continue_while_the_gap_halves(monkeypatch, first, gaps, checks):
    """From one check to the next, each after a batch of steps; otherwise nothing is found."""
    run = Steps(monkeypatch, first, gaps)
    assert settling._hurried(run, "static") is None
    assert run.s == checks
    assert run.k == checks * BATCH
    assert run.starts[:BATCH] == ["closest"] * BATCH
    if checks > 1:
        assert run.starts[BATCH] == "s1"


@pytest.mark.parametrize(("end", "k", "s"), [(("k", 3), 3, 0), (("s", 1), BATCH, 1)])
def test_a_step_that_proves_is_the_answer(monkeypatch, end, k, s):
    run = Steps(monkeypatch, [2.0], [1.0, 0.5], end)
    assert settling._hurried(run, "static").kind == end[0]
    assert (run.k, run.s) == (k, s)


@pytest.mark.parametrize("end", [("k", 2), ("s", 1)])
def test_a_step_that_carries_nothing_ends_without_an_answer(monkeypatch, end):
    run = Steps(monkeypatch, [2.0], [1.0, 0.5], end)
    monkeypatch.setattr(settling, "proves_load", lambda run, step: False)
    assert settling._hurried(run, "static") is None
    assert run.s == (end[0] == "s")


def test_an_exhausted_run_ends(monkeypatch):
    run = Steps(monkeypatch, [2.0], [])
    run.exhausted = True
    assert settling._hurried(run, "static") is None
    assert run.k == 1


def drifting(monkeypatch, end=None):
    """A drift whose K- and S-steps are noted; what comes after it is ``after``."""
    run = Steps(monkeypatch, [2.0], [1.0] * 9, end)
    run.kinds, run.frozen = [], []
    plain = run.k_step

    def k_step(own, reactions, static, kind):
        run.kinds.append(kind)
        run.frozen.append(float(reactions[0]))
        return plain(own, reactions, static, kind)

    monkeypatch.setattr(settling, "feasible_k_step", k_step)
    # Each point presses as much as its number says.
    monkeypatch.setattr(
        settling, "pressing", lambda program, point: np.array([float(point[1:] or 0)])
    )
    monkeypatch.setattr(settling, "settled", lambda own, static: ("after", static))
    return run, settling._hurried, settling.drifted(run, "s")


def test_a_drift_takes_all_of_its_steps_and_then_settles(monkeypatch):
    """Undamped steps first, then damped ones; S-steps check now and then, and give the state."""
    run, _, found = drifting(monkeypatch)
    assert found == ("after", f"s{len(settling._PAIRED)}")
    assert run.kinds == ["K"] * settling._UNDAMPED + ["damped K"] * (
        settling._DRIFT - settling._UNDAMPED
    )
    assert run.s == len(settling._PAIRED)
    changes = [i + 1 for i in range(1, settling._DRIFT) if run.starts[i] != run.starts[i - 1]]
    assert changes == [look + 1 for look in settling._PAIRED if look < settling._DRIFT]


def test_undamped_steps_freeze_the_last_reactions_and_damped_ones_half_of_the_change(monkeypatch):
    run, *_ = drifting(monkeypatch)
    undamped = settling._UNDAMPED
    assert run.frozen[: undamped + 1] == list(map(float, range(undamped + 1)))
    for k in range(undamped + 1, settling._DRIFT):
        last = run.frozen[k - 1]
        assert run.frozen[k] == pytest.approx(last + (k - last) / 2)


@pytest.mark.parametrize(("end", "k", "s"), [(("k", 3), 3, 0), (("s", 1), settling._PAIRED[0], 1)])
def test_a_drift_ends_with_a_step_that_proves(monkeypatch, end, k, s):
    run, _, found = drifting(monkeypatch, end)
    assert found.kind == end[0]
    assert (run.k, run.s) == (k, s)


@pytest.mark.parametrize(("accepted", "most"), [(None, None), (1e-4, 3 + settling._ENOUGH)])
def test_soils_settle_by_s_steps_hurry_and_then_wait(monkeypatch, accepted, most):
    """Each stage follows where the one before finds nothing; solves count from the first one."""
    asked, answers = [], {"first": None, "hurry": None, "last": None}

    def alternate(run, static, kind, patience, blend, most, *falls):
        asked.append((static, patience, most, *falls))
        return answers["first" if falls else "last"]

    monkeypatch.setattr(settling, "alternate", alternate)
    monkeypatch.setattr(settling, "_hurried", lambda run, static: answers["hurry"])
    monkeypatch.setattr(settling, "closest", lambda run, static: "closest")
    run = SimpleNamespace(iterates=[0, 1, 2], options=SimpleNamespace(accepted=accepted))
    assert settling.settled(run, "static") is None
    assert asked == [
        ("static", 0, most, constants.FAST_GAP),
        ("closest", constants.LONG_PATIENCE, most),
    ]
    for stage in ("last", "hurry", "first"):
        answers[stage] = stage
        assert settling.settled(run, "static") == stage
