"""A path of large deformation with friction: a billet is pressed to half of its height.

No time is asserted: machines differ. Before are the figures of the loop that began each step at the
associated state, all solves to 1e-10 and all rows times their weights, on the machine of the page
and in the same minutes, when it was busy: what counts is the ratio.
"""

import time

import pytest

import lacore as la
from tests.benchmarks.measuring import Model, elastic_seconds

STEPS, TRAVEL, MU = 40, 0.25, 0.2
BAR = 25.0  # s
PEERS, FIRST = ("clarabel", "cvxpy", "cvxpy:QOCO"), 4  # steps of each
"""ECOS takes no hardening."""
BEFORE = {"before": 55.3, "before_iterations": 4878, "before_solves": 206}
PLATEN = la.RigidObstacle((0, 0.5), (0, -1))


def billet():
    """A quarter in 800 triangles, finer towards the edge; its side folds onto the platen."""
    mesh = la.meshes.rectangle((0, 1), (0, 0.5), 20, 10, grade_x=(1.0, 3.0), grade_y=(0.5, 3.0))
    steel = la.VonMises(hardening=la.hardening.Linear(1.0, 1.0))
    return la.Problem(
        bodies={"billet": la.Body(mesh, steel, space="p2-gauss")},
        supports=[la.Fix("billet", "left", "x")],
        interfaces=[la.Interface(("billet", "top"), PLATEN, MU)],
        reference_loads=[la.RigidFooting("billet", "bottom", (0, 1), rough=False)],
    )


@pytest.mark.slow
@pytest.mark.benchmark(group="paths", timer=time.process_time)
def test_path(benchmark, one_thread):
    problem = billet()
    folds = la.Interface(("billet", "right"), PLATEN, MU)
    path = benchmark.pedantic(
        la.sequential, (problem, TRAVEL, STEPS), {"approaching": [folds]}, rounds=1
    )
    seconds = benchmark.stats.stats.min
    given = la.discretise(problem)
    begin = time.process_time()
    la.solve(given, coupling="associated")
    associated = time.process_time() - begin
    benchmark.extra_info.update(
        BEFORE,
        kind="path",
        what=f"billet, mu = {MU}, H = 1",
        triangles=problem.bodies["billet"].mesh.nelements,
        unknowns=given.program.n,
        steps=STEPS,
        seconds=seconds,
        bar=BAR,
        elastic_solves=seconds / elastic_seconds(Model(problem)),
        associated_seconds=associated,
        ratio=seconds / associated,
        solves=int(path.history["solves"].sum()),
        gap=float(path.history["gap"].max()),
        load_factor=float(path.history["load_factor"].iloc[-1]),
    )
    assert str(path).endswith("reached: the requested travel is reached")
    assert len(path.history) == STEPS


@pytest.mark.slow
@pytest.mark.benchmark(group="paths")
def test_peers(benchmark, one_thread, in_this_process):
    """The first steps by each backend, in one run, so that ratios count."""
    problem = billet()
    folds = la.Interface(("billet", "right"), PLATEN, MU)

    def each():
        found = {}
        for backend in PEERS:
            la.solve(problem, backend=backend, coupling="associated")  # imports and libraries
            begin = time.process_time()
            path = la.sequential(
                problem, TRAVEL * FIRST / STEPS, FIRST, approaching=[folds], backend=backend
            )
            found[backend] = path.history, time.process_time() - begin
        return found

    found = benchmark.pedantic(each, rounds=1)
    least = found["clarabel"][1]
    benchmark.extra_info.update(
        kind="path peers",
        what=f"the first {FIRST} steps of that billet",
        runs=[
            {
                "backend": backend,
                "steps": len(history),
                "solves": int(history["solves"].sum()),
                "gap": float(history["gap"].max()),
                "seconds": seconds,
                "ratio": seconds / least,
            }
            for backend, (history, seconds) in found.items()
        ],
    )
    assert len(found["clarabel"][0]) == FIRST
