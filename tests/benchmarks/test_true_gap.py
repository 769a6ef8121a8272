"""Upper bounds of the smooth punch at the same true gap: time, memory and how both grow.

What solvers call a tolerance differs by a factor of a hundred. So each is asked for tighter ones
until the certificate of its answer, computed anew, is within the gap; the last solve counts. Each
runs in a process of its own. No time is asserted: machines differ.
"""

import pytest

import lacore as la
from lacore.program.certificate import certify
from lacore.solvers.backend import load_backend
from tests.benchmarks.measuring import Clocked, dear, elastic_seconds
from tests.benchmarks.test_assembly import SIZES

GAP = 1e-5
LIMIT = 120.0  # s
TRIED = {  # tolerances: the first leaves so much on 10 000 unknowns
    "interior_point": (1e-5, 3e-6, 1e-6),
    "clarabel": (1e-7, 3e-8, 1e-8),
    "cvxpy": (1e-8, 3e-9, 1e-9),
    "cvxpy:QOCO": (1e-5, 3e-6, 1e-6),
    "cvxpy:ECOS": (1e-5, 3e-6, 1e-6),
}
RUNS = [
    *[(name, size) for name in ("interior_point", "clarabel") for size in SIZES],
    *[("cvxpy", size) for size in (*SIZES[:3], SIZES[-1])],
    *[("cvxpy:ECOS", size) for size in SIZES[:3]],
    *[("cvxpy:QOCO", size) for size in SIZES[:2]],
]
"""Peers as far as they go: QOCO ends without an answer on 10 000 triangles."""
DEAR = [("cvxpy", SIZES[-1])]


def label(run):
    name, (nx, ny) = run
    return f"{name}-{4 * nx * ny}".replace(":", "-")


@pytest.mark.slow
@pytest.mark.parametrize("run", dear(RUNS, DEAR), ids=label)
@pytest.mark.benchmark(group="true gap")
def test_true_gap(benchmark, model, run):
    name, size = run
    case, tiny, backend = model(*size), model(2, 2), load_backend(name)
    if reason := backend.unavailable():
        pytest.skip(reason)

    def closest():
        for tolerance in TRIED[name]:
            settings = backend.Options(tolerance=tolerance, time_limit=LIMIT)
            with la.SolverProcess() as process:
                # Imports and libraries are loaded by a solve of no account.
                process.prepare(Clocked(backend), tiny.program, settings).solve(tiny.contact)
                solver = process.prepare(Clocked(backend), case.program, settings)
                answer = solver.solve(case.contact)
            if answer.point is None and name.startswith("cvxpy"):
                pytest.skip(f"{answer.native_status}: {answer.message}")
            certificate = certify(case.program, answer.point, case.contact)
            if max(certificate.flow, certificate.gap) <= GAP:
                break
        return tolerance, answer, certificate

    before = elastic_seconds(case)
    tolerance, answer, certificate = benchmark.pedantic(closest, rounds=1)
    elastic = min(before, elastic_seconds(case))
    benchmark.extra_info.update(
        case.size,
        kind="true gap",
        what=name,
        tolerance=tolerance,
        gap=max(certificate.flow, certificate.gap),
        doubt=certificate.load,
        seconds=answer.solve_time,
        elastic_solves=answer.solve_time / elastic,
        elastic_seconds=elastic,
        iterations=answer.iterations,
        memory_mb=answer.peak_memory,
        load_factor=float(answer.point.load_factor),
    )
    assert max(certificate.flow, certificate.gap) <= GAP
    assert certificate.divergence <= GAP  # else it would be no upper bound
