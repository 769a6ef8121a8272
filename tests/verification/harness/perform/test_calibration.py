"""The short solve that measures the noise of a machine."""

from math import isnan

from lacore_verification.harness.perform import worker


class Clock:
    """Time that passes where a test says so, and in each solve."""

    def __init__(self):
        self.now = 0.0

    def perf_counter(self):
        return self.now


def test_it_takes_little_of_the_time_of_a_comparison(monkeypatch):
    clock = Clock()
    monkeypatch.setattr(worker, "time", clock)

    def solve():
        clock.now += 0.02

    monkeypatch.setattr(worker, "_prepared", lambda: solve)
    own = worker.Calibration()
    spent = []
    while clock.now < 60.0:
        before = clock.now
        own.seconds()
        spent.append(clock.now - before)
        clock.now += 0.1  # a run
    assert spent[0] == 0.04  # the first one is not measured
    assert sum(own > 0 for own in spent) > 10
    assert sum(spent) < 0.02 * clock.now


def test_it_is_measured_at_once_and_not_again_at_once():
    own = worker.Calibration()
    assert own.seconds() > 0
    assert isnan(own.seconds())
