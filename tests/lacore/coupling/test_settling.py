"""Undamped K-steps of soils, on gaps that are made up."""

from types import SimpleNamespace

import numpy as np
import pytest

from lacore.coupling import settling


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
