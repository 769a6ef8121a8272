"""The certified loop on masonry walls: in units of one associated solve of the same wall.

No time is asserted: machines differ. Statuses are, and the independent check of small walls is
elsewhere.
"""

import json
import subprocess
import sys
import time

import pytest

import lacore as la
from lacore.solvers.backend import load_backend

SCRIPT = """
import json, sys, time
import lacore as la
from lacore.solvers.child_process import forget_peak_memory, peak_memory
from tests.benchmarks.test_walls import wall_of

wide, courses, every, tolerance = json.loads(sys.argv[1])

def solve(of, coupling):
    begin = time.process_time()
    state = la.solve(of, coupling=coupling, tolerance=tolerance)
    return state, time.process_time() - begin

solve(wall_of(4, 4, every), "certified")  # what is loaded by then is no part of the wall
wall = la.discretise(wall_of(wide, courses, every))
forget_peak_memory()
before = peak_memory()
state, seconds = solve(wall, "certified")
above = peak_memory() - before
associated = min(solve(wall, "associated")[1] for _ in range(3))
certificate = state.certificate
print(json.dumps({
    "blocks": wall.n_elements - 1,
    "joints": wall.full.contact.count // 2,
    "unknowns": wall.program.n,
    "seconds": seconds,
    "associated_seconds": associated,
    "ratio": seconds / associated,
    "solves": len(state.history),
    "gap": max(certificate.gap, certificate.slip),
    "memory_mb": above,
    "status": state.status.label,
    "load_factor": state.load_factor,
}))
"""
MU = 0.65  # of all joints
WALLS = {  # blocks wide, courses, a window every so many blocks, bar of the certificate
    "55": (5, 11, 5, 1e-6),
    "1 000": (40, 25, 8, 1e-6),
    "1 000, 50 courses": (20, 50, 6, 1e-6),
    "1 000, 100 courses": (10, 100, 5, 1e-6),
    "2 000": (50, 40, 6, 1e-6),
    "2 000, 50 courses": (40, 50, 6, 1e-6),
    "2 000, 100 courses": (20, 100, 6, 1e-6),
    "5 000": (125, 40, 8, 1e-6),
    "5 000, 50 courses": (100, 50, 8, 1e-5),
    "5 000, 100 courses": (50, 100, 8, 1e-5),
}
BARS = {"1 000": (2, None), "5 000": (100, 60)}  # s: a bar, and an aim
DEAR = "5 000, 100 courses"  # minutes
PEERS = ("clarabel", "highs", "cvxpy", "cvxpy:QOCO", "cvxpy:ECOS")


def wall_of(wide, courses, every):
    """Of running bond with windows, pushed sideways."""
    rows = la.masonry.regular_bond(wide, courses, la.masonry.windows(wide, courses, every))
    return la.Problem(
        {"wall": la.masonry.running_bond(rows, friction=MU)},
        [la.BodyForce("wall", (1, 0))],
        [la.Fix("wall", "base")],
        dead_loads=[la.BodyForce("wall", (0, -1))],
    )


@pytest.mark.slow
@pytest.mark.parametrize("name", [*WALLS][:-1])
@pytest.mark.benchmark(group="walls")
def test_wall(benchmark, one_thread, name):
    """In a process of its own, whose peak memory is that of this wall."""
    assert measured(benchmark, name)["status"] == "solved"


@pytest.mark.dear
@pytest.mark.slow
@pytest.mark.benchmark(group="walls")
def test_dear_wall(benchmark, one_thread):
    """The longest path, and steps from a place on it that stall near the bar."""
    assert measured(benchmark, DEAR)["status"] == "solved"


def measured(benchmark, name):
    wide, courses, every, tolerance = WALLS[name]
    given = json.dumps([wide, courses, every, tolerance])

    def run():
        command = [sys.executable, "-c", SCRIPT, given]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout

    found = json.loads(benchmark.pedantic(run, rounds=1))
    bar, aim = BARS.get(name, (None, None))
    benchmark.extra_info.update(
        found,
        kind="wall",
        what=f"wall of {name}",
        courses=courses,
        tolerance=tolerance,
        bar=bar,
        aim=aim,
    )
    return found


@pytest.mark.slow
@pytest.mark.benchmark(group="walls")
def test_peers(benchmark, one_thread, in_this_process):
    """A wall by each backend, in one run, so that ratios count."""
    wide, courses, every, tolerance = WALLS["1 000"]
    small, wall = (la.discretise(wall_of(*size)) for size in ((4, 4, 5), (wide, courses, every)))

    def timed(of, backend, coupling):
        begin = time.process_time()
        state = la.solve(of, backend=backend, coupling=coupling, tolerance=tolerance)
        return state, time.process_time() - begin

    def each():
        found = {}
        for backend in (name for name in PEERS if not load_backend(name).unavailable()):
            timed(small, backend, "certified")  # imports and libraries
            once, certified = (timed(wall, backend, how) for how in ("associated", "certified"))
            found[backend] = once, certified
        return found

    found = benchmark.pedantic(each, rounds=1)
    least = found["clarabel"][1][1]
    benchmark.extra_info.update(
        kind="wall peers",
        what="wall of 1 000",
        runs=[
            {
                "backend": backend,
                "associated": once,
                "seconds": seconds,
                "solves": len(state.history),
                "residual": state.certificate.worst[1],
                "ratio": seconds / least,
            }
            for backend, ((_, once), (state, seconds)) in found.items()
        ],
    )
    assert found["clarabel"][1][0].status is la.Status.SOLVED
