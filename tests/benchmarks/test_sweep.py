"""What a sweep of 200 small runs takes besides its solves: harness, pipes, store."""

import pytest

from lacore_verification.harness.campaigns.run_all import run_all
from lacore_verification.harness.campaigns.sweep import plan
from lacore_verification.harness.store.results import load_results
from lacore_verification.harness.store.store import NAME

SWEEPS = {
    "deformable-block, medium": (["deformable-block"], "mu=0.05:0.95:200", "clarabel", "medium"),
    "prandtl-punch, coarse": (["prandtl-punch:smooth"], "r=0.1:1e-4:200:log", "newton", "coarse"),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", SWEEPS)
@pytest.mark.benchmark(group="sweep")
def test_sweep(benchmark, one_thread, tmp_path, name):
    """No time is asserted: it is the machine's. Runs of one problem share its assembly."""
    cases, vary, backend, mesh = SWEEPS[name]
    runs = plan(cases, [vary], [backend], [mesh])
    outcomes = benchmark.pedantic(run_all, args=(runs, tmp_path / NAME), rounds=1)
    total = benchmark.stats.stats.min
    results = load_results(tmp_path)
    builds = results.drop_duplicates("build_time")["build_time"].sum()
    inside = builds + results["solve_time"].sum()
    benchmark.extra_info.update(
        kind="sweep",
        what=name,
        runs=len(runs),
        seconds=total,
        seconds_a_run=inside / len(runs),
        own_share=1 - inside / total,
    )
    assert len(results) == len(runs) == 200
    assert all(outcome.row.status == "solved" for outcome in outcomes)
    assert 0 < inside < total
