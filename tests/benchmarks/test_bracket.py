"""Brackets with proof to a width: all solves, refinement and projection included.

Processor time of one bound at a time, and time by the clock of two. Neither is asserted: machines
differ. Widths, sizes, sides and the gap identity are, and that both runs find the same.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import pytest
from skfem import MeshTri

import lacore as la
from lacore.bounds.bracket.bracket import width
from lacore.numerics.symmetric import symmetric_solver
from lacore.solvers.backend import load_backend
from lacore_verification.catalogue.catalogue import find
from tests.benchmarks.measuring import Model, dear, elastic_seconds, punch

SOIL = la.VonMises(shear_strength=1.0)
PRANDTL = 2 + np.pi
CUT = (3.77, 3.78)  # gamma H/k (Pastor, Thai & Francescato 2000)


def even_punch():
    """A crossed mesh that is not graded."""
    mesh = la.meshes.rectangle((0, 4), (-2, 0), 8, 4)
    return replace(punch(8, 4), bodies={"soil": la.Body(mesh, SOIL)})


def vertical_cut():
    """Height 1 above a stratum of depth 1, crossed."""
    mesh = la.meshes.rectangle((0, 3), (-2, 0), 6, 4)
    x, y = mesh.p[:, mesh.t].mean(axis=1)
    soil = mesh.restrict(np.flatnonzero((x > 1) | (y < -1)))
    names = {
        "left": lambda x: x[0] == 0,
        "right": lambda x: x[0] == 3,
        "bottom": lambda x: x[1] == -2,
    }
    return la.Problem(
        bodies={"soil": la.Body(MeshTri(soil.p, soil.t).with_boundaries(names), SOIL)},
        supports=[la.Fix("soil", "bottom"), la.Fix("soil", "right"), la.Fix("soil", "left", "x")],
        reference_loads=[la.BodyForce("soil", (0, -1))],
    )


def case(name):
    """As the catalogue starts it."""
    found, (variant, *_) = find(name)
    return found.problem(variant, found.levels(variant)[0])


@dataclass(frozen=True)
class Bracketed:
    """A width with at most so many elements on each mesh; s by the clock as a bar and as an aim."""

    make: Callable[[], la.Problem]
    width: float
    elements: int
    bar: float | None = None
    aim: float | None = None
    sectors: int | None = None  # of a fan for the lower bound, by hand

    @property
    def lower_mesh(self):
        if self.sectors is None:
            return None
        return la.meshes.fan((0, 4), (-2, 0), (1, 0), self.sectors, 5, crossed=False)


RUNS = {
    "punch, fan, 1%": Bracketed(even_punch, 0.01, 1300, sectors=24),
    "punch, fan, 0.5%": Bracketed(even_punch, 0.005, 1300, sectors=24),
    "punch, fan, 0.2%": Bracketed(even_punch, 0.002, 6000, sectors=48),
    "punch, fan, 0.1%": Bracketed(even_punch, 0.001, 13_000, bar=2, sectors=48),
    "punch, fan, 0.02%": Bracketed(even_punch, 0.0002, 20_000, bar=20, sectors=96),
    "punch, 1%": Bracketed(even_punch, 0.01, 1300),
    "punch, 0.5%": Bracketed(even_punch, 0.005, 6000),
    "punch, 0.2%": Bracketed(even_punch, 0.002, 13_000, bar=5),
    "cut, 1%": Bracketed(vertical_cut, 0.01, 1300),
    "cut, 0.5%": Bracketed(vertical_cut, 0.005, 6000),
    "cut, 0.2%": Bracketed(vertical_cut, 0.002, 6000),
    "cut, 0.1%": Bracketed(vertical_cut, 0.001, 13_000, bar=6, aim=5),
    "cut, 0.02%": Bracketed(vertical_cut, 0.0002, 60_000, bar=90, aim=60),
    "notched-strip, 1%": Bracketed(partial(case, "notched-strip"), 0.01, 6000),
    "notched-strip, 0.5%": Bracketed(partial(case, "notched-strip"), 0.005, 6000),
} | {
    f"{name}, 0.2%": Bracketed(partial(case, name), 0.002, 13_000, bar=5)
    for name in (
        "rough-platens-2",
        "notched-strip",
        "centre-crack:plane-strain",
        "opposed-punches:h-2",
        "plate-hole",
    )
}


def timed(run, jobs, backend="auto"):
    """A bracket, its processor time and its time by the clock."""
    problem, below = run.make(), run.lower_mesh
    begin, started = time.process_time(), time.perf_counter()
    found = la.bracket(
        problem, run.width, run.elements, lower_mesh=below, backend=backend, jobs=jobs
    )
    return found, time.process_time() - begin, time.perf_counter() - started


@pytest.fixture(scope="module")
def loaded(one_thread):
    """Imports, libraries and compiled loops, by brackets of no account."""
    for backend in ("clarabel", "interior_point"):
        la.bracket(even_punch(), 0.5, backend=backend)


@pytest.mark.slow
@pytest.mark.parametrize("name", RUNS)
@pytest.mark.benchmark(group="bracket")
def test_bracket(benchmark, loaded, name):
    """One bound at a time, then two: the same bounds."""
    run = RUNS[name]
    found, seconds, _ = benchmark.pedantic(timed, args=(run, 1), rounds=1)
    again, of_both, wall = timed(run, 2)
    last = Model(found.upper_bound.discretisation.problem)
    most = found.history.groupby("bound").elements.max()
    elastic = elastic_seconds(last)
    benchmark.extra_info.update(
        kind="bracket",
        what=name,
        asked=run.width,
        width=found.width,
        lower=found.lower,
        upper=found.upper,
        triangles_lower=int(most["lower"]),
        triangles_upper=int(most["upper"]),
        solves=len(found.history),
        seconds=seconds,
        of_both=of_both,
        wall=wall,
        bar=run.bar,
        aim=run.aim,
        elastic_seconds=elastic,
        elastic_solves=seconds / elastic,
        direct_solver=symmetric_solver().name,
    )
    assert found.status is la.Ending.REACHED
    assert (again.lower, again.upper) == (found.lower, found.upper)
    assert found.history.elements.max() <= run.elements
    gaps = found.gaps()
    assert gaps.total == pytest.approx(gaps.upper - gaps.lower, rel=1e-5)
    assert gaps.least >= -1e-9
    assert known(found, name)


def known(found, name):
    """Whether a bracket is proven of the continuum, and holds what is known of its load."""
    if not name.startswith(("punch", "cut")):
        return True
    low, high = (PRANDTL, PRANDTL) if name.startswith("punch") else CUT
    return found.strict and found.lower <= high and found.upper >= low


BACKENDS = ("auto", "clarabel", "interior_point", "cvxpy", "cvxpy:QOCO", "cvxpy:ECOS")
PEERS = ("cut, 1%", "punch, fan, 1%", "cut, 0.1%", "punch, fan, 0.1%")


@pytest.mark.slow
@pytest.mark.parametrize("name", dear(PEERS, ["cut, 0.1%"]))
@pytest.mark.benchmark(group="bracket")
def test_peers(benchmark, loaded, name, in_this_process):
    """The same bracket by each backend, one bound at a time: in one run, so ratios count."""
    installed = [name for name in BACKENDS if not load_backend(name).unavailable()]
    for backend in installed:
        la.bracket(even_punch(), 0.5, backend=backend)

    def each():
        return {backend: timed(RUNS[name], 1, backend)[:2] for backend in installed}

    found = benchmark.pedantic(each, rounds=1)
    least = found["auto"][1]
    benchmark.extra_info.update(
        kind="bracket peers",
        what=name,
        runs=[
            {
                "what": name,
                "backend": backend,
                "asked": RUNS[name].width,
                "width": one.width,
                "solves": len(one.history),
                "ending": one.status.label,
                "seconds": seconds,
                "ratio": seconds / least,
            }
            for backend, (one, seconds) in found.items()
        ],
    )
    assert found["auto"][0].status is la.Ending.REACHED
    assert all(known(one, name) for one, _ in found.values() if np.isfinite(one.width))


@pytest.mark.slow
@pytest.mark.parametrize(("name", "make"), [("punch", even_punch), ("cut", vertical_cut)])
@pytest.mark.benchmark(group="bracket")
def test_orders(benchmark, loaded, name, make):
    """Width against elements: adaptive -1 or better, even meshes -0.4 to -0.5."""

    def uniform():
        widths, elements = [], []
        problem = make()
        ((body_name, body),) = problem.bodies.items()
        mesh = body.mesh
        for _ in range(3):
            stated = replace(problem, bodies={body_name: replace(body, mesh=mesh)})
            lower, upper = la.lower_bound(stated).load_factor, la.upper_bound(stated).load_factor
            widths.append(width(lower, upper))
            elements.append(mesh.nelements)
            mesh = mesh.refined()
        return np.polyfit(np.log(elements), np.log(widths), 1)[0]

    def adaptive():
        history = la.bracket(make(), 0.003).history
        both = history[history.bound == "upper"]
        both = both[both.width < 0.1]  # after the first meshes, which see little
        return np.polyfit(np.log(both.elements), np.log(both.width), 1)[0]

    orders = benchmark.pedantic(lambda: (uniform(), adaptive()), rounds=1)
    benchmark.extra_info.update(kind="bracket order", what=name, even=orders[0], adaptive=orders[1])
    assert -0.55 < orders[0] < -0.35
    assert orders[1] < -0.9
