"""Hypothesis is derandomised: the same examples at each run, on each machine."""

from hypothesis import HealthCheck, settings

settings.register_profile(
    "lacore",
    derandomize=True,
    deadline=None,
    max_examples=40,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("lacore")
