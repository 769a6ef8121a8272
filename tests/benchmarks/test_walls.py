"""The certified loop on masonry walls: in units of one associated solve of the same wall.

No time is asserted: machines differ. Statuses are, and the independent check of small walls is
elsewhere.
"""

import json
import subprocess
import sys

import pytest

SCRIPT = """
import json, resource, sys, time
import lacore as la

wide, courses, every, mu, tolerance = json.loads(sys.argv[1])

def problem(wide, courses):
    rows = la.masonry.regular_bond(wide, courses, la.masonry.windows(wide, courses, every))
    return la.Problem(
        {"wall": la.masonry.running_bond(rows, friction=mu)},
        [la.BodyForce("wall", (1, 0))],
        [la.Fix("wall", "base")],
        dead_loads=[la.BodyForce("wall", (0, -1))],
    )

def solve(of, coupling):
    begin = time.process_time()
    state = la.solve(of, coupling=coupling, tolerance=tolerance)
    return state, time.process_time() - begin

def peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024

solve(problem(4, 4), "certified")  # what is loaded by then is no part of the wall
wall = la.discretise(problem(wide, courses))
before = peak()
state, seconds = solve(wall, "certified")
above = peak() - before
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
MU = 0.65
WALLS = {  # blocks wide, courses, a window every so many blocks, bar of the certificate
    "55": (5, 11, 5, 1e-6),
    "1 000": (40, 25, 8, 1e-6),
    "1 000, tall": (20, 50, 6, 1e-6),
    "1 000, 100 courses": (10, 100, 5, 1e-6),
    "2 000": (50, 40, 6, 1e-6),
    "2 000, tall": (40, 50, 6, 1e-6),
    "2 000, 100 courses": (20, 100, 6, 1e-6),
    "5 000": (125, 40, 8, 1e-6),
    "5 000, tall": (100, 50, 8, 1e-5),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", WALLS)
@pytest.mark.benchmark(group="walls")
def test_wall(benchmark, one_thread, name):
    """In a process of its own, whose peak memory is that of this wall."""
    wide, courses, every, tolerance = WALLS[name]
    given = json.dumps([wide, courses, every, MU, tolerance])

    def run():
        command = [sys.executable, "-c", SCRIPT, given]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout

    found = json.loads(benchmark.pedantic(run, rounds=1))
    benchmark.extra_info.update(found, kind="wall", what=f"wall of {name}", tolerance=tolerance)
    assert found["status"] == "solved", found
