"""Share of a reaction loop that passes between the calls of its backend: our own Python."""

import time

import pytest

import lacore as la
from lacore.coupling.fixed_point import reaction_loop
from lacore.coupling.options import CouplingOptions
from lacore.coupling.run import Run
from lacore.program.kinematic import dimensionless
from lacore_verification.catalogue.catalogue import find
from tests.benchmarks.measuring import Clocked

MESHES = {
    "deformable-block:sliding": {"n": 18},
    "platens-coulomb:mu-0.2": {"nx": 50, "ny": 25, "ratio": 60.0},
}


@pytest.mark.slow
@pytest.mark.parametrize("name", MESHES)
@pytest.mark.benchmark(group="loop", timer=time.process_time)
def test_loop(benchmark, one_thread, name):
    case, (variant,) = find(name)
    problem = case.build(**MESHES[name], **variant.parameters)
    d = la.discretise(problem)
    program = dimensionless(d.program, d.natural)
    backend = la.find_backend("clarabel")
    solver = Clocked(backend).prepare(program, backend.Options())
    coupled = benchmark.pedantic(
        reaction_loop,
        args=(Run(program, solver, False, CouplingOptions(), lambda _: None),),
        rounds=1,
    )
    total = benchmark.stats.stats.min
    inside = sum(iterate.inner.solve_time for iterate in coupled.iterates)
    point = coupled.final.inner.point
    benchmark.extra_info.update(
        kind="loop",
        what=name,
        triangles=sum(body.mesh.nelements for body in problem.bodies.values()),
        unknowns=program.n,
        seconds=total,
        solves=len(coupled.iterates),
        iterations=sum(iterate.inner.iterations for iterate in coupled.iterates),
        own_share=1 - inside / total,
        status=coupled.status.label,
        load_factor=point.load_factor * program.scales.load_factor,
    )
    assert coupled.status is la.Status.SOLVED
