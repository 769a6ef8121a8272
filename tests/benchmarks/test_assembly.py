"""From a problem to its program, and the elastic solve that everything is measured in."""

import time

import numpy as np
import pytest

import lacore as la
from tests.benchmarks.measuring import direct_solvers, elastic_seconds, solve_elastic

SIZES = [(16, 10), (25, 25), (50, 50), (79, 79), (112, 112)]
IDS = [str(4 * nx * ny) for nx, ny in SIZES]


@pytest.mark.slow
@pytest.mark.parametrize("size", SIZES, ids=IDS)
@pytest.mark.benchmark(group="assembly", timer=time.process_time)
def test_assembly(benchmark, model, size):
    case = model(*size)
    benchmark.pedantic(la.discretise, args=(case.problem,), rounds=3, warmup_rounds=1)
    seconds, elastic = benchmark.stats.stats.min, elastic_seconds(case)
    benchmark.extra_info.update(
        case.size,
        kind="assembly",
        what="assembly",
        seconds=seconds,
        elastic_solves=seconds / elastic,
    )


@pytest.mark.slow
@pytest.mark.parametrize("make", direct_solvers(), ids=lambda make: make.name)
@pytest.mark.parametrize("size", SIZES, ids=IDS)
@pytest.mark.benchmark(group="elastic solve", timer=time.process_time)
def test_elastic_solve(benchmark, model, size, make):
    case = model(*size)
    matrix, load = case.stiffness, case.program.reference_load
    displacement = benchmark.pedantic(
        solve_elastic, setup=lambda: ((make(), matrix, load), {}), rounds=3
    )
    assert np.abs(matrix @ displacement - load).max() < 1e-9
    seconds = benchmark.stats.stats.min
    solver = make()
    solver.factorise(matrix)
    begin = time.process_time()
    solver.factorise(matrix)
    solver.solve(load)
    again = time.process_time() - begin
    solver.close()
    benchmark.extra_info.update(
        case.size,
        kind="elastic",
        what=f"elastic solve, {make.name}",
        seconds=seconds,
        elastic_solves=seconds / elastic_seconds(case),
        again_seconds=again,  # with the same pattern: PARDISO keeps its analysis
    )
